// SPDX-License-Identifier: Apache-2.0
#include "core/math/transform.hpp"

#include <gtest/gtest.h>

#include "core/math/frame.hpp"
#include "tests/support/near.hpp"

namespace tessera::core {
namespace {

TEST(Transform, AppliesTheInnerMapFirst) {
  const Transform t = compose(translation({1, 0, 0}), scaling({2, 3, 4}));
  expect_near(t.point({1, 1, 1}), {3, 3, 4}, 1e-6f);
  expect_near(t.direction({1, 1, 1}), {2, 3, 4}, 1e-6f);
}

TEST(Transform, RotatesCounterClockwiseAroundTheAxis) {
  expect_near(rotation({0, 0, 2}, 90).direction({1, 0, 0}), {0, 1, 0}, 1e-6f);
  expect_near(rotation({0, 1, 0}, 90).direction({0, 0, 1}), {1, 0, 0}, 1e-6f);
  expect_near(rotation({1, 1, 1}, 120).direction({1, 0, 0}), {0, 1, 0}, 1e-6f);
}

TEST(Transform, KeepsNormalsPerpendicular) {
  const Transform t = compose(rotation({1, 2, 3}, 40), scaling({1, 5, 0.2f}));
  const Vec3 along{1, -2, 0.5f}, other{0, 1, 4}, normal = cross(along, other);
  EXPECT_NEAR(dot(normalize(t.normal(normal)), normalize(t.direction(along))), 0, 1e-6);
  EXPECT_NEAR(dot(normalize(t.normal(normal)), normalize(t.direction(other))), 0, 1e-6);
}

TEST(Transform, KnowsMirroringAndFlattening) {
  EXPECT_FLOAT_EQ(scaling({-1, 2, 3}).determinant(), -6);
  EXPECT_EQ(scaling({1, 0, 1}).determinant(), 0);
}

TEST(Frame, IsOrthonormalForEveryNormal) {
  const Vec3 normals[] = {{0, 0, 1},  {0, 0, -1},           {1, 0, 0},
                          {0, -1, 0}, normalize({1, 2, 3}), normalize({1e-4f, 0, -1})};
  for (const Vec3 n : normals) {
    const Frame frame = Frame::around(n);
    EXPECT_NEAR(length(frame.tangent), 1, 1e-6);
    EXPECT_NEAR(dot(frame.tangent, frame.bitangent), 0, 1e-6);
    expect_near(cross(frame.tangent, frame.bitangent), n, 1e-6f);
    expect_near(frame.to_local(n), {0, 0, 1}, 1e-6f);
    expect_near(frame.to_world(frame.to_local({1, 2, 3})), {1, 2, 3}, 1e-5f);
  }
}

}  // namespace
}  // namespace tessera::core
