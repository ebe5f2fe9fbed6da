// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/work_list.hpp"

#include <algorithm>
#include <bit>

namespace tessera::scheduler {

using core::SampleRange;

SampleRange pass_of(std::uint32_t sample) {
  if (sample == 0) return {0, 1};
  const std::uint32_t begin = std::bit_floor(sample);
  return {begin, 2 * begin};
}

WorkList::WorkList(int tile_count, std::uint32_t spp) : tile_count_(tile_count), spp_(spp) {}

std::optional<WorkItem> WorkList::Walk::next(const Wanted& wanted) {
  while (const std::optional<WorkItem> candidate = front()) {
    const IntervalSet pieces = wanted(*candidate);
    go_to(pieces.empty() ? candidate->samples.end : pieces.ranges().front().begin);
    if (!pieces.empty()) return WorkItem{candidate->tile, pieces.ranges().front()};
  }
  return std::nullopt;
}

std::optional<WorkItem> WorkList::Walk::front() {
  for (; returned_ != list_.returned_.end(); ++returned_, returned_from_ = 0) {
    for (const SampleRange& range : returned_->second.ranges()) {
      if (range.end > returned_from_)
        return WorkItem{returned_->first.second, {std::max(range.begin, returned_from_), range.end}};
    }
  }
  if (cursor_.sample >= list_.spp_) return std::nullopt;
  return WorkItem{cursor_.tile, {cursor_.sample, std::min(pass_of(cursor_.sample).end, list_.spp_)}};
}

void WorkList::Walk::go_to(std::uint32_t sample) {
  if (returned_ != list_.returned_.end()) {
    returned_from_ = sample;
    return;
  }
  const SampleRange pass = pass_of(cursor_.sample);
  cursor_.sample = sample;
  if (sample < std::min(pass.end, list_.spp_)) return;
  const bool last_tile = cursor_.tile + 1 == list_.tile_count_;
  cursor_ = last_tile ? Cursor{0, pass.end} : Cursor{cursor_.tile + 1, pass.begin};
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
  cursor_ = {0, pass_of(spp_ - 1).end};
}

void WorkList::put_back(const WorkItem& item) {
  for (std::uint32_t begin = item.samples.begin; begin < item.samples.end;) {
    const SampleRange pass = pass_of(begin);
    const std::uint32_t end = std::min(pass.end, item.samples.end);
    // Samples beyond the cursor are candidates already.
    const SampleRange passed{begin, std::min(end, passed_until(item.tile, pass))};
    if (!passed.empty()) returned_[{pass.begin, item.tile}].add(passed);
    begin = end;
  }
}

void WorkList::extend(std::uint32_t spp) {
  if (spp <= spp_) return;
  // The old spp cut the last pass short: repeat it from its first tile. Samples that are done or leased are
  // not wanted.
  const std::uint32_t first_short_pass = pass_of(spp_).begin;
  if (cursor_.sample >= first_short_pass) {
    cursor_ = {0, first_short_pass};
    returned_.erase(returned_.lower_bound({first_short_pass, 0}), returned_.end());
  }
  spp_ = spp;
}

IntervalSet WorkList::candidates(int tile) const {
  IntervalSet all;
  for (std::uint32_t begin = 0; begin < spp_; begin = pass_of(begin).end) {
    const auto returned = returned_.find({begin, tile});
    if (returned != returned_.end()) all.add(returned->second);
  }
  for (std::uint32_t begin = 0; begin < spp_; begin = pass_of(begin).end) {
    all.add({passed_until(tile, pass_of(begin)), std::min(pass_of(begin).end, spp_)});
  }
  return all;
}

std::uint32_t WorkList::passed_until(int tile, SampleRange pass) const {
  const SampleRange at = pass_of(cursor_.sample);
  if (pass.begin != at.begin) return pass.begin < at.begin ? pass.end : pass.begin;
  if (tile != cursor_.tile) return tile < cursor_.tile ? pass.end : pass.begin;
  return cursor_.sample;
}

}  // namespace tessera::scheduler
