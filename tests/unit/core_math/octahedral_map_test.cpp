// SPDX-License-Identifier: Apache-2.0
#include "core/math/octahedral_map.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/math/elementary.hpp"

namespace tessera::core {
namespace {

TEST(OctahedralMap, GoesThereAndBack) {
  std::mt19937 generator(1);
  std::normal_distribution<float> coordinate;
  for (int i = 0; i < 4096; ++i) {
    const Vec3 d = normalize(Vec3{coordinate(generator), coordinate(generator), coordinate(generator)});
    EXPECT_LT(length(from_octahedral_square(to_octahedral_square(d)) - d), 1e-5f);
  }
  for (const Vec3 axis :
       {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}})
    EXPECT_LT(length(from_octahedral_square(to_octahedral_square(axis)) - axis), 1e-5f);
}

TEST(OctahedralMap, CoversTheSphereOnce) {
  double sum = 0;
  constexpr int kSide = 512;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      sum += static_cast<double>(octahedral_area(from_octahedral_square<float>(
          {(static_cast<float>(x) + 0.5f) / kSide, (static_cast<float>(y) + 0.5f) / kSide})));
  EXPECT_NEAR(sum / (kSide * kSide), 4 * static_cast<double>(kPi), 1e-3);
}

}  // namespace
}  // namespace tessera::core
