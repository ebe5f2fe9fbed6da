// SPDX-License-Identifier: Apache-2.0
// The state of a farm behind one lock: the scheduler, the jobs, and the calls of workers that wait.
//
// StateLock (state_lock.hpp) is the only access to it. Only decisions of the scheduler are made under the
// lock, which takes microseconds. Samples are added to films, messages built, images developed and lines
// logged without it. Thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <utility>

#include "core/base/determinism_fingerprint.hpp"
#include "server/base/rate_limited_log.hpp"
#include "server/farm/job_record.hpp"
#include "server/farm/quarantine.hpp"
#include "server/farm/troubles.hpp"
#include "server/farm/waiting_calls.hpp"
#include "server/scheduler/scheduler.hpp"

namespace tessera::farm {

struct Options {
  // The heartbeat timeout: a worker that is silent for longer loses its leases. See scheduler::Options.
  scheduler::Duration lease_duration = std::chrono::seconds(10);
  // The share of ranges that a second worker renders again to compare the bits: 0 to 1.
  double audit_share = 0;
  // The determinism fingerprint that workers need to join. The default is that of the coordinator's own
  // release.
  std::string fingerprint{core::kDeterminismFingerprint};
  // The clock. Tests replace it.
  std::function<scheduler::Time()> now = std::chrono::steady_clock::now;
  // See scheduler::Options.
  std::uint32_t epoch = 1;
  scheduler::SignLease sign{};
};

// What the state lock guards.
struct State {
  explicit State(const Options& options);

  // Null if there is none.
  JobRecord* find_job(const std::string& id);
  const JobRecord* find_job(const std::string& id) const;
  // Adds a job that the scheduler has.
  JobRecord& add_job(JobRecord record);
  // Removes a job that the scheduler no longer has. The caller destroys the returned record without the lock.
  std::map<std::string, JobRecord>::node_type remove_job(const std::string& id);
  // Counts a job toward its submitter's unfinished ones, or no longer.
  void set_open(JobRecord& record, bool is_open);
  void count_open_job(const std::string& submitter, int change);

  scheduler::Scheduler scheduler;
  std::map<std::string, JobRecord> jobs;              // by id
  std::map<std::string, std::string> job_of_request;  // ids by request_id
  // The unfinished jobs of each submitter, with those that are being checked (jobs/quota.hpp). Without zeros.
  std::map<std::string, std::int64_t> open_jobs;
  std::map<std::string, WaitingCall> waiting;  // by worker
  Quarantine quarantine;
  Troubles troubles;
  base::RateLimitedLog rejected_log, troubles_log;
  std::set<std::string> to_reopen;             // jobs
  std::map<std::string, std::string> present;  // names of the registered workers by id, for the log
  // Somebody waits for a checkpoint: users learn that a job is done or has failed after the next one.
  bool checkpoint_is_awaited = false;
  bool closed = false;
};

class Farm {
 public:
  explicit Farm(Options options) : options_(std::move(options)), state_(options_) {}

  const Options& options() const { return options_; }

 private:
  friend class StateLock;

  const Options options_;
  std::mutex mutex_;
  State state_;  // guarded by mutex_
};

}  // namespace tessera::farm
