// SPDX-License-Identifier: Apache-2.0
// Which work a worker may be given, and which of it comes first.
#include <algorithm>
#include <utility>

#include "server/scheduler/farm_state.hpp"

namespace tessera::scheduler {

bool FarmState::can_render(const Worker& worker, const Job& job) {
  return worker.info.capabilities.suffice_for(job.shape()) && worker.fits(job.determinism_fingerprint());
}

bool FarmState::awaits_files(const Worker& worker, const Job& job) {
  return worker.has_stalled(job.run()) && worker.fetching.contains(job.id());
}

bool FarmState::may_take(const Worker& worker, const Job& job) const {
  if (!job.may_be_leased_to(worker.info.id) || !can_render(worker, job)) return false;
  const Effort* const known = worker.effort(job.run());
  const bool in_cooldown = known != nullptr && known->in_cooldown(now_);
  return !in_cooldown && !awaits_files(worker, job);
}

bool FarmState::has_refused_lately(const Worker& worker, const Job& job) const {
  const JobNotes* const known = worker.notes.find(job.run());
  return known != nullptr && known->refused && now_ < *known->refused + options_.lease_duration;
}

bool FarmState::can_be_given(const Worker& worker, const Job& job, bool also_refused) const {
  return (also_refused || !has_refused_lately(worker, job)) && may_take(worker, job);
}

bool FarmState::can_audit(const Job& job, const Worker& worker) const {
  if (job.to_verify() == 0 || producers_.is_distrusted(worker.producer())) return false;
  return job.audits().offer(worker.producer(), producers_, [](const WorkItem&) { return false; });
}

Portion FarmState::audit_copy(const Job& job, const Worker& worker) const {
  if (job.auditing() == 0 || producers_.is_distrusted(worker.producer())) return {};
  return job.next_audit_copy(worker.producer(), producers_);
}

std::vector<JobSnapshot> FarmState::snapshots(const std::vector<JobNumber>& jobs) const {
  std::vector<JobSnapshot> snapshots;
  for (const JobNumber number : jobs) {
    const Job& job = jobs_.at(number);
    snapshots.push_back(
        {job.policy().priority, std::max(virtual_time_, job.virtual_finish), job.last_served});
  }
  return snapshots;
}

// The first of each index, and what only the holders of a lease may take. The indexes must be up to date.
std::optional<JobNumber> FarmState::chosen(const Worker& worker, bool also_refused) const {
  const auto takes = [&](JobNumber job) { return can_be_given(worker, jobs_.at(job), also_refused); };
  const auto audits = [&](JobNumber job) { return takes(job) && can_audit(jobs_.at(job), worker); };
  std::set<JobNumber> firsts;
  if (const auto job = work_.free().first(virtual_time_, kNoIdentity, takes)) firsts.insert(*job);
  if (!work_.audits().empty() && !producers_.is_distrusted(worker.producer())) {
    const IdentityNumber identity = producers_.identity(worker.producer());
    if (const auto job = work_.audits().first(virtual_time_, identity, audits)) firsts.insert(*job);
  }
  for (const HeldLease& held : worker.leases) {
    if (!work_.is_limited(held.number) || !takes(held.number)) continue;
    if (jobs_.at(held.number).free() > 0 || audits(held.number)) firsts.insert(held.number);
  }
  if (firsts.empty()) return std::nullopt;
  const std::vector<JobNumber> candidates(firsts.begin(), firsts.end());
  return candidates[choose_job(snapshots(candidates))];
}

int FarmState::sharers(const Job& job) const {
  int active = 0;
  for (const auto& [capabilities, workers] : registry_.active_by_capabilities())
    if (capabilities.suffice_for(job.shape())) active += workers;
  const std::uint32_t most = job.policy().max_workers;
  return most == 0 || most > static_cast<std::uint32_t>(active) ? active : static_cast<int>(most);
}

double FarmState::expected_seconds(const Worker& worker) const {
  double seconds = 0;
  for (const HeldLease& held : worker.leases) {
    const Job& job = jobs_.at(held.number);
    const double speed = expected_mean_speed(options_.sizing, worker.snapshot(held.run));
    for (const WorkItem& item : job.find_lease(held.id)->items) seconds += job.mean_samples(item) / speed;
  }
  return seconds;
}

}  // namespace tessera::scheduler
