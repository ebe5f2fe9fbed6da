// SPDX-License-Identifier: Apache-2.0
#include "scenes/modelling/implicit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tessera::modelling {
namespace {

// The quadratic smooth minimum (Quilez 2013): at most blend / 4 below the smaller of the two.
float smooth_min(float a, float b, float blend) {
  if (blend == 0) return std::min(a, b);
  const float near = std::max(blend - std::fabs(a - b), 0.0f) / blend;
  return std::min(a, b) - near * near * blend / 4;
}

}  // namespace

Field ball(Vec3 center, float radius) {
  return [=](Vec3 p) { return length(p - center) - radius; };
}

Field ellipsoid(const Ellipsoid& shape) {
  const Vec3 up = normalize(shape.up), side = normalize(cross(up, shape.forward)), forward = cross(side, up);
  const Vec3 center = shape.center, radii = shape.radii;
  return [=](Vec3 p) {
    const Vec3 d = p - center;
    const Vec3 scaled{dot(d, side) / radii.x, dot(d, up) / radii.y, dot(d, forward) / radii.z};
    const Vec3 half_gradient{scaled.x / radii.x, scaled.y / radii.y, scaled.z / radii.z};
    const float k = length(scaled), steepness = length(half_gradient);
    if (steepness == 0) return -std::min({radii.x, radii.y, radii.z});
    return k * (k - 1) / steepness;
  };
}

Field limb(Vec3 a, float radius_a, Vec3 b, float radius_b) {
  const Vec3 along = b - a;
  const float length_squared = dot(along, along);
  return [=](Vec3 p) {
    const float t = std::clamp(dot(p - a, along) / length_squared, 0.0f, 1.0f);
    return length(p - a - along * t) - (radius_a + (radius_b - radius_a) * t);
  };
}

Field unite(Field a, Field b, float blend) {
  return [a = std::move(a), b = std::move(b), blend](Vec3 p) { return smooth_min(a(p), b(p), blend); };
}

Field carve(Field from, Field tool, float blend) {
  return [from = std::move(from), tool = std::move(tool), blend](Vec3 p) {
    return -smooth_min(-from(p), tool(p), blend);
  };
}

Field both_sides(Field shape, float blend) {
  return [shape = std::move(shape), blend](Vec3 p) {
    return smooth_min(shape(p), shape({-p.x, p.y, p.z}), blend);
  };
}

Vec3 gradient_direction(const Field& field, Vec3 p, float step) {
  const auto slope = [&](Vec3 axis) { return field(p + axis * step) - field(p - axis * step); };
  const Vec3 gradient{slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})};
  return length_squared(gradient) > 0 ? normalize(gradient) : Vec3{0, 1, 0};
}

}  // namespace tessera::modelling
