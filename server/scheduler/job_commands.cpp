// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/job_commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "server/scheduler/changes.hpp"

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

Worker* JobCommands::on(const SubmitJob& event, Actions& actions) {
  actions.status = jobs_.may_add(event.id, event.shape);
  if (actions.status)
    jobs_.add(event.id, event.shape, {event.priority, event.max_workers}, JobState::kRunning, {}, actions);
  return nullptr;
}

Worker* JobCommands::on(const RestoreJob& event, Actions& actions) {
  actions.status = jobs_.may_add(event.id, event.shape);
  if (actions.status && !fits(event.done, event.shape)) {
    actions.status =
        core::fail(core::ErrorCode::kInvalidArgument,
                   fmt::format("the stored samples of job {} are not of its shape", event.id.value));
  }
  if (!actions.status) return nullptr;

  Job& job =
      jobs_.add(event.id, event.shape, {event.priority, event.max_workers}, event.state, event.done, actions);
  job.failure = event.failure;
  job.set_determinism_fingerprint(event.determinism_fingerprint);
  job.failure_details = event.failure_details;
  auditing_.restore_producers(job, event.provenance);
  if (event.state == JobState::kRunning && farm_.settled(job)) jobs_.become(job, JobState::kDone, actions);
  if (event.state == JobState::kDone && !farm_.settled(job)) jobs_.become(job, JobState::kRunning, actions);
  return nullptr;
}

Worker* JobCommands::on(const ReopenJob& event, Actions& actions) {
  Job* const job = jobs_.find_or_refuse(event.id, actions);
  if (job == nullptr) return nullptr;
  farm_.step.work_appeared = true;
  farm_.reviews.add(job->number());
  reviews_.advance(actions);
  return nullptr;
}

Worker* JobCommands::on(const PauseJob& event, Actions& actions) {
  if (Job* const job = jobs_.find_or_refuse(event.id, actions))
    jobs_.become(*job, JobState::kPaused, actions);
  return nullptr;
}

Worker* JobCommands::on(const ResumeJob& event, Actions& actions) {
  Job* const job = jobs_.find_or_refuse(event.id, actions);
  if (job == nullptr) return nullptr;
  // A done job lacks nothing to resume; only extend makes it run again.
  if (job->state() == JobState::kDone) {
    actions.status =
        core::fail(core::ErrorCode::kFailedPrecondition,
                   fmt::format("job {} is done: extend it to render more samples", event.id.value));
    return nullptr;
  }
  jobs_.become(*job, JobState::kRunning, actions);
  return nullptr;
}

Worker* JobCommands::on(const CancelJob& event, Actions& actions) {
  if (Job* const job = jobs_.find_or_refuse(event.id, actions))
    jobs_.become(*job, JobState::kCancelled, actions);
  return nullptr;
}

Worker* JobCommands::on(const FailJob& event, Actions& actions) {
  Job* const job = jobs_.find_or_refuse(event.id, actions);
  if (job == nullptr) return nullptr;
  const bool already = job->state() == JobState::kFailed;
  jobs_.become(*job, JobState::kFailed, actions);
  if (!actions.status || already) return nullptr;
  job->failure = event.failure;
  job->failure_details = event.details;
  return nullptr;
}

Worker* JobCommands::on(const DeleteJob& event, Actions& actions) {
  Job* const job = jobs_.find_or_refuse(event.id, actions);
  if (job == nullptr) return nullptr;
  note_change(actions.changed_jobs, event.id);
  jobs_.remove(*job, actions);
  return nullptr;
}

Worker* JobCommands::on(const ReleaseJob& event, Actions& actions) {
  Job* const job = jobs_.find_or_refuse(event.id, actions);
  if (job == nullptr) return nullptr;
  const JobState state = job->state();
  if (state == JobState::kRunning || state == JobState::kPaused || farm_.reviews.contains(job->number())) {
    actions.status =
        core::fail(core::ErrorCode::kFailedPrecondition,
                   fmt::format("job {} is {} and cannot leave", event.id.value, job_state_name(state)));
    return nullptr;
  }
  jobs_.remove(*job, actions);
  return nullptr;
}

Worker* JobCommands::on(const ExtendJob& event, Actions& actions) {
  Job* const job = jobs_.find_or_refuse(event.id, actions);
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
  farm_.step.work_appeared = true;
  if (job->state() == JobState::kDone && !job->complete()) jobs_.become(*job, JobState::kRunning, actions);
  return nullptr;
}

Worker* JobCommands::on(const UpdateJob& event, Actions& actions) {
  Job* const job = jobs_.find_or_refuse(event.id, actions);
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
  farm_.step.work_appeared = true;
  return nullptr;
}

}  // namespace tessera::scheduler
