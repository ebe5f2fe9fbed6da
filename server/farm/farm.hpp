// SPDX-License-Identifier: Apache-2.0
// The state of a farm behind one lock: the scheduler, the jobs, and the calls of workers that wait.
//
// StateLock (state_lock.hpp) is the only access to it. Only decisions of the scheduler are made under the
// lock, which takes microseconds. Samples are added to films, messages built, images developed and lines
// logged without it. Thread-safe.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/determinism_fingerprint.hpp"
#include "core/base/mutex.hpp"
#include "core/common/rate_limited_log.hpp"
#include "server/base/duration_histogram.hpp"
#include "server/base/memory_reserve.hpp"
#include "server/events/event_log.hpp"
#include "server/farm/drains.hpp"
#include "server/farm/job_record.hpp"
#include "server/farm/quarantine.hpp"
#include "server/farm/troubles.hpp"
#include "server/farm/validating_job.hpp"
#include "server/farm/waiting_calls.hpp"
#include "server/scheduler/ranked_set.hpp"
#include "server/scheduler/scheduler.hpp"

namespace tessera::farm {

struct Options {
  // The heartbeat timeout: a worker that is silent for longer loses its leases. See scheduler::Options.
  scheduler::Duration lease_duration = std::chrono::seconds(10);
  // The share of ranges that a second worker renders again to compare the bits: 0 to 1.
  double audit_share = 0;
  // The determinism fingerprints that workers may have. Not empty. The default is that of the coordinator's
  // own release.
  std::set<std::string> fingerprints{std::string(core::kDeterminismFingerprint)};
  // The clock that measures how long the state lock is held.
  std::function<std::chrono::nanoseconds()> hold_clock = [] {
    return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch());
  };
  // The clock. Tests replace it.
  std::function<scheduler::Time()> now = std::chrono::steady_clock::now;
  // See scheduler::Options.
  std::uint32_t epoch = 1;
  scheduler::SignLease sign{};

  // A worker that is silent for so long is forgotten.
  scheduler::Duration forget_after() const { return 10 * lease_duration; }
};

// How full the cache folder of a worker is.
struct CacheUse {
  std::uint64_t used_bytes = 0, limit_bytes = 0;
  bool operator==(const CacheUse&) const = default;
};

// A registered worker, for the log.
struct PresentWorker {
  std::string name, principal;
};

// Lines about workers, of which callers can cause any number.
struct Logs {
  static constexpr std::size_t kMaxEvents = 100;

  common::RateLimitedLog rejections, troubles;
  // Of single workers.
  common::RateLimitedLog registered{kMaxEvents}, lost{kMaxEvents}, quarantined{kMaxEvents},
      stalled{kMaxEvents};

  // Calls visit(log) for each.
  template <typename Visit>
  void for_each(const Visit& visit) {
    for (common::RateLimitedLog* const log :
         {&rejections, &troubles, &registered, &lost, &quarantined, &stalled})
      visit(*log);
  }
};

// What the state lock guards.
struct State {
  explicit State(const Options& options);

  // Null if there is none.
  JobRecord* find_job(const std::string& id);
  const JobRecord* find_job(const std::string& id) const;
  // Adds a job that the scheduler has.
  void add_job(JobRecord record) noexcept;
  // Removes a job that the scheduler no longer has. The caller destroys the returned record without the lock.
  std::map<std::string, JobRecord>::node_type remove_job(const std::string& id);
  // Null if there is none.
  ValidatingJob* find_validating(const std::string& id);
  const ValidatingJob* find_validating(const std::string& id) const;
  // Adds a job that is to be validated, and removes one that no longer is. The caller destroys the returned
  // job without the lock.
  ValidatingJob& add_validating(ValidatingJob job) noexcept;
  std::map<std::string, ValidatingJob>::node_type remove_validating(const std::string& id);
  // Counts a job toward its owner's unfinished ones, or no longer.
  void set_open(JobRecord& record, bool is_open);
  void count_open_job(const std::string& owner, int change);

  scheduler::Scheduler scheduler;
  std::map<std::string, JobRecord> jobs;            // by id
  std::map<std::string, ValidatingJob> validating;  // by id; none of them is in `jobs`
  // How many have ended without becoming running, by scheduler::JobState.
  std::array<std::uint64_t, scheduler::kJobStates> ended_unvalidated{};
  scheduler::RankedSet<events::Revision> validating_order;  // their revisions: the first submitted first
  std::map<std::string, std::string> job_of_request;        // ids by request_id
  // The unfinished jobs of each owner, with those that are being submitted (jobs/quota.hpp) or validated.
  // Without zeros.
  std::map<std::string, std::int64_t> open_jobs;
  WaitingCalls waiting;
  // Workers to which new work is offered next; the lock is released in between.
  std::deque<std::string> to_offer;
  Quarantine quarantine;
  Drains drains;
  Troubles troubles;
  std::map<std::string, CacheUse> caches;  // by worker; of those that report it
  Logs logs;
  std::set<std::string> to_reopen;  // jobs
  // Workers of which stored jobs may have samples: these are to be found and reopened.
  std::vector<scheduler::Producer> to_search;
  // For the log: the registered workers by id, and the addresses that workers last called from.
  std::map<std::string, PresentWorker> present;
  std::map<std::string, std::string> peers;
  // Somebody waits for a checkpoint: users learn that a job is done or has failed after the next one.
  bool checkpoint_is_awaited = false;
  bool closed = false;
};

class Farm {
 public:
  explicit Farm(Options options)
      : options_(std::move(options)),
        events_(options_.epoch),
        lock_holds_(hold_bounds()),
        first_samples_(first_samples_bounds()),
        state_(options_) {}

  const Options& options() const { return options_; }
  // Readers of the log need no state lock. Changes are appended by StateLock.
  events::EventLog& events() { return events_; }
  // How long the state lock was held, each time.
  const base::DurationHistogram& lock_holds() const { return lock_holds_; }
  // The time from the submission of each job until its first samples were counted.
  const base::DurationHistogram& first_samples() const { return first_samples_; }
  // What decisions under the state lock may use when memory runs out.
  base::MemoryReserve& memory_reserve() { return memory_reserve_; }
  // What StateLock locks, for annotations.
  core::Mutex& mutex() TESSERA_RETURNS(mutex_) { return mutex_; }

 private:
  friend class StateLock;

  // From 10 µs to a second.
  static std::vector<std::chrono::nanoseconds> hold_bounds();
  // From 0.1 s to two hours.
  static std::vector<std::chrono::nanoseconds> first_samples_bounds();

  const Options options_;
  events::EventLog events_;
  base::DurationHistogram lock_holds_, first_samples_;
  base::MemoryReserve memory_reserve_;
  // The same for what is deferred until the lock is released, by several threads at once.
  base::MemoryReserve deferred_reserve_;
  core::Mutex mutex_;
  State state_ TESSERA_GUARDED_BY(mutex_);
};

}  // namespace tessera::farm
