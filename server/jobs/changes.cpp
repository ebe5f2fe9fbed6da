// SPDX-License-Identifier: Apache-2.0
// Lists and changes of jobs.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <limits>
#include <utility>

#include "server/jobs/job_service.hpp"

namespace tessera::jobs {

using core::ErrorCode;
using farm::JobRecord;
using farm::JobSnapshot;
using farm::StateLock;

namespace {

core::Error no_job(const std::string& id) {
  return {ErrorCode::kNotFound, fmt::format("there is no job {}", id)};
}

}  // namespace

std::optional<JobSnapshot> JobService::snapshot(const std::string& id) {
  const StateLock lock(farm_);
  const JobRecord* record = lock->find_job(id);
  if (record == nullptr) return std::nullopt;
  return lock.snapshot_of(*record);
}

core::Result<v1::Job> JobService::get(const std::string& id) {
  const auto found = snapshot(id);
  if (!found) return core::fail(no_job(id));
  return describe(*found);
}

core::Result<v1::Job> JobService::get_without_bundle(const std::string& id) {
  const auto found = snapshot(id);
  if (!found) return core::fail(no_job(id));
  return summarise(*found);
}

std::vector<v1::Job> JobService::list(const v1::ListJobsRequest& request) {
  const std::size_t most =
      request.max_jobs() == 0 ? std::numeric_limits<std::size_t>::max() : request.max_jobs();
  std::vector<JobSnapshot> snapshots;
  {
    const StateLock lock(farm_);
    for (scheduler::JobView& view : lock->scheduler.jobs(lock.now(), request.id_prefix(), most)) {
      const JobRecord& record = *lock->find_job(view.id.value);
      snapshots.emplace_back(record, std::move(view));
    }
  }
  std::vector<v1::Job> jobs;
  for (auto each = snapshots.rbegin(); each != snapshots.rend(); ++each) jobs.push_back(summarise(*each));
  return jobs;
}

core::Result<v1::Job> JobService::change(const std::string& id, const scheduler::Event& event) {
  const auto changed = [&]() -> core::Result<JobSnapshot> {
    StateLock lock(farm_);
    if (const auto done = lock.handle(event).status; !done) return core::fail(done.error());
    JobRecord& record = *lock->find_job(id);
    ++record.revision;
    return lock.snapshot_of(record);
  };
  return store_change(changed());
}

core::Result<v1::Job> JobService::store_change(core::Result<JobSnapshot> changed) {
  if (!changed) return core::fail(changed.error());
  // Its samples come first: the next checkpoint stores that it is done.
  if (changed->is_unpublished) changed->view.state = scheduler::JobState::kRunning;
  if (auto stored = state_.jobs.update_job(to_row(*changed)); !stored) {
    return core::fail(stored.error().within("the job was changed, but a crash would undo it"));
  }
  return describe(*changed);
}

core::Result<v1::Job> JobService::cancel(const std::string& id) {
  return change(id, scheduler::CancelJob{{id}});
}

core::Result<v1::Job> JobService::pause(const std::string& id) {
  return change(id, scheduler::PauseJob{{id}});
}

core::Result<v1::Job> JobService::resume(const std::string& id) {
  return change(id, scheduler::ResumeJob{{id}});
}

core::Result<v1::Job> JobService::update(const v1::UpdateJobRequest& request) {
  scheduler::UpdateJob event{{request.job_id()}, {}, {}};
  if (request.has_priority()) event.priority = request.priority();
  if (request.has_max_workers()) event.max_workers = request.max_workers();
  auto updated = change(request.job_id(), event);
  if (updated)
    spdlog::info("job {} ({}) has priority {} and at most {} workers (0: any number)", updated->id(),
                 updated->name(), updated->priority(), updated->max_workers());
  return updated;
}

core::Status JobService::remove(const std::string& id) {
  // From the store first: a job that is deleted only from memory would be back after a restart.
  if (!snapshot(id)) return core::fail(no_job(id));
  if (const core::Status deleted = state_.jobs.delete_job(id); !deleted) return deleted;
  std::map<std::string, JobRecord>::node_type removed;  // destroyed without the lock
  StateLock lock(farm_);
  if (const auto done = lock.handle(scheduler::DeleteJob{{id}}).status; !done) return done;
  removed = lock->remove_job(id);
  lock.log(spdlog::level::info, fmt::format("job {} deleted", id));
  return {};
}

}  // namespace tessera::jobs
