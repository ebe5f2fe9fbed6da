// SPDX-License-Identifier: Apache-2.0
// Shows the image of a job in tev while the job is watched.
#pragma once

#include <atomic>
#include <string>
#include <thread>

#include "client/farm/farm.hpp"
#include "client/notices.hpp"

namespace tessera::client {

class TevWatch {
 public:
  // Follows the job's tiles in a thread of its own, until the job is over or the command is interrupted. A
  // missing or lost tev, and tiles that cannot be watched, become notices. `farm` and `notices` must outlive
  // this.
  TevWatch(Farm& farm, std::string job_id, std::string address, Notices& notices);
  // With `is_over`, as a job that is over, waits until tev has the last tile.
  void finish(bool is_over);
  ~TevWatch() { finish(false); }

 private:
  std::atomic<bool> is_last_{false};  // no further attempt
  std::jthread thread_;
};

}  // namespace tessera::client
