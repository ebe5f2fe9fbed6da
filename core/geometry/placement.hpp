// SPDX-License-Identifier: Apache-2.0
// The placement of an instance: an affine map and its inverse, in double. Immutable.
#pragma once

#include "core/geometry/aabb.hpp"
#include "core/geometry/object_ray.hpp"
#include "core/geometry/vec3d.hpp"
#include "core/math/transform.hpp"

namespace tessera::core {

// An affine map and the inverse of its linear part. D is double, or DoubleN for a map in each lane, which is
// bit-identical to that map alone.
template <typename D>
struct AffineMapOf {
  // Object space to world space.
  Vec3dOf<D> point(Vec3dOf<D> p) const { return vector(p) + origin; }
  Vec3dOf<D> vector(Vec3dOf<D> v) const { return v.x * x_axis + v.y * y_axis + v.z * z_axis; }
  // Transforms by the inverse transpose, which keeps normals outward, also under reflections. The result
  // does not have unit length.
  Vec3dOf<D> normal(Vec3dOf<D> n) const { return n.x * inverse_x + n.y * inverse_y + n.z * inverse_z; }

  // World space to object space.
  Vec3dOf<D> object_point(Vec3dOf<D> p) const { return object_vector(p - origin); }
  Vec3dOf<D> object_vector(Vec3dOf<D> v) const {
    return {dot(inverse_x, v), dot(inverse_y, v), dot(inverse_z, v)};
  }

  // The terms to which the world-space rounding error of a point is proportional, given the object-space
  // `terms`, the magnitudes of its summands. They account for the rounding of rays that leave the point and
  // are transformed back into object space.
  //
  // Let A be the map's matrix and B its computed inverse. A point x of the object becomes A x + o, and a ray
  // that leaves it starts at B (A x + o - o) in the object. Each of these steps has an error of a few
  // roundings of |A| |x| + |o| in the world, and so has B's difference from the inverse, except for a factor
  // |A| |B|.
  Vec3dOf<D> error_terms(Vec3dOf<D> terms) const {
    const auto magnitude = [this](Vec3dOf<D> v) {
      return v.x * abs(x_axis) + v.y * abs(y_axis) + v.z * abs(z_axis);
    };
    const Vec3dOf<D> in_world = magnitude(terms) + abs(origin);
    return magnitude(
        {dot(abs(inverse_x), in_world), dot(abs(inverse_y), in_world), dot(abs(inverse_z), in_world)});
  }

  Vec3dOf<D> x_axis, y_axis, z_axis, origin;   // the columns of the map
  Vec3dOf<D> inverse_x, inverse_y, inverse_z;  // the rows of the inverse of its linear part
};

class Placement {
 public:
  // The map must be invertible and scale no length by more than 1e15 either way: see can_place().
  explicit Placement(const Transform& to_world);
  static bool can_place(const Transform& to_world);
  Transform transform() const {
    return {map_.x_axis.rounded(), map_.y_axis.rounded(), map_.z_axis.rounded(), map_.origin.rounded()};
  }
  const AffineMapOf<double>& map() const { return map_; }

  // As those of the map.
  Vec3d point(Vec3d p) const { return map_.point(p); }
  Vec3d vector(Vec3d v) const { return map_.vector(v); }
  Vec3d normal(Vec3d n) const { return map_.normal(n); }
  Vec3d error_terms(Vec3d terms) const { return map_.error_terms(terms); }
  // Whether it turns right-handed axes into left-handed ones.
  bool reflects() const { return dot(map_.x_axis, cross(map_.y_axis, map_.z_axis)) < 0; }

  // World space to object space, for a ray or its parts. Vector versions (D is DoubleN or DoubleVector) are
  // bit-identical.
  ObjectRay to_object(const Ray& ray) const;
  template <typename D>
  Vec3dOf<D> object_point(Vec3dOf<D> p) const {
    return object_vector(p - Vec3dOf<D>(map_.origin.x, map_.origin.y, map_.origin.z));
  }
  template <typename D>
  Vec3dOf<D> object_vector(Vec3dOf<D> v) const {
    const auto along = [&v](const Vec3d& row) { return dot(Vec3dOf<D>(row.x, row.y, row.z), v); };
    return {along(map_.inverse_x), along(map_.inverse_y), along(map_.inverse_z)};
  }
  // The sums of the magnitudes of the summands of object_point(p), to which its rounding error is
  // proportional.
  Vec3d object_terms(Vec3d p) const {
    const Vec3d v = abs(p - map_.origin);
    return {dot(abs(map_.inverse_x), v), dot(abs(map_.inverse_y), v), dot(abs(map_.inverse_z), v)};
  }
  Vec3d object_normal(Vec3d n) const {
    return {dot(map_.x_axis, n), dot(map_.y_axis, n), dot(map_.z_axis, n)};
  }

  // Bounds of the transformed points of `box`, including the error of intersection.
  Aabb bounds(const Aabb& box) const;

 private:
  AffineMapOf<double> map_;
};

// The factor by which the map scales lengths if it is a similarity to within `tolerance`; else 0.
float uniform_scale(const Transform& transform, float tolerance);

// The tolerance for differences of length and angle between axes that rounding alone explains.
inline constexpr float kRoundToRounding = 1e-5f;

}  // namespace tessera::core
