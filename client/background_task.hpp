// SPDX-License-Identifier: Apache-2.0
// Work that is repeated in a thread of its own while a render goes on.
#pragma once

#include <functional>
#include <string>
#include <thread>

#include "core/base/error.hpp"

namespace tessera::client {

class BackgroundTask {
 public:
  // Calls `task` every `seconds`, for the first time after that time; less often where it takes long, so that
  // it never takes more than half of the thread's time. `report` gets the message of each failure, in the
  // same thread.
  BackgroundTask(double seconds, std::function<core::Status()> task,
                 std::function<void(const std::string&)> report);

  // Destruction waits for a call in progress.

 private:
  std::jthread thread_;
};

}  // namespace tessera::client
