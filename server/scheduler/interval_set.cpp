// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/interval_set.hpp"

#include <algorithm>

namespace tessera::scheduler {

using core::SampleRange;

IntervalSet::IntervalSet(std::initializer_list<SampleRange> ranges) {
  for (const SampleRange& range : ranges) add(range);
}

void IntervalSet::add(SampleRange range) {
  if (range.empty()) return;
  // Merges all ranges that overlap or touch the new one.
  const auto first =
      std::lower_bound(ranges_.begin(), ranges_.end(), range.begin,
                       [](const SampleRange& r, std::uint32_t begin) { return r.end < begin; });
  const auto last = std::upper_bound(first, ranges_.end(), range.end,
                                     [](std::uint32_t end, const SampleRange& r) { return end < r.begin; });
  if (first == last) {
    ranges_.insert(first, range);
    return;
  }
  *first = {std::min(range.begin, first->begin), std::max(range.end, std::prev(last)->end)};
  ranges_.erase(std::next(first), last);
}

void IntervalSet::add(const IntervalSet& other) {
  for (const SampleRange& range : other.ranges_) add(range);
}

void IntervalSet::remove(SampleRange range) {
  if (range.empty() || !intersects(range)) return;
  std::vector<SampleRange> kept;
  for (const SampleRange& r : ranges_) {
    const SampleRange before{r.begin, std::min(r.end, range.begin)},
        after{std::max(r.begin, range.end), r.end};
    if (!before.empty()) kept.push_back(before);
    if (!after.empty()) kept.push_back(after);
  }
  ranges_ = std::move(kept);
}

void IntervalSet::remove(const IntervalSet& other) {
  for (const SampleRange& range : other.ranges_) remove(range);
}

std::uint64_t IntervalSet::count() const {
  std::uint64_t total = 0;
  for (const SampleRange& range : ranges_) total += range.count();
  return total;
}

bool IntervalSet::contains(SampleRange range) const {
  return range.empty() || std::any_of(ranges_.begin(), ranges_.end(), [&](const SampleRange& r) {
           return r.begin <= range.begin && range.end <= r.end;
         });
}

bool IntervalSet::intersects(SampleRange range) const {
  return !range.empty() && std::any_of(ranges_.begin(), ranges_.end(), [&](const SampleRange& r) {
    return r.begin < range.end && range.begin < r.end;
  });
}

IntervalSet IntervalSet::intersection(SampleRange range) const {
  IntervalSet common;
  for (const SampleRange& r : ranges_) {
    common.add({std::max(r.begin, range.begin), std::min(r.end, range.end)});
  }
  return common;
}

}  // namespace tessera::scheduler
