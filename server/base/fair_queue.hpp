// SPDX-License-Identifier: Apache-2.0
// A queue for a resource that callers share, such as memory for images. Each caller may hold as much as
// FairShare allows, granted in the order of arrival. The first waiting caller that holds nothing is not
// overtaken, so that small requests cannot starve a large one. A caller that holds something waits until
// enough is given back, and does not block others. Thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "server/base/fair_share.hpp"

namespace tessera::base {

class FairQueue {
 public:
  // At most `max_waiting` requests wait, and each caller has its share of these.
  FairQueue(std::uint64_t all, std::uint64_t max_waiting);

  // Called once with the grant, under no lock of the queue; must be short. The thread that gives something
  // back also runs the callbacks of the requests that this satisfies.
  using Granted = std::function<void(FairShare::Held)>;

  // Waits under the unique key `who`. The request is granted later, or before this returns. Returns false,
  // and does nothing, if too many requests wait.
  [[nodiscard]] bool wait(const void* who, const std::string& caller, std::uint64_t amount, Granted granted);
  // Cancels the request. Returns whether it still waited; it is not granted after that.
  bool leave(const void* who);

  // The amount that all callers hold together.
  std::uint64_t held() const;

 private:
  struct State;
  const std::shared_ptr<State> state_;
};

}  // namespace tessera::base
