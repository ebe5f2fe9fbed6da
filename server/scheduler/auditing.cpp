// SPDX-License-Identifier: Apache-2.0
// Audits: which worker may audit what, and the consequences of each outcome.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "server/scheduler/item_text.hpp"
#include "server/scheduler/scheduler.hpp"

namespace tessera::scheduler {
namespace {

std::string describe(const Job& job, const WorkItem& item) {
  return fmt::format("{} of job {}", describe_item_with_pixels(job.shape().grid(), item), job.id().value);
}

bool overlaps(const WorkItem& a, const WorkItem& b) {
  return a.tile == b.tile && a.samples.begin < b.samples.end && b.samples.begin < a.samples.end;
}

}  // namespace

Producer Scheduler::producer_of(const SubmitResult& result) const {
  const Worker* const known = registry_.find(result.worker);
  return known != nullptr ? known->producer() : Producer{{}, result.worker, {}, result.principal};
}

std::optional<Ruling> Scheduler::take_audit(Job& job, const SubmitResult& event, std::size_t i) {
  const WorkItem& item = event.items[i];
  std::vector<std::pair<WorkerId, WorkItem>> held_by_others;
  for (const LeaseId id : job.audit_leases().holding(job.audits().entry_of(item))) {
    const Lease& lease = *job.audit_leases().find(id);
    if (lease.holder == event.worker) continue;
    for (const WorkItem& held : lease.items) held_by_others.emplace_back(lease.holder, held);
  }
  std::vector<Lease> ended;
  std::optional<Ruling> ruling = job.audit(event.lease, item, fingerprint_of(event, i), ended);
  forget_emptied(job, ended);
  if (!ruling) return ruling;
  for (const auto& [holder, held] : held_by_others) {
    if (overlaps(held, ruling->item)) tell_of_less({holder});
  }
  return ruling;
}

void Scheduler::tell_of_less(const std::vector<WorkerId>& workers) {
  for (const WorkerId& id : workers) {
    registry_.find(id)->shrunk = true;
    lost_leases_.insert(id);
  }
}

void Scheduler::follow(Job& job, const Ruling& ruling, Actions& actions) {
  using enum Ruling::Outcome;
  actions.reviewed_tiles.push_back({job.id(), ruling.item.tile});
  if (ruling.outcome == kContradicted) {
    actions.contradictions.push_back(
        fmt::format("{} and {} have rendered different bits of {}: a worker of a third name is to decide",
                    called(producers_.at(ruling.producer)), called(producers_.at(ruling.auditor)),
                    describe(job, ruling.item)));
    work_appeared_ = true;
    return;
  }
  if (Worker* const worker = registry_.find(producers_.at(ruling.producer).worker)) ++worker->audited_ranges;
  if (ruling.outcome == kRefuted) drop_tile(job, ruling.item.tile, actions);
  for (const ProducerNumber producer : ruling.wrong) disprove(job, ruling, producer, actions);
}

void Scheduler::disprove(const Job& job, const Ruling& ruling, ProducerNumber number, Actions& actions) {
  const Producer producer = producers_.at(number);
  if (Worker* const worker = registry_.find(producer.worker)) ++worker->disproved_ranges;
  std::vector<std::string> others;
  for (const ProducerNumber right : ruling.right) others.push_back(called(producers_.at(right)));
  actions.disproved.push_back(
      {producer, fmt::format("it rendered different bits of {} than {}", describe(job, ruling.item),
                             fmt::join(others, " and "))});
  distrust(producer, actions);
}

// Single samples cannot be subtracted from a film, so the whole tile is dropped.
void Scheduler::drop_tile(Job& job, int tile, Actions& actions) {
  std::vector<WorkerId> auditors;
  for (const LeaseId id : job.audit_leases().holding({tile, {0, job.shape().target(tile)}}))
    auditors.push_back(job.audit_leases().find(id)->holder);
  tell_of_less(auditors);
  std::vector<Lease> ended;
  job.drop_tile(tile, ended);
  for (const Lease& lease : ended) forget_lease(job, lease);
  actions.dropped_tiles.push_back({job.id(), tile});
  work_appeared_ = true;
}

Worker* Scheduler::on(const DropTile& event, Actions& actions) {
  Job* const job = find_or_refuse(event.id, actions);
  if (job == nullptr || !takes_results(job->state()) || !job->has_tile(event.tile)) return nullptr;
  drop_tile(*job, event.tile, actions);
  if (job->state() == JobState::kDone) become(*job, JobState::kRunning, actions);
  return nullptr;
}

void Scheduler::restore_producers(Job& job, const std::vector<ProducedItem>& provenance) {
  std::map<int, IntervalSet> known;
  for (const ProducedItem& each : provenance) {
    const WorkItem& item = each.item;
    if (!job.has(item) || !job.done(item.tile).contains(item.samples)) continue;
    if (known[item.tile].intersects(item.samples)) continue;
    known[item.tile].add(item.samples);
    job.note_producer(item, producers_.number(each.producer), each.fingerprint, each.due);
  }
}

}  // namespace tessera::scheduler
