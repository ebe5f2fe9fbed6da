// SPDX-License-Identifier: Apache-2.0
// Audits of a job's done samples.
#include <algorithm>
#include <utility>

#include "server/scheduler/job.hpp"

namespace tessera::scheduler {
namespace {

// A worker delivers two adjacent ranges of a lease as one, which could not be compared with either entry.
bool touches_any(const std::vector<WorkItem>& items, const WorkItem& item) {
  return std::any_of(items.begin(), items.end(), [&](const WorkItem& other) {
    return other.tile == item.tile &&
           (other.samples.end == item.samples.begin || item.samples.end == other.samples.begin);
  });
}

bool lies_in(const WorkItem& part, const WorkItem& whole) {
  return part.tile == whole.tile && part.samples.begin >= whole.samples.begin &&
         part.samples.end <= whole.samples.end;
}

}  // namespace

bool Job::is_suspect(const WorkItem& item) const {
  const PoisonTracker::Part part = poison_.first_part(item);
  return !part.losses.empty() || part.samples != item.samples;
}

Portion Job::next_audits(LeaseSize size, bool holds_nothing, const Producer& worker,
                         const Producers& producers) const {
  Portion portion;
  portion.audit = true;
  audits_.offer(worker, producers, [&](const WorkItem& item) {
    if (size.is_used_up() || portion.items.size() == kMaxItemsPerLease) return false;
    if (touches_any(portion.items, item)) return true;
    const bool alone = is_suspect(item);
    if (alone && !(holds_nothing && portion.items.empty())) return false;
    portion.items.push_back(item);
    portion.alone = alone;
    take_from(size, item);
    return !alone;
  });
  return portion;
}

Portion Job::next_audit_copy(const Producer& worker, const Producers& producers) const {
  // A lease alone is not copied, as in held_once().
  const auto may_share = [this](LeaseId lease) { return !audit_leases_.find(lease)->alone; };
  const std::optional<WorkItem> item = audits_.copy_for(worker, producers, may_share);
  if (!item) return {};
  return {{*item}, is_suspect(*item), true};
}

void Job::lease_audit(Lease lease) {
  for (const WorkItem& item : lease.items) {
    auditing_count_ += pixel_samples(item);
    audits_.begin(item, lease.id, *lease.auditor);
  }
  audit_leases_.insert(std::move(lease));
}

Lease Job::end_audit(LeaseId id, LeaseState to) {
  Lease lease = audit_leases_.end(id, to);
  for (const WorkItem& item : lease.items) {
    auditing_count_ -= pixel_samples(item);
    audits_.abandon(id, item);
  }
  note_ended_lease(lease);
  return lease;
}

bool Job::is_audit(LeaseId lease, const WorkItem& item) const {
  const Lease* const audit = audit_leases_.find(lease);
  return audit != nullptr && std::any_of(audit->items.begin(), audit->items.end(),
                                         [&](const WorkItem& asked) { return lies_in(item, asked); });
}

std::optional<Ruling> Job::audit(LeaseId lease, const WorkItem& item, const Fingerprint& fingerprint,
                                 std::vector<Lease>& ended) {
  poison_.clear(item);
  auditing_count_ -= pixel_samples(item);
  if (auto emptied = audit_leases_.trim(lease, item)) {
    note_ended_lease(*emptied);
    ended.push_back(std::move(*emptied));
  }
  std::optional<Ruling> ruling = audits_.deliver(lease, item, fingerprint);
  if (ruling) trim_audits(ruling->item, ended);  // also from leases of other auditors
  return ruling;
}

void Job::trim_audits(const WorkItem& item, std::vector<Lease>& ended) {
  for (const LeaseId id : audit_leases_.holding(item)) {
    for (const WorkItem& held : audit_leases_.find(id)->items) {
      if (lies_in(held, item)) auditing_count_ -= pixel_samples(held);
    }
  }
  for (Lease& lease : audit_leases_.trim(item)) {
    note_ended_lease(lease);
    ended.push_back(std::move(lease));
  }
}

void Job::drop_tile(int tile, std::vector<Lease>& ended) {
  const WorkItem whole{tile, {0, shape_.target(tile)}};
  IntervalSet& done = done_.mutable_at(tile);
  done_count_ -= done.count() * grid_.rect(tile).pixel_count();
  done = {};
  trim_audits(whole, ended);
  audits_.drop_tile(tile);
  work_.put_back(whole);
}

}  // namespace tessera::scheduler
