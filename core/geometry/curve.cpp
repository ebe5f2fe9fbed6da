// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/curve.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/rounding.hpp"
#include "core/geometry/seen_curve.hpp"

namespace tessera::core {
namespace {

// Bounds on the error of a point: rounding, and that of the iteration.
Vec3d curve_error_terms(const CurvePart& part) {
  constexpr double kIteration = 1 << 14;
  const double radius = part.max_radius();
  Vec3d terms{};
  for (const Vec3d& p : part.points) {
    const Vec3d size = abs(p);
    terms = {std::max(terms.x, size.x), std::max(terms.y, size.y), std::max(terms.z, size.z)};
  }
  return kIteration * (terms + Vec3d{radius, radius, radius});
}

Vec3d value_at(const CurvePart& part, double u) {
  const double v = 1 - u;
  return v * v * v * part.points[0] + 3 * u * v * v * part.points[1] + 3 * u * u * v * part.points[2] +
         u * u * u * part.points[3];
}

Vec3d scaled_to_unit(Vec3d v) {
  const double size = length(v);
  return size > 0 ? (1 / size) * v : Vec3d{};
}

ObjectPointOf<float> point_of_round(const CurvePart& part, const ObjectRay& ray, double u) {
  const CurveFrame frame(ray);
  SeenCurve curve(part, frame);
  curve.find_powers();
  const auto entry = enter_round(curve, u);  // `u` was rounded
  const double exact_u = entry ? entry->u : u;
  const CurvePlace at(curve, exact_u);
  const double s = entry ? entry->depth - at.point.z : -at.radius;
  const Vec3d arm{-at.point.x, -at.point.y, s};
  const Vec3d outward = scaled_to_unit(arm);
  // The normal leans back where the radius grows, by its growth over the length of the surface there.
  const Vec3d along = scaled_to_unit(at.tangent);
  const double speed = length(at.tangent);
  const double surface_speed = std::max(speed - dot(arm, at.bend) / speed, 0.1 * speed);

  ObjectPointOf<float> point;
  point.position = value_at(part, exact_u) + frame.to_object(at.radius * outward);
  point.terms = curve_error_terms(part);
  const Vec3d normal = frame.to_object(outward - at.radius_slope / surface_speed * along);
  // It faces the ray, which enters.
  point.geometric_normal = dot(normal, frame.along) <= 0 ? normal : -1.0 * frame.along;
  point.shading_normal = {};
  return point;
}

// Rays leave from twice the width before or behind the ribbon, so that it does not shadow itself when it
// turns to them (as in Pharr et al. 2023).
ObjectPointOf<float> point_of_flat(const CurvePart& part, const ObjectRay& ray, double u) {
  const CurveFrame frame(ray);
  SeenCurve curve(part, frame);
  curve.find_powers();
  const CurvePlace at(curve, u);
  ObjectPointOf<float> point;
  point.position = value_at(part, u) + frame.to_object({-at.point.x, -at.point.y, 0});
  const double thickness = 2 * at.radius / gamma<double>(16);
  point.terms = curve_error_terms(part) + Vec3d{thickness, thickness, thickness};
  const Vec3d along = frame.to_object(scaled_to_unit(at.tangent));
  const Vec3d facing = part.shape == CurveShape::kRibbon ? (1 - u) * part.normals[0] + u * part.normals[1]
                                                         : -1.0 * frame.along;
  const Vec3d normal = facing - dot(facing, along) * along;
  point.geometric_normal = length(normal) > 1e-9 * length(facing) ? normal : facing;
  point.shading_normal = {};
  return point;
}

}  // namespace

double CurvePart::max_radius() const {
  return std::max({radii[0], radii[1], radii[2], radii[3], 0.0});
}

Aabb CurvePart::bounds() const {
  const double radius = max_radius();
  if (!(radius > 0)) return {};
  Aabb box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] =
        std::minmax({points[0][axis], points[1][axis], points[2][axis], points[3][axis]});
    const double slack = 1e-6 * (high - low + radius) + 1e-12 * (std::fabs(low) + std::fabs(high));
    box.lower[axis] = rounded_down(low - radius - slack);
    box.upper[axis] = -rounded_down(-(high + radius + slack));
  }
  return box;
}

ObjectPointOf<float> point_of_curve(const CurvePart& part, const ObjectRay& ray, float u) {
  return part.shape == CurveShape::kRound ? point_of_round(part, ray, double{u})
                                          : point_of_flat(part, ray, double{u});
}

Vec3d curve_tangent(const CurvePart& part, double u) {
  const double v = 1 - u;
  const auto& p = part.points;
  return 3.0 * (v * v * (p[1] - p[0]) + 2 * u * v * (p[2] - p[1]) + u * u * (p[3] - p[2]));
}

double curve_radius(const CurvePart& part, double u) {
  return CubicPowers(part.radii[0], part.radii[1], part.radii[2], part.radii[3]).value(u);
}

CurveTube tube_around(const CurvePart& part) {
  const auto& points = part.points;
  const Vec3d from = points[0], along = scaled_to_unit(points[3] - from);
  double low = 0, high = length(points[3] - from);
  for (const Vec3d& p : points) {
    low = std::min(low, dot(p - from, along));
    high = std::max(high, dot(p - from, along));
  }
  const Vec3 start = (from + low * along).rounded(), end = (from + high * along).rounded();
  // From the axis as it was rounded.
  const Vec3d axis = scaled_to_unit(Vec3d(end) - Vec3d(start));
  const double axis_length = length(Vec3d(end) - Vec3d(start));
  double farthest = 0;
  for (const Vec3d& p : points) {
    const Vec3d away = p - Vec3d(start);
    const double foot = dot(away, axis);
    farthest = std::max({farthest, length(away - foot * axis), -foot, foot - axis_length});
  }
  const double radius = (farthest + part.max_radius()) * (1 + 1e-4);
  return {start, end, -rounded_down(-radius)};
}

}  // namespace tessera::core
