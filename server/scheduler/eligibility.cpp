// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/eligibility.hpp"

#include <algorithm>
#include <utility>

namespace tessera::scheduler {

bool Eligibility::can_render(const Worker& worker, const Job& job) {
  return worker.info.capabilities.suffice_for(job.shape()) && worker.fits(job.determinism_fingerprint());
}

bool Eligibility::awaits_files(const Worker& worker, const Job& job) {
  return worker.has_stalled(job.run()) && worker.fetching.contains(job.id());
}

bool Eligibility::may_take(const Worker& worker, const Job& job) const {
  if (!job.may_be_leased_to(worker.info.id) || !can_render(worker, job)) return false;
  const Effort* const known = worker.effort(job.run());
  const bool in_cooldown = known != nullptr && known->in_cooldown(farm_.now);
  return !in_cooldown && !awaits_files(worker, job);
}

bool Eligibility::has_refused_lately(const Worker& worker, const Job& job) const {
  const JobNotes* const known = worker.notes.find(job.run());
  return known != nullptr && known->refused && farm_.now < *known->refused + farm_.options.lease_duration;
}

bool Eligibility::can_be_given(const Worker& worker, const Job& job, bool also_refused) const {
  return (also_refused || !has_refused_lately(worker, job)) && may_take(worker, job);
}

bool Eligibility::can_audit(const Job& job, const Worker& worker) const {
  if (job.to_verify() == 0 || farm_.producers.is_distrusted(worker.producer())) return false;
  return job.audits().offer(worker.producer(), farm_.producers, [](const WorkItem&) { return false; });
}

Portion Eligibility::audit_copy(const Job& job, const Worker& worker) const {
  if (job.auditing() == 0 || farm_.producers.is_distrusted(worker.producer())) return {};
  return job.next_audit_copy(worker.producer(), farm_.producers);
}

std::vector<JobSnapshot> Eligibility::snapshots(const std::vector<JobNumber>& jobs) const {
  std::vector<JobSnapshot> snapshots;
  for (const JobNumber number : jobs) {
    const Job& job = farm_.jobs.at(number);
    snapshots.push_back(
        {job.policy().priority, std::max(farm_.virtual_time, job.virtual_finish), job.last_served});
  }
  return snapshots;
}

// The first of each index, and what only the holders of a lease may take. The indexes must be up to date.
std::optional<JobNumber> Eligibility::chosen(const Worker& worker, bool also_refused) const {
  const auto takes = [&](JobNumber job) { return can_be_given(worker, farm_.jobs.at(job), also_refused); };
  const auto audits = [&](JobNumber job) { return takes(job) && can_audit(farm_.jobs.at(job), worker); };
  std::set<JobNumber> firsts;
  if (const auto job = farm_.work.free().first(farm_.virtual_time, kNoIdentity, takes)) firsts.insert(*job);
  if (!farm_.work.audits().empty() && !farm_.producers.is_distrusted(worker.producer())) {
    const IdentityNumber identity = farm_.producers.identity(worker.producer());
    if (const auto job = farm_.work.audits().first(farm_.virtual_time, identity, audits)) firsts.insert(*job);
  }
  for (const HeldLease& held : worker.leases) {
    if (!farm_.work.is_limited(held.number) || !takes(held.number)) continue;
    if (farm_.jobs.at(held.number).free() > 0 || audits(held.number)) firsts.insert(held.number);
  }
  if (firsts.empty()) return std::nullopt;
  const std::vector<JobNumber> candidates(firsts.begin(), firsts.end());
  return candidates[choose_job(snapshots(candidates))];
}

int Eligibility::sharers(const Job& job) const {
  int active = 0;
  for (const auto& [capabilities, workers] : farm_.registry.active_by_capabilities())
    if (capabilities.suffice_for(job.shape())) active += workers;
  const std::uint32_t most = job.policy().max_workers;
  return most == 0 || most > static_cast<std::uint32_t>(active) ? active : static_cast<int>(most);
}

double Eligibility::expected_seconds(const Worker& worker) const {
  double seconds = 0;
  for (const HeldLease& held : worker.leases) {
    const Job& job = farm_.jobs.at(held.number);
    const double speed = expected_mean_speed(farm_.options.sizing, worker.snapshot(held.run));
    for (const WorkItem& item : job.find_lease(held.id)->items) seconds += job.mean_samples(item) / speed;
  }
  return seconds;
}

}  // namespace tessera::scheduler
