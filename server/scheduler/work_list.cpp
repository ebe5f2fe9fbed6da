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

std::optional<WorkItem> WorkList::next(const Wanted& wanted) {
  while (const std::optional<WorkItem> candidate = front()) {
    const IntervalSet pieces = wanted(*candidate);
    if (!pieces.empty()) {
      const SampleRange piece = pieces.ranges().front();
      if (piece.begin > candidate->samples.begin) forget_front(*candidate, piece.begin);
      return WorkItem{candidate->tile, piece};
    }
    forget_front(*candidate, candidate->samples.end);
  }
  return std::nullopt;
}

void WorkList::take(const WorkItem& piece, std::uint32_t count) {
  forget_front(piece, piece.samples.begin + count);
}

void WorkList::put_back(const WorkItem& item) {
  for (std::uint32_t begin = item.samples.begin; begin < item.samples.end;) {
    const SampleRange pass = pass_of(begin);
    const std::uint32_t end = std::min(pass.end, item.samples.end);
    // What the cursor has yet to come to is a candidate already.
    const SampleRange passed{begin, std::min(end, passed_until(item.tile, pass))};
    if (!passed.empty()) returned_[{pass.begin, item.tile}].add(passed);
    begin = end;
  }
}

void WorkList::extend(std::uint32_t spp) {
  if (spp <= spp_) return;
  // The last pass was cut short by the old spp: go through it again from its first tile. What is done or
  // leased of it is not wanted.
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

std::optional<WorkItem> WorkList::front() const {
  if (!returned_.empty()) {
    const auto& [key, samples] = *returned_.begin();
    return WorkItem{key.second, samples.ranges().front()};
  }
  if (cursor_.sample >= spp_) return std::nullopt;
  return WorkItem{cursor_.tile, {cursor_.sample, std::min(pass_of(cursor_.sample).end, spp_)}};
}

void WorkList::forget_front(const WorkItem& front, std::uint32_t until) {
  if (!returned_.empty()) {
    const auto first = returned_.begin();
    first->second.remove({front.samples.begin, until});
    if (first->second.empty()) returned_.erase(first);
    return;
  }
  const SampleRange pass = pass_of(cursor_.sample);
  cursor_.sample = until;
  if (until < std::min(pass.end, spp_)) return;
  const bool last_tile = cursor_.tile + 1 == tile_count_;
  cursor_ = last_tile ? Cursor{0, pass.end} : Cursor{cursor_.tile + 1, pass.begin};
}

}  // namespace tessera::scheduler
