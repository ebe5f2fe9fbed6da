// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/leases.hpp"

#include <algorithm>
#include <utility>

namespace tessera::scheduler {

void Leases::enter(Worker& worker, Job& job, Lease lease) {
  Effort& known = effort(worker, job);
  const bool resumes = known.gave_back && farm_.now - *known.gave_back < farm_.options.lease_duration;
  if (!resumes && !worker.holds_any_of(job.number())) known.no_progress_since = farm_.now;
  farm_.live_leases.insert(lease.id);
  farm_.step.progressed_workers.insert(worker.info.id);
  worker.leases.push_back({lease.id, job.id(), job.number(), job.run(), lease.alone});
  farm_.registry.count_activity(worker);
  farm_.waiting.update(worker);
  job.lease(std::move(lease));
  farm_.touched.insert(job.number());
}

Lease Leases::end(Job& job, LeaseId id, LeaseState to) {
  Lease lease = job.end_lease(id, to);
  forget(job, lease);
  farm_.step.work_appeared = true;
  return lease;
}

void Leases::end_all(Worker& worker) {
  worker.wanted_leases = 0;
  revoke_ended(worker);
  for (const HeldLease& held : std::vector<HeldLease>(worker.leases))
    end(farm_.at(held.number), held.id, LeaseState::kRevoked);
}

void Leases::forget(const Job& job, const Lease& lease) {
  Worker& holder = *farm_.registry.find(lease.holder);
  count_ended(lease.state);
  Effort& known = effort(holder, job);
  known.gave_back.reset();
  // Samples that others have delivered, or leases that it could not hold, are no lack of progress.
  if (lease.state == LeaseState::kReturned) {
    known.gave_back = farm_.now;
  } else {
    known.no_progress_since = farm_.now;
  }
  forget_held(holder, lease.id);
}

void Leases::forget_held(Worker& holder, LeaseId lease) {
  std::erase_if(holder.leases, [&](const HeldLease& held) { return held.id == lease; });
  farm_.live_leases.erase(lease);
  farm_.step.lost_leases.insert(holder.info.id);
  farm_.registry.count_activity(holder);
  farm_.step.progressed_workers.insert(holder.info.id);
  farm_.waiting.update(holder);
}

void Leases::count_ended(LeaseState state) {
  ++farm_.counts.ended_leases[static_cast<std::size_t>(state)];
}

void Leases::forget_emptied(const Job& job, const std::vector<Lease>& leases) {
  for (const Lease& lease : leases) {
    forget(job, lease);
    // Another worker may take its place.
    if (job.policy().max_workers > 0 && !job.is_holder(lease.holder)) farm_.step.work_appeared = true;
  }
}

void Leases::shorten(const std::vector<WorkerId>& workers) {
  for (const WorkerId& id : workers) {
    farm_.registry.find(id)->shrunk = true;
    farm_.step.lost_leases.insert(id);
  }
}

}  // namespace tessera::scheduler
