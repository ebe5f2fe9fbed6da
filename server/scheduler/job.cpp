// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/job.hpp"

#include <algorithm>
#include <utility>

#include "server/scheduler/lifecycle.hpp"

namespace tessera::scheduler {

Job::Job(JobNumber number, JobId id, JobShape shape, SchedulingPolicy policy, JobState state,
         const std::vector<IntervalSet>& done)
    : number_(number),
      id_(std::move(id)),
      shape_(std::move(shape)),
      grid_(shape_.grid()),
      policy_(policy),
      state_(state),
      done_(grid_.tile_count()),
      work_(shape_),
      costs_(grid_.tile_count()),
      audits_(grid_),
      total_(shape_.pixel_samples()) {
  for (std::size_t i = 0; i < done.size(); ++i) {
    if (done[i].empty()) continue;
    const int tile = static_cast<int>(i);
    done_.mutable_at(tile) = done[i];
    done_count_ += done[i].count() * grid_.rect(tile).pixel_count();
  }
  if (complete()) {
    work_.clear();
  } else if (done_count_ > 0 && takes_results(state)) {
    forget_what_is_leased();
  }
}

void Job::become(JobState to) {
  if (!may_become(state_, to)) invalid_transition("job", job_state_name(state_), job_state_name(to));
  state_ = to;
}

EndedRun Job::begin_run(RunNumber next) {
  EndedRun ended{.number = std::exchange(run_, next),
                 .leases = std::exchange(leases_, {}),
                 .audit_leases = std::exchange(audit_leases_, {}),
                 .lease_counts = std::exchange(lease_counts_, {}),
                 .copyable = std::exchange(copyable_, {}),
                 .stalled_workers = std::exchange(stalled_workers_, {}),
                 .refusers = std::exchange(refusers_of_run_, {})};
  leased_count_ = auditing_count_ = 0;
  tolerated_workers_ = waived_ = 0;
  return ended;
}

Audits Job::take_audits() {
  return std::exchange(audits_, Audits(grid_));
}

void Job::set_policy(const SchedulingPolicy& policy) {
  policy_ = policy;
  tolerated_workers_ = workers_beyond_limit();
}

bool Job::may_be_leased_to(const WorkerId& worker) const {
  const std::size_t most = policy_.max_workers;
  return most == 0 || holder_count() - (is_holder(worker) ? 1 : 0) < most;
}

bool Job::may_have_another_holder() const {
  return policy_.max_workers == 0 || holder_count() < policy_.max_workers;
}

std::size_t Job::workers_beyond_limit() const {
  const std::size_t most = policy_.max_workers;
  if (most == 0) return 0;
  const std::size_t holders = holder_count();
  return holders <= most ? 0 : holders - most;
}

void Job::note_ended_lease(const Lease& lease) {
  const auto count = lease_counts_.find(lease.holder);
  if (--count->second == 0) lease_counts_.erase(count);
  tolerated_workers_ = std::min(tolerated_workers_, workers_beyond_limit());
}

std::uint64_t Job::pixel_samples(const WorkItem& item) const {
  return grid_.rect(item.tile).pixel_count() * item.samples.count();
}

double Job::mean_samples(const WorkItem& item) const {
  return static_cast<double>(pixel_samples(item)) * costs_.relative(item.tile);
}

void Job::learn_costs(const std::vector<WorkItem>& items, double mean_samples) {
  std::vector<TileCosts::Part> parts;
  for (const WorkItem& item : items) parts.push_back({item.tile, static_cast<double>(pixel_samples(item))});
  costs_.learn(parts, mean_samples);
}

bool Job::has(const WorkItem& item) const {
  return has_tile(item.tile) && !item.samples.empty() && item.samples.end <= shape_.target(item.tile);
}

IntervalSet Job::free_of(const WorkItem& item) const {
  IntervalSet samples{item.samples};
  samples.remove(done(item.tile));
  samples.remove(leases_.leased(item.tile));
  return samples;
}

// The samples of a tile that fit into what is left of a lease: at least one.
std::uint32_t Job::samples_for(int tile, const LeaseSize& left) const {
  constexpr double kRounding = 1e-3;  // of costs
  const double pixel_samples = std::min(left.mean_samples / costs_.relative(tile), left.most_samples);
  const double fitting = pixel_samples / static_cast<double>(grid_.rect(tile).pixel_count()) + kRounding;
  return static_cast<std::uint32_t>(std::clamp<double>(fitting, 1, shape_.target(tile)));
}

void Job::take_from(LeaseSize& left, const WorkItem& item) const {
  left.mean_samples -= mean_samples(item);
  left.most_samples -= static_cast<double>(pixel_samples(item));
}

Portion Job::next_free(LeaseSize size, bool holds_nothing) const {
  Portion portion;
  WorkList::Walk walk(work_);
  const auto wanted = [this](const WorkItem& candidate) { return free_of(candidate); };
  while (!portion.alone && !size.is_used_up() && portion.items.size() < kMaxItemsPerLease) {
    const std::optional<WorkItem> piece = walk.next(wanted);
    if (!piece) break;
    const PoisonTracker::Part part = poison_.first_part(*piece);
    portion.alone = !part.losses.empty();
    if (portion.alone && !(holds_nothing && portion.items.empty())) return {std::move(portion.items), false};
    const bool single = part.losses.size() >= kLossesUntilSingleSamples;
    const std::uint32_t count = single ? 1 : std::min(samples_for(piece->tile, size), part.samples.count());
    walk.pass(*piece, count);
    portion.items.push_back({piece->tile, {piece->samples.begin, piece->samples.begin + count}});
    take_from(size, portion.items.back());
  }
  return portion;
}

Portion Job::next_copies(LeaseSize size) const {
  Portion portion;
  for (const LeaseId id : copyable_) {
    if (portion.alone || size.is_used_up() || portion.items.size() == kMaxItemsPerLease) break;
    append_copies(held_once(*leases_.find(id)), size, portion);
  }
  return portion;
}

bool Job::has_copies(const Lease& lease) const {
  // A lease alone is not copied: two deaths of one cause would count twice.
  return !lease.alone && std::any_of(lease.items.begin(), lease.items.end(), [&](const WorkItem& item) {
    return !leases_.leased_twice(item.tile).contains(item.samples);
  });
}

std::vector<WorkItem> Job::held_once(const Lease& lease) const {
  std::vector<WorkItem> pieces;
  if (lease.alone) return pieces;
  for (const WorkItem& item : lease.items) {
    IntervalSet samples{item.samples};
    samples.remove(leases_.leased_twice(item.tile));
    for (const core::SampleRange& range : samples.ranges()) pieces.push_back({item.tile, range});
  }
  return pieces;
}

void Job::append_copies(const std::vector<WorkItem>& pieces, LeaseSize& left, Portion& portion) const {
  for (const WorkItem& piece : pieces) {
    if (portion.alone || left.is_used_up() || portion.items.size() == kMaxItemsPerLease) return;
    const PoisonTracker::Part part = poison_.first_part(piece);
    const bool suspect = !part.losses.empty();
    if (suspect && !portion.items.empty()) continue;
    const std::uint32_t count = std::min(samples_for(piece.tile, left), part.samples.count());
    portion.items.push_back({piece.tile, {piece.samples.begin, piece.samples.begin + count}});
    portion.alone = suspect;
    take_from(left, portion.items.back());
  }
}

std::vector<WorkItem> Job::free_parts(const std::vector<WorkItem>& items) const {
  std::vector<WorkItem> parts;
  for (const WorkItem& item : items) {
    if (!has(item)) continue;
    IntervalSet samples = free_of(item);
    for (const WorkItem& part : parts) {
      if (part.tile == item.tile) samples.remove(part.samples);
    }
    for (const core::SampleRange& range : samples.ranges()) {
      if (parts.size() == kMaxItemsPerLease) return parts;
      parts.push_back({item.tile, range});
    }
  }
  return parts;
}

void Job::lease(Lease lease) {
  ++lease_counts_[lease.holder];
  if (lease.auditor) return lease_audit(std::move(lease));
  for (const WorkItem& item : lease.items) {
    IntervalSet newly{item.samples};
    newly.remove(leases_.leased(item.tile));
    leased_count_ += newly.count() * grid_.rect(item.tile).pixel_count();
    if (!newly.empty() && !lease.alone) copyable_.insert(lease.id);
  }
  leases_.insert(std::move(lease));
  forget_what_is_leased();
}

// Removes leased candidates from the front, so that each search need not skip them again.
void Job::forget_what_is_leased() {
  work_.forget_unwanted([this](const WorkItem& candidate) { return free_of(candidate); });
  while (!copyable_.empty() && !has_copies(*leases_.find(*copyable_.begin())))
    copyable_.erase(copyable_.begin());
}

const Lease* Job::find_lease(LeaseId id) const {
  const Lease* const lease = leases_.find(id);
  return lease != nullptr ? lease : audit_leases_.find(id);
}

void Job::acknowledge(LeaseId id) {
  (audit_leases_.find(id) != nullptr ? audit_leases_ : leases_).acknowledge(id);
}

Lease Job::end_lease(LeaseId id, LeaseState to) {
  if (audit_leases_.find(id) != nullptr) return end_audit(id, to);
  Lease lease = leases_.end(id, to);
  copyable_.erase(id);
  for (const WorkItem& item : lease.items) {
    IntervalSet freed{item.samples};
    freed.remove(leases_.leased(item.tile));
    for (const core::SampleRange& range : freed.ranges()) {
      work_.put_back({item.tile, range});
      leased_count_ -= pixel_samples({item.tile, range});
    }
    for (const LeaseId other : leases_.holding(item)) copyable_.insert(other);
  }
  note_ended_lease(lease);
  return lease;
}

bool Job::accept(const WorkItem& item, std::vector<Lease>& ended) {
  IntervalSet& done = done_.mutable_at(item.tile);
  if (done.intersects(item.samples)) return false;
  const IntervalSet was_leased = leases_.leased(item.tile).intersection(item.samples);
  leased_count_ -= was_leased.count() * grid_.rect(item.tile).pixel_count();
  done_count_ += pixel_samples(item);
  done.add(item.samples);
  poison_.clear(item);
  stuck_before_any_.clear();
  refusals_ = 0;
  refusers_.clear();
  refusing_principals_.clear();
  refusing_workers_.clear();
  for (Lease& lease : leases_.trim(item)) {
    copyable_.erase(lease.id);
    note_ended_lease(lease);
    ended.push_back(std::move(lease));
  }
  return true;
}

void Job::extend(std::uint32_t spp, const std::vector<TileTarget>& tiles) {
  total_ += shape_.raise(spp, tiles);
  work_.extend(shape_);
}

}  // namespace tessera::scheduler
