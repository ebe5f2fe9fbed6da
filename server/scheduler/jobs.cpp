// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/jobs.hpp"

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "server/scheduler/auditors.hpp"
#include "server/scheduler/changes.hpp"

namespace tessera::scheduler {

core::Status Jobs::may_add(const JobId& id, const JobShape& shape) const {
  if (auto possible = check_shape(shape); !possible) return possible;
  if (farm_.find(id) != nullptr) {
    return core::fail(core::ErrorCode::kAlreadyExists, fmt::format("there is a job {} already", id.value));
  }
  return {};
}

void Jobs::remove(Job& job, Actions& actions) {
  leases_.end_run(job, actions);
  const JobNumber number = job.number();
  farm_.job_numbers.erase(job.id());
  farm_.runs.erase(job.run());
  farm_.touched.erase(number);
  farm_.work.remove(number);
  farm_.job_totals.remove(number);
  farm_.audit_waits.leave(number);
  farm_.unattended.leave(number);
  farm_.reviews.remove(number);
  auto removed = farm_.jobs.extract(number);
  actions.discarded.push_back(std::make_shared<decltype(removed)>(std::move(removed)));
}

Job* Jobs::find_or_refuse(const JobId& id, Actions& actions) {
  Job* const job = farm_.find(id);
  if (job == nullptr) {
    actions.status = core::fail(core::ErrorCode::kNotFound, fmt::format("there is no job {}", id.value));
  }
  return job;
}

Job& Jobs::add(const JobId& id, const JobShape& shape, const SchedulingPolicy& policy, JobState state,
               const std::vector<IntervalSet>& done, Actions& actions) {
  // First what may take much memory.
  const JobNumber number = farm_.last_job_number + 1;
  Job& job = farm_.jobs.try_emplace(number, number, id, shape, policy, state, done).first->second;
  farm_.last_job_number = number;
  job.begin_run(++farm_.last_run_number);
  farm_.runs.emplace(job.run(), number);
  farm_.job_numbers.emplace(id, number);
  farm_.touched.insert(number);
  farm_.step.work_appeared = true;
  note_change(actions.changed_jobs, id);
  return job;
}

void Jobs::become(Job& job, JobState to, Actions& actions) {
  const JobState from = job.state();
  if (from == to) return;
  if (!may_become(from, to)) {
    actions.status = core::fail(core::ErrorCode::kFailedPrecondition,
                                fmt::format("job {} is {} and cannot become {}", job.id().value,
                                            job_state_name(from), job_state_name(to)));
    return;
  }
  job.become(to);
  ++farm_.counts.job_changes[static_cast<std::size_t>(to)];
  farm_.touched.insert(job.number());
  actions.job_changes.push_back({job.id(), from, to});
  note_change(actions.changed_jobs, job.id());
  if (to == JobState::kRunning) {
    farm_.step.work_appeared = true;
    if (farm_.settled(job)) become(job, JobState::kDone, actions);
    return;
  }
  if (to == JobState::kPaused) return;
  leases_.end_run(job, actions);
  if (!takes_results(to)) actions.discarded.push_back(std::make_shared<Audits>(job.take_audits()));
}

void Jobs::fail(Job& job, const Failure& failure, Actions& actions) {
  job.failure = failure.message;
  job.failure_details = failure.details;
  become(job, JobState::kFailed, actions);
}

void Jobs::refresh_indexes() {
  for (const JobNumber number : farm_.touched) {
    const Job& job = farm_.jobs.at(number);
    farm_.step.progressed_jobs.insert(number);
    farm_.work.update(job, farm_.producers);
    farm_.job_totals.update(job);
    if (lacks_only_lots(job)) {
      farm_.audit_waits.enter(number);
    } else {
      farm_.audit_waits.leave(number);
    }
    if (is_unattended(job)) {
      farm_.unattended.enter(number, farm_.now);
    } else {
      farm_.unattended.leave(number);
    }
  }
  farm_.touched.clear();
}

}  // namespace tessera::scheduler
