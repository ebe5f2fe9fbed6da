// SPDX-License-Identifier: Apache-2.0
// Parts of cubic curves that are swept by a radius, and where rays hit them; in double from float data.
//
// A round curve is the surface that a circle sweeps, perpendicular to the curve: open at both ends, and hit
// from outside only, so that a ray that starts inside leaves it unhindered. A flat curve is a ribbon that
// faces each ray; a ribbon has normals of its own, which its width follows (Pharr et al. 2023, section 6.7).
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/geometry/aabb.hpp"
#include "core/geometry/object_point.hpp"
#include "core/geometry/object_ray.hpp"
#include "core/geometry/vec3d.hpp"

namespace tessera::core {

enum class CurveShape : std::uint8_t { kRound, kFlat, kRibbon };

// A cubic curve in the Bernstein basis, with its radius. The parameter runs from 0 to 1.
struct CurvePart {
  std::array<Vec3d, 4> points{};
  std::array<double, 4> radii{};
  CurveShape shape = CurveShape::kRound;
  std::array<Vec3d, 2> normals{};  // of a ribbon, at both ends; need not be unit length

  // The largest radius of the control points, which no radius exceeds.
  double max_radius() const;
  // Bounds of every point that a ray can hit, rounded outwards.
  Aabb bounds() const;
};

struct CurveHit {
  double t;
  double u;       // along the part, in [0, 1]
  double across;  // in [-1, 1]; grows along the cross product of the normal and the tangent
};

// The nearest hit in front of the origin. None if t is not provably positive.
std::optional<CurveHit> intersect_curve(const CurvePart& part, const ObjectRay& ray);

// The surface where intersect_curve() found `hit`, rounded to float, on the same ray. Without uv.
ObjectPointOf<float> point_of_curve(const CurvePart& part, const ObjectRay& ray, float u);

// The derivative of the curve's position by u.
Vec3d curve_tangent(const CurvePart& part, double u);
double curve_radius(const CurvePart& part, double u);

// An axis and a radius that bound the part: no point of it is farther than the radius from the line through
// the axis, nor farther beyond an end of the axis.
struct CurveTube {
  Vec3 start{}, end{};
  float radius = 0;
};
CurveTube tube_around(const CurvePart& part);

}  // namespace tessera::core
