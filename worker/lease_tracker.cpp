// SPDX-License-Identifier: Apache-2.0
#include "worker/lease_tracker.hpp"

#include <fmt/format.h>
#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <span>

#include "core/base/printable.hpp"
#include "core/common/log.hpp"

namespace tessera::worker {
namespace {

// Jobs without leases that are remembered, so that a farm that alternates between jobs need not send them
// again.
constexpr std::size_t kIdleJobsKept = 16;
// An upper bound on any coordinator's lease time.
constexpr std::chrono::seconds kLongestLeaseTime{3600};
// Bounds on what an answer may contain: several times what any coordinator gives.
constexpr int kMaxLeases = 64;
constexpr int kMaxItems = 1024;
// How long a trouble is reported after it last occurred; it recurs if the job is leased again.
constexpr std::chrono::minutes kTroubleShown{10};

v1::Lease to_proto(const HeldLease& lease) {
  v1::Lease message;
  message.set_id(lease.id());
  message.set_job_id(lease.job_id());
  message.set_token(lease.token());
  for (const WorkItem& item : lease.items()) *message.add_items() = proto::to_proto(item);
  return message;
}

v1::Rendering to_proto(const Piece& piece) {
  v1::Rendering message;
  message.set_lease_id(piece.lease_id);
  message.set_job_id(piece.job->id);
  *message.mutable_item() = proto::to_proto(piece.item);
  return message;
}

Duration heartbeat_timeout(const v1::SynchronizeResponse& response) {
  using google::protobuf::util::TimeUtil;
  const std::int64_t told_s = TimeUtil::DurationToSeconds(response.heartbeat_timeout());
  if (told_s >= kLongestLeaseTime.count()) return kLongestLeaseTime;
  return std::chrono::milliseconds(
      std::max<std::int64_t>(TimeUtil::DurationToMilliseconds(response.heartbeat_timeout()), 0));
}

// At most kMaxLeases leases; the rest is ignored.
std::span<const v1::Lease* const> first_leases(const google::protobuf::RepeatedPtrField<v1::Lease>& leases) {
  return {leases.data(), static_cast<std::size_t>(std::min(leases.size(), kMaxLeases))};
}

// The valid items. The coordinator keeps the others.
std::vector<WorkItem> readable_items(const v1::Lease& lease, const v1::JobSpec& job) {
  const v1::RenderSettings& settings = job.settings();
  const auto images = static_cast<std::uint32_t>(std::max(job.images_size(), 1));
  std::vector<WorkItem> items;
  int left_out = std::max(lease.items_size() - kMaxItems, 0);
  for (int i = 0; i < std::min(lease.items_size(), kMaxItems); ++i) {
    const v1::WorkItem& message = lease.items(i);
    const auto item = proto::from_proto(message);
    // At most one tile, since a result cannot hold more.
    const bool inside = item && item->image < images && message.rect().x1() <= settings.width_px() &&
                        message.rect().y1() <= settings.height_px() && item->rect.width() <= core::kTilePx &&
                        item->rect.height() <= core::kTilePx;
    if (inside)
      items.push_back(*item);
    else
      ++left_out;
  }
  if (left_out > 0)
    common::log(
        spdlog::level::warn,
        fmt::format("{} items of lease {} are left out: job {} does not have their image, pixels or samples, "
                    "or they are more than a tile, or there are more than {}",
                    left_out, lease.id(), lease.job_id(), kMaxItems),
        {.job = lease.job_id()});
  return items;
}

}  // namespace

void LeaseTracker::report(v1::SynchronizeRequest& request) {
  const core::MutexLock lock(mutex_);
  just_finished_.clear();
  just_given_.clear();
  forget_idle_jobs();
  std::uint32_t given_up = 0;
  for (const HeldLease& lease : leases_) {
    if (unwanted_.contains(lease.id())) continue;
    *request.add_held() = to_proto(lease);
    if (is_unusable(lease.job_id())) ++given_up;
  }
  for (const auto& [id, entry] : jobs_) request.add_known_job_ids(id);
  // Leases that only wait to be given back do not count, so that the worker gets other work.
  request.set_wanted_leases(draining_ ? 0 : options_.wanted_leases + given_up);
  request.set_draining(draining_);
  report_activity(request);
  report_troubles(request);
}

// A fetch continues when the leases of the job have gone to others.
void LeaseTracker::report_activity(v1::SynchronizeRequest& request) const {
  for (const auto& [id, entry] : jobs_) {
    const bool comes_next = entry.stage == Stage::kWanted && holds_any_of(id);
    if (comes_next || entry.stage == Stage::kFetching) request.add_fetching_job_ids(id);
  }
  if (rendering_) *request.mutable_rendering() = to_proto(*rendering_);
}

void LeaseTracker::report_troubles(v1::SynchronizeRequest& request) const {
  for (const auto& [id, entry] : jobs_) {
    if (entry.trouble.empty() || Clock::now() - entry.trouble_at > kTroubleShown) continue;
    v1::Trouble& trouble = *request.add_troubles();
    trouble.set_job_id(id);
    trouble.set_text(core::printable(entry.trouble));
  }
}

bool LeaseTracker::apply(const v1::SynchronizeResponse& response) {
  const core::MutexLock lock(mutex_);
  heartbeat_timeout_ = std::max(heartbeat_timeout_, heartbeat_timeout(response));
  bool changed = false;
  for (const v1::JobSpec& spec : response.jobs()) changed |= add_job(spec);

  const auto leases = first_leases(response.leases());
  std::map<std::uint64_t, const v1::Lease*> wanted;
  for (const v1::Lease* lease : leases) wanted.emplace(lease->id(), lease);
  for (HeldLease& lease : leases_) {
    const auto still = wanted.find(lease.id());
    if (still == wanted.end() && just_given_.contains(lease.id())) continue;
    if (still == wanted.end()) {
      changed |= unwanted_.try_emplace(lease.id(), Clock::now()).second;
      lease.stop_rendering();
    } else {
      changed |= lease.keep_only(readable_items(*still->second, jobs_.at(lease.job_id()).spec));
    }
  }
  leases_.remove_if([&](const HeldLease& lease) TESSERA_REQUIRES(mutex_) {
    return lease.empty() && unwanted_.erase(lease.id()) > 0;
  });
  for (const v1::Lease* lease : leases) changed |= add_lease(*lease);
  announce_change();
  return changed;
}

bool LeaseTracker::add_job(const v1::JobSpec& spec) {
  if (jobs_.size() >= static_cast<std::size_t>(kMaxLeases) + kIdleJobsKept && !jobs_.contains(spec.job_id()))
    return false;
  const auto [job, is_new] = jobs_.try_emplace(spec.job_id());
  if (is_new) job->second.spec = spec;
  return is_new;
}

bool LeaseTracker::add_lease(const v1::Lease& lease) {
  if (draining_ || find_lease(lease.id()) != nullptr || just_finished_.contains(lease.id())) return false;
  if (leases_.size() >= static_cast<std::size_t>(kMaxLeases)) return false;
  const auto job = jobs_.find(lease.job_id());
  if (job == jobs_.end()) {
    common::log(spdlog::level::warn,
                fmt::format("lease {} is of job {}, which the coordinator did not describe", lease.id(),
                            lease.job_id()),
                {.job = lease.job_id()});
    return false;
  }
  leases_.emplace_back(lease.id(), lease.job_id(), readable_items(lease, job->second.spec), lease.token());
  return true;
}

void LeaseTracker::forget_idle_jobs() {
  std::size_t idle = 0;
  std::erase_if(jobs_, [&](const auto& job) TESSERA_REQUIRES(mutex_) {
    const bool needed = holds_any_of(job.first) || job.second.stage == Stage::kFetching;
    return !needed && ++idle > kIdleJobsKept;
  });
}

bool LeaseTracker::holds_any_of(const std::string& job_id) const {
  return std::any_of(leases_.begin(), leases_.end(),
                     [&](const HeldLease& lease) { return lease.job_id() == job_id; });
}

std::optional<v1::JobSpec> LeaseTracker::next_to_fetch(const std::stop_token& stop) {
  core::MutexLock lock(mutex_);
  for (;;) {
    if (stop.stop_requested()) return std::nullopt;
    for (const HeldLease& lease : leases_) {
      const auto job = jobs_.find(lease.job_id());
      if (job->second.stage != Stage::kWanted || !lease.has_todo()) continue;
      job->second.stage = Stage::kFetching;
      return job->second.spec;
    }
    await_change(lock, stop);
  }
}

void LeaseTracker::fetched(std::shared_ptr<const Job> job) {
  const core::MutexLock lock(mutex_);
  const auto entry = jobs_.find(job->id);
  if (entry == jobs_.end()) return;
  entry->second.stage = Stage::kReady;
  entry->second.job = std::move(job);
  announce_change();
}

void LeaseTracker::cannot_fetch(const std::string& job_id, const std::string& why) {
  const core::MutexLock lock(mutex_);
  make_unusable(job_id, why);
}

void LeaseTracker::decline(const std::string& job_id, const std::string& why) {
  const core::MutexLock lock(mutex_);
  make_declined(job_id, why);
}

std::vector<std::shared_ptr<const Job>> LeaseTracker::jobs_in_hand() const {
  const core::MutexLock lock(mutex_);
  std::vector<std::shared_ptr<const Job>> jobs;
  for (const auto& [id, entry] : jobs_)
    if (entry.job && holds_any_of(id)) jobs.push_back(entry.job);
  return jobs;
}

void LeaseTracker::make_unusable(const std::string& job_id, const std::string& trouble) {
  const auto found = jobs_.find(job_id);
  if (found == jobs_.end()) return;
  JobEntry& entry = found->second;
  Duration delay = options_.first_delay;
  for (int i = 0; i < entry.failures && delay < options_.longest_delay; ++i) delay *= 2;
  ++entry.failures;
  entry.stage = Stage::kUnusable;
  entry.job.reset();
  entry.decline_reason.clear();
  entry.trouble = trouble;
  entry.trouble_at = Clock::now();
  entry.give_back_at = Clock::now() + std::min(delay, options_.longest_delay);
  announce_change();
}

void LeaseTracker::make_declined(const std::string& job_id, const std::string& why) {
  make_unusable(job_id, why);
  const auto job = jobs_.find(job_id);
  if (job != jobs_.end()) job->second.decline_reason = why;
}

bool LeaseTracker::is_unusable(const std::string& job_id) const {
  const auto job = jobs_.find(job_id);
  return job != jobs_.end() && job->second.stage == Stage::kUnusable;
}

HeldLease* LeaseTracker::next_renderable() {
  for (HeldLease& lease : leases_)
    if (lease.has_todo() && jobs_.at(lease.job_id()).stage == Stage::kReady) return &lease;
  return nullptr;
}

std::optional<Piece> LeaseTracker::take(const std::stop_token& stop, const SizePiece& size_piece) {
  core::MutexLock lock(mutex_);
  for (;;) {
    if (stop.stop_requested() || draining_) return std::nullopt;
    if (HeldLease* lease = next_renderable())
      return Piece{lease->id(), jobs_.at(lease->job_id()).job, lease->take(size_piece(lease->job_id()))};
    await_change(lock, stop);
  }
}

void LeaseTracker::begins(const Piece& piece) {
  const core::MutexLock lock(mutex_);
  rendering_ = piece;
  rendering_since_ = Clock::now();
  announce_change();
}

void LeaseTracker::rendered(const Piece& piece, core::FilmTile tile, Duration render_time) {
  const core::MutexLock lock(mutex_);
  rendering_.reset();
  has_rendered_ = true;
  if (has_abandoned_) return;
  find_lease(piece.lease_id)->rendered(std::move(tile), render_time);
  const auto job = jobs_.find(piece.job->id);
  if (job != jobs_.end()) {
    job->second.failures = 0;
    job->second.trouble.clear();
  }
  announce_change();
}

void LeaseTracker::cannot_render(const Piece& piece, const std::string& why) {
  const core::MutexLock lock(mutex_);
  rendering_.reset();
  if (has_abandoned_) return;
  find_lease(piece.lease_id)->not_rendered();
  make_declined(piece.job->id, why);
}

HeldLease* LeaseTracker::find_lease(std::uint64_t id) {
  const auto lease =
      std::find_if(leases_.begin(), leases_.end(), [id](const HeldLease& l) { return l.id() == id; });
  return lease == leases_.end() ? nullptr : &*lease;
}

HeldLease* LeaseTracker::next_sendable(Clock::time_point now) {
  for (HeldLease& lease : leases_) {
    if (is_unusable(lease.job_id()) && now >= jobs_.at(lease.job_id()).give_back_at) lease.stop_rendering();
    if (lease.has_delivery()) return &lease;
  }
  return nullptr;
}

LeaseTracker::Clock::time_point LeaseTracker::next_give_back() const {
  Clock::time_point next = Clock::time_point::max();
  for (const HeldLease& lease : leases_)
    if (is_unusable(lease.job_id())) next = std::min(next, jobs_.at(lease.job_id()).give_back_at);
  return next;
}

Delivery LeaseTracker::batch_of(HeldLease& lease) const {
  Delivery delivery = lease.take_batch();
  if (!delivery.lease_finished) return delivery;
  if (is_unusable(lease.job_id())) {
    delivery.decline_reason = jobs_.at(lease.job_id()).decline_reason;
  } else if (!draining_) {
    for (const HeldLease& other : leases_)
      if (other.id() != lease.id() && !unwanted_.contains(other.id()))
        delivery.held_besides.push_back(other.id());
  }
  return delivery;
}

std::optional<Delivery> LeaseTracker::next_delivery(const std::stop_token& stop) {
  core::MutexLock lock(mutex_);
  for (;;) {
    if (stop.stop_requested()) return std::nullopt;
    if (HeldLease* lease = next_sendable(Clock::now())) return batch_of(*lease);
    if (draining_ && leases_.empty()) return std::nullopt;
    await_change(lock, stop, next_give_back());
  }
}

void LeaseTracker::announce_change() {
  ++version_;
  changed_.notify_all();
}

void LeaseTracker::await_change(core::MutexLock& lock, const std::stop_token& stop, Clock::time_point until) {
  const auto any_change = [this, seen = version_]() TESSERA_REQUIRES(mutex_) { return version_ != seen; };
  if (until == Clock::time_point::max())
    changed_.wait(lock.native(), stop, any_change);
  else
    changed_.wait_until(lock.native(), stop, until, any_change);
}

void LeaseTracker::delivered(const Delivery& delivery, const v1::SubmitResultResponse& answer) {
  const core::MutexLock lock(mutex_);
  HeldLease* lease = find_lease(delivery.lease_id);
  lease->delivered();
  if (delivery.lease_finished) {
    just_finished_.insert(lease->id());
    unwanted_.erase(lease->id());
    // An unusable job can be tried again after its lease is given back.
    const auto job = jobs_.find(lease->job_id());
    if (job->second.stage == Stage::kUnusable) job->second.stage = Stage::kWanted;
    leases_.remove_if([&](const HeldLease& other) { return other.id() == delivery.lease_id; });
  }
  // If a Synchronize that was answered meanwhile took one of these leases away, the next one reports so.
  for (const v1::JobSpec& spec : answer.jobs()) add_job(spec);
  for (const v1::Lease* given : first_leases(answer.new_leases()))
    if (add_lease(*given)) just_given_.insert(given->id());
  announce_change();
}

std::optional<UnwantedPiece> LeaseTracker::abandon_endless(const std::stop_token& stop,
                                                           const HangTimeout& hang_timeout) {
  core::MutexLock lock(mutex_);
  for (;;) {
    if (stop.stop_requested()) return std::nullopt;
    auto unwanted = unwanted_piece();
    const Clock::time_point until =
        unwanted ? unwanted->unwanted_since + hang_timeout(*unwanted) : Clock::time_point::max();
    if (Clock::now() >= until) {
      has_abandoned_ = true;
      find_lease(unwanted->piece.lease_id)->abandon();
      stop_taking();
      return unwanted;
    }
    await_change(lock, stop, until);
  }
}

std::optional<UnwantedPiece> LeaseTracker::unwanted_piece() const {
  if (!rendering_) return std::nullopt;
  const auto unwanted = unwanted_.find(rendering_->lease_id);
  if (unwanted == unwanted_.end() && !nothing_wanted_since_) return std::nullopt;
  const Clock::time_point heard = unwanted == unwanted_.end() ? *nothing_wanted_since_ : unwanted->second;
  const Clock::time_point since = std::max(heard, rendering_since_);
  return UnwantedPiece{*rendering_,        since - rendering_since_, since,
                       heartbeat_timeout_, !has_rendered_,           nothing_wanted_since_.has_value()};
}

void LeaseTracker::drop_all_wanted() {
  const core::MutexLock lock(mutex_);
  nothing_wanted_since_ = Clock::now();
  announce_change();
}

void LeaseTracker::drain() {
  const core::MutexLock lock(mutex_);
  stop_taking();
}

void LeaseTracker::stop_taking() {
  draining_ = true;
  for (HeldLease& lease : leases_) lease.stop_rendering();
  announce_change();
}

}  // namespace tessera::worker
