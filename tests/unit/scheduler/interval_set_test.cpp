// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/interval_set.hpp"

#include <gtest/gtest.h>

#include <bitset>
#include <random>

namespace tessera::scheduler {
namespace {

using core::SampleRange;

constexpr std::uint32_t kUniverse = 64;
using Bits = std::bitset<kUniverse>;

Bits bits_of(SampleRange range) {
  Bits bits;
  for (std::uint32_t i = range.begin; i < range.end; ++i) bits.set(i);
  return bits;
}
Bits bits_of(const IntervalSet& set) {
  Bits bits;
  for (const SampleRange& range : set.ranges()) bits |= bits_of(range);
  return bits;
}

// Sorted, disjoint, non-adjacent and without empty ranges: equal sets are equal values.
void expect_canonical(const IntervalSet& set) {
  for (std::size_t i = 0; i < set.ranges().size(); ++i) {
    EXPECT_FALSE(set.ranges()[i].empty());
    EXPECT_TRUE(i == 0 || set.ranges()[i].begin > set.ranges()[i - 1].end);
  }
}

SampleRange random_range(std::mt19937& rng) {
  const auto begin = static_cast<std::uint32_t>(rng() % kUniverse);
  return {begin, begin + static_cast<std::uint32_t>(rng() % (kUniverse - begin + 1))};
}

TEST(IntervalSet, AgreesWithABitmapThroughRandomOperations) {
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    std::mt19937 rng(seed);
    IntervalSet set, other;
    Bits bits, other_bits;
    for (int step = 0; step < 100; ++step) {
      const SampleRange range = random_range(rng);
      switch (rng() % 5) {
        case 0:
          set.add(range), bits |= bits_of(range);
          break;
        case 1:
          set.remove(range), bits &= ~bits_of(range);
          break;
        case 2:
          other = IntervalSet{range, random_range(rng)}, other_bits = bits_of(other);
          break;
        case 3:
          set.add(other), bits |= other_bits;
          break;
        case 4:
          set.remove(other), bits &= ~other_bits;
          break;
      }
      expect_canonical(set);
      ASSERT_EQ(bits_of(set), bits) << "seed " << seed << " step " << step;
      ASSERT_EQ(set.count(), bits.count());
      ASSERT_EQ(set.empty(), bits.none());
      const SampleRange asked = random_range(rng);
      ASSERT_EQ(set.contains(asked), (bits_of(asked) & ~bits).none());
      ASSERT_EQ(set.intersects(asked), (bits_of(asked) & bits).any());
      ASSERT_EQ(bits_of(set.intersection(asked)), bits_of(asked) & bits);
      expect_canonical(set.intersection(asked));
    }
  }
}

TEST(IntervalSet, JoinsRangesThatTouch) {
  IntervalSet set{{0, 4}, {8, 12}};
  EXPECT_EQ(set.ranges().size(), 2u);
  set.add({4, 8});
  EXPECT_EQ(set, (IntervalSet{{0, 12}}));
}

}  // namespace
}  // namespace tessera::scheduler
