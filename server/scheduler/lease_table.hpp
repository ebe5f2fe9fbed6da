// SPDX-License-Identifier: Apache-2.0
// The leases of one job: which worker renders which samples. Keeps the missing samples of each lease, and
// answers which samples of a tile are leased, and by which leases, in time logarithmic in their number. Not
// thread-safe.
#pragma once

#include <map>
#include <optional>
#include <unordered_map>
#include <vector>

#include "server/scheduler/interval_set.hpp"
#include "server/scheduler/lease_state.hpp"
#include "server/scheduler/producer.hpp"
#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

struct Lease {
  LeaseId id;
  WorkerId holder;
  // Missing samples, disjoint, in the order in which they are to be rendered.
  std::vector<WorkItem> items;
  // Its holder may hold nothing else (poison_tracker.hpp).
  bool alone = false;
  // Proves that it was given to its holder.
  LeaseToken token{};
  // Set if its samples are done and this worker audits them (audits.hpp).
  std::optional<ProducerNumber> auditor{};
  // Changed by the table only.
  LeaseState state = LeaseState::kGranted;
};

class LeaseTable {
 public:
  // Ordered by id: oldest first.
  const std::map<LeaseId, Lease>& all() const { return leases_; }
  const Lease* find(LeaseId id) const;

  // The id must be new, and the items must not be empty. No sample may be in more than two leases.
  void insert(Lease lease);
  // The lease's holder has reported it. It must exist; no change if it is held already.
  void acknowledge(LeaseId id);
  // Ends a lease, which must exist, in a final state.
  Lease end(LeaseId id, LeaseState to);

  // Removes samples from all leases. Ends and returns the leases that are left without items.
  std::vector<Lease> trim(const WorkItem& done);
  // The same for one lease.
  std::optional<Lease> trim(LeaseId id, const WorkItem& done);

  // The samples of a tile that are in any lease, and those that are in two. Valid until the table changes.
  const IntervalSet& leased(int tile) const;
  const IntervalSet& leased_twice(int tile) const;
  // The leases that have any of these samples, oldest first.
  std::vector<LeaseId> holding(const WorkItem& item) const;

 private:
  // A part of a lease, as one of its items.
  struct Part {
    core::SampleRange samples;
    LeaseId lease;
  };
  struct Tile {
    // In the order of their first samples.
    std::vector<Part> parts;
    // No part has more samples.
    std::uint32_t longest = 0;
    IntervalSet once, twice;
  };

  // The only function that changes a lease's state.
  static void become(Lease& lease, LeaseState to);
  void enter(const WorkItem& item, LeaseId id);
  void remove(const WorkItem& item, LeaseId id);
  Lease extract(LeaseId id, LeaseState to);
  const Tile& at(int tile) const;

  std::map<LeaseId, Lease> leases_;
  // The tiles with leases. Never iterated, so its order does not matter.
  std::unordered_map<int, Tile> tiles_;
};

}  // namespace tessera::scheduler
