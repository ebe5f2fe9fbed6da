// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/losses.hpp"

#include <algorithm>

namespace tessera::scheduler {
namespace {

// How late the scheduler may be called after a lease's expiry and still presume its holder dead.
constexpr Duration kPunctuality = std::chrono::seconds(1);

}  // namespace

void Losses::lose_lease(const Worker& worker, const HeldLease& held, Actions& actions) {
  Job& job = farm_.at(held.number);
  const bool heard_of = worker.reported.contains(held.id);
  const Lease lease = leases_.end(job, held.id, LeaseState::kExpired);
  // The death counts against the lease's samples only if the worker had the lease and the scheduler is on
  // time. A lease that it never reported may not have reached it. One that was told with the answer to a
  // result most likely has, and one death alone fails no job. A draining worker was told to stop. If the
  // deadline is long past, the coordinator itself was suspended.
  const bool draining = worker.state() == WorkerState::kDraining;
  if (!heard_of || draining || farm_.now > farm_.registry.deadline(worker) + kPunctuality) return;
  const auto has_strikes = [this](const WorkerId& struck, const std::set<JobNumber>& jobs) {
    return std::any_of(jobs.begin(), jobs.end(), [&](JobNumber number) {
      const auto found = farm_.jobs.find(number);
      return found != farm_.jobs.end() && found->second.may_have_strikes_of(struck);
    });
  };
  farm_.struck_jobs.at_or_insert(worker.info.id, has_strikes).insert(job.number());
  const auto failure = job.strike(lease, worker.loss(LossKind::kDied), quorum_.are_all_principals(job));
  if (failure) jobs_.fail(job, *failure, actions);
}

void Losses::withdraw_strikes(const WorkerId& worker) {
  const Worker* const known = farm_.registry.find(worker);
  if (known != nullptr && known->state() != WorkerState::kSilent) return;
  const std::set<JobNumber>* const struck = farm_.struck_jobs.find(worker);
  if (struck == nullptr) return;
  for (const JobNumber number : *struck) {
    const auto job = farm_.jobs.find(number);
    if (job != farm_.jobs.end()) job->second.withdraw_strikes(worker, LossKind::kDied);
  }
  farm_.struck_jobs.erase(worker);
}

}  // namespace tessera::scheduler
