// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/lease_table.hpp"

#include <algorithm>

#include "server/scheduler/lifecycle.hpp"

namespace tessera::scheduler {
namespace {

bool overlap(const WorkItem& a, const WorkItem& b) {
  return a.tile == b.tile && a.samples.begin < b.samples.end && b.samples.begin < a.samples.end;
}

constexpr auto kBeginsBefore = [](const auto& part, std::uint32_t sample) {
  return part.samples.begin < sample;
};

}  // namespace

const Lease* LeaseTable::find(LeaseId id) const {
  const auto found = leases_.find(id);
  return found == leases_.end() ? nullptr : &found->second;
}

void LeaseTable::insert(Lease lease) {
  for (const WorkItem& item : lease.items) enter(item, lease.id);
  const LeaseId id = lease.id;
  leases_.emplace(id, std::move(lease));
}

void LeaseTable::enter(const WorkItem& item, LeaseId id) {
  Tile& tile = tiles_[item.tile];
  tile.twice.add(tile.once.intersection(item.samples));
  tile.once.add(item.samples);
  tile.longest = std::max(tile.longest, item.samples.count());
  const auto next = std::lower_bound(tile.parts.begin(), tile.parts.end(), item.samples.begin, kBeginsBefore);
  tile.parts.insert(next, {item.samples, id});
}

// The item must be one of the lease's.
void LeaseTable::remove(const WorkItem& item, LeaseId id) {
  const auto found = tiles_.find(item.tile);
  Tile& tile = found->second;
  auto part = std::lower_bound(tile.parts.begin(), tile.parts.end(), item.samples.begin, kBeginsBefore);
  while (part->lease != id) ++part;
  tile.parts.erase(part);
  if (tile.parts.empty()) {
    tiles_.erase(found);
    return;
  }
  const IntervalSet shared = tile.twice.intersection(item.samples);
  IntervalSet sole{item.samples};
  sole.remove(shared);
  tile.once.remove(sole);
  tile.twice.remove(shared);
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
  for (const WorkItem& item : leases_.at(id).items) remove(item, id);
  return extract(id, to);
}

std::vector<Lease> LeaseTable::trim(const WorkItem& done) {
  std::vector<Lease> emptied;
  for (const LeaseId id : holding(done)) {
    if (auto lease = trim(id, done)) emptied.push_back(std::move(*lease));
  }
  return emptied;
}

std::optional<Lease> LeaseTable::trim(LeaseId id, const WorkItem& done) {
  Lease& lease = leases_.at(id);
  std::vector<WorkItem> kept;
  for (const WorkItem& item : lease.items) {
    if (!overlap(item, done)) {
      kept.push_back(item);
      continue;
    }
    remove(item, id);
    IntervalSet samples{item.samples};
    samples.remove(done.samples);
    for (const core::SampleRange& range : samples.ranges()) {
      kept.push_back({item.tile, range});
      enter(kept.back(), id);
    }
  }
  lease.items = std::move(kept);
  if (!lease.items.empty()) return std::nullopt;
  return extract(id, LeaseState::kDone);
}

// The lease's items must be removed already.
Lease LeaseTable::extract(LeaseId id, LeaseState to) {
  Lease lease = std::move(leases_.extract(id).mapped());
  become(lease, to);
  return lease;
}

const LeaseTable::Tile& LeaseTable::at(int tile) const {
  static const Tile kNone;
  const auto found = tiles_.find(tile);
  return found == tiles_.end() ? kNone : found->second;
}

const IntervalSet& LeaseTable::leased(int tile) const {
  return at(tile).once;
}

const IntervalSet& LeaseTable::leased_twice(int tile) const {
  return at(tile).twice;
}

std::vector<LeaseId> LeaseTable::holding(const WorkItem& item) const {
  const Tile& tile = at(item.tile);
  std::vector<LeaseId> ids;
  const std::uint32_t from = item.samples.begin - std::min(tile.longest, item.samples.begin);
  auto part = std::lower_bound(tile.parts.begin(), tile.parts.end(), from, kBeginsBefore);
  for (; part != tile.parts.end() && part->samples.begin < item.samples.end; ++part) {
    if (part->samples.end > item.samples.begin) ids.push_back(part->lease);
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

}  // namespace tessera::scheduler
