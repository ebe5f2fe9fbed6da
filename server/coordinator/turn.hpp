// One turn at the coordinator's gate: the lock, the time, and answers that go out when the lock is released.
#pragma once

#include <functional>
#include <mutex>
#include <utility>
#include <vector>

#include "server/coordinator/coordinator.hpp"

namespace tessera::coordinator {

class Coordinator::Turn {
 public:
  explicit Turn(Coordinator& coordinator) : lock_(coordinator.gate_), now_(coordinator.options_.now()) {}
  ~Turn() {
    lock_.unlock();
    for (const auto& action : later_) action();
  }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

  scheduler::Time now() const { return now_; }
  // Does it after the turn.
  void later(std::function<void()> action) { later_.push_back(std::move(action)); }

 private:
  std::unique_lock<std::mutex> lock_;
  const scheduler::Time now_;
  std::vector<std::function<void()>> later_;
};

}  // namespace tessera::coordinator
