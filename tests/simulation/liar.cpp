// SPDX-License-Identifier: Apache-2.0
#include "tests/simulation/liar.hpp"

#include <limits>

namespace tessera::simulation {

using namespace scheduler;

void Liar::speak(int jobs, const std::string& victim) {
  if (world_.random.chance(0.2)) return forge(jobs, victim);
  world_.random.chance(0.5) ? deliver(jobs) : synchronize(jobs, victim);
}

void Liar::take(const Reply& reply) {
  for (const LeaseDescription& lease : reply.leases) given_.push_back(lease);
}

LeaseDescription Liar::any_own_lease(int jobs) {
  if (given_.empty() || world_.random.chance(0.3)) return {any_lease(), any_job(jobs), any_items()};
  LeaseDescription lease =
      given_[static_cast<std::size_t>(world_.random.integer(0, static_cast<int>(given_.size()) - 1))];
  if (world_.random.chance(0.7)) lease.items = any_items();
  return lease;
}

// A plausible result with invented sums, under another worker's id or an unknown one; for a lease of its own
// with that lease's token, or for a guessed lease.
void Liar::forge(int jobs, const std::string& victim) {
  Random& random = world_.random;
  LeaseDescription lease = any_own_lease(jobs);
  if (random.chance(0.3)) lease.id = any_lease();
  const WorkerId id{random.chance(0.7) ? victim : "9999.nobody"};
  SubmitResult result{{id}, lease.job, lease.id, {{random.integer(0, 3), {0, 1}}}, 0.1, random.chance(0.5)};
  if (random.chance(0.7)) result.token = lease.token;
  coordinator_.submit_result(result, [](const auto&) {});
}

JobId Liar::any_job(int jobs) {
  return {std::to_string(world_.random.integer(1, jobs + 1))};
}

// Usually one that was granted, or may be.
LeaseId Liar::any_lease() {
  Random& random = world_.random;
  if (random.chance(0.05)) return {std::numeric_limits<std::uint64_t>::max()};
  return {(static_cast<std::uint64_t>(random.integer(0, 3)) << 40) +
          static_cast<std::uint64_t>(random.integer(0, 30))};
}

WorkItem Liar::any_item() {
  Random& random = world_.random;
  constexpr int kMax = std::numeric_limits<int>::max();
  constexpr std::uint32_t kMaxSamples = std::numeric_limits<std::uint32_t>::max();
  switch (random.integer(0, 19)) {
    case 0:
      return {random.chance(0.5) ? kMax : -kMax - 1, {0, 1}};
    case 1:
      return {0, {0, kMaxSamples}};
    case 2:
      return {random.integer(0, 8), {kMaxSamples - 1, kMaxSamples}};
    default:
      const auto begin = static_cast<std::uint32_t>(random.integer(0, 20));
      return {random.integer(-1, 8), {begin, static_cast<std::uint32_t>(random.integer(0, 25))}};
  }
}

std::vector<WorkItem> Liar::any_items() {
  Random& random = world_.random;
  std::vector<WorkItem> items;
  for (int i = random.chance(0.1) ? 100 : random.integer(0, 3); i > 0; --i) items.push_back(any_item());
  if (!items.empty() && random.chance(0.2)) items.push_back(items.front());
  return items;
}

double Liar::any_seconds() {
  using limits = std::numeric_limits<double>;
  const double odd[] = {
      0, 1e-300, 1e308, -1e308, limits::infinity(), -limits::infinity(), limits::quiet_NaN()};
  return world_.random.chance(0.5) ? world_.random.real(-1, 1) : odd[world_.random.integer(0, 6)];
}

void Liar::deliver(int jobs) {
  Random& random = world_.random;
  has_delivered_ = true;
  const LeaseDescription lease = any_own_lease(jobs);
  SubmitResult result{{kLiar}, lease.job, lease.id, lease.items, any_seconds(), random.chance(0.5), ""};
  result.token = lease.token;
  if (random.chance(0.1)) {
    result.decline_reason = "it is not to my liking";
    refused_.insert(result.job);
  }
  for (int i = result.items.size() % 3 == 1 ? random.integer(1, 5) : 0; i > 0; --i)
    result.held.push_back(any_lease());
  coordinator_.submit_result(result, [](const auto&) {});
}

void Liar::synchronize(int jobs, const std::string& victim) {
  Random& random = world_.random;
  const WorkerId id{random.chance(0.2) ? victim : kLiar};
  // It can take any name; its machine is proved, and so its own.
  const std::string name = random.chance(0.3) ? victim.substr(victim.find('.') + 1) : kLiar;
  Synchronize call{
      {id, name, "", random.integer(1, 4096), kLiar}, {}, random.integer(-1, 9), random.chance(0.2)};
  // Else a victim would be sent what the liar was given in its name, and cannot render it.
  call.worker.capabilities.renders_layers = id.value == kLiar;
  for (int i = random.chance(0.1) ? 100 : random.integer(0, 4); i > 0; --i) {
    call.held.push_back({any_lease(), any_job(jobs), any_items()});
    if (random.chance(0.3)) call.held.push_back(call.held.back());
  }
  if (!call.held.empty() && call.wanted_leases % 2 == 0) {
    const LeaseDescription& first = call.held.front();
    call.rendering = {first.id, first.job, first.items.empty() ? WorkItem{} : first.items.back()};
  }
  for (const LeaseDescription& lease : call.held) {
    if (call.wanted_leases % 3 == 0) call.fetching.insert(lease.job);
  }
  if (id.value == kLiar && random.chance(0.3)) call.held = given_;
  coordinator_.synchronize(call, [this, id](const Reply& reply) {
    if (id.value == kLiar) take(reply);
  });
}

}  // namespace tessera::simulation
