// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/work_list.hpp"

#include <algorithm>
#include <bit>
#include <iterator>
#include <vector>

namespace tessera::scheduler {

using core::SampleRange;

namespace {

// The tiles whose targets differ; of shapes that differ in the target of the others, all that have their own.
std::vector<int> affected_tiles(const JobShape& before, const JobShape& after) {
  const auto &old = before.targets.all(), &now = after.targets.all();
  TileTargets::ByTile affected;
  if (before.spp == after.spp) {
    std::set_symmetric_difference(old.begin(), old.end(), now.begin(), now.end(),
                                  std::back_inserter(affected));
  } else {
    std::set_union(old.begin(), old.end(), now.begin(), now.end(), std::back_inserter(affected));
  }
  std::vector<int> tiles;
  for (const TileTarget& each : affected)
    if (tiles.empty() || tiles.back() != each.tile) tiles.push_back(each.tile);
  return tiles;
}

}  // namespace

SampleRange pass_of(std::uint32_t sample) {
  if (sample == 0) return {0, 1};
  const std::uint32_t begin = std::bit_floor(sample);
  return {begin, 2 * begin};
}

WorkList::WorkList(const JobShape& shape)
    : shape_(shape), grid_(shape.grid()), cursor_{{0, shape.spp}, 0, 0} {
  for (const TileTarget& own : shape.targets.all())
    if (own.spp > shape.spp) put_back({own.tile, {shape.spp, own.spp}});
}

WorkItem WorkList::at(const Cursor& cursor) const {
  const std::uint32_t end =
      std::min({pass_of(cursor.sample).end, cursor.round.end, shape_.target(cursor.tile)});
  return {cursor.tile, {cursor.sample, std::max(end, cursor.sample)}};
}

WorkList::Cursor WorkList::after(Cursor cursor, std::uint32_t sample) const {
  const WorkItem item = at(cursor);
  if (sample < item.samples.end) {
    cursor.sample = sample;
    return cursor;
  }
  const SampleRange pass = pass_of(cursor.sample);
  const int next = cursor.tile + 1;
  const bool ends_image = next % grid_.tiles_per_image() == 0;
  if (!ends_image) return {cursor.round, next, std::max(pass.begin, cursor.round.begin)};
  if (pass.end < cursor.round.end) return {cursor.round, next - grid_.tiles_per_image(), pass.end};
  const bool ends_job = next == grid_.tile_count();
  if (!ends_job) return {cursor.round, next, cursor.round.begin};
  return {{cursor.round.end, shape_.spp}, 0, cursor.round.end};
}

bool WorkList::Walk::is_at_returned() const {
  if (returned_ == list_.returned_.end()) return false;
  return cursor_.round.empty() || returned_->first <= list_.place_of(cursor_.tile, cursor_.sample);
}

std::optional<WorkItem> WorkList::Walk::next(const Wanted& wanted) {
  while (const std::optional<WorkItem> candidate = front()) {
    const IntervalSet pieces = candidate->samples.empty() ? IntervalSet() : wanted(*candidate);
    go_to(pieces.empty() ? candidate->samples.end : pieces.ranges().front().begin);
    if (!pieces.empty()) return WorkItem{candidate->tile, pieces.ranges().front()};
  }
  return std::nullopt;
}

std::optional<WorkItem> WorkList::Walk::front() {
  for (; is_at_returned(); ++returned_, returned_from_ = 0) {
    for (const SampleRange& range : returned_->second.ranges()) {
      if (range.end > returned_from_)
        return WorkItem{returned_->first.tile, {std::max(range.begin, returned_from_), range.end}};
    }
  }
  if (cursor_.round.empty()) return std::nullopt;
  return list_.at(cursor_);
}

void WorkList::Walk::go_to(std::uint32_t sample) {
  if (is_at_returned()) {
    returned_from_ = sample;
  } else {
    cursor_ = list_.after(cursor_, sample);
  }
}

void WorkList::forget_unwanted(const Wanted& wanted) {
  Walk walk(*this);
  walk.next(wanted);
  returned_.erase(returned_.begin(), walk.returned_);
  if (!returned_.empty()) returned_.begin()->second.remove({0, walk.returned_from_});
  cursor_ = walk.cursor_;
}

void WorkList::clear() {
  returned_.clear();
  cursor_ = {{shape_.spp, shape_.spp}, 0, shape_.spp};
}

void WorkList::put_back(const WorkItem& item) {
  for (std::uint32_t begin = item.samples.begin; begin < item.samples.end;) {
    const SampleRange pass = pass_of(begin);
    const std::uint32_t end = std::min(pass.end, item.samples.end);
    // Samples beyond the cursor are candidates already.
    const SampleRange passed{begin, std::min(end, passed_until(item.tile, pass))};
    const SampleRange beyond{std::max(begin, shape_.spp), end};
    for (const SampleRange& range : {passed, beyond})
      if (!range.empty()) returned_[place_of(item.tile, range.begin)].add(range);
    begin = end;
  }
}

void WorkList::extend(const JobShape& shape) {
  const JobShape before = shape_;
  shape_ = shape;
  // A round that has not begun can become longer. Otherwise another one follows it.
  const bool has_begun = cursor_.tile > 0 || cursor_.sample > cursor_.round.begin;
  if (cursor_.round.empty() || (!has_begun && cursor_.round.end == before.spp)) cursor_.round.end = shape.spp;
  for (const int tile : affected_tiles(before, shape)) {
    const std::uint32_t old_target = before.target(tile);
    // The cursor comes to these now.
    for (std::uint32_t begin = before.spp; begin < std::min(old_target, shape.spp);) {
      const SampleRange pass = pass_of(begin);
      const auto returned = returned_.find(place_of(tile, begin));
      begin = pass.end;
      if (returned == returned_.end()) continue;
      returned->second.remove({std::max(pass.begin, before.spp), std::min(pass.end, shape.spp)});
      if (returned->second.empty()) returned_.erase(returned);
    }
    if (shape.target(tile) > old_target) put_back({tile, {old_target, shape.target(tile)}});
  }
}

IntervalSet WorkList::candidates(int tile) const {
  const std::uint32_t target = shape_.target(tile);
  IntervalSet all;
  for (std::uint32_t begin = 0; begin < target; begin = pass_of(begin).end) {
    const auto returned = returned_.find(place_of(tile, begin));
    if (returned != returned_.end()) all.add(returned->second);
  }
  for (std::uint32_t begin = 0; begin < std::min(target, shape_.spp); begin = pass_of(begin).end) {
    const SampleRange pass = pass_of(begin);
    all.add({passed_until(tile, pass), std::min({pass.end, target, shape_.spp})});
  }
  return all;
}

std::uint32_t WorkList::passed_until(int tile, SampleRange pass) const {
  const SampleRange& round = cursor_.round;
  if (pass.end <= round.begin) return pass.end;
  if (pass.begin >= round.end) return pass.begin;
  const std::uint32_t begin = std::max(pass.begin, round.begin), end = std::min(pass.end, round.end);
  const Place at = place_of(cursor_.tile, cursor_.sample), asked = place_of(tile, pass.begin);
  if (asked != at) return asked < at ? end : begin;
  return cursor_.sample;
}

}  // namespace tessera::scheduler
