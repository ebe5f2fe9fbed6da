// SPDX-License-Identifier: Apache-2.0
// One lease on its way through a worker: what is still to be rendered of it, what is being rendered, what
// waits to be delivered. Plain state with the rules that need no other lease; not thread-safe (LeaseTracker
// guards it).
//
//   todo ──take──▶ rendering ──rendered──▶ growing ──flush──▶ ready ──take_batch──▶ delivering ──delivered──▶
//   gone
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "core/film/film.hpp"
#include "proto/convert.hpp"
#include "proto/retry.hpp"

namespace tessera::worker {

using proto::Duration;
using proto::WorkItem;

// What is sent in one message.
struct Delivery {
  std::uint64_t lease_id = 0;
  std::string job_id;
  std::string lease_token;
  std::vector<core::FilmTile> tiles;
  Duration render_time{};
  bool lease_finished = false;
  // Why the lease is given back, if its scene cannot be built.
  std::string decline_reason;
  // All other leases that are held; empty if none should be given for this one.
  std::vector<std::uint64_t> held_besides;
};

class HeldLease {
 public:
  HeldLease(std::uint64_t id, std::string job_id, std::vector<WorkItem> items, std::string token = {})
      : id_(id), job_id_(std::move(job_id)), token_(std::move(token)), todo_(items.begin(), items.end()) {}

  std::uint64_t id() const { return id_; }
  const std::string& job_id() const { return job_id_; }
  // v1.Lease.token.
  const std::string& token() const { return token_; }

  // Everything held of it, in a canonical form: ranges of one rectangle that touch are one item.
  std::vector<WorkItem> items() const;

  // Forgets what is to be rendered and is not among `wanted`. Returns whether that changed anything.
  bool keep_only(const std::vector<WorkItem>& wanted);
  // Nothing more will be rendered of it, but for a piece that is on its way.
  void stop_rendering();

  bool has_todo() const { return !todo_.empty(); }
  // The next piece to be rendered: about `target_samples` pixel samples of one item, at least one sample of
  // each pixel. Only if has_todo() and nothing of it is being rendered.
  WorkItem take(std::uint64_t target_samples);
  // The piece that take() gave. Pieces of one item are put together until it is complete or took long enough.
  void rendered(core::FilmTile tile, Duration render_time);
  // The piece that take() gave could not be rendered and is to be done again.
  void not_rendered();
  // The piece that take() gave never will be rendered: nothing more is, and what was before it can be sent.
  void abandon();

  // Whether something can be sent: rendered tiles, or that the lease is finished.
  bool has_delivery() const;
  Delivery take_batch();
  // What take_batch() gave last has arrived, or was refused for good.
  void delivered();

  // Nothing of it is left to be rendered, and nothing rendered waits.
  bool empty() const;

 private:
  void flush();

  std::uint64_t id_;
  std::string job_id_;
  std::string token_;
  std::deque<WorkItem> todo_;
  bool stopped_ = false;
  std::optional<WorkItem> rendering_;
  std::optional<core::FilmTile> growing_;
  Duration growing_time_{};
  std::deque<core::FilmTile> ready_;
  Duration ready_time_{};
  std::optional<std::vector<WorkItem>> delivering_;  // also of a lease that is given back without any
};

}  // namespace tessera::worker
