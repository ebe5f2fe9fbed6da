// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/scheduler.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

namespace tessera::scheduler {

Actions Scheduler::handle(const Event& event, Time now) {
  farm_.now = std::max(farm_.now, now);
  farm_.step = {.left = farm_.options.per_event};
  Actions actions;
  workers_.expire_workers(actions);
  workers_.settle_sender(event, actions);
  leases_.clear_ended_runs(actions);
  reviews_.advance(actions);

  Worker* asking = dispatch(event, actions);
  count_verdicts(actions.verdicts);
  if (asking != nullptr) {
    leases_.revoke_ended(*asking);
    grants_.top_up(*asking);
  }
  waivers_.end_hopeless_waits(actions);
  if (asking != nullptr) leases_.revoke_ended(*asking);
  const auto* const result = std::get_if<SubmitResult>(&event);
  if (asking != nullptr && result != nullptr && Results::has_lost(*asking, *result)) asking = nullptr;
  if (asking != nullptr) farm_.waiting.release(*asking);
  replies_.wake_waiting(actions);
  report_progress(actions);
  report_unattended(actions);
  if (asking != nullptr) reply(*asking, result, actions);
  return actions;
}

Worker* Scheduler::dispatch(const Event& event, Actions& actions) {
  const auto handle = [&](const auto& e) -> Worker* {
    if constexpr (std::is_same_v<std::decay_t<decltype(e)>, Tick>) {
      return nullptr;
    } else if constexpr (requires { workers_.on(e, actions); }) {
      return workers_.on(e, actions);
    } else if constexpr (requires { results_.on(e, actions); }) {
      return results_.on(e, actions);
    } else if constexpr (requires { commands_.on(e, actions); }) {
      return commands_.on(e, actions);
    } else if constexpr (requires { auditing_.on(e, actions); }) {
      return auditing_.on(e, actions);
    } else {
      return reviews_.on(e, actions);
    }
  };
  return std::visit(handle, event);
}

void Scheduler::reply(Worker& worker, const SubmitResult* result, Actions& actions) {
  if (result != nullptr) {
    actions.reply = replies_.reply_with_answer(worker, *result);
  } else {
    actions.reply = replies_.reply_to(worker);
    replies_.tell_to_stop(worker, *actions.reply);
  }
}

void Scheduler::count_verdicts(const std::vector<Verdict>& verdicts) {
  for (const Verdict verdict : verdicts) {
    farm_.counts.accepted_items += verdict == Verdict::kAccepted;
    farm_.counts.audited_items += verdict == Verdict::kAudited;
    farm_.counts.dropped_items += verdict == Verdict::kDropped;
  }
}

void Scheduler::report_unattended(Actions& actions) {
  const auto most = static_cast<std::size_t>(farm_.options.per_event.reported_jobs);
  for (const JobNumber number :
       farm_.unattended.take_due(farm_.now, farm_.options.unattended_patience, most)) {
    const Job& job = farm_.jobs.at(number);
    actions.unattended.push_back({job.id(), job.to_verify()});
  }
}

void Scheduler::report_progress(Actions& actions) {
  for (const JobNumber number : farm_.step.progressed_jobs) {
    const auto job = farm_.jobs.find(number);
    if (job == farm_.jobs.end()) continue;  // deleted
    const Progress progress = job->second.progress();
    if (std::exchange(job->second.reported, progress) != progress)
      actions.progressed_jobs.push_back(job->second.id());
  }
  const std::set<WorkerId>& workers = farm_.step.progressed_workers;
  actions.progressed_workers.assign(workers.begin(), workers.end());
}

}  // namespace tessera::scheduler
