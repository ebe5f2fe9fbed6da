// SPDX-License-Identifier: Apache-2.0
#include "core/math/quaternion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/near.hpp"

namespace tessera::core {
namespace {

void expect_same_map(const Transform& a, const Transform& b, float tolerance = 1e-6f) {
  expect_near(a.x_axis, b.x_axis, tolerance);
  expect_near(a.y_axis, b.y_axis, tolerance);
  expect_near(a.z_axis, b.z_axis, tolerance);
}

TEST(QuaternionRotation, IsThatAboutTheAxis) {
  for (const float degrees : {0.0f, 30.0f, 90.0f, 179.0f, 270.0f, -45.0f, 720.0f})
    for (const Vec3 axis : {Vec3{0, 1, 0}, Vec3{1, 2, -3}})
      expect_same_map(rotation(rotation_quaternion(axis, degrees)), rotation(axis, degrees));
}

// Between two rotations about one axis, the angle grows linearly.
TEST(Slerp, TurnsAtConstantSpeed) {
  const Vec3 axis{1, 2, -3};
  for (const float angle : {1e-4f, 0.01f, 1.0f, 90.0f, 179.0f}) {
    const Quaternion a = rotation_quaternion(axis, 20), b = rotation_quaternion(axis, 20 + angle);
    for (const float t : {0.0f, 0.25f, 0.5f, 0.9f, 1.0f})
      expect_same_map(rotation(slerp(a, b, t)), rotation(axis, 20 + t * angle), 2e-6f);
  }
}

TEST(Slerp, TakesTheShorterArc) {
  const Vec3 axis{0, 0, 1};
  const Quaternion a = rotation_quaternion(axis, 10), b = rotation_quaternion(axis, 350);
  expect_same_map(rotation(slerp(a, b, 0.5f)), rotation(axis, 0));
  const Quaternion same{-a.w, -a.x, -a.y, -a.z};
  expect_same_map(rotation(slerp(a, same, 0.3f)), rotation(axis, 10));
}

// Half-way between quarter turns about x and about y lies a rotation about the diagonal of the two.
TEST(Slerp, MeetsHalfWayBetweenTwoAxes) {
  const Quaternion a = rotation_quaternion({1, 0, 0}, 90), b = rotation_quaternion({0, 1, 0}, 90);
  const Quaternion middle = slerp(a, b, 0.5f);
  EXPECT_NEAR(middle.x, middle.y, 1e-6f);
  EXPECT_NEAR(middle.z, 0, 1e-6f);
  // The sum of both, normalised: cos of half the angle is 2 cos 45 over the sum's length, sqrt 3.
  EXPECT_NEAR(middle.w, std::sqrt(2.0f) / std::sqrt(3.0f), 1e-6f);
}

TEST(Slerp, HasUnitLengthAndStartsExactly) {
  const Quaternion a = rotation_quaternion({1, 1, 0}, 33), b = rotation_quaternion({0, 1, 5}, 170);
  EXPECT_EQ(slerp(a, b, 0), a);
  EXPECT_EQ(slerp(a, a, 0.7f), a);
  for (const float t : {0.1f, 0.5f, 1.0f}) {
    const Quaternion q = slerp(a, b, t);
    EXPECT_NEAR(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z, 1, 1e-6f);
  }
}

}  // namespace
}  // namespace tessera::core
