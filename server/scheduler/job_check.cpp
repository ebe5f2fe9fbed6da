// SPDX-License-Identifier: Apache-2.0
// The invariants of a job.
#include <fmt/format.h>

#include <algorithm>

#include "server/scheduler/job.hpp"

namespace tessera::scheduler {

std::optional<std::string> Job::check() const {
  if (done_count_ > total_) return fmt::format("{} samples done of {}", done_count_, total_);
  if (done_count_ + leased_count_ > total_) {
    return fmt::format("{} samples done and {} leased of {}", done_count_, leased_count_, total_);
  }
  if (workers_beyond_limit() > tolerated_workers_) {
    return fmt::format("{} workers hold leases, but no more than {} may", holder_count(),
                       policy_.max_workers);
  }
  if (state_ == JobState::kDone && !complete())
    return fmt::format("done, but lacks {} samples", total_ - done_count_);
  if (state_ != JobState::kRunning && state_ != JobState::kPaused && lease_count() > 0) {
    return fmt::format("{}, but has {} leases", job_state_name(state_), lease_count());
  }
  return std::nullopt;
}

std::optional<std::string> Job::check_lease(const Lease& lease) const {
  const std::uint64_t id = lease.id.value;
  if (lease.items.empty()) return fmt::format("lease {} holds nothing", id);
  if (!is_live(lease.state))
    return fmt::format("lease {} is {}, but has not ended", id, lease_state_name(lease.state));
  for (const WorkItem& item : lease.items) {
    if (!has(item)) return fmt::format("lease {} holds samples that are not of the job", id);
    const bool wrong =
        lease.auditor ? !done(item.tile).contains(item.samples) : done(item.tile).intersects(item.samples);
    if (wrong) return fmt::format("lease {} holds {} samples", id, lease.auditor ? "missing" : "done");
  }
  return std::nullopt;
}

// The ledger covers only done samples, and every entry that is due waits for an auditor or has one.
std::optional<std::string> Job::check_audits() const {
  std::uint64_t due = 0, auditing = 0;
  for (int tile = 0; tile < grid_.tile_count(); ++tile) {
    std::uint32_t end = 0;
    for (const LedgerEntry& entry : audits_.ledger().of_tile(tile)) {
      if (entry.samples.begin < end || entry.samples.empty())
        return fmt::format("tile {}: its ledger overlaps", tile);
      if (!done(tile).contains(entry.samples))
        return fmt::format("tile {}: its ledger has missing samples", tile);
      if (entry.due() != Due::kNo) due += pixel_samples({tile, entry.samples});
      end = entry.samples.end;
    }
  }
  for (const auto& [id, lease] : audit_leases_.all()) {
    for (const WorkItem& item : lease.items) auditing += pixel_samples(item);
  }
  if (due != to_verify()) return fmt::format("{} samples to verify, counted {}", due, to_verify());
  if (auditing != auditing_count_)
    return fmt::format("{} samples rendered again, counted {}", auditing, auditing_count_);
  return audits_.check();
}

bool Job::has_copies_to_give() const {
  return std::any_of(leases_.all().begin(), leases_.all().end(),
                     [&](const auto& entry) { return has_copies(entry.second); });
}

std::optional<std::string> Job::check_samples() const {
  std::uint64_t done_count = 0, leased_count = 0;
  for (int tile = 0; tile < grid_.tile_count(); ++tile) {
    if (const auto wrong = check_tile(tile)) return fmt::format("tile {}: {}", tile, *wrong);
    const std::uint64_t pixels = grid_.rect(tile).pixel_count();
    done_count += done(tile).count() * pixels;
    leased_count += leases_.leased(tile).count() * pixels;
  }
  if (done_count != done_count_) return fmt::format("{} samples done, counted {}", done_count, done_count_);
  if (leased_count != leased_count_)
    return fmt::format("{} samples leased, counted {}", leased_count, leased_count_);
  std::set<WorkerId> holders;
  for (const auto& [id, lease] : leases_.all()) {
    holders.insert(lease.holder);
    if (has_copies(lease) && !copyable_.contains(id))
      return fmt::format("lease {} has samples to copy, but is not offered", id.value);
  }
  for (const auto& [id, lease] : audit_leases_.all()) holders.insert(lease.holder);
  if (holders.size() != holder_count())
    return fmt::format("{} workers hold leases, counted {}", holders.size(), holder_count());
  return check_audits();
}

// Every missing sample is leased to at most two workers, or is a candidate.
std::optional<std::string> Job::check_tile(int tile) const {
  const core::SampleRange all{0, shape_.target(tile)};
  IntervalSet lost{all};
  lost.remove(done(tile));
  lost.remove(leases_.leased(tile));
  lost.remove(work_.candidates(tile));
  const bool matters = state_ == JobState::kRunning || state_ == JobState::kPaused;
  if (matters && !lost.empty()) {
    return fmt::format("samples from {} on are neither done, nor leased, nor free", lost.ranges()[0].begin);
  }
  IntervalSet once, twice;
  for (const LeaseId id : leases_.holding({tile, all})) {
    for (const WorkItem& item : leases_.find(id)->items) {
      if (item.tile != tile) continue;
      if (twice.intersects(item.samples)) return "leased three times";
      twice.add(once.intersection(item.samples));
      once.add(item.samples);
    }
  }
  if (once != leases_.leased(tile) || twice != leases_.leased_twice(tile))
    return "other samples are leased than those of its leases";
  return std::nullopt;
}

}  // namespace tessera::scheduler
