// SPDX-License-Identifier: Apache-2.0
// The surface at a hit in double, in object space and transformed to world space. T is float (one hit) or
// FloatN (hits in lanes).
#pragma once

#include <array>
#include <cmath>

#include "core/geometry/rounding.hpp"
#include "core/geometry/surface.hpp"
#include "core/geometry/vec3d.hpp"

namespace tessera::core {

template <typename T>
struct ObjectPointOf {
  using Wide = Vec3dOf<WideOf<T>>;

  Wide position, terms;  // `terms`: magnitudes of the summands of the position
  Wide geometric_normal;
  Wide shading_normal;  // 0 if it equals the geometric one
  Vec2Of<T> uv;
};

// A triangle and the barycentric coordinates (of its second and third corner) of a hit.
template <typename T>
struct TriangleAtHit {
  std::array<Vec3Of<T>, 3> corners, normals;
  std::array<Vec2Of<T>, 3> uvs;
  T b1, b2;
};

// The weights of the corners. b1 and b2 are rounded separately, so their sum may slightly exceed 1.
template <typename T>
std::array<WideOf<T>, 3> corner_weights(T b1, T b2) {
  using D = WideOf<T>;
  const D w1 = widened(b1), w2 = widened(b2), w0 = larger(D(0.0), 1.0 - w1 - w2);
  const D sum = w0 + w1 + w2;
  return {w0 / sum, w1 / sum, w2 / sum};
}

template <typename T, typename D>
Vec2Of<T> interpolated(const std::array<Vec2Of<T>, 3>& uvs, const std::array<D, 3>& weights) {
  return uvs[0] * to_float(weights[0]) + uvs[1] * to_float(weights[1]) + uvs[2] * to_float(weights[2]);
}

template <typename T>
ObjectPointOf<T> point_of_triangle(const TriangleAtHit<T>& triangle) {
  using D = WideOf<T>;
  using Wide = Vec3dOf<D>;
  const std::array<D, 3> weights = corner_weights(triangle.b1, triangle.b2);
  const auto& [b0, b1, b2] = weights;
  const auto& [c0, c1, c2] = triangle.corners;
  const auto& [n0, n1, n2] = triangle.normals;
  const Wide p0 = b0 * Wide(c0), p1 = b1 * Wide(c1), p2 = b2 * Wide(c2);

  ObjectPointOf<T> point;
  point.position = p0 + p1 + p2;
  point.terms = abs(p0) + abs(p1) + abs(p2);
  point.geometric_normal = cross(Wide(c1) - Wide(c0), Wide(c2) - Wide(c0));
  const Wide normal = b0 * Wide(n0) + b1 * Wide(n1) + b2 * Wide(n2);
  point.shading_normal = select(length(normal) > 1e-6, normal, Wide{});
  point.uv = interpolated(triangle.uvs, weights);
  return point;
}

template <typename D>
auto unit_or_zero(Vec3dOf<D> v) {
  const auto unit = (D(1.0) / length(v) * v).rounded();
  return select(has_direction(v), unit, decltype(unit){});
}

// The error bound of a coordinate that was rounded to float from a sum computed in double, whose summands'
// magnitudes sum to `terms`.
template <typename T, typename D>
Vec3Of<T> rounding_error(Vec3Of<T> position, Vec3dOf<D> terms) {
  const Vec3Of<T> from_rounding = abs(position) * T(gamma<float>(2));
  return from_rounding + (D(gamma<double>(16)) * terms).rounded();
}

// The placement of geometry that is not instanced.
struct IdentityTransform {
  template <typename D>
  static Vec3dOf<D> point(Vec3dOf<D> p) {
    return p;
  }
  template <typename D>
  static Vec3dOf<D> normal(Vec3dOf<D> n) {
    return n;
  }
  template <typename D>
  static Vec3dOf<D> error_terms(Vec3dOf<D> terms) {
    return terms;
  }
};

// Transforms an object-space point by `place` (IdentityTransform or a Placement).
template <typename Place, typename T>
SurfacePointOf<T> in_world(const Place& place, const ObjectPointOf<T>& model) {
  SurfacePointOf<T> point;
  point.position = place.point(model.position).rounded();
  point.position_error = rounding_error(point.position, place.error_terms(model.terms));
  point.geometric_normal = unit_or_zero(place.normal(model.geometric_normal));
  point.shading_normal = point.geometric_normal;
  const MaskOf<T> interpolated = has_direction(model.shading_normal);
  if (any(interpolated)) {
    const Vec3Of<T> smooth = unit_or_zero(place.normal(model.shading_normal));
    point.shading_normal =
        select(interpolated, face_toward(smooth, point.geometric_normal), point.shading_normal);
  }
  point.uv = model.uv;
  return point;
}

}  // namespace tessera::core
