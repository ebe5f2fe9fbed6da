// SPDX-License-Identifier: Apache-2.0
// A set of sample numbers as sorted, disjoint, non-adjacent half-open ranges. Meant for few ranges: every
// operation is linear in their number.
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

  const std::vector<core::SampleRange>& ranges() const { return ranges_; }
  bool operator==(const IntervalSet&) const = default;

 private:
  std::vector<core::SampleRange> ranges_;
};

}  // namespace tessera::scheduler
