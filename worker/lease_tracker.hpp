// SPDX-License-Identifier: Apache-2.0
// The worker's leases, from the coordinator to delivery, and their jobs (held_jobs.hpp). The worker's threads
// share only this object. Thread-safe; functions that block say so.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/mutex.hpp"
#include "tessera/v1/worker_service.pb.h"
#include "worker/held_jobs.hpp"
#include "worker/held_lease.hpp"
#include "worker/job.hpp"
#include "worker/lease_messages.hpp"

namespace tessera::worker {

// A piece that is rendered although nobody wants it any more: its lease was taken away, its job has ended, or
// the worker is stopping.
struct UnwantedPiece {
  Piece piece;
  // How long it had been rendered when it became unwanted, and when that was.
  Duration wanted_for{};
  std::chrono::steady_clock::time_point unwanted_since{};
  // The coordinator's lease time: the longest heartbeat timeout of its answers.
  Duration heartbeat_timeout{};
  // This worker has not finished any piece yet.
  bool first = false;
  // The worker is stopping.
  bool stopping = false;
};

class LeaseTracker {
 public:
  struct Options {
    // More than one, so that the first is rendered while the scenes of the others are fetched.
    std::uint32_t wanted_leases = 2;
    HeldJobs::Delays delays{};
  };

  LeaseTracker() : LeaseTracker(Options{}) {}
  explicit LeaseTracker(Options options) : options_(options), jobs_(options.delays) {}

  // ---- For the thread that synchronises ----

  // Fills in the leases that are held, their wanted number, and the known jobs.
  void report(v1::SynchronizeRequest& request);
  // Applies the leases that the coordinator wants the worker to hold. The answer must be to the last report;
  // leases that came with answers to deliveries since then stay. Returns whether anything changed.
  bool apply(const v1::SynchronizeResponse& response);

  // ---- For the thread that fetches ----

  // Blocks until the files of a job are wanted. Empty after a stop.
  std::optional<v1::JobSpec> next_to_fetch(const std::stop_token& stop);
  void fetched(std::shared_ptr<const Job> job);
  // Reported as a trouble until the files are fetched.
  void cannot_fetch(const std::string& job_id, const std::string& why);
  // The same if trying again is no use: the coordinator gets the reason with the lease.
  void decline(const std::string& job_id, const std::string& why);
  // The fetched jobs of the leases.
  std::vector<std::shared_ptr<const Job>> jobs_in_hand() const;

  // ---- For the thread that renders ----

  // The number of pixel samples in a piece of this job.
  using SizePiece = std::function<std::uint64_t(const std::string& job_id)>;

  // Blocks until there is a piece to render. Empty after a stop. After each piece, call rendered() or
  // cannot_render().
  std::optional<Piece> take(const std::stop_token& stop, const SizePiece& size_piece);
  // The scene is ready, and rendering of the samples begins; the call is optional.
  void begins(const Piece& piece);
  void rendered(const Piece& piece, core::FilmTile tile, Duration render_time);
  // The scene cannot be built or rendered. The reason is reported as a trouble until a piece of the job is
  // rendered. An empty reason: its files must be fetched again first.
  void cannot_render(const Piece& piece, const std::string& why);

  // ---- For the thread that delivers ----

  // Blocks until there is something to send. Empty when nothing is left after drain(), or after a stop.
  std::optional<Delivery> next_delivery(const std::stop_token& stop);
  // The delivery was accepted, with this answer, or rejected.
  void delivered(const Delivery& delivery, const v1::SubmitResultResponse& answer = {});

  // ---- For the watchdog thread ----

  // How long an unwanted piece may continue.
  using HangTimeout = std::function<Duration(const UnwantedPiece&)>;

  // Blocks until an unwanted piece has exceeded its time. Then behaves as drain(), without waiting for the
  // piece: it is still reported as being rendered, and dropped if it ends after all. Empty after a stop.
  std::optional<UnwantedPiece> abandon_endless(const std::stop_token& stop, const HangTimeout& hang_timeout);

  // ---- For the owner ----

  // Makes the current piece unwanted, whatever its lease.
  void drop_all_wanted();
  // From now on nothing new is rendered or accepted; results are still delivered.
  void drain();

 private:
  using Clock = std::chrono::steady_clock;

  HeldLease* find_lease(std::uint64_t id) TESSERA_REQUIRES(mutex_);
  bool add_lease(const v1::Lease& lease) TESSERA_REQUIRES(mutex_);
  bool holds_any_of(const std::string& job_id) const TESSERA_REQUIRES(mutex_);
  HeldLease* next_renderable() TESSERA_REQUIRES(mutex_);
  HeldLease* next_sendable(Clock::time_point now) TESSERA_REQUIRES(mutex_);
  Delivery batch_of(HeldLease& lease) const TESSERA_REQUIRES(mutex_);
  Clock::time_point next_give_back() const TESSERA_REQUIRES(mutex_);
  std::optional<UnwantedPiece> unwanted_piece() const TESSERA_REQUIRES(mutex_);
  void stop_taking() TESSERA_REQUIRES(mutex_);
  void announce_change() TESSERA_REQUIRES(mutex_);
  void await_change(core::MutexLock& lock, const std::stop_token& stop,
                    Clock::time_point until = Clock::time_point::max()) TESSERA_REQUIRES(mutex_);

  const Options options_;

  mutable core::Mutex mutex_;
  std::condition_variable_any changed_;
  std::uint64_t version_ TESSERA_GUARDED_BY(mutex_) = 0;    // changes with every member below
  std::list<HeldLease> leases_ TESSERA_GUARDED_BY(mutex_);  // in the order of rendering
  // Since when leases are held only until their results are delivered.
  std::map<std::uint64_t, Clock::time_point> unwanted_ TESSERA_GUARDED_BY(mutex_);
  std::set<std::uint64_t> just_finished_ TESSERA_GUARDED_BY(mutex_);  // since the last report
  // From answers to deliveries since the last report.
  std::set<std::uint64_t> just_given_ TESSERA_GUARDED_BY(mutex_);
  std::optional<Piece> rendering_ TESSERA_GUARDED_BY(mutex_);  // the piece in progress
  Clock::time_point rendering_since_ TESSERA_GUARDED_BY(mutex_){};
  std::optional<Clock::time_point> nothing_wanted_since_ TESSERA_GUARDED_BY(mutex_);
  bool has_rendered_ TESSERA_GUARDED_BY(mutex_) = false;     // has finished any piece
  bool has_abandoned_ TESSERA_GUARDED_BY(mutex_) = false;    // gave up the piece in progress
  Duration heartbeat_timeout_ TESSERA_GUARDED_BY(mutex_){};  // the maximum of all answers
  HeldJobs jobs_ TESSERA_GUARDED_BY(mutex_);
  bool draining_ TESSERA_GUARDED_BY(mutex_) = false;
};

}  // namespace tessera::worker
