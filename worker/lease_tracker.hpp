// SPDX-License-Identifier: Apache-2.0
// Everything this worker holds: leases on their way from the coordinator to delivery, and the jobs they
// belong to. The one place where the worker's threads meet. Thread-safe; functions that block say so.
//
// What a job needs before its leases are rendered:
//
//   WANTED ──files fetched──▶ READY ──scene cannot be built──▶ UNUSABLE
//      │  ◀───────────────── lease given back ─────────────────── ▲
//      └──────────────────── files cannot be fetched ─────────────┘
//
// Leases of an unusable job are given back, but only after a delay that grows with every failure: the
// coordinator may well lease the job here again.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "tessera/v1/worker_service.pb.h"
#include "worker/held_lease.hpp"
#include "worker/job.hpp"

namespace tessera::worker {

// Something to render.
struct Piece {
  std::uint64_t lease_id = 0;
  std::shared_ptr<const Job> job;
  WorkItem item;
};

// One that is being rendered for nobody: its lease was taken away, its job has ended, or the worker is to
// stop.
struct UnwantedPiece {
  Piece piece;
  // How long it had been rendered when that was heard, and since when it goes on all the same.
  Duration wanted_for{};
  std::chrono::steady_clock::time_point unwanted_since{};
  // The longest time within which the coordinator asked to be heard from: its lease time.
  Duration heartbeat_timeout{};
  // This worker has rendered no other.
  bool first = false;
  // It is to stop.
  bool stopping = false;
};

class LeaseTracker {
 public:
  struct Options {
    // Rendered from the first while the next ones' scenes are fetched.
    std::uint32_t wanted_leases = 2;
    // How long a lease of an unusable job is kept before it is given back: after the first failure, and at
    // most.
    Duration first_delay = std::chrono::seconds(1), longest_delay = std::chrono::seconds(30);
  };

  LeaseTracker() : LeaseTracker(Options{}) {}
  explicit LeaseTracker(Options options) : options_(options) {}

  // ---- For the thread that synchronises ----

  // Fills in what is held, wanted and known.
  void report(v1::SynchronizeRequest& request);
  // Takes over what the coordinator says should be held. The answer must be to the last report; what came
  // with the answers to deliveries since then stays. Returns whether it differed from what was held.
  bool apply(const v1::SynchronizeResponse& response);

  // ---- For the thread that fetches ----

  // Blocks until a job's files are wanted; nothing after a stop.
  std::optional<v1::JobSpec> next_to_fetch(const std::stop_token& stop);
  void fetched(std::shared_ptr<const Job> job);
  // Reported as a trouble until it is fetched.
  void cannot_fetch(const std::string& job_id, const std::string& why);

  // ---- For the thread that renders ----

  // Pixel samples that a piece of this job should have.
  using SizePiece = std::function<std::uint64_t(const std::string& job_id)>;

  // Blocks until there is something to render; nothing after a stop. Each piece is followed by one of the two
  // below.
  std::optional<Piece> take(const std::stop_token& stop, const SizePiece& size_piece);
  // Its scene is ready, and its samples come next; need not be called.
  void begins(const Piece& piece);
  void rendered(const Piece& piece, core::FilmTile tile, Duration render_time);
  // The scene cannot be built or rendered, for this reason, which is reported as a trouble until a piece of
  // the job is rendered; empty if its files must be fetched again first.
  void cannot_render(const Piece& piece, const std::string& why);

  // ---- For the thread that delivers ----

  // Blocks until there is something to send; nothing once there is nothing left after drain(), or after a
  // stop.
  std::optional<Delivery> next_delivery(const std::stop_token& stop);
  // It has arrived, and this was the answer; or it was refused for good.
  void delivered(const Delivery& delivery, const v1::SubmitResultResponse& answer = {});

  // ---- For the thread that watches the one that renders ----

  // How long an unwanted piece may go on.
  using HangTimeout = std::function<Duration(const UnwantedPiece&)>;

  // Blocks until a piece has gone on for longer, takes it for endless, and does as drain() does without
  // waiting for it. It is still reported as being rendered, and dropped if it is rendered after all. Nothing
  // after a stop.
  std::optional<UnwantedPiece> abandon_endless(const std::stop_token& stop, const HangTimeout& hang_timeout);

  // ---- For whoever stops the worker ----

  // The piece in hand is unwanted from now on, whatever its lease.
  void drop_all_wanted();
  // From now on nothing new is rendered or taken; what is rendered is still to be delivered.
  void drain();

 private:
  using Clock = std::chrono::steady_clock;

  enum class Stage { kWanted, kFetching, kReady, kUnusable };
  struct JobEntry {
    v1::JobSpec spec;
    Stage stage = Stage::kWanted;
    std::shared_ptr<const Job> job;  // once READY
    int failures = 0;
    std::string decline_reason;        // why, while UNUSABLE for this reason
    Clock::time_point give_back_at{};  // while UNUSABLE
    std::string trouble;               // what kept it from being rendered last; empty once that is over
    Clock::time_point trouble_at{};
  };

  // All of these expect mutex_ to be held.
  HeldLease* find_lease(std::uint64_t id);
  bool add_job(const v1::JobSpec& spec);
  bool add_lease(const v1::Lease& lease);
  bool is_unusable(const std::string& job_id) const;
  void make_unusable(const std::string& job_id, const std::string& trouble);
  bool holds_any_of(const std::string& job_id) const;
  void report_activity(v1::SynchronizeRequest& request) const;
  void report_troubles(v1::SynchronizeRequest& request) const;
  void forget_idle_jobs();
  HeldLease* next_renderable();
  HeldLease* next_sendable(Clock::time_point now);
  Delivery batch_of(HeldLease& lease) const;
  Clock::time_point next_give_back() const;
  std::optional<UnwantedPiece> unwanted_piece() const;
  void stop_taking();
  void announce_change();
  void await_change(std::unique_lock<std::mutex>& lock, const std::stop_token& stop,
                    Clock::time_point until = Clock::time_point::max());

  const Options options_;

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::uint64_t version_ = 0;    // guarded by mutex_; of everything below
  std::list<HeldLease> leases_;  // guarded by mutex_; in the order they are to be rendered
  // Guarded by mutex_; held, but only until what is rendered is delivered. Since when.
  std::map<std::uint64_t, Clock::time_point> unwanted_;
  std::set<std::uint64_t> just_finished_;  // guarded by mutex_; since the last report
  // Guarded by mutex_; with answers to deliveries, since the last report.
  std::set<std::uint64_t> just_given_;
  std::optional<Piece> rendering_;       // guarded by mutex_; whose samples are being rendered
  Clock::time_point rendering_since_{};  // guarded by mutex_
  std::optional<Clock::time_point> nothing_wanted_since_;  // guarded by mutex_
  bool has_rendered_ = false;                              // guarded by mutex_; any piece
  bool has_abandoned_ = false;                             // guarded by mutex_; the piece in hand
  Duration heartbeat_timeout_{};                           // guarded by mutex_; the longest of all answers
  std::map<std::string, JobEntry> jobs_;                   // guarded by mutex_
  bool draining_ = false;                                  // guarded by mutex_
};

}  // namespace tessera::worker
