// SPDX-License-Identifier: Apache-2.0
// The lifecycle of jobs, as users direct it.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "server/scheduler/changes.hpp"
#include "server/scheduler/scheduler.hpp"

namespace tessera::scheduler {
namespace {

bool fits(const std::vector<IntervalSet>& done, const JobShape& shape) {
  const int tiles = shape.grid().tile_count();
  if (done.size() != static_cast<std::size_t>(tiles)) return false;
  for (int tile = 0; tile < tiles; ++tile) {
    const IntervalSet& samples = done[static_cast<std::size_t>(tile)];
    if (!samples.empty() && samples.ranges().back().end > shape.target(tile)) return false;
  }
  return true;
}

core::Status check_extension(const Job& job, const ExtendJob& event) {
  const bool only_tiles = event.spp == 0 && !event.tiles.empty();
  if (event.spp < job.shape().spp && !only_tiles) {
    return core::fail(core::ErrorCode::kInvalidArgument,
                      fmt::format("job {} has {} samples per pixel already: ask for more, got {}",
                                  event.id.value, job.shape().spp, event.spp));
  }
  const std::size_t targets = job.shape().targets.all().size() + event.tiles.size();
  if (!event.tiles.empty() && targets > kMaxTileTargets) {
    return core::fail(core::ErrorCode::kInvalidArgument,
                      fmt::format("job {} can have {} tiles with targets of their own: raise that of all",
                                  event.id.value, kMaxTileTargets));
  }
  const auto unknown = std::find_if(event.tiles.begin(), event.tiles.end(),
                                    [&](const TileTarget& each) { return !job.has_tile(each.tile); });
  if (unknown == event.tiles.end()) return {};
  return core::fail(core::ErrorCode::kInvalidArgument,
                    fmt::format("job {} has no tile {}", event.id.value, unknown->tile));
}

}  // namespace

core::Status Scheduler::may_add(const JobId& id, const JobShape& shape) const {
  if (auto possible = check_shape(shape); !possible) return possible;
  if (find(id) != nullptr) {
    return core::fail(core::ErrorCode::kAlreadyExists, fmt::format("there is a job {} already", id.value));
  }
  return {};
}

Worker* Scheduler::on(const SubmitJob& event, Actions& actions) {
  actions.status = may_add(event.id, event.shape);
  if (actions.status)
    add(event.id, event.shape, {event.priority, event.max_workers}, JobState::kRunning, {}, actions);
  return nullptr;
}

Worker* Scheduler::on(const RestoreJob& event, Actions& actions) {
  actions.status = may_add(event.id, event.shape);
  if (actions.status && !fits(event.done, event.shape)) {
    actions.status =
        core::fail(core::ErrorCode::kInvalidArgument,
                   fmt::format("the stored samples of job {} are not of its shape", event.id.value));
  }
  if (!actions.status) return nullptr;

  Job& job =
      add(event.id, event.shape, {event.priority, event.max_workers}, event.state, event.done, actions);
  job.failure = event.failure;
  job.set_determinism_fingerprint(event.determinism_fingerprint);
  job.failure_details = event.failure_details;
  restore_producers(job, event.provenance);
  if (event.state == JobState::kRunning && settled(job)) become(job, JobState::kDone, actions);
  if (event.state == JobState::kDone && !settled(job)) become(job, JobState::kRunning, actions);
  return nullptr;
}

Worker* Scheduler::on(const ReopenJob& event, Actions& actions) {
  Job* const job = find_or_refuse(event.id, actions);
  if (job == nullptr) return nullptr;
  work_appeared_ = true;
  reviews_.add(job->number());
  review_jobs(actions);
  return nullptr;
}

Worker* Scheduler::on(const PauseJob& event, Actions& actions) {
  if (Job* const job = find_or_refuse(event.id, actions)) become(*job, JobState::kPaused, actions);
  return nullptr;
}

Worker* Scheduler::on(const ResumeJob& event, Actions& actions) {
  Job* const job = find_or_refuse(event.id, actions);
  if (job == nullptr) return nullptr;
  // A done job lacks nothing to resume; only extend makes it run again.
  if (job->state() == JobState::kDone) {
    actions.status =
        core::fail(core::ErrorCode::kFailedPrecondition,
                   fmt::format("job {} is done: extend it to render more samples", event.id.value));
    return nullptr;
  }
  become(*job, JobState::kRunning, actions);
  return nullptr;
}

Worker* Scheduler::on(const CancelJob& event, Actions& actions) {
  if (Job* const job = find_or_refuse(event.id, actions)) become(*job, JobState::kCancelled, actions);
  return nullptr;
}

Worker* Scheduler::on(const FailJob& event, Actions& actions) {
  Job* const job = find_or_refuse(event.id, actions);
  if (job == nullptr) return nullptr;
  const bool already = job->state() == JobState::kFailed;
  become(*job, JobState::kFailed, actions);
  if (!actions.status || already) return nullptr;
  job->failure = event.failure;
  job->failure_details = event.details;
  return nullptr;
}

Worker* Scheduler::on(const DeleteJob& event, Actions& actions) {
  Job* const job = find_or_refuse(event.id, actions);
  if (job == nullptr) return nullptr;
  note_change(actions.changed_jobs, event.id);
  remove(*job, actions);
  return nullptr;
}

Worker* Scheduler::on(const ReleaseJob& event, Actions& actions) {
  Job* const job = find_or_refuse(event.id, actions);
  if (job == nullptr) return nullptr;
  const JobState state = job->state();
  if (state == JobState::kRunning || state == JobState::kPaused || reviews_.contains(job->number())) {
    actions.status =
        core::fail(core::ErrorCode::kFailedPrecondition,
                   fmt::format("job {} is {} and cannot leave", event.id.value, job_state_name(state)));
    return nullptr;
  }
  remove(*job, actions);
  return nullptr;
}

void Scheduler::remove(Job& job, Actions& actions) {
  end_run(job, actions);
  const JobNumber number = job.number();
  job_numbers_.erase(job.id());
  runs_.erase(job.run());
  touched_.erase(number);
  work_.remove(number);
  job_totals_.remove(number);
  audit_waits_.leave(number);
  reviews_.remove(number);
  auto removed = jobs_.extract(number);
  actions.discarded.push_back(std::make_shared<decltype(removed)>(std::move(removed)));
}

Worker* Scheduler::on(const ExtendJob& event, Actions& actions) {
  Job* const job = find_or_refuse(event.id, actions);
  if (job == nullptr) return nullptr;
  if (!takes_results(job->state())) {
    actions.status = core::fail(
        core::ErrorCode::kFailedPrecondition,
        fmt::format("job {} is {} and cannot be extended", event.id.value, job_state_name(job->state())));
    return nullptr;
  }
  actions.status = check_extension(*job, event);
  if (!actions.status) return nullptr;
  if (job->shape().is_raised_by(event.spp, event.tiles)) note_change(actions.changed_jobs, event.id);
  job->extend(event.spp, event.tiles);
  work_appeared_ = true;
  if (job->state() == JobState::kDone && !job->complete()) become(*job, JobState::kRunning, actions);
  return nullptr;
}

Worker* Scheduler::on(const UpdateJob& event, Actions& actions) {
  Job* const job = find_or_refuse(event.id, actions);
  if (job == nullptr) return nullptr;
  if (job->state() != JobState::kRunning && job->state() != JobState::kPaused) {
    actions.status =
        core::fail(core::ErrorCode::kFailedPrecondition,
                   fmt::format("job {} is {}: how it is served can be changed while it is running "
                               "or paused",
                               event.id.value, job_state_name(job->state())));
    return nullptr;
  }
  const SchedulingPolicy policy{event.priority.value_or(job->policy().priority),
                                event.max_workers.value_or(job->policy().max_workers)};
  if (policy != job->policy()) note_change(actions.changed_jobs, event.id);
  job->set_policy(policy);
  work_appeared_ = true;
  return nullptr;
}

Job* Scheduler::find(const JobId& id) {
  const auto found = job_numbers_.find(id);
  return found == job_numbers_.end() ? nullptr : &at(found->second);
}

Job& Scheduler::at(JobNumber number) {
  touched_.insert(number);
  return jobs_.at(number);
}

Job* Scheduler::find_or_refuse(const JobId& id, Actions& actions) {
  Job* const job = find(id);
  if (job == nullptr) {
    actions.status = core::fail(core::ErrorCode::kNotFound, fmt::format("there is no job {}", id.value));
  }
  return job;
}

Job& Scheduler::add(const JobId& id, const JobShape& shape, const SchedulingPolicy& policy, JobState state,
                    const std::vector<IntervalSet>& done, Actions& actions) {
  const JobNumber number = ++last_job_number_;
  job_numbers_.emplace(id, number);
  jobs_.try_emplace(number, number, id, shape, policy, state, done);
  Job& job = at(number);
  job.begin_run(++last_run_number_);
  runs_.emplace(job.run(), number);
  work_appeared_ = true;
  note_change(actions.changed_jobs, id);
  return job;
}

void Scheduler::become(Job& job, JobState to, Actions& actions) {
  const JobState from = job.state();
  if (from == to) return;
  if (!may_become(from, to)) {
    actions.status = core::fail(core::ErrorCode::kFailedPrecondition,
                                fmt::format("job {} is {} and cannot become {}", job.id().value,
                                            job_state_name(from), job_state_name(to)));
    return;
  }
  job.become(to);
  ++counts_.job_changes[static_cast<std::size_t>(to)];
  touched_.insert(job.number());
  actions.job_changes.push_back({job.id(), from, to});
  note_change(actions.changed_jobs, job.id());
  if (to == JobState::kRunning) {
    work_appeared_ = true;
    if (settled(job)) become(job, JobState::kDone, actions);
    return;
  }
  if (to == JobState::kPaused) return;
  end_run(job, actions);
  if (!takes_results(to)) actions.discarded.push_back(std::make_shared<Audits>(job.take_audits()));
}

void Scheduler::fail(Job& job, const Failure& failure, Actions& actions) {
  job.failure = failure.message;
  job.failure_details = failure.details;
  become(job, JobState::kFailed, actions);
}

void Scheduler::refresh_indexes() {
  for (const JobNumber number : touched_) {
    const Job& job = jobs_.at(number);
    progressed_jobs_.insert(number);
    work_.update(job, producers_);
    job_totals_.update(job);
    if (lacks_only_lots(job)) {
      audit_waits_.enter(number);
    } else {
      audit_waits_.leave(number);
    }
  }
  touched_.clear();
}

}  // namespace tessera::scheduler
