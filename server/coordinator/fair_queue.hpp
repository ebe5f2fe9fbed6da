// What callers share and wait for, such as memory for pictures: each may have as much as FairShare says, and
// is given it in the order in which they came. Who has nothing and comes next is not overtaken, so that a
// large amount comes together however many small ones are wanted after it; who has something already waits
// for what they give back, and holds up nobody. Thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "server/coordinator/fair_share.hpp"

namespace tessera::coordinator {

class FairQueue {
 public:
  // At most `max_waiting` wait, and of those each caller has its share.
  FairQueue(std::uint64_t all, std::uint64_t max_waiting);

  // What was granted; destroyed, it is given back, and granted to those who wait on the same thread.
  class Held {
   public:
    Held(Held&&) noexcept = default;
    Held& operator=(Held&&) = delete;
    ~Held();

   private:
    friend class FairQueue;
    struct State;
    Held(std::shared_ptr<State> state, FairShare::Held held);

    std::shared_ptr<State> state_;  // null when moved from
    std::optional<FairShare::Held> held_;
  };
  // Called once, under no lock of the queue; must be short.
  using Granted = std::function<void(Held)>;

  // Waits as `who`, which nobody else does. It is granted later, or before this returns. False, and nothing
  // happens, if too many wait.
  [[nodiscard]] bool wait(const void* who, const std::string& caller, std::uint64_t amount, Granted granted);
  // Whether `who` still waited: then it is not granted any more.
  bool leave(const void* who);

  // How much all together have.
  std::uint64_t held() const;

 private:
  const std::shared_ptr<Held::State> state_;
};

}  // namespace tessera::coordinator
