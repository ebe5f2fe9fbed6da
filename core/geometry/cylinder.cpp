// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/cylinder.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/rounding.hpp"
#include "core/math/elementary.hpp"

namespace tessera::core {

// Each end is an ellipse; see bounds(const Disk&).
Aabb Cylinder::bounds() const {
  const Vec3d u = place_.vector({1, 0, 0}), v = place_.vector({0, 1, 0});
  const Vec3d start = place_.point({0, 0, 0}), end = place_.point({0, 0, 1});
  const Vec3d error = gamma<double>(32) * place_.error_terms({1, 1, 1});
  Aabb box;
  for (int axis = 0; axis < 3; ++axis) {
    const double reach = std::sqrt(u[axis] * u[axis] + v[axis] * v[axis]) + error[axis];
    box.lower[axis] = rounded_down(std::min(start[axis], end[axis]) - reach);
    box.upper[axis] = -rounded_down(-(std::max(start[axis], end[axis]) + reach));
  }
  return box;
}

// As intersect_sphere(), in the plane across the axis of the unit cylinder.
std::optional<Cylinder::Hit> Cylinder::intersect(const ObjectRay& ray) const {
  const Vec3d o = place_.object_point(ray.origin), d = place_.object_vector(ray.direction);
  const double a = d.x * d.x + d.y * d.y, b = -(o.x * d.x + o.y * d.y), oo = o.x * o.x + o.y * o.y;
  if (!(a > 0)) return std::nullopt;
  const double x = o.x + b / a * d.x, y = o.y + b / a * d.y;
  const double discriminant = 1 - (x * x + y * y);
  if (!(discriminant >= 0)) return std::nullopt;

  const auto at = [&](double t) -> std::optional<Hit> {
    const Vec3d p = o + t * d;
    if (!(t > 0 && p.z >= 0 && p.z <= 1)) return std::nullopt;
    const double radius = std::sqrt(p.x * p.x + p.y * p.y);
    return Hit{t, {p.x / radius, p.y / radius, p.z}};
  };
  const double q = b + std::copysign(std::sqrt(a * discriminant), b);
  const Vec3d terms = place_.object_terms(ray.origin);
  const double error = gamma<double>(16) * (oo + 1 + std::fabs(o.x) * terms.x + std::fabs(o.y) * terms.y);
  const double c = oo - 1, near = c / q, far = q / a;
  if (c > error) {  // outside
    if (!(b > 0)) return std::nullopt;
    const auto front = at(near);
    return front ? front : at(far);
  }
  if (c < -error) return at(std::signbit(b) ? near : far);
  return b > gamma<double>(16) * std::sqrt(oo * a) ? at(far) : std::nullopt;
}

ObjectPointOf<float> Cylinder::point(const ObjectRay& ray) const {
  const auto hit = intersect(ray);
  const Vec3d unit = hit ? hit->unit : Vec3d{1, 0, 0};
  ObjectPointOf<float> point;
  point.position = place_.point(unit);
  point.terms = place_.error_terms(abs(unit));
  point.geometric_normal = outward(unit);
  point.shading_normal = {};
  point.uv = {turns_of(static_cast<float>(unit.x), static_cast<float>(unit.y)), static_cast<float>(unit.z)};
  return point;
}

Vec3d Cylinder::outward(Vec3d unit) const {
  return (flipped_ ? -1.0 : 1.0) * place_.normal({unit.x, unit.y, 0});
}

WideDerivatives Cylinder::derivatives(Vec2 uv) const {
  const auto [sine, cosine] = sin_cos_turns(uv.x);
  return {2 * std::numbers::pi * place_.vector({-double{sine}, double{cosine}, 0}), place_.vector({0, 0, 1})};
}

Vec3d Cylinder::position(Vec2 uv) const {
  const auto [sine, cosine] = sin_cos_turns(uv.x);
  return place_.point({double{cosine}, double{sine}, double{uv.y}});
}

double Cylinder::area() const {
  return cylinder_area(place_.vector({0, 0, 1}), place_.vector({1, 0, 0}), place_.vector({0, 1, 0}));
}

// The rectangle rule converges exponentially on a periodic function (Trefethen and Weideman 2014).
double cylinder_area(Vec3d axis, Vec3d radius_u, Vec3d radius_v) {
  constexpr int kSteps = 256;
  const Vec3d across_u = cross(radius_u, axis), across_v = cross(radius_v, axis);
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const auto [sine, cosine] = sin_cos_turns(static_cast<float>(i) / kSteps);
    sum += length(double{cosine} * across_v - double{sine} * across_u);
  }
  return 2 * std::numbers::pi * sum / kSteps;
}

}  // namespace tessera::core
