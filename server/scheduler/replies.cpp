// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/replies.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace tessera::scheduler {

void Replies::wake_waiting(Actions& actions) {
  jobs_.refresh_indexes();
  std::vector<Worker*> woken;
  const auto wake = [&](const WorkerId& id) {
    Worker* const worker = farm_.registry.find(id);
    if (worker == nullptr || !worker->waiting) return;
    farm_.waiting.release(*worker);
    woken.push_back(worker);
  };
  for (const WorkerId& id : farm_.step.lost_leases) wake(id);
  if (farm_.step.work_appeared) {
    farm_.waiting.begin_wave();
  } else if (!farm_.work.any_open()) {
    farm_.work.any_limited() ? farm_.waiting.skip_idle() : farm_.waiting.end_wave();
  }
  for (const WorkerId& id : farm_.waiting.next(farm_.options.per_event.woken_workers)) wake(id);
  std::sort(woken.begin(), woken.end(),
            [](const Worker* a, const Worker* b) { return a->rank() < b->rank(); });
  for (const Worker* const worker : woken) actions.wake.push_back(worker->info.id);
}

Reply Replies::reply_to(Worker& worker) {
  Reply reply;
  std::set<LeaseId> ids;
  for (const HeldLease& held : worker.leases) {
    const Lease& lease = *farm_.jobs.at(held.number).find_lease(held.id);
    reply.leases.push_back({held.id, held.job, lease.items, lease.token});
    ids.insert(held.id);
  }
  reply.changed = ids != worker.reported || worker.shrunk;
  worker.shrunk = false;
  reply.heartbeat_timeout = farm_.registry.deadline(worker) - farm_.now;
  if (!reply.changed) farm_.waiting.hold(worker);
  return reply;
}

// The first reply that says so is not delayed. It is repeated, since it may get lost.
void Replies::tell_to_stop(Worker& worker, Reply& reply) {
  reply.stop = worker.stop_requested;
  if (!reply.stop || std::exchange(worker.was_told_to_stop, true)) return;
  reply.changed = true;
  farm_.waiting.release(worker);
}

// The worker's Synchronize keeps waiting, as if it had reported the leases of this answer.
Reply Replies::reply_with_answer(Worker& worker, const SubmitResult& result) {
  worker.reported = {result.held.begin(), result.held.end()};
  Reply reply = reply_to(worker);
  for (const LeaseDescription& lease : reply.leases) worker.reported.insert(lease.id);
  farm_.waiting.hold(worker);
  return reply;
}

}  // namespace tessera::scheduler
