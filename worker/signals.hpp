// SPDX-License-Identifier: Apache-2.0
// Turns SIGINT and SIGTERM into a stop token: the first requests an orderly stop. A SIGINT after it ends the
// process at once; a SIGTERM after it changes nothing. SIGHUP calls a function.
#pragma once

#include <functional>
#include <stop_token>
#include <thread>

#include "core/base/mutex.hpp"

namespace tessera::worker {

// Signals belong to the process: create it once, in main, before any other thread starts (threads inherit the
// signal mask).
class StopSignals {
 public:
  StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  // Calls this with each SIGHUP from now on, in a thread that does nothing else. Before, SIGHUP changes
  // nothing.
  void on_hangup(std::function<void()> call);
  std::stop_token token() const { return stop_.get_token(); }
  // Leaves further signals pending for the program that replaces this one.
  void leave_pending() { thread_ = {}; }

 private:
  void listen(const std::stop_token& not_needed);
  void note_stop(int signal);
  void note_hangup();

  std::stop_source stop_;
  core::Mutex mutex_;
  std::function<void()> hangup_ TESSERA_GUARDED_BY(mutex_);
  std::jthread thread_;
};

}  // namespace tessera::worker
