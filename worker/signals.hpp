// SPDX-License-Identifier: Apache-2.0
// SIGINT and SIGTERM as a stop token: the first asks for an orderly end, the second ends the process at once.
#pragma once

#include <stop_token>
#include <thread>

namespace tessera::worker {

// Signals belong to the process: to be made once, in main, before any other thread is started (threads
// inherit which signals they leave to this one).
class StopSignals {
 public:
  StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  std::stop_token token() const { return stop_.get_token(); }
  // Signals from now on are left to the program that this process is about to become.
  void leave_pending() { thread_ = {}; }

 private:
  std::stop_source stop_;
  std::jthread thread_;
};

}  // namespace tessera::worker
