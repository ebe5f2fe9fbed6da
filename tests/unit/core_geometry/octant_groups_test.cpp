// SPDX-License-Identifier: Apache-2.0
// Every ray of a run is in one group, or alone, and those of a group go into one octant.
#include "core/accel/octant_groups.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/unit/core_geometry/shapes.hpp"

namespace tessera::core::accel {
namespace {

struct Groups {
  std::vector<std::vector<std::size_t>> together;
  std::vector<std::size_t> alone;
};

// Bit i is the sign of coordinate i.
unsigned octant(const Ray& ray) {
  unsigned octant = 0;
  for (int axis = 0; axis < 3; ++axis) octant |= (std::signbit(ray.direction[axis]) ? 1u : 0u) << axis;
  return octant;
}

Groups groups_of(const std::vector<Ray>& run) {
  Groups groups;
  const Columns<Ray> columns{std::span(run)};
  for_each_group(
      columns.all(),
      [&](std::span<const std::uint16_t> order) { groups.together.emplace_back(order.begin(), order.end()); },
      [&](std::size_t i) { groups.alone.push_back(i); });
  return groups;
}

void expect_each_once(const std::vector<Ray>& run) {
  const Groups groups = groups_of(run);
  std::vector<int> met(run.size(), 0);
  for (const std::size_t i : groups.alone) ++met[i];
  for (const auto& group : groups.together) {
    EXPECT_GE(group.size(), kMinGroup);
    EXPECT_LE(group.size(), kGroupSize);
    for (const std::size_t i : group) {
      ++met[i];
      EXPECT_EQ(octant(run[i]), octant(run[group.front()]));
    }
  }
  EXPECT_EQ(met, std::vector<int>(run.size(), 1));
}

std::vector<Ray> alike(std::size_t count) {
  return std::vector<Ray>(count, Ray{{0, 0, 0}, {1, -2, 3}});
}

std::vector<Ray> mixed(std::size_t count, test::Random& random) {
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) rays.push_back({{0, 0, 0}, random.direction()});
  return rays;
}

TEST(OctantGroups, HoldEachRayOnce) {
  test::Random random(41);
  for (const std::size_t count : {0u, 1u, 7u, 8u, 63u, 64u, 65u, 130u, 511u, 512u}) {
    SCOPED_TRACE(count);
    expect_each_once(alike(count));
    for (int i = 0; i < 10; ++i) expect_each_once(mixed(count, random));
  }
}

TEST(OctantGroups, LeaveNeighboursOfOneOctantAsTheyCome) {
  test::Random random(42);
  std::vector<Ray> run = mixed(kGroupSize, random);
  const std::vector<Ray> more = alike(kGroupSize);
  run.insert(run.end(), more.begin(), more.end());
  expect_each_once(run);
  const std::vector<std::size_t> first = groups_of(run).together.front();
  ASSERT_EQ(first.size(), kGroupSize);
  for (std::size_t i = 0; i < kGroupSize; ++i) EXPECT_EQ(first[i], kGroupSize + i);
}

TEST(OctantGroups, TakeZerosByTheirSigns) {
  std::vector<Ray> run = alike(kGroupSize);
  for (std::size_t i = 0; i < run.size(); ++i) run[i].direction.x = i % 2 == 0 ? 0.0f : -0.0f;
  EXPECT_EQ(octant(run[0]), 2u);
  EXPECT_EQ(octant(run[1]), 3u);
  expect_each_once(run);
  EXPECT_EQ(groups_of(run).together.size(), 2u);
}

}  // namespace
}  // namespace tessera::core::accel
