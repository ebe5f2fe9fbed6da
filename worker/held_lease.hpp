// SPDX-License-Identifier: Apache-2.0
// The progress of one lease in a worker: the samples to render, the piece in progress, and the results to
// deliver. Plain state with the rules that need no other lease. Not thread-safe; guarded by LeaseTracker.
//
//   todo ──take──▶ rendering ──rendered──▶ growing ──flush──▶ ready ──take_batch──▶ delivering
//                                                                                       │ delivered
//                                                                                       ▼
//                                                                                    removed
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/film/film.hpp"
#include "proto/convert.hpp"
#include "proto/retry.hpp"

namespace tessera::worker {

using proto::Duration;
using proto::WorkItem;

// Samples of a tile, with the image that they are of.
struct RenderedTile : core::FilmTile {
  RenderedTile() = default;
  RenderedTile(core::FilmTile tile, std::uint32_t of_image)
      : core::FilmTile(std::move(tile)), image(of_image) {}

  std::uint32_t image = 0;

  WorkItem item() const { return {rect, range, image}; }
};

// The content of one message.
struct Delivery {
  std::uint64_t lease_id = 0;
  std::string job_id;
  std::string lease_token;
  std::vector<RenderedTile> tiles;
  Duration render_time{};
  bool lease_finished = false;
  // Why the lease is given back, if its scene cannot be built.
  std::string decline_reason;
  // All other leases that are held; empty if the coordinator should give none with the answer.
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

  // All items that are held, in a canonical form: adjacent ranges of one tile are one item.
  std::vector<WorkItem> items() const;

  // Drops samples that are still to be rendered and not in `wanted`. Returns whether there were any.
  bool keep_only(const std::vector<WorkItem>& wanted);
  // Drops everything that is still to be rendered, except for a piece in progress.
  void stop_rendering();

  bool has_todo() const { return !todo_.empty(); }
  // The next piece to render: about `target_samples` pixel samples of one item, at least one sample of each
  // pixel. Requires has_todo(), and that no piece is in progress.
  WorkItem take(std::uint64_t target_samples);
  // Takes the result of the piece of take(). Pieces of one item are merged until the item is complete or took
  // long enough.
  void rendered(core::FilmTile tile, Duration render_time);
  // The piece of take() could not be rendered, and is to be rendered again.
  void not_rendered();
  // The piece of take() will never be rendered, nor anything else of the lease. Earlier pieces can be sent.
  void abandon();

  // Whether something can be sent: rendered tiles, or that the lease is finished.
  bool has_delivery() const;
  Delivery take_batch();
  // The last delivery of take_batch() was accepted or rejected.
  void delivered();

  // Whether nothing is left to render or to send.
  bool empty() const;

 private:
  void flush();

  std::uint64_t id_;
  std::string job_id_;
  std::string token_;
  std::deque<WorkItem> todo_;
  bool stopped_ = false;
  std::optional<WorkItem> rendering_;
  std::optional<RenderedTile> growing_;
  Duration growing_time_{};
  std::deque<RenderedTile> ready_;
  Duration ready_time_{};
  std::optional<std::vector<WorkItem>> delivering_;  // also set for a lease that is given back without items
};

}  // namespace tessera::worker
