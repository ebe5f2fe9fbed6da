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

// The first range that ends after this sample.
IntervalSet::Ranges::const_iterator IntervalSet::first_beyond(std::uint32_t sample) const {
  return std::upper_bound(ranges_.begin(), ranges_.end(), sample,
                          [](std::uint32_t s, const SampleRange& r) { return s < r.end; });
}

void IntervalSet::remove(SampleRange range) {
  if (!intersects(range)) return;
  const auto first = ranges_.begin() + (first_beyond(range.begin) - ranges_.cbegin());
  const auto last = std::lower_bound(first, ranges_.end(), range.end,
                                     [](const SampleRange& r, std::uint32_t end) { return r.begin < end; });
  const SampleRange before{first->begin, range.begin}, after{range.end, std::prev(last)->end};
  if (!before.empty() && !after.empty() && std::next(first) == last) {
    *first = before;
    ranges_.insert(last, after);
    return;
  }
  auto kept = first;
  if (!before.empty()) *kept++ = before;
  if (!after.empty()) *kept++ = after;
  ranges_.erase(kept, last);
}

void IntervalSet::remove(const IntervalSet& other) {
  if (empty()) return;
  const std::uint32_t end = ranges_.back().end;
  for (auto range = other.first_beyond(ranges_.front().begin);
       range != other.ranges_.end() && range->begin < end; ++range)
    remove(*range);
}

std::uint64_t IntervalSet::count() const {
  std::uint64_t total = 0;
  for (const SampleRange& range : ranges_) total += range.count();
  return total;
}

bool IntervalSet::contains(SampleRange range) const {
  if (range.empty()) return true;
  const auto found = first_beyond(range.begin);
  return found != ranges_.end() && found->begin <= range.begin && range.end <= found->end;
}

bool IntervalSet::intersects(SampleRange range) const {
  if (range.empty()) return false;
  const auto found = first_beyond(range.begin);
  return found != ranges_.end() && found->begin < range.end;
}

IntervalSet IntervalSet::intersection(SampleRange range) const {
  IntervalSet common;
  if (range.empty()) return common;
  for (auto r = first_beyond(range.begin); r != ranges_.end() && r->begin < range.end; ++r)
    common.ranges_.push_back({std::max(r->begin, range.begin), std::min(r->end, range.end)});
  return common;
}

}  // namespace tessera::scheduler
