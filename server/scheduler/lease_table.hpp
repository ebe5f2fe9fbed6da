// SPDX-License-Identifier: Apache-2.0
// The leases of one job: who has been asked to render what. Keeps only what is still missing of each lease,
// and answers for each tile which of its samples are leased. Not thread-safe.
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
  // Not done yet, in the order in which they are to be rendered; disjoint.
  std::vector<WorkItem> items;
  // Its holder is to hold nothing else (poison_tracker.hpp).
  bool alone = false;
  // Its samples are done, and rendered again by this author (audits.hpp).
  std::optional<ProducerNumber> auditor{};
  // Changed by the table alone.
  LeaseState state = LeaseState::kGranted;
};

class LeaseTable {
 public:
  // In the order of their ids: oldest first.
  const std::map<LeaseId, Lease>& all() const { return leases_; }
  const Lease* find(LeaseId id) const;

  // Workers that hold at least one.
  std::size_t holder_count() const { return lease_counts_.size(); }
  bool is_holder(const WorkerId& worker) const { return lease_counts_.contains(worker); }

  // The id must be new, the items not empty.
  void insert(Lease lease);
  // Its holder has reported it. The lease must be there; no change if it is held already.
  void acknowledge(LeaseId id);
  // Ends a lease, which must be there, in a state that is final.
  Lease end(LeaseId id, LeaseState to);

  // Takes samples out of all leases. Returns the leases that are left without items: they are done, and no
  // longer there.
  std::vector<Lease> trim(const WorkItem& done);
  // The same with one lease alone.
  std::optional<Lease> trim(LeaseId id, const WorkItem& done);

  // The leased samples of a tile; those of all leases but one.
  IntervalSet leased(int tile) const { return leased_by_others(tile, LeaseId{}); }
  IntervalSet leased_by_others(int tile, LeaseId but) const;
  // The leases with items of this tile, in no particular order.
  const std::vector<LeaseId>& of_tile(int tile) const;

 private:
  // The one way in which a lease's state changes.
  static void become(Lease& lease, LeaseState to);
  void drop_from_tile(int tile, LeaseId id);
  // Takes out a lease that has no items left in by_tile_.
  Lease extract(LeaseId id, LeaseState to);

  std::map<LeaseId, Lease> leases_;
  // By holder; none is 0.
  std::map<WorkerId, int> lease_counts_;
  // Each lease once for every tile of its items. Never iterated, so that its order cannot matter.
  std::unordered_map<int, std::vector<LeaseId>> by_tile_;
};

}  // namespace tessera::scheduler
