// SPDX-License-Identifier: Apache-2.0
#include "core/view/tile_queue.hpp"

#include <algorithm>

namespace tessera::view {

TileQueue::Distance TileQueue::distance(int tile) const {
  const core::PixelRect rect = grid_.rect(tile);
  const Distance x = rect.x0 + rect.x1 - 2 * Distance{centre_x_};
  const Distance y = rect.y0 + rect.y1 - 2 * Distance{centre_y_};
  return x * x + y * y;
}

void TileQueue::add(const TileChange& change, bool with_coarse, bool is_first) {
  Entry& entry = entries_[change.tile];
  if (change.revision <= entry.sent) return;
  entry.last = change.revision;
  if (is_first && !entry.is_first) ++first_left_;
  entry.is_first |= is_first;
  if (entry.is_waiting) return;
  entry.is_waiting = true;
  if (with_coarse)
    coarse_.emplace(distance(change.tile), change.tile);
  else
    fine_.emplace(entry.sent_at, distance(change.tile), change.tile);
}

std::optional<TileQueue::Next> TileQueue::take(Clock::time_point now) {
  if (!coarse_.empty()) {
    const auto [distance, tile] = *coarse_.begin();
    coarse_.erase(coarse_.begin());
    const Entry& entry = entries_.at(tile);
    fine_.emplace(entry.sent_at, distance, tile);
    return Next{{entry.last, tile}, true};
  }
  if (const auto time = next_time(); !time || *time > now) return std::nullopt;
  const int tile = std::get<int>(*fine_.begin());
  fine_.erase(fine_.begin());
  Entry& entry = entries_.at(tile);
  entry.is_waiting = false;
  return Next{{entry.last, tile}, false};
}

void TileQueue::note_sent(int tile, Revision revision, Clock::time_point now) {
  Entry& entry = entries_.at(tile);
  entry.sent = revision;
  entry.sent_at = now;
  if (entry.is_first) --first_left_;
  entry.is_first = false;
}

std::optional<TileQueue::Clock::time_point> TileQueue::next_time() const {
  if (!coarse_.empty()) return Clock::time_point{};
  if (fine_.empty()) return std::nullopt;
  const Clock::time_point sent_at = std::get<0>(*fine_.begin());
  return sent_at == Clock::time_point{} ? sent_at : sent_at + kMinInterval;
}

Revision TileQueue::complete_until(Revision seen) const {
  Revision complete = seen;
  for (const auto& [tile, entry] : entries_)
    if (entry.is_waiting) complete = std::min(complete, entry.last - 1);
  return complete;
}

}  // namespace tessera::view
