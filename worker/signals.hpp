// SPDX-License-Identifier: Apache-2.0
// Turns SIGINT and SIGTERM into a stop token: the first requests an orderly stop. A SIGINT after it ends the
// process at once; a SIGTERM after it changes nothing.
#pragma once

#include <stop_token>
#include <thread>

namespace tessera::worker {

// Signals belong to the process: create it once, in main, before any other thread starts (threads inherit the
// signal mask).
class StopSignals {
 public:
  StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  std::stop_token token() const { return stop_.get_token(); }
  // Leaves further signals pending for the program that replaces this one.
  void leave_pending() { thread_ = {}; }

 private:
  std::stop_source stop_;
  std::jthread thread_;
};

}  // namespace tessera::worker
