// SPDX-License-Identifier: Apache-2.0
// Changes of jobs.
#include <fmt/format.h>

#include <optional>
#include <thread>
#include <utility>

#include "core/common/log.hpp"
#include "server/jobs/continuation.hpp"
#include "server/jobs/find_job.hpp"
#include "server/jobs/job_service.hpp"

namespace tessera::jobs {

using farm::JobRecord;
using farm::JobSnapshot;
using farm::StateLock;

core::Result<v1::Job> JobService::get(const std::string& id) {
  const auto found = find_job(farm_, state_.jobs, id);
  if (!found) return core::fail(found.error());
  return describe(found->snapshot);
}

core::Result<v1::Job> JobService::get_without_bundle(const std::string& id) {
  const auto found = find_job(farm_, state_.jobs, id);
  if (!found) return core::fail(found.error());
  return describe_without_bundle(found->snapshot);
}

core::Result<v1::Job> JobService::summary(const std::string& id) {
  const auto found = find_job(farm_, state_.jobs, id);
  if (!found) return core::fail(found.error());
  return summarise(found->snapshot);
}

core::Result<v1::Job> JobService::change(const std::string& id, const scheduler::Event& event) {
  const auto change_in_memory = [&]() -> std::optional<core::Result<JobSnapshot>> {
    StateLock lock(farm_);
    if (auto enough = lock.expect_memory(); !enough) return core::fail(enough.error());
    if (lock->find_validating(id) != nullptr) return core::fail(is_being_validated(id));
    JobRecord* const record = lock->find_job(id);
    if (record == nullptr) return std::nullopt;
    if (const auto done = lock.handle(event).status; !done) return core::fail(done.error());
    lock.change(*record);
    return lock.snapshot_of(*record);
  };
  for (;;) {
    if (auto changed = change_in_memory()) return store_change(*std::move(changed));
    const auto found = find_job(farm_, state_.jobs, id);
    if (!found) return core::fail(found.error());
    if (!found->is_settled) {
      std::this_thread::yield();
      continue;
    }
    if (auto answer = answer_of_finished(found->snapshot, event); !answer) return core::fail(answer.error());
    return describe(found->snapshot);
  }
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
  if (const auto ended = end_unvalidated(id, scheduler::JobState::kCancelled, {})) {
    if (!*ended) return core::fail(ended->error());
    return farm::describe(**ended);
  }
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
    common::log(spdlog::level::info,
                fmt::format("job {} ({}) has priority {} and at most {} workers (0: any number)",
                            updated->id(), updated->name(), updated->priority(), updated->max_workers()),
                {.job = updated->id()});
  return updated;
}

core::Status JobService::remove(const std::string& id) {
  if (const auto removed = remove_validating(id)) return *removed;
  const core::MutexLock nobody_moves_it(moving_mutex_);
  if (auto enough = StateLock(farm_).expect_memory(); !enough) return enough;
  if (const auto found = find_job(farm_, state_.jobs, id); !found) return core::fail(found.error());
  // From the store first: a job that is deleted only from memory would be back after a restart.
  if (const core::Status deleted = state_.jobs.delete_job(id); !deleted) return deleted;
  files_.note_deleted();
  std::map<std::string, JobRecord>::node_type removed;  // destroyed without the lock
  StateLock lock(farm_);
  lock.log(spdlog::level::info, fmt::format("job {} deleted", id), {.job = id});
  if (lock->find_job(id) == nullptr) {
    farm_.events().append_end(events::SubjectKind::kJob, id);
    return {};
  }
  if (const auto done = lock.handle(scheduler::DeleteJob{{id}}).status; !done) return done;
  removed = lock.remove_job(id);
  return {};
}

}  // namespace tessera::jobs
