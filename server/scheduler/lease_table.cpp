// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/lease_table.hpp"

#include <algorithm>

#include "server/scheduler/lifecycle.hpp"

namespace tessera::scheduler {
namespace {

bool has_tile(const Lease& lease, int tile) {
  return std::any_of(lease.items.begin(), lease.items.end(),
                     [&](const WorkItem& i) { return i.tile == tile; });
}

// The items without the samples of `done`.
std::vector<WorkItem> without(const std::vector<WorkItem>& items, const WorkItem& done) {
  std::vector<WorkItem> rest;
  for (const WorkItem& item : items) {
    IntervalSet samples{item.samples};
    if (item.tile == done.tile) samples.remove(done.samples);
    for (const core::SampleRange& range : samples.ranges()) rest.push_back({item.tile, range});
  }
  return rest;
}

}  // namespace

const Lease* LeaseTable::find(LeaseId id) const {
  const auto found = leases_.find(id);
  return found == leases_.end() ? nullptr : &found->second;
}

void LeaseTable::insert(Lease lease) {
  for (const WorkItem& item : lease.items) {
    std::vector<LeaseId>& ids = by_tile_[item.tile];
    if (std::find(ids.begin(), ids.end(), lease.id) == ids.end()) ids.push_back(lease.id);
  }
  ++lease_counts_[lease.holder];
  const LeaseId id = lease.id;
  leases_.emplace(id, std::move(lease));
}

void LeaseTable::become(Lease& lease, LeaseState to) {
  if (!may_become(lease.state, to))
    invalid_transition("lease", lease_state_name(lease.state), lease_state_name(to));
  lease.state = to;
}

void LeaseTable::acknowledge(LeaseId id) {
  Lease& lease = leases_.at(id);
  if (lease.state != LeaseState::kHeld) become(lease, LeaseState::kHeld);
}

Lease LeaseTable::end(LeaseId id, LeaseState to) {
  for (const WorkItem& item : leases_.at(id).items) drop_from_tile(item.tile, id);
  return extract(id, to);
}

std::vector<Lease> LeaseTable::trim(const WorkItem& done) {
  std::vector<Lease> emptied;
  for (const LeaseId id : std::vector<LeaseId>(of_tile(done.tile))) {
    if (auto lease = trim(id, done)) emptied.push_back(std::move(*lease));
  }
  return emptied;
}

std::optional<Lease> LeaseTable::trim(LeaseId id, const WorkItem& done) {
  Lease& lease = leases_.at(id);
  lease.items = without(lease.items, done);
  if (!has_tile(lease, done.tile)) drop_from_tile(done.tile, id);
  if (!lease.items.empty()) return std::nullopt;
  return extract(id, LeaseState::kDone);
}

Lease LeaseTable::extract(LeaseId id, LeaseState to) {
  Lease lease = std::move(leases_.extract(id).mapped());
  become(lease, to);
  const auto count = lease_counts_.find(lease.holder);
  if (--count->second == 0) lease_counts_.erase(count);
  return lease;
}

IntervalSet LeaseTable::leased_by_others(int tile, LeaseId but) const {
  IntervalSet samples;
  for (const LeaseId id : of_tile(tile)) {
    if (id == but) continue;
    for (const WorkItem& item : leases_.at(id).items) {
      if (item.tile == tile) samples.add(item.samples);
    }
  }
  return samples;
}

const std::vector<LeaseId>& LeaseTable::of_tile(int tile) const {
  static const std::vector<LeaseId> kNone;
  const auto found = by_tile_.find(tile);
  return found == by_tile_.end() ? kNone : found->second;
}

void LeaseTable::drop_from_tile(int tile, LeaseId id) {
  const auto found = by_tile_.find(tile);
  if (found == by_tile_.end()) return;
  std::erase(found->second, id);
  if (found->second.empty()) by_tile_.erase(found);
}

}  // namespace tessera::scheduler
