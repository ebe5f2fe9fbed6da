// SPDX-License-Identifier: Apache-2.0
// The leases of one job: which worker renders which samples. Keeps the missing samples of each lease, and
// answers which samples of a tile are leased. Not thread-safe.
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

  // The workers that hold at least one lease.
  std::size_t holder_count() const { return lease_counts_.size(); }
  bool is_holder(const WorkerId& worker) const { return lease_counts_.contains(worker); }

  // The id must be new, and the items must not be empty.
  void insert(Lease lease);
  // The lease's holder has reported it. It must exist; no change if it is held already.
  void acknowledge(LeaseId id);
  // Ends a lease, which must exist, in a final state.
  Lease end(LeaseId id, LeaseState to);

  // Removes samples from all leases. Ends and returns the leases that are left without items.
  std::vector<Lease> trim(const WorkItem& done);
  // The same for one lease.
  std::optional<Lease> trim(LeaseId id, const WorkItem& done);

  // The leased samples of a tile, of all leases or of all but one.
  IntervalSet leased(int tile) const { return leased_by_others(tile, LeaseId{}); }
  IntervalSet leased_by_others(int tile, LeaseId but) const;
  // The leases with items of this tile, in no particular order.
  const std::vector<LeaseId>& of_tile(int tile) const;

 private:
  // The only function that changes a lease's state.
  static void become(Lease& lease, LeaseState to);
  void drop_from_tile(int tile, LeaseId id);
  // Removes a lease that has no items left in by_tile_.
  Lease extract(LeaseId id, LeaseState to);

  std::map<LeaseId, Lease> leases_;
  // Leases by holder, without zeros.
  std::map<WorkerId, int> lease_counts_;
  // Contains each lease once for every tile of its items. Never iterated, so its order does not matter.
  std::unordered_map<int, std::vector<LeaseId>> by_tile_;
};

}  // namespace tessera::scheduler
