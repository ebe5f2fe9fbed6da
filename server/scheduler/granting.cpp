// SPDX-License-Identifier: Apache-2.0
// Which work a worker is given next.
#include <algorithm>
#include <utility>

#include "server/scheduler/scheduler.hpp"

namespace tessera::scheduler {

void Scheduler::top_up(Worker& worker) {
  while (worker.room() > 0 && grant_free(worker, false)) {
  }
  // Copies are only for workers without other work. Jobs whose scene the worker could not build come last, or
  // it would be given nothing else.
  if (worker.room() <= 0 || !worker.leases.empty()) return;
  if (!grant_copy(worker)) grant_free(worker, true);
}

Job* Scheduler::choose(const Worker& worker, bool also_refused) {
  refresh_indexes();
  const std::optional<JobNumber> number = chosen(worker, also_refused);
  return number ? &at(*number) : nullptr;
}

bool Scheduler::grant_free(Worker& worker, bool also_refused) {
  Job* const job = choose(worker, also_refused);
  if (job == nullptr) return false;
  const std::uint64_t available = job->free() + job->to_verify();
  const LeaseSize size =
      next_lease_size(options_.sizing, worker.snapshot(job->run()), available, sharers(*job));
  Portion portion;
  if (can_audit(*job, worker))
    portion = job->next_audits(size, worker.leases.empty(), worker.producer(), producers_);
  if (portion.items.empty()) portion = job->next_free(size, worker.leases.empty());
  // Items that must be leased alone wait for the first idle worker.
  if (portion.items.empty()) return false;
  grant(worker, *job, std::move(portion));
  return true;
}

// Near the end of a job, the items that have been held for longest are leased a second time, and the first
// result wins.
bool Scheduler::grant_copy(Worker& worker) {
  refresh_indexes();
  Portion portion;
  const auto has_copies = [&](JobNumber number) {
    if (!can_be_given(worker, jobs_.at(number), false)) return false;
    Job& job = at(number);
    const LeaseSize size =
        next_lease_size(options_.sizing, worker.snapshot(job.run()), job.leased(), sharers(job));
    portion = job.next_copies(size);
    if (portion.items.empty()) job.note_no_copies();
    if (portion.items.empty()) portion = audit_copy(job, worker);
    return !portion.items.empty();
  };
  const std::optional<JobNumber> number = work_.copies().first(virtual_time_, kNoIdentity, has_copies);
  if (!number) return false;
  grant(worker, at(*number), std::move(portion));
  return true;
}

void Scheduler::grant(Worker& worker, Job& job, Portion portion) {
  ++last_lease_id_.value;
  ++counts_.granted_leases;
  job.last_served = ++servings_;
  charge(job, portion);
  Lease lease{last_lease_id_, worker.info.id, std::move(portion.items), portion.alone};
  if (portion.audit) lease.auditor = producers_.number(worker.producer());
  enter_lease(worker, job, std::move(lease));
}

// A job that was paused or had no work gets no credit: its virtual time continues from that of the others.
void Scheduler::charge(Job& job, const Portion& portion) {
  std::uint64_t samples = 0;
  for (const WorkItem& item : portion.items) samples += job.pixel_samples(item);
  virtual_time_ = std::max(virtual_time_, job.virtual_finish);
  job.virtual_finish = virtual_time_ + static_cast<double>(samples) * cost_of(options_.sizing, job.cost);
}

}  // namespace tessera::scheduler
