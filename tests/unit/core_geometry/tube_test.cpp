// SPDX-License-Identifier: Apache-2.0
#include "core/accel/tube_test.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/accel/slab_test.hpp"
#include "tests/unit/core_geometry/curve_parts.hpp"

namespace tessera::core::accel {
namespace {

using test::bent;
using test::place;
using test::straight;
using test::unit;
using test::wide;

// Four parts, of which the first two are like those that segments are divided into, and the last may be a
// loop.
std::array<CurvePart, BvhPacket::kWidth> parts_of_packet(test::Random& random, CurveShape shape) {
  std::array<CurvePart, BvhPacket::kWidth> parts;
  for (std::size_t lane = 0; lane < parts.size(); ++lane) {
    CurvePart& part = parts[lane] = bent(random, shape);
    if (lane > 1) continue;
    const Vec3d along = Vec3d(random.direction());
    for (std::size_t i = 1; i < 4; ++i)
      part.points[i] = part.points[i - 1] + 0.1 * along + 0.01 * wide(random, 1);
    part.radii.fill(0.0125);
  }
  if (random.below(4) == 0) parts[3].points[3] = parts[3].points[0];  // a loop, whose axis has no length
  return parts;
}

BvhPacket packet_of(const std::array<CurvePart, BvhPacket::kWidth>& parts) {
  BvhPacket packet;
  packet.kind = GeometryKind::kCurve;
  packet.lanes = (1u << BvhPacket::kWidth) - 1;
  for (std::uint32_t lane = 0; lane < parts.size(); ++lane) set_tube(packet, lane, tube_around(parts[lane]));
  return packet;
}

// From anywhere around a part, also from inside of it, past it, along it or parallel to its axis.
ObjectRay ray_near(const CurvePart& part, test::Random& random) {
  const double u = static_cast<double>(random.uniform(0, 1));
  const Vec3d target = place(part, u) + 1.5 * curve_radius(part, u) * Vec3d(random.direction());
  const double distance = std::ldexp(1000.0, -static_cast<int>(random.below(20)));
  Vec3d direction = Vec3d(random.direction());
  if (random.below(4) == 0) direction = unit(curve_tangent(part, u)) + 0.01 * direction;
  if (random.below(8) == 0 && length(part.points[3] - part.points[0]) > 0)
    direction = unit(part.points[3] - part.points[0]);
  const Vec3d origin = Vec3d((target - distance * direction).rounded());
  return {origin, std::ldexp(1.0, static_cast<int>(random.below(20)) - 10) * (target - origin), 1e30f};
}

TEST(TubeTest, KeepsEveryPartThatIsHit) {
  test::Random random(9);
  int hits = 0;
  for (const CurveShape shape : {CurveShape::kRound, CurveShape::kFlat})
    for (int i = 0; i < 5000; ++i) {
      const auto parts = parts_of_packet(random, shape);
      const BvhPacket packet = packet_of(parts);
      const ObjectRay ray = ray_near(parts[random.below(BvhPacket::kWidth)], random);
      for (std::size_t lane = 0; lane < parts.size(); ++lane) {
        const auto hit = intersect_curve(parts[lane], ray);
        if (!hit) continue;
        const float limit = box_limit(static_cast<float>(hit->t));
        EXPECT_TRUE(curves_near(packet, ray, limit) >> lane & 1) << i << ' ' << lane;
        ++hits;
      }
    }
  EXPECT_GT(hits, 3000);
}

TEST(TubeTest, RejectsPartsBesideBehindAndBeyond) {
  const CurvePart part = straight({-1, 0, 0}, {1, 0, 0}, 0.1, 0.1);
  const BvhPacket packet = packet_of({part, part, part, part});
  const auto is_near = [&](Vec3d origin, Vec3d direction, float limit) {
    return curves_near(packet, ObjectRay(origin, direction, 1e30f), limit) != 0;
  };
  EXPECT_TRUE(is_near({0.9, 0.05, -5}, {0, 0, 1}, 1e30f));
  EXPECT_FALSE(is_near({0.9, 0.11, -5}, {0, 0, 1}, 1e30f)) << "beside it";
  EXPECT_FALSE(is_near({1.2, 0.05, -5}, {0, 0, 1}, 1e30f)) << "beyond its end";
  EXPECT_FALSE(is_near({1.6, 0, -0.5}, {-1, 0, -1}, 1e30f)) << "beyond its end, away from it";
  EXPECT_FALSE(is_near({0.9, 0.05, 5}, {0, 0, 1}, 1e30f)) << "behind the origin";
  EXPECT_FALSE(is_near({0.9, 0.05, -5}, {0, 0, 1}, 4.8f)) << "beyond the limit";
}

// Most parts that a ray comes near are hit: of those that segments are divided into, seen from aside.
TEST(TubeTest, KeepsFewPartsThatAreMissed) {
  test::Random random(10);
  int near = 0, hits = 0;
  for (int i = 0; i < 5000; ++i) {
    const auto parts = parts_of_packet(random, CurveShape::kRound);
    const Vec3d origin = 5.0 * Vec3d(random.direction());
    const ObjectRay ray(origin, parts[0].points[1] + 0.1 * wide(random, 1) - origin, 1e30f);
    if ((curves_near(packet_of(parts), ray, 1e30f) & 1) == 0) continue;
    ++near;
    hits += intersect_curve(parts[0], ray) ? 1 : 0;
  }
  EXPECT_GT(near, 500);
  EXPECT_GT(hits, 0.5 * near);
}

}  // namespace
}  // namespace tessera::core::accel
