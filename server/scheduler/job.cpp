// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/job.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "server/scheduler/lifecycle.hpp"

namespace tessera::scheduler {
namespace {

constexpr int kRefusalsUntilFailure = 3;
constexpr std::size_t kRefusersUntilFailure = 3;
constexpr std::size_t kPrincipalsUntilFailure = 3;

constexpr const char* kWhatToDoAboutStuck =
    "Render the pixels here to see what keeps them (tessera render SCENE --crop), lower what the scene asks "
    "for there, such as max_depth, or look at how busy the machines are; then submit it again";

std::string names_of(const std::vector<Loss>& losses) {
  std::vector<std::string> names;
  for (const Loss& each : losses) names.push_back(fmt::format("{} ({:.8})", each.name, each.worker.value));
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string sentence_on(const WorkItem& item, const core::PixelRect& rect, const std::vector<Loss>& losses) {
  const auto is = [](LossKind kind) { return [kind](const Loss& loss) { return loss.kind == kind; }; };
  const bool any_died = std::any_of(losses.begin(), losses.end(), is(LossKind::kDied));
  const bool any_stuck = std::any_of(losses.begin(), losses.end(), is(LossKind::kStuck));
  const char* const what = !any_stuck  ? "died one after the other while they rendered"
                           : !any_died ? "hung one after the other in"
                                       : "died or hung one after the other while they rendered";
  return fmt::format(
      "{} workers {} samples [{}, {}) of tile {} (pixels [{}, {}) x [{}, {})): {}. {}", losses.size(), what,
      item.samples.begin, item.samples.end, item.tile, rect.x0, rect.x1, rect.y0, rect.y1, names_of(losses),
      any_stuck ? kWhatToDoAboutStuck
                : "Look into their logs, and whether they have the memory that the scene needs; then submit "
                  "it again");
}

bool are_enough(const Principals& said, const FindPrincipals& find_present) {
  Principals present = find_present();
  present.insert(said.begin(), said.end());
  return said.size() >= std::min(kPrincipalsUntilFailure, present.size());
}

Principals principals_of(const std::vector<Loss>& losses) {
  Principals principals;
  for (const Loss& loss : losses) principals.insert(loss.principal);
  return principals;
}

std::uint64_t total_samples(const JobShape& shape) {
  return std::uint64_t{shape.window.pixel_count()} * shape.spp;
}

}  // namespace

Job::Job(JobId id, JobShape shape, SchedulingPolicy policy, JobState state, std::vector<IntervalSet> done)
    : id_(std::move(id)),
      shape_(shape),
      grid_(shape.grid()),
      policy_(policy),
      state_(state),
      done_(std::move(done)),
      work_(grid_.tile_count(), shape.spp),
      audits_(grid_),
      total_(total_samples(shape)) {
  done_.resize(static_cast<std::size_t>(grid_.tile_count()));
  for (int tile = 0; tile < grid_.tile_count(); ++tile) {
    done_count_ += this->done(tile).count() * grid_.rect(tile).pixel_count();
  }
}

void Job::become(JobState to) {
  if (!may_become(state_, to)) invalid_transition("job", job_state_name(state_), job_state_name(to));
  state_ = to;
}

void Job::set_policy(const SchedulingPolicy& policy) {
  policy_ = policy;
  tolerated_workers_ = workers_beyond_limit();
}

bool Job::may_be_leased_to(const WorkerId& worker) const {
  const std::size_t most = policy_.max_workers;
  return most == 0 || holder_count() - (is_holder(worker) ? 1 : 0) < most;
}

std::size_t Job::holder_count() const {
  std::set<WorkerId> auditors;
  for (const auto& [id, lease] : audit_leases_.all()) {
    if (!leases_.is_holder(lease.holder)) auditors.insert(lease.holder);
  }
  return leases_.holder_count() + auditors.size();
}

std::size_t Job::workers_beyond_limit() const {
  const std::size_t most = policy_.max_workers;
  if (most == 0) return 0;
  const std::size_t holders = holder_count();
  return holders <= most ? 0 : holders - most;
}

void Job::note_ended_lease() {
  tolerated_workers_ = std::min(tolerated_workers_, workers_beyond_limit());
}

std::uint64_t Job::pixel_samples(const WorkItem& item) const {
  return grid_.rect(item.tile).pixel_count() * item.samples.count();
}

bool Job::has(const WorkItem& item) const {
  return item.tile >= 0 && item.tile < grid_.tile_count() && !item.samples.empty() &&
         item.samples.end <= shape_.spp;
}

IntervalSet Job::free_of(const WorkItem& item) const {
  IntervalSet samples{item.samples};
  samples.remove(done(item.tile));
  samples.remove(leases_.leased(item.tile));
  return samples;
}

// The samples of a tile that fit into a budget of pixel samples: at least one.
std::uint32_t Job::samples_for(int tile, std::uint64_t budget) const {
  const std::uint64_t fitting = budget / grid_.rect(tile).pixel_count();
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(fitting, 1, shape_.spp));
}

Portion Job::next_free(std::uint64_t samples, bool holds_nothing) const {
  Portion portion;
  WorkList::Walk walk(work_);
  const auto wanted = [this](const WorkItem& candidate) { return free_of(candidate); };
  while (!portion.alone && samples > 0 && portion.items.size() < kMaxItemsPerLease) {
    const std::optional<WorkItem> piece = walk.next(wanted);
    if (!piece) break;
    const PoisonTracker::Part part = poison_.first_part(*piece);
    portion.alone = !part.losses.empty();
    if (portion.alone && !(holds_nothing && portion.items.empty())) return {std::move(portion.items), false};
    const bool single = part.losses.size() >= kLossesUntilSingleSamples;
    const std::uint32_t count =
        single ? 1 : std::min(samples_for(piece->tile, samples), part.samples.count());
    walk.pass(*piece, count);
    portion.items.push_back({piece->tile, {piece->samples.begin, piece->samples.begin + count}});
    samples -= std::min(samples, pixel_samples(portion.items.back()));
  }
  return portion;
}

Portion Job::next_copies(std::uint64_t samples) const {
  Portion portion;
  for (const LeaseId id : copyable_) {
    if (portion.alone || samples == 0 || portion.items.size() == kMaxItemsPerLease) break;
    append_copies(held_once(*leases_.find(id)), samples, portion);
  }
  return portion;
}

bool Job::has_copies(const Lease& lease) const {
  // A lease alone is not copied: two deaths of one cause would count twice.
  return !lease.alone && std::any_of(lease.items.begin(), lease.items.end(), [&](const WorkItem& item) {
    return !leases_.leased_by_others(item.tile, lease.id).contains(item.samples);
  });
}

std::vector<WorkItem> Job::held_once(const Lease& lease) const {
  std::vector<WorkItem> pieces;
  if (lease.alone) return pieces;
  for (const WorkItem& item : lease.items) {
    IntervalSet samples{item.samples};
    samples.remove(leases_.leased_by_others(item.tile, lease.id));
    for (const core::SampleRange& range : samples.ranges()) pieces.push_back({item.tile, range});
  }
  return pieces;
}

void Job::append_copies(const std::vector<WorkItem>& pieces, std::uint64_t& budget, Portion& portion) const {
  for (const WorkItem& piece : pieces) {
    if (portion.alone || budget == 0 || portion.items.size() == kMaxItemsPerLease) return;
    const PoisonTracker::Part part = poison_.first_part(piece);
    const bool suspect = !part.losses.empty();
    if (suspect && !portion.items.empty()) continue;
    const std::uint32_t count = std::min(samples_for(piece.tile, budget), part.samples.count());
    portion.items.push_back({piece.tile, {piece.samples.begin, piece.samples.begin + count}});
    portion.alone = suspect;
    budget -= std::min(budget, pixel_samples(portion.items.back()));
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
  if (lease.auditor) return lease_audit(std::move(lease));
  for (const WorkItem& item : lease.items) {
    IntervalSet newly{item.samples};
    newly.remove(leases_.leased(item.tile));
    leased_count_ += newly.count() * grid_.rect(item.tile).pixel_count();
  }
  copyable_.insert(lease.id);
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
    for (const LeaseId other : leases_.of_tile(item.tile)) copyable_.insert(other);
  }
  note_ended_lease();
  return lease;
}

std::vector<Lease> Job::end_all_leases() {
  std::vector<Lease> ended;
  const auto revoke_first_of = [&](const LeaseTable& leases) {
    ended.push_back(end_lease(leases.all().begin()->first, LeaseState::kRevoked));
  };
  while (!leases_.all().empty()) revoke_first_of(leases_);
  while (!audit_leases_.all().empty()) revoke_first_of(audit_leases_);
  return ended;
}

bool Job::accept(const WorkItem& item, std::vector<Lease>& ended) {
  IntervalSet& done = done_[static_cast<std::size_t>(item.tile)];
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
    ended.push_back(std::move(lease));
  }
  note_ended_lease();
  return true;
}

std::optional<std::string> Job::strike(const Lease& lease, const Loss& loss, const FindPrincipals& present) {
  for (const WorkItem& item : lease.items) poison_.strike(item, loss, lease.alone);
  // With several items, the cause is unknown.
  return lease.alone ? verdict_on(lease.items.front(), present) : std::nullopt;
}

std::optional<std::string> Job::strike(const std::vector<WorkItem>& items, const Loss& loss,
                                       const FindPrincipals& present) {
  std::vector<WorkItem> missing;
  for (const WorkItem& item : items) {
    IntervalSet samples{item.samples};
    // Samples that were rendered do not run for ever.
    samples.remove(done(item.tile));
    for (const core::SampleRange& range : samples.ranges()) missing.push_back({item.tile, range});
  }
  if (missing.empty()) return std::nullopt;
  for (const WorkItem& item : missing) poison_.strike(item, loss, true);
  const auto is_of_name = [&](const Loss& other) {
    return other.name == loss.name && other.principal == loss.principal;
  };
  if (std::none_of(stuck_before_any_.begin(), stuck_before_any_.end(), is_of_name))
    stuck_before_any_.push_back(loss);
  for (const WorkItem& item : missing) {
    if (auto verdict = verdict_on(item, present)) return verdict;
  }
  return std::nullopt;
}

std::optional<std::string> Job::verdict_on(const WorkItem& item, const FindPrincipals& present) const {
  PoisonTracker::Part part;
  for (WorkItem rest = item; !rest.samples.empty(); rest.samples.begin = part.samples.end) {
    part = poison_.first_part(rest);
    if (part.losses.size() < kLossesUntilFailure) continue;
    // Another worker that holds the samples may still render them.
    if (leases_.leased(item.tile).intersects(part.samples)) continue;
    if (audit_leases_.leased(item.tile).intersects(part.samples)) continue;
    if (!are_enough(principals_of(part.losses), present)) continue;
    return sentence_on({item.tile, poison_.to_be_told(rest)}, grid_.rect(item.tile), part.losses);
  }
  return std::nullopt;
}

std::optional<std::string> Job::nobody_gets_on(const FindPrincipals& present) const {
  if (done_count_ > 0 || lease_count() > 0 || stuck_before_any_.size() < kLossesUntilFailure)
    return std::nullopt;
  if (!are_enough(principals_of(stuck_before_any_), present)) return std::nullopt;
  return fmt::format(
      "{} workers hung in all samples of it that they held, and none has been rendered: {}. {}",
      stuck_before_any_.size(), names_of(stuck_before_any_), kWhatToDoAboutStuck);
}

void Job::withdraw_strikes(const WorkerId& worker, LossKind kind) {
  poison_.withdraw_strikes(worker, kind);
  if (kind == LossKind::kStuck)
    std::erase_if(stuck_before_any_, [&](const Loss& loss) { return loss.worker == worker; });
}

std::optional<std::string> Job::decline_reason(const Refuser& refuser, const std::string& why,
                                               const std::set<std::string>& present,
                                               const FindPrincipals& principals) {
  ++refusals_;
  refusers_.insert(refuser.name);
  refusing_principals_.insert(refuser.principal);
  refusing_workers_.insert(refuser.worker);
  const auto has_refused = [&](const auto& entry) { return refusing_workers_.contains(entry.second.holder); };
  const bool nobody_else =
      std::includes(refusers_.begin(), refusers_.end(), present.begin(), present.end()) &&
      std::all_of(leases_.all().begin(), leases_.all().end(), has_refused) &&
      std::all_of(audit_leases_.all().begin(), audit_leases_.all().end(), has_refused);
  if (refusals_ < kRefusalsUntilFailure) return std::nullopt;
  if (refusers_.size() < kRefusersUntilFailure && !nobody_else) return std::nullopt;
  if (!are_enough(refusing_principals_, principals)) return std::nullopt;
  return fmt::format(
      "{} times in a row a worker could not build the scene, the last of them {}, which says: \"{}\". Mend "
      "that, or "
      "give the workers the release and the memory that the scene needs; then submit it again",
      refusals_, refuser.name, why);
}

void Job::extend(std::uint32_t spp) {
  shape_.spp = spp;
  total_ = total_samples(shape_);
  work_.extend(spp);
}

}  // namespace tessera::scheduler
