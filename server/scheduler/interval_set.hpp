// SPDX-License-Identifier: Apache-2.0
// A set of sample numbers as sorted, disjoint, non-adjacent half-open ranges. Queries of a range take time
// logarithmic in the number of ranges, plus the ranges that it meets; changes move the ranges behind it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/film/region.hpp"

namespace tessera::scheduler {

class IntervalSet {
 public:
  IntervalSet() = default;
  IntervalSet(std::initializer_list<core::SampleRange> ranges);

  // Empty ranges change nothing.
  void add(core::SampleRange range);
  void add(const IntervalSet& other);
  void remove(core::SampleRange range);
  void remove(const IntervalSet& other);

  bool empty() const { return ranges_.empty(); }
  std::uint64_t count() const;
  bool contains(core::SampleRange range) const;
  bool intersects(core::SampleRange range) const;
  IntervalSet intersection(core::SampleRange range) const;

  using Ranges = std::vector<core::SampleRange>;
  const Ranges& ranges() const { return ranges_; }
  bool operator==(const IntervalSet&) const = default;

 private:
  Ranges::const_iterator first_beyond(std::uint32_t sample) const;

  Ranges ranges_;
};

}  // namespace tessera::scheduler
