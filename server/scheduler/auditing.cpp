// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/auditing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "server/scheduler/item_text.hpp"

namespace tessera::scheduler {
namespace {

std::string describe(const Job& job, const WorkItem& item) {
  return fmt::format("{} of job {}", describe_item_with_pixels(job.shape().grid(), item), job.id().value);
}

bool overlaps(const WorkItem& a, const WorkItem& b) {
  return a.tile == b.tile && a.samples.begin < b.samples.end && b.samples.begin < a.samples.end;
}

}  // namespace

Producer Auditing::producer_of(const SubmitResult& result) const {
  const Worker* const known = farm_.registry.find(result.worker);
  return known != nullptr ? known->producer() : Producer{{}, result.worker, {}, result.principal};
}

std::optional<Ruling> Auditing::take(Job& job, const SubmitResult& event, std::size_t i) {
  const WorkItem& item = event.items[i];
  std::vector<std::pair<WorkerId, WorkItem>> held_by_others;
  for (const LeaseId id : job.audit_leases().holding(job.audits().entry_of(item))) {
    const Lease& lease = *job.audit_leases().find(id);
    if (lease.holder == event.worker) continue;
    for (const WorkItem& held : lease.items) held_by_others.emplace_back(lease.holder, held);
  }
  std::vector<Lease> ended;
  std::optional<Ruling> ruling = job.audit(event.lease, item, fingerprint_of(event, i), ended);
  leases_.forget_emptied(job, ended);
  if (!ruling) return ruling;
  for (const auto& [holder, held] : held_by_others) {
    if (overlaps(held, ruling->item)) leases_.shorten({holder});
  }
  return ruling;
}

void Auditing::follow(Job& job, const Ruling& ruling, Actions& actions) {
  using enum Ruling::Outcome;
  actions.reviewed_tiles.push_back({job.id(), ruling.item.tile});
  if (ruling.outcome == kContradicted) {
    actions.contradictions.push_back(
        fmt::format("{} and {} have rendered different bits of {}: a worker of a third name is to decide",
                    called(farm_.producers.at(ruling.producer)), called(farm_.producers.at(ruling.auditor)),
                    describe(job, ruling.item)));
    farm_.step.work_appeared = true;
    return;
  }
  if (Worker* const worker = farm_.registry.find(farm_.producers.at(ruling.producer).worker))
    ++worker->audited_ranges;
  if (ruling.outcome == kRefuted) drop_tile(job, ruling.item.tile, actions);
  for (const ProducerNumber producer : ruling.wrong) disprove(job, ruling, producer, actions);
}

void Auditing::disprove(const Job& job, const Ruling& ruling, ProducerNumber number, Actions& actions) {
  const Producer producer = farm_.producers.at(number);
  if (Worker* const worker = farm_.registry.find(producer.worker)) ++worker->disproved_ranges;
  std::vector<std::string> others;
  for (const ProducerNumber right : ruling.right) others.push_back(called(farm_.producers.at(right)));
  actions.disproved.push_back(
      {producer, fmt::format("it rendered different bits of {} than {}", describe(job, ruling.item),
                             fmt::join(others, " and "))});
  reviews_.distrust(producer, actions);
}

// Single samples cannot be subtracted from a film, so the whole tile is dropped.
void Auditing::drop_tile(Job& job, int tile, Actions& actions) {
  std::vector<WorkerId> auditors;
  for (const LeaseId id : job.audit_leases().holding({tile, {0, job.shape().target(tile)}}))
    auditors.push_back(job.audit_leases().find(id)->holder);
  leases_.shorten(auditors);
  std::vector<Lease> ended;
  job.drop_tile(tile, ended);
  for (const Lease& lease : ended) leases_.forget(job, lease);
  actions.dropped_tiles.push_back({job.id(), tile});
  farm_.step.work_appeared = true;
}

Worker* Auditing::on(const DropTile& event, Actions& actions) {
  Job* const job = jobs_.find_or_refuse(event.id, actions);
  if (job == nullptr || !takes_results(job->state()) || !job->has_tile(event.tile)) return nullptr;
  drop_tile(*job, event.tile, actions);
  if (job->state() == JobState::kDone) jobs_.become(*job, JobState::kRunning, actions);
  return nullptr;
}

void Auditing::restore_producers(Job& job, const std::vector<ProducedItem>& provenance) {
  std::map<int, IntervalSet> known;
  for (const ProducedItem& each : provenance) {
    const WorkItem& item = each.item;
    if (!job.has(item) || !job.done(item.tile).contains(item.samples)) continue;
    if (known[item.tile].intersects(item.samples)) continue;
    known[item.tile].add(item.samples);
    job.note_producer(item, farm_.producers.number(each.producer), each.fingerprint, each.due);
  }
}

}  // namespace tessera::scheduler
