// SPDX-License-Identifier: Apache-2.0
// Where ranges of items are cut: the cheapest border between bins, and both parts as they are told.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <span>
#include <tuple>
#include <vector>

#include "core/accel/binary_bvh.hpp"
#include "core/accel/partition.hpp"

namespace tessera::core {
namespace {

// Boxes within a cube whose side is twice `scale`.
std::vector<accel::BuildItem> random_items(std::size_t count, float scale, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1, 1);
  const auto anywhere = [&] { return scale * unit(random); };
  std::vector<accel::BuildItem> items;
  for (std::size_t i = 0; i < count; ++i) {
    Aabb box;
    for (int corner = 0; corner < 2; ++corner) box.include(Vec3{anywhere(), anywhere(), anywhere()});
    items.emplace_back(box, static_cast<std::uint32_t>(i));
  }
  return items;
}

// Ids, in order.
std::vector<std::uint32_t> ids_of(std::span<const accel::BuildItem> items) {
  std::vector<std::uint32_t> ids;
  for (const accel::BuildItem& item : items) ids.push_back(item.primitive());
  std::sort(ids.begin(), ids.end());
  return ids;
}

// By Binning's bins alone: the items before the border and those behind it.
struct PlainParts {
  std::size_t counts[2] = {0, 0};
  Aabb boxes[2];
  std::vector<std::uint32_t> left;  // ids, in order

  PlainParts(const std::vector<accel::BuildItem>& items, const accel::Binning& binning, int axis,
             int first_right_bin) {
    for (const accel::BuildItem& item : items) {
      alignas(32) std::uint32_t bins[8];
      binning.bins(item.box(), item.box()).store(bins);
      const bool is_right = bins[axis] >= static_cast<std::uint32_t>(first_right_bin);
      ++counts[is_right];
      boxes[is_right].include(item.box().box());
      if (!is_right) left.push_back(item.primitive());
    }
    std::sort(left.begin(), left.end());
  }

  // The packets of both parts, times their areas in units in which they are of moderate size.
  double cost(double unit) const {
    double sum = 0;
    for (int side = 0; side < 2; ++side) {
      const double x = boxes[side].extent(0) / unit, y = boxes[side].extent(1) / unit,
                   z = boxes[side].extent(2) / unit;
      sum += (x * y + y * z + z * x) *
             static_cast<double>((counts[side] + accel::kMaxLeafSize - 1) / accel::kMaxLeafSize);
    }
    return sum;
  }
};

class Binned : public testing::TestWithParam<float> {};

TEST_P(Binned, ItemsAreCutWhereItIsCheapest) {
  for (const std::size_t count : {2, 5, 8, 33, 1000}) {
    for (unsigned seed = 0; seed < 10; ++seed) {
      SCOPED_TRACE(testing::Message() << count << " items, seed " << seed);
      std::vector<accel::BuildItem> items = random_items(count, GetParam(), seed);
      const accel::RangeBounds bounds = bounds_of(items);
      const accel::Binning binning(bounds.half_centroids.box());
      accel::Bins bins;
      bins.add(binning, items);
      const accel::Split split = bins.best_split(bounds.boxes.box());
      ASSERT_GE(split.axis, 0);

      double least = std::numeric_limits<double>::infinity();
      for (int axis = 0; axis < 3; ++axis) {
        for (int border = 1; border < accel::kBins; ++border) {
          const PlainParts parts(items, binning, axis, border);
          if (parts.counts[0] > 0 && parts.counts[1] > 0) least = std::min(least, parts.cost(GetParam()));
        }
      }
      const PlainParts expected(items, binning, split.axis, split.first_right_bin);
      EXPECT_NEAR(expected.cost(GetParam()), least, 1e-5 * least);
      EXPECT_EQ(split.left.box(), expected.boxes[0]);
      EXPECT_EQ(split.right.box(), expected.boxes[1]);

      const accel::Parts parts = partition(items, binning, split);
      const std::span<const accel::BuildItem> all(items);
      EXPECT_EQ(ids_of(all.first(parts.left_count)), expected.left);
      EXPECT_EQ(parts.left_half_centroids.box(), bounds_of(all.first(parts.left_count)).half_centroids.box());
      EXPECT_EQ(parts.right_half_centroids.box(),
                bounds_of(all.subspan(parts.left_count)).half_centroids.box());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OfAllSizes, Binned, testing::Values(1e-30f, 1.0f, 3e38f));

TEST(Partition, ByManyThreadsGivesTheSameParts) {
  std::vector<accel::BuildItem> items = random_items(3 * accel::kParallelSize + 1, 1, 25);
  const accel::RangeBounds bounds = bounds_of(items);
  const accel::Binning binning(bounds.half_centroids.box());
  accel::Bins at_once, in_pieces;
  at_once.add(binning, items);
  for (std::size_t piece = 0; piece < accel::piece_count(items.size()); ++piece) {
    accel::Bins bins;
    bins.add(binning, piece_of(items, piece));
    in_pieces.add(bins);
  }
  const accel::Split split = at_once.best_split(bounds.boxes.box());
  const accel::Split same = in_pieces.best_split(bounds.boxes.box());
  EXPECT_EQ(std::tie(split.cost, split.axis, split.first_right_bin),
            std::tie(same.cost, same.axis, same.first_right_bin));
  for (const int border : {1, 5, split.first_right_bin, accel::kBins - 1}) {
    accel::Split at = split;
    at.first_right_bin = border;
    std::vector<accel::BuildItem> by_one = items, by_many = items;
    const accel::Parts expected = partition(by_one, binning, at);
    accel::Parts parts;
#pragma omp parallel num_threads(3)
#pragma omp single
    parts = partition_in_parallel(by_many, binning, at);
    ASSERT_EQ(parts.left_count, expected.left_count);
    EXPECT_EQ(parts.left_half_centroids.box(), expected.left_half_centroids.box());
    EXPECT_EQ(parts.right_half_centroids.box(), expected.right_half_centroids.box());
    const std::span<const accel::BuildItem> one(by_one), many(by_many);
    EXPECT_EQ(ids_of(many.first(parts.left_count)), ids_of(one.first(parts.left_count)));
    EXPECT_EQ(ids_of(many.subspan(parts.left_count)), ids_of(one.subspan(parts.left_count)));
  }
}

TEST(Binning, ItemsOfOneCentroidAreNotCut) {
  const std::vector<accel::BuildItem> items(9, accel::BuildItem({{-1, 2, 3}, {4, 5, 6}}, 7));
  const accel::RangeBounds bounds = bounds_of(items);
  accel::Bins bins;
  bins.add(accel::Binning(bounds.half_centroids.box()), items);
  EXPECT_LT(bins.best_split(bounds.boxes.box()).axis, 0);
}

}  // namespace
}  // namespace tessera::core
