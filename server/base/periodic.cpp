// SPDX-License-Identifier: Apache-2.0
#include "server/base/periodic.hpp"

#include <utility>

namespace tessera::base {

Periodic::Periodic(std::chrono::milliseconds period, std::function<void()> call)
    : period_(period), call_(std::move(call)) {
  thread_ = std::thread([this] {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait_for(lock, period_ / 4, [this] { return stopping_; });
      changed_.wait_for(lock, period_ - period_ / 4, [this] { return stopping_ || hurried_; });
      if (stopping_) return;
      hurried_ = false;
      lock.unlock();
      call_();
      lock.lock();
    }
  });
}

Periodic::~Periodic() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Periodic::trigger() {
  {
    const std::lock_guard lock(mutex_);
    hurried_ = true;
  }
  changed_.notify_all();
}

}  // namespace tessera::base
