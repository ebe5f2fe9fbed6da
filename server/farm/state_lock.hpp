// SPDX-License-Identifier: Apache-2.0
// The state lock: gives access to the state of a farm while it holds the mutex, reads the clock once, and
// runs deferred callbacks after the mutex is released.
//
// Allocations under the lock may use the memory reserve, and those of deferred callbacks a second one. What
// changes several parts of the state is noexcept: if the reserve is not enough, the process ends, and the
// next start continues from the store. So no change of these stays half-made.
#pragma once

#include <spdlog/common.h>

#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/mutex.hpp"
#include "server/farm/farm.hpp"

namespace tessera::farm {

class TESSERA_THREAD_ANNOTATION(scoped_lockable) StateLock {
 public:
  explicit StateLock(Farm& farm) TESSERA_ACQUIRE(farm.mutex());
  ~StateLock() TESSERA_RELEASE();
  StateLock(const StateLock&) = delete;
  StateLock& operator=(const StateLock&) = delete;

  State* operator->() { return &state_; }
  const State* operator->() const { return &state_; }
  const Options& options() const { return options_; }
  scheduler::Time now() const { return now_; }

  // RESOURCE_EXHAUSTED, to be repeated after a second, while memory is so scarce that the reserves are not
  // complete. For calls that can be refused before they change anything.
  core::Status expect_memory() const;

  // Runs the callback after the mutex is released.
  void later(std::function<void()> action) { later_.push_back(std::move(action)); }
  // Logs after the mutex is released.
  void log(spdlog::level::level_enum level, std::string line, common::LogFields fields = {});
  // As log(), each limited to a line in ten seconds.
  void log_rejection(std::string line, common::LogFields fields = {}) {
    log_some(state_.logs.rejections, {std::move(line), std::move(fields)});
  }
  void log_trouble(std::string line, common::LogFields fields = {}) {
    log_some(state_.logs.troubles, {std::move(line), std::move(fields)});
  }
  // What a line about a worker names besides: its principal, and the address that it last called from.
  common::LogFields fields_of_worker(const std::string& id) const;
  // Logs suppressed lines that are due.
  void log_suppressed();

  // A snapshot of a job that exists.
  JobSnapshot snapshot_of(const JobRecord& record) const;
  JobSnapshot snapshot_of(const ValidatingJob& job) const;

  // The job has changed, and the store must learn of it.
  void change(JobRecord& record) { record.revision = note_progress(record); }
  // The job has changed, but not what the store keeps of it besides its tiles. Returns the revision.
  events::Revision note_progress(JobRecord& record);
  void note_progress(ValidatingJob& job);
  // The first samples of a job are counted.
  void note_first_samples(JobRecord& record);
  // Removes a job that the scheduler no longer has. The caller destroys the returned record without the lock.
  std::map<std::string, JobRecord>::node_type remove_job(const std::string& id) noexcept;
  // Adds a job to the scheduler, by a SubmitJob or a RestoreJob, and does what follows. Nothing is changed if
  // the scheduler refuses it.
  core::Status add_job(const scheduler::Event& event, JobRecord record) noexcept;
  // Adds a job that is to be validated.
  void add_validating(ValidatingJob job) noexcept;
  // Removes a deleted job that was to be validated. The caller destroys the returned job without the lock.
  std::map<std::string, ValidatingJob>::node_type delete_validating(const std::string& id) noexcept;
  // What is known of a worker besides the scheduler has changed.
  void note_worker(const std::string& id);
  // Puts a worker into quarantine, if it is not in it, and logs that. Its leases stay.
  void quarantine(const scheduler::Producer& producer, const std::string& because) noexcept;

  // Advances the scheduler by one event and does what follows. Returns the actions, which are done.
  scheduler::Actions handle(const scheduler::Event& event) noexcept;
  // Does what follows from an event: notes changes of jobs, quarantines workers, and offers new work to
  // workers whose calls wait. If these are many, the others are offered it after the mutex is released.
  void apply(const scheduler::Actions& actions) noexcept;

 private:
  // Refills the reserves, which takes no lock, and returns that of decisions.
  static base::MemoryReserve& refilled_reserve(Farm& farm);
  void log_some(common::RateLimitedLog& log, common::LogLine line);
  void note_change(const scheduler::JobChange& change);
  void append_events(const scheduler::Actions& actions);
  void follow_audits(const scheduler::Actions& actions);
  void offer_later(const std::string& worker);
  void continue_offers() noexcept;
  // Logs that a worker has registered or is lost, and forgets one that the scheduler has forgotten.
  void note_presence(const scheduler::WorkerId& worker);

  Farm& farm_;
  base::MemoryReserve::Scope reserve_;
  core::MutexLock lock_;
  const std::chrono::nanoseconds since_;  // by Options::hold_clock
  const Options& options_;
  events::EventLog& events_;
  State& state_;
  const scheduler::Time now_;
  std::vector<std::function<void()>> later_;
  // The workers that were offered work under this lock, each once: leases for one are not free for the next.
  std::set<std::string> offered_;
  bool continues_offers_ = false;
};

}  // namespace tessera::farm
