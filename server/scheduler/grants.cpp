// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/grants.hpp"

#include <algorithm>
#include <utility>

namespace tessera::scheduler {

void Grants::top_up(Worker& worker) {
  while (worker.room() > 0 && grant_free(worker, false)) {
  }
  // Copies are only for workers without other work. Jobs whose scene the worker could not build come last, or
  // it would be given nothing else.
  if (worker.room() <= 0 || !worker.leases.empty()) return;
  if (!grant_copy(worker)) grant_free(worker, true);
}

Job* Grants::choose(const Worker& worker, bool also_refused) {
  jobs_.refresh_indexes();
  const std::optional<JobNumber> number = eligibility_.chosen(worker, also_refused);
  return number ? &farm_.at(*number) : nullptr;
}

bool Grants::grant_free(Worker& worker, bool also_refused) {
  Job* const job = choose(worker, also_refused);
  if (job == nullptr) return false;
  const std::uint64_t available = job->free() + job->to_verify();
  const LeaseSize size = next_lease_size(farm_.options.sizing, worker.snapshot(job->run()), available,
                                         eligibility_.sharers(*job));
  Portion portion;
  if (eligibility_.can_audit(*job, worker))
    portion = job->next_audits(size, worker.leases.empty(), worker.producer(), farm_.producers);
  if (portion.items.empty()) portion = job->next_free(size, worker.leases.empty());
  // Items that must be leased alone wait for the first idle worker.
  if (portion.items.empty()) return false;
  grant(worker, *job, std::move(portion));
  return true;
}

// Near the end of a job, the items that have been held for longest are leased a second time, and the first
// result wins.
bool Grants::grant_copy(Worker& worker) {
  jobs_.refresh_indexes();
  Portion portion;
  const auto has_copies = [&](JobNumber number) {
    if (!eligibility_.can_be_given(worker, farm_.jobs.at(number), false)) return false;
    Job& job = farm_.at(number);
    const LeaseSize size = next_lease_size(farm_.options.sizing, worker.snapshot(job.run()), job.leased(),
                                           eligibility_.sharers(job));
    portion = job.next_copies(size);
    if (portion.items.empty()) job.note_no_copies();
    if (portion.items.empty()) portion = eligibility_.audit_copy(job, worker);
    return !portion.items.empty();
  };
  const std::optional<JobNumber> number =
      farm_.work.copies().first(farm_.virtual_time, kNoIdentity, has_copies);
  if (!number) return false;
  grant(worker, farm_.at(*number), std::move(portion));
  return true;
}

void Grants::grant(Worker& worker, Job& job, Portion portion) {
  ++farm_.last_lease_id.value;
  ++farm_.counts.granted_leases;
  job.last_served = ++farm_.servings;
  charge(job, portion);
  Lease lease{farm_.last_lease_id, worker.info.id, std::move(portion.items), portion.alone,
              farm_.options.sign(farm_.last_lease_id, worker.info.id, job.id())};
  if (portion.audit) lease.auditor = farm_.producers.number(worker.producer());
  leases_.enter(worker, job, std::move(lease));
}

// A job that was paused or had no work gets no credit: its virtual time continues from that of the others.
void Grants::charge(Job& job, const Portion& portion) {
  std::uint64_t samples = 0;
  for (const WorkItem& item : portion.items) samples += job.pixel_samples(item);
  farm_.virtual_time = std::max(farm_.virtual_time, job.virtual_finish);
  job.virtual_finish =
      farm_.virtual_time + static_cast<double>(samples) * cost_of(farm_.options.sizing, job.cost);
}

}  // namespace tessera::scheduler
