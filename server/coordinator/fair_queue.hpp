// SPDX-License-Identifier: Apache-2.0
// What callers share and wait for, such as memory for pictures: each may have as much as FairShare says, and
// is given it in the order in which they came. Who has nothing and comes next is not overtaken, so that a
// large amount comes together however many small ones are wanted after it; who has something already waits
// for what they give back, and holds up nobody. Thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "server/coordinator/fair_share.hpp"

namespace tessera::coordinator {

class FairQueue {
 public:
  // At most `max_waiting` wait, and of those each caller has its share.
  FairQueue(std::uint64_t all, std::uint64_t max_waiting);

  // Called once with what was granted, under no lock of the queue; must be short. What is given back is
  // granted to those who wait on the same thread.
  using Granted = std::function<void(FairShare::Held)>;

  // Waits as `who`, which nobody else does. It is granted later, or before this returns. False, and nothing
  // happens, if too many wait.
  [[nodiscard]] bool wait(const void* who, const std::string& caller, std::uint64_t amount, Granted granted);
  // Whether `who` still waited: then it is not granted any more.
  bool leave(const void* who);

  // How much all together have.
  std::uint64_t held() const;

 private:
  struct State;
  const std::shared_ptr<State> state_;
};

}  // namespace tessera::coordinator
