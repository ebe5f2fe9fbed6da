// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/curves.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/cylinder.hpp"
#include "tests/unit/core_geometry/curve_parts.hpp"
#include "tests/unit/core_geometry/shapes.hpp"

namespace tessera::core {
namespace {

using test::bent;
using test::place;
using test::straight;
using test::unit;
using test::wide;

// A point of the surface of a round part, and its normal.
struct OnRound {
  Vec3d point, normal;
};
OnRound on_round(const CurvePart& part, double u, Vec3d aside) {
  const Vec3d tangent = unit(curve_tangent(part, u));
  const Vec3d out = unit(aside - dot(aside, tangent) * tangent);
  constexpr double kStep = 1e-6;
  const double growth = (curve_radius(part, u + kStep) - curve_radius(part, u - kStep)) / (2 * kStep);
  // The surface's speed along the tangent, from the change of the frame.
  const Vec3d bend =
      (1 / (2 * kStep)) * (unit(curve_tangent(part, u + kStep)) - unit(curve_tangent(part, u - kStep)));
  const double radius = curve_radius(part, u);
  const double speed = length(curve_tangent(part, u)) - radius * dot(out, bend);
  return {place(part, u) + radius * out, unit(out - growth / speed * tangent)};
}

TEST(RoundCurve, IsTheCylinderIfStraight) {
  test::Random random(1);
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3d start = wide(random, 1), end = wide(random, 1);
    const double radius = std::ldexp(0.2, -static_cast<int>(random.below(8)));
    const Vec3d across = unit(cross(end - start, wide(random, 1)));
    const Vec3 u = (radius * across).rounded();
    const Vec3 v = (radius * unit(cross(end - start, across))).rounded();
    const Cylinder cylinder(start.rounded(), (end - start).rounded(), u, v, false);
    const Vec3d target = start + static_cast<double>(random.uniform(0.05f, 0.95f)) * (end - start) +
                         0.9 * radius * Vec3d(random.direction());
    const Vec3d origin = 5.0 * Vec3d(random.direction());
    const ObjectRay ray(origin, target - origin, 1e30f);
    const auto hit = intersect_curve(straight(start, end, radius, radius), ray);
    const auto expected = cylinder.intersect(ray);
    // From inside, as through an open end, curves are not hit.
    const bool enters = expected && dot(cylinder.point(ray).geometric_normal, ray.direction) < -1e-3;
    if (!enters) continue;
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->t, expected->t, 1e-5);
    EXPECT_NEAR(hit->u, expected->unit.z, 2e-5 / length(end - start) + 1e-5 / radius * 0.01);
    ++hits;
  }
  EXPECT_GT(hits, 10000);
}

// Rays towards points of the surface hit it there, unless they hit it before.
TEST(RoundCurve, IsHitWhereverItIsAimedAt) {
  test::Random random(2);
  int there = 0, aimed = 0, missed = 0;
  for (int i = 0; i < 20000; ++i) {
    const CurvePart part = bent(random, CurveShape::kRound);
    const auto [point, normal] =
        on_round(part, static_cast<double>(random.uniform(0, 1)), Vec3d(random.direction()));
    const Vec3d origin = 8.0 * Vec3d(random.direction());
    const ObjectRay ray(origin, point - origin, 1e30f);
    if (!(dot(unit(ray.direction), normal) < -0.02)) continue;
    ++aimed;
    const auto hit = intersect_curve(part, ray);
    if (!hit) {
      ++missed;
      continue;
    }
    ASSERT_LT(hit->t, 1 + 1e-9) << i;
    there += std::fabs(hit->t - 1) < 1e-9 ? 1 : 0;
    const Vec3d met = origin + hit->t * ray.direction - place(part, hit->u);
    EXPECT_NEAR(length(met), curve_radius(part, hit->u), 1e-9) << i;
    if (hit->u > 0 && hit->u < 1) {
      EXPECT_NEAR(dot(met, unit(curve_tangent(part, hit->u))), 0, 1e-9) << i;
    }
  }
  EXPECT_GT(there, 0.9 * aimed);
  EXPECT_LT(missed, 0.0005 * aimed) << "where thick curves bend strongly";
}

TEST(RoundCurve, IsMissedByRaysThatPassIt) {
  const CurvePart part = straight({-1, 0, 0}, {1, 0, 0}, 0.1, 0.1);
  EXPECT_TRUE(intersect_curve(part, ObjectRay({0.3, 0.0999, -5}, {0, 0, 1}, 1e30f)));
  EXPECT_FALSE(intersect_curve(part, ObjectRay({0.3, 0.1001, -5}, {0, 0, 1}, 1e30f)));
  EXPECT_FALSE(intersect_curve(part, ObjectRay({1.0001, 0, -5}, {0, 0, 1}, 1e30f)));
  EXPECT_FALSE(intersect_curve(part, ObjectRay({-5, 0, 0}, {1, 0, 0}, 1e30f))) << "along its axis";
  EXPECT_FALSE(intersect_curve(part, ObjectRay({0, 0, 5}, {0, 0, 1}, 1e30f))) << "behind the origin";
  EXPECT_FALSE(intersect_curve(part, ObjectRay({0, 0, 0}, {0.1, 0, 1}, 1e30f))) << "from inside";
  EXPECT_FALSE(intersect_curve(part, ObjectRay({0, 0, 0}, {0, 0, 0}, 1e30f))) << "no direction";
}

// A ray that has just left a part is done with it where it is straight, and hits it again where it bends
// back.
TEST(RoundCurve, IsHitAgainOnlyWhereItBendsBack) {
  const CurvePart rod = straight({-1, 0, 0}, {1, 0, 0}, 0.1, 0.2);
  for (const Vec3d direction : {Vec3d(0, 0, 1), Vec3d(1, 0, 0.2), Vec3d(-1, 0.1, 0.1)})
    EXPECT_FALSE(intersect_curve(rod, ObjectRay({0.3, 0, 0.17}, direction, 1e30f)));
  CurvePart hook = straight({0, 0, 0}, {0, 0, 0}, 0.1, 0.1);
  hook.points = {Vec3d(-1, 0, 0), Vec3d(2, 0, 0), Vec3d(2, 2, 0), Vec3d(-1, 2, 0)};
  const auto again = intersect_curve(hook, ObjectRay({-0.5, 0.35, 0}, {0, 1, 0}, 1e30f));
  ASSERT_TRUE(again);
  EXPECT_GT(again->u, 0.5);
  EXPECT_GT(again->t, 1);
}

TEST(FlatCurve, IsHitWithinItsWidth) {
  test::Random random(3);
  for (int i = 0; i < 5000; ++i) {
    const CurvePart part = bent(random, CurveShape::kFlat);
    const double u = static_cast<double>(random.uniform(0, 1));
    const Vec3d origin = 8.0 * Vec3d(random.direction());
    const auto hit = intersect_curve(part, ObjectRay(origin, place(part, u) - origin, 1e30f));
    ASSERT_TRUE(hit) << i;
    ASSERT_LT(hit->t, 1 + 1e-9) << i;
  }
  const CurvePart ribbon = straight({-1, 0, 0}, {1, 0, 0}, 0.1, 0.1, CurveShape::kFlat);
  for (const double y : {-0.0999, -0.05, 0.0, 0.02, 0.0999}) {
    const auto hit = intersect_curve(ribbon, ObjectRay({0.5, y, -5}, {0, 0, 2}, 1e30f));
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->t, 2.5, 1e-12);
    EXPECT_NEAR(hit->u, 0.75, 1e-9);
    // Across grows along normal x tangent, -z x x.
    EXPECT_NEAR(hit->across, -y / 0.1, 1e-9);
  }
  EXPECT_FALSE(intersect_curve(ribbon, ObjectRay({0.5, 0.1001, -5}, {0, 0, 2}, 1e30f)));
}

TEST(RibbonCurve, IsAsWideAsItIsSeen) {
  CurvePart part = straight({-1, 0, 0}, {1, 0, 0}, 0.1, 0.1, CurveShape::kRibbon);
  part.normals = {Vec3d{0, 1, 1}, Vec3d{0, 1, 1}};
  const double width = 0.1 / std::sqrt(2.0);
  EXPECT_TRUE(intersect_curve(part, ObjectRay({0, 0.99 * width, -5}, {0, 0, 1}, 1e30f)));
  EXPECT_FALSE(intersect_curve(part, ObjectRay({0, 1.01 * width, -5}, {0, 0, 1}, 1e30f)));
}

// Whatever its basis, a curve is the Bezier curve that follows from the definition of the basis.
TEST(Curves, EvaluateEachBasis) {
  const std::vector<Vec3> p{{0, 0, 0}, {1, 2, 0}, {3, 1, 1}, {4, 0, 2}, {5, 5, 5}};
  const auto start_of = [&](CurveBasis basis) {
    Curves curves;
    CurveStrands strands{basis, CurveShape::kRound, p, {10}, {5}, {}};
    if (basis == CurveBasis::kBezier) strands.points.pop_back(), strands.counts = {4};
    EXPECT_TRUE(Curves::is_sound(strands));
    curves.add(strands, 0);
    return curves.part(0);
  };
  const auto near = [](Vec3d a, Vec3 b) { return length(a - Vec3d(b)) < 1e-6; };
  const CurvePart linear = start_of(CurveBasis::kLinear), bezier = start_of(CurveBasis::kBezier);
  const CurvePart spline = start_of(CurveBasis::kBSpline), catmull = start_of(CurveBasis::kCatmullRom);
  EXPECT_TRUE(near(linear.points[0], p[0]) && near(unit(curve_tangent(linear, 0.3)), normalize(p[1] - p[0])));
  EXPECT_TRUE(near(bezier.points[0], p[0]));
  EXPECT_TRUE(near(spline.points[0], (1.0f / 6) * (p[0] + 4 * p[1] + p[2])));
  EXPECT_TRUE(near(unit(curve_tangent(spline, 0)), normalize(p[2] - p[0])));
  EXPECT_TRUE(near(catmull.points[0], p[1]));
  EXPECT_TRUE(near(unit(curve_tangent(catmull, 0)), normalize(p[2] - p[0])));
}

TEST(Curves, AreSoundOnlyWithEveryCount) {
  const std::vector<Vec3> four(4), five(5);
  const auto sound = [](CurveBasis basis, const std::vector<Vec3>& points, std::size_t radii,
                        std::vector<std::uint32_t> counts) {
    return Curves::is_sound({basis, CurveShape::kRound, points, std::vector<float>(radii, 1.0f), counts, {}});
  };
  EXPECT_TRUE(sound(CurveBasis::kBezier, four, 1, {4}));
  EXPECT_TRUE(sound(CurveBasis::kBSpline, five, 5, {5}));
  EXPECT_TRUE(sound(CurveBasis::kLinear, five, 1, {2, 3}));
  EXPECT_FALSE(sound(CurveBasis::kBezier, five, 1, {5}));
  EXPECT_FALSE(sound(CurveBasis::kBSpline, four, 2, {4}));
  EXPECT_FALSE(sound(CurveBasis::kBSpline, five, 1, {4}));
  EXPECT_FALSE(sound(CurveBasis::kLinear, five, 1, {4, 1}));
  CurveStrands ribbon{CurveBasis::kBezier, CurveShape::kRibbon, four, {1}, {4}, {}};
  EXPECT_FALSE(Curves::is_sound(ribbon));
  ribbon.normals.resize(2);
  EXPECT_TRUE(Curves::is_sound(ribbon));
}

// A long spline is divided, and its parts leave no gap that a ray passes through.
TEST(Curves, PartsMeet) {
  test::Random random(4);
  for (const CurveShape shape : {CurveShape::kRound, CurveShape::kFlat}) {
    Primitives primitives;
    CurveStrands strands{CurveBasis::kBSpline, shape, {}, {2e-3f}, {40}, {}};
    for (int i = 0; i < 40; ++i)
      strands.points.push_back(Vec3{0.1f * static_cast<float>(i), 0, 0} + random.in_box(0.05f));
    primitives.add_curves(strands, 0);
    ASSERT_GT(primitives.shape_count(), 37u);
    for (std::uint32_t p = 0; p + 1 < primitives.shape_count(); ++p) {
      const CurvePart part = primitives.curve(p);
      ASSERT_LT(length(part.points[3] - primitives.curve(p + 1).points[0]), 1e-7);
      for (int i = 0; i < 20; ++i) {
        const Vec3 origin = part.points[3].rounded() + 0.5f * random.direction();
        const Ray ray{origin, part.points[3].rounded() - origin};
        if (std::fabs(dot(normalize(ray.direction), curve_tangent(part, 1).rounded())) >
            0.9f * static_cast<float>(length(curve_tangent(part, 1))))
          continue;
        ASSERT_TRUE(test::brute_force_hit(primitives, ray).found()) << p;
      }
    }
  }
}

TEST(Curves, HaveSurfacesThatFaceTheRay) {
  Primitives primitives;
  primitives.add_curves({CurveBasis::kLinear, CurveShape::kRound, {{-1, 0, 0}, {1, 0, 0}}, {0.1f}, {2}, {}},
                        7);
  EXPECT_EQ(primitives.material(0), 7u);
  const Ray ray{{0.5f, 0.05f, 3}, {0, 0, -1}};
  const Hit hit = test::brute_force_hit(primitives, ray);
  ASSERT_TRUE(hit.found());
  const SurfacePoint point = primitives.surface(ray, hit);
  const float height = std::sqrt(0.01f - 0.0025f);
  EXPECT_NEAR(length(point.position - Vec3{0.5f, 0.05f, height}), 0, 1e-6f);
  EXPECT_NEAR(length(point.geometric_normal - Vec3{0, 0.5f, 10 * height}), 0, 1e-5f);
  EXPECT_NEAR(point.uv.x, 0.75f, 1e-6f);
  EXPECT_NEAR(point.uv.y, 0.75f, 1e-6f);  // y = 0.05 is across by a half, along z x x
  const auto [along_u, along_v] = primitives.tangents(hit, point);
  EXPECT_NEAR(length(along_u - Vec3{1, 0, 0}), 0, 1e-6f);
  EXPECT_NEAR(length(cross(along_u, along_v) - point.geometric_normal), 0, 1e-5f);
}

TEST(Curves, AreTheSameInInstancesAsUnderTheirMap) {
  test::Random random(6);
  int hits = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 center = random.in_box(1);
    const float factor = random.uniform(0.3f, 2);
    const Transform map = compose(
        translation(center), compose(scaling({factor, factor, factor}), rotation(random.direction(), 70)));
    CurveStrands strands{CurveBasis::kBezier, CurveShape::kRound, {}, {0.1f}, {4}, {}};
    for (int k = 0; k < 4; ++k) strands.points.push_back(random.in_box(1));
    Primitives plain, object, shown;
    object.add_curves(strands, 0);
    shown.add_object(std::move(object));
    shown.add_instance({Placement(map), 0});
    for (Vec3& p : strands.points) p = map.point(p);
    strands.radii = {0.1f * factor};
    plain.add_curves(strands, 0);
    const Vec3 origin = random.in_box(4);
    const Ray ray{origin, test::point_of(plain, random) - origin};
    const Hit a = test::brute_force_hit(plain, ray), b = test::brute_force_hit(shown, ray);
    if (!a.found() || !b.found()) continue;
    ++hits;
    if (std::fabs(a.t - b.t) > 1e-3f) continue;  // the other side of an edge
    const SurfacePoint p = plain.surface(ray, a), q = shown.surface(ray, b);
    EXPECT_NEAR(length(p.position - q.position), 0, 1e-4f);
    EXPECT_GT(dot(p.geometric_normal, q.geometric_normal), 0.99f);
    EXPECT_GT(dot(plain.tangents(a, p).along_u, shown.tangents(b, q).along_u), 0.99f);
  }
  EXPECT_GT(hits, 600);
}

// Rays that leave a curve do not hit it where they leave: outwards, or inwards as light through hair does.
TEST(Curves, AreNotHitByRaysThatLeaveThem) {
  test::Random random(7);
  for (const CurveShape shape : {CurveShape::kRound, CurveShape::kFlat})
    for (int i = 0; i < 5000; ++i) {
      const Vec3 middle = 100 * random.in_box(1), axis = random.direction();
      const float radius = std::ldexp(0.2f, -static_cast<int>(random.below(8)));
      Primitives primitives;
      primitives.add_curves({CurveBasis::kLinear, shape, {middle - axis, middle + axis}, {radius}, {2}, {}},
                            0);
      const Vec3 origin = middle + 3 * random.direction();
      const Ray ray{origin, middle + 0.5f * radius * random.direction() - origin};
      const Hit hit = test::brute_force_hit(primitives, ray);
      if (!hit.found()) continue;
      const SurfacePoint point = primitives.surface(ray, hit);
      const Vec3 away = random.direction();
      const Ray next{offset_origin(point, away), away};
      EXPECT_FALSE(test::brute_force_hit(primitives, next).found()) << i;
    }
}

TEST(Curves, LieWithinTheirBoundsAndTubes) {
  test::Random random(8);
  for (int i = 0; i < 200; ++i) {
    const CurvePart part = bent(random, CurveShape::kRound);
    const Aabb box = part.bounds();
    const CurveTube tube = tube_around(part);
    const Vec3d axis = unit(Vec3d(tube.end) - Vec3d(tube.start));
    for (int k = 0; k < 100; ++k) {
      const Vec3d p = on_round(part, k / 99.0, Vec3d(random.direction())).point;
      for (int a = 0; a < 3; ++a) {
        EXPECT_LE(static_cast<double>(box.lower[a]), p[a]);
        EXPECT_GE(static_cast<double>(box.upper[a]), p[a]);
      }
      const Vec3d from = p - Vec3d(tube.start);
      const double foot = dot(from, axis), radius = static_cast<double>(tube.radius);
      EXPECT_LE(length(from - foot * axis), radius);
      EXPECT_GE(foot, -radius);
      EXPECT_LE(foot, length(Vec3d(tube.end) - Vec3d(tube.start)) + radius);
    }
  }
}

}  // namespace
}  // namespace tessera::core
