// SPDX-License-Identifier: Apache-2.0
#include "worker/held_lease.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace tessera::worker {
namespace {

// An unfinished item is sent in parts that took about this long to render.
constexpr Duration kLongestGrowing = std::chrono::seconds(2);
// The sums and planes in one message before compression. It is small enough for a slow line.
constexpr std::size_t kMaxBatchBytes = std::size_t{2} << 20;

std::size_t sums_bytes(const core::FilmTile& tile) {
  std::size_t words = tile.sums.size() + tile.odd_sums.size();
  for (const core::Plane& plane : tile.planes) words += plane.size();
  return words * sizeof(std::uint64_t);
}

core::SampleRange intersection(core::SampleRange a, core::SampleRange b) {
  return {std::max(a.begin, b.begin), std::min(a.end, b.end)};
}

bool are_of_one_tile(const WorkItem& a, const WorkItem& b) {
  return a.image == b.image && a.rect == b.rect;
}

// Whether `next` begins where the samples of the same tile end.
bool continues(const WorkItem& item, const WorkItem& next) {
  return are_of_one_tile(item, next) && item.range.end == next.range.begin;
}

// Merges adjacent ranges of one tile, in the order of first appearance.
std::vector<WorkItem> joined(std::vector<WorkItem> items) {
  std::vector<WorkItem> result;
  for (const WorkItem& item : items) {
    const auto neighbour = std::find_if(result.begin(), result.end(),
                                        [&](const WorkItem& other) { return continues(other, item); });
    if (neighbour == result.end())
      result.push_back(item);
    else
      neighbour->range.end = item.range.end;
  }
  return result;
}

}  // namespace

std::vector<WorkItem> HeldLease::items() const {
  std::vector<WorkItem> all = delivering_.value_or(std::vector<WorkItem>());
  for (const RenderedTile& tile : ready_) all.push_back(tile.item());
  if (growing_) all.push_back(growing_->item());
  if (rendering_) all.push_back(*rendering_);
  all.insert(all.end(), todo_.begin(), todo_.end());
  return joined(std::move(all));
}

bool HeldLease::keep_only(const std::vector<WorkItem>& wanted) {
  std::deque<WorkItem> kept;
  for (const WorkItem& item : todo_) {
    for (const WorkItem& other : wanted) {
      if (!are_of_one_tile(other, item)) continue;
      const core::SampleRange common = intersection(item.range, other.range);
      if (!common.empty()) kept.push_back({item.rect, common, item.image});
    }
  }
  const bool changed = kept != todo_;
  todo_ = std::move(kept);
  return changed;
}

void HeldLease::stop_rendering() {
  todo_.clear();
  stopped_ = true;
}

WorkItem HeldLease::take(std::uint64_t target_samples) {
  assert(has_todo() && !rendering_);
  WorkItem& next = todo_.front();
  const std::uint64_t count =
      std::clamp<std::uint64_t>(target_samples / next.rect.pixel_count(), 1, next.range.count());
  WorkItem piece = next;
  piece.range.end = piece.range.begin + static_cast<std::uint32_t>(count);
  next.range.begin = piece.range.end;
  if (next.range.empty()) todo_.pop_front();
  rendering_ = piece;
  return piece;
}

void HeldLease::rendered(core::FilmTile tile, Duration render_time) {
  assert(rendering_ && rendering_->rect == tile.rect && rendering_->range == tile.range);
  const WorkItem item = *std::exchange(rendering_, std::nullopt);
  if (growing_ && continues(growing_->item(), item)) {
    growing_->append(tile);
  } else {
    flush();
    growing_.emplace(std::move(tile), item.image);
  }
  growing_time_ += render_time;
  const bool continues_next = has_todo() && continues(growing_->item(), todo_.front());
  if (!continues_next || growing_time_ >= kLongestGrowing) flush();
}

void HeldLease::not_rendered() {
  assert(rendering_);
  if (!stopped_) todo_.push_front(*rendering_);
  rendering_.reset();
}

void HeldLease::abandon() {
  assert(rendering_);
  rendering_.reset();
  stop_rendering();
}

void HeldLease::flush() {
  if (!growing_) return;
  ready_.push_back(std::move(*growing_));
  growing_.reset();
  ready_time_ += std::exchange(growing_time_, Duration{});
}

bool HeldLease::has_delivery() const {
  const bool finished = !has_todo() && !rendering_;
  return !delivering_ && (!ready_.empty() || finished);
}

Delivery HeldLease::take_batch() {
  assert(has_delivery());
  // No further samples follow, so an unfinished item is sent as well.
  if (!has_todo() && !rendering_) flush();
  Delivery delivery;
  delivery.lease_id = id_;
  delivery.job_id = job_id_;
  delivery.lease_token = token_;
  delivering_.emplace();
  std::size_t bytes = 0;
  while (!ready_.empty() && (bytes == 0 || bytes + sums_bytes(ready_.front()) <= kMaxBatchBytes)) {
    bytes += sums_bytes(ready_.front());
    delivering_->push_back(ready_.front().item());
    delivery.tiles.push_back(std::move(ready_.front()));
    ready_.pop_front();
  }
  delivery.render_time = std::exchange(ready_time_, Duration{});
  delivery.lease_finished = !has_todo() && !rendering_ && ready_.empty();
  return delivery;
}

void HeldLease::delivered() {
  delivering_.reset();
}

bool HeldLease::empty() const {
  return !has_todo() && !rendering_ && !growing_ && ready_.empty() && !delivering_;
}

}  // namespace tessera::worker
