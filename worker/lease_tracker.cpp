// SPDX-License-Identifier: Apache-2.0
#include "worker/lease_tracker.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/common/log.hpp"

namespace tessera::worker {

void LeaseTracker::report(v1::SynchronizeRequest& request) {
  const core::MutexLock lock(mutex_);
  just_finished_.clear();
  just_given_.clear();
  const auto is_held = [this](const std::string& id) TESSERA_REQUIRES(mutex_) { return holds_any_of(id); };
  jobs_.forget_idle(is_held);
  std::uint32_t given_up = 0;
  for (const HeldLease& lease : leases_) {
    if (unwanted_.contains(lease.id())) continue;
    *request.add_held() = to_proto(lease);
    if (jobs_.is_unusable(lease.job_id())) ++given_up;
  }
  jobs_.report(request, is_held);
  // Leases that only wait to be given back do not count, so that the worker gets other work.
  request.set_wanted_leases(draining_ ? 0 : options_.wanted_leases + given_up);
  request.set_draining(draining_);
  if (rendering_) *request.mutable_rendering() = to_proto(*rendering_);
}

bool LeaseTracker::apply(const v1::SynchronizeResponse& response) {
  const core::MutexLock lock(mutex_);
  heartbeat_timeout_ = std::max(heartbeat_timeout_, heartbeat_timeout(response));
  bool changed = false;
  for (const v1::JobSpec& spec : response.jobs()) changed |= jobs_.add(spec);

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
      changed |= lease.keep_only(readable_items(*still->second, *jobs_.find(lease.job_id())));
    }
  }
  leases_.remove_if([&](const HeldLease& lease) TESSERA_REQUIRES(mutex_) {
    return lease.empty() && unwanted_.erase(lease.id()) > 0;
  });
  for (const v1::Lease* lease : leases) changed |= add_lease(*lease);
  announce_change();
  return changed;
}

bool LeaseTracker::add_lease(const v1::Lease& lease) {
  if (draining_ || find_lease(lease.id()) != nullptr || just_finished_.contains(lease.id())) return false;
  if (leases_.size() >= static_cast<std::size_t>(kMaxLeases)) return false;
  const v1::JobSpec* const job = jobs_.find(lease.job_id());
  if (job == nullptr) {
    common::log(spdlog::level::warn,
                fmt::format("lease {} is of job {}, which the coordinator did not describe", lease.id(),
                            lease.job_id()),
                {.job = lease.job_id()});
    return false;
  }
  leases_.emplace_back(lease.id(), lease.job_id(), readable_items(lease, *job), lease.token());
  return true;
}

bool LeaseTracker::holds_any_of(const std::string& job_id) const {
  return std::any_of(leases_.begin(), leases_.end(),
                     [&](const HeldLease& lease) { return lease.job_id() == job_id; });
}

std::optional<v1::JobSpec> LeaseTracker::next_to_fetch(const std::stop_token& stop) {
  core::MutexLock lock(mutex_);
  for (;;) {
    if (stop.stop_requested()) return std::nullopt;
    for (const HeldLease& lease : leases_)
      if (lease.has_todo() && jobs_.begin_fetch(lease.job_id())) return *jobs_.find(lease.job_id());
    await_change(lock, stop);
  }
}

void LeaseTracker::fetched(std::shared_ptr<const Job> job) {
  const core::MutexLock lock(mutex_);
  jobs_.fetched(std::move(job));
  announce_change();
}

void LeaseTracker::cannot_fetch(const std::string& job_id, const std::string& why) {
  const core::MutexLock lock(mutex_);
  jobs_.make_unusable(job_id, why);
  announce_change();
}

void LeaseTracker::decline(const std::string& job_id, const std::string& why) {
  const core::MutexLock lock(mutex_);
  jobs_.make_unusable(job_id, why, why);
  announce_change();
}

std::vector<std::shared_ptr<const Job>> LeaseTracker::jobs_in_hand() const {
  const core::MutexLock lock(mutex_);
  return jobs_.in_hand([this](const std::string& id) TESSERA_REQUIRES(mutex_) { return holds_any_of(id); });
}

HeldLease* LeaseTracker::next_renderable() {
  for (HeldLease& lease : leases_)
    if (lease.has_todo() && jobs_.ready(lease.job_id())) return &lease;
  return nullptr;
}

std::optional<Piece> LeaseTracker::take(const std::stop_token& stop, const SizePiece& size_piece) {
  core::MutexLock lock(mutex_);
  for (;;) {
    if (stop.stop_requested() || draining_) return std::nullopt;
    if (HeldLease* lease = next_renderable())
      return Piece{lease->id(), jobs_.ready(lease->job_id()), lease->take(size_piece(lease->job_id()))};
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
  jobs_.rendered(piece.job->id);
  announce_change();
}

void LeaseTracker::cannot_render(const Piece& piece, const std::string& why) {
  const core::MutexLock lock(mutex_);
  rendering_.reset();
  if (has_abandoned_) return;
  find_lease(piece.lease_id)->not_rendered();
  jobs_.make_unusable(piece.job->id, why, why);
  announce_change();
}

HeldLease* LeaseTracker::find_lease(std::uint64_t id) {
  const auto lease =
      std::find_if(leases_.begin(), leases_.end(), [id](const HeldLease& l) { return l.id() == id; });
  return lease == leases_.end() ? nullptr : &*lease;
}

HeldLease* LeaseTracker::next_sendable(Clock::time_point now) {
  for (HeldLease& lease : leases_) {
    if (jobs_.is_unusable(lease.job_id()) && now >= jobs_.give_back_at(lease.job_id()))
      lease.stop_rendering();
    if (lease.has_delivery()) return &lease;
  }
  return nullptr;
}

LeaseTracker::Clock::time_point LeaseTracker::next_give_back() const {
  Clock::time_point next = Clock::time_point::max();
  for (const HeldLease& lease : leases_)
    if (jobs_.is_unusable(lease.job_id())) next = std::min(next, jobs_.give_back_at(lease.job_id()));
  return next;
}

Delivery LeaseTracker::batch_of(HeldLease& lease) const {
  Delivery delivery = lease.take_batch();
  if (!delivery.lease_finished) return delivery;
  if (jobs_.is_unusable(lease.job_id())) {
    delivery.decline_reason = jobs_.decline_reason(lease.job_id());
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
    jobs_.given_back(lease->job_id());
    leases_.remove_if([&](const HeldLease& other) { return other.id() == delivery.lease_id; });
  }
  // If a Synchronize that was answered meanwhile took one of these leases away, the next one reports so.
  for (const v1::JobSpec& spec : answer.jobs()) jobs_.add(spec);
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
