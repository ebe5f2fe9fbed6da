// SPDX-License-Identifier: Apache-2.0
// The state lock: gives access to the state of a farm while it holds the mutex, reads the clock once, and
// runs deferred callbacks after the mutex is released.
#pragma once

#include <spdlog/common.h>

#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "server/farm/farm.hpp"

namespace tessera::farm {

class StateLock {
 public:
  explicit StateLock(Farm& farm);
  ~StateLock();
  StateLock(const StateLock&) = delete;
  StateLock& operator=(const StateLock&) = delete;

  State* operator->() { return &state_; }
  const State* operator->() const { return &state_; }
  const Options& options() const { return options_; }
  scheduler::Time now() const { return now_; }

  // Runs the callback after the mutex is released.
  void later(std::function<void()> action) { later_.push_back(std::move(action)); }
  // Logs after the mutex is released.
  void log(spdlog::level::level_enum level, std::string line);
  // As log(), each limited to a line in ten seconds.
  void log_rejection(std::string line) { log_some(state_.rejected_log, std::move(line)); }
  void log_trouble(std::string line) { log_some(state_.troubles_log, std::move(line)); }
  // Logs suppressed lines that are due.
  void log_suppressed();

  // A snapshot of a job that exists.
  JobSnapshot snapshot_of(const JobRecord& record) const;

  // Advances the scheduler by one event and does what follows. Returns the actions, which are done.
  scheduler::Actions handle(const scheduler::Event& event);
  // Does what follows from an event: notes changes of jobs, quarantines workers, and offers new work to
  // workers whose calls wait.
  void apply(const scheduler::Actions& actions);

 private:
  void log_some(base::RateLimitedLog& log, std::string line);
  void note_change(const scheduler::JobChange& change);
  void follow_audits(const scheduler::Actions& actions);

  std::unique_lock<std::mutex> lock_;
  const Options& options_;
  State& state_;
  const scheduler::Time now_;
  std::vector<std::function<void()>> later_;
};

}  // namespace tessera::farm
