// SPDX-License-Identifier: Apache-2.0
// The placement of an instance: an affine map and its inverse, in double. Immutable.
#pragma once

#include "core/geometry/aabb.hpp"
#include "core/geometry/object_ray.hpp"
#include "core/geometry/vec3d.hpp"
#include "core/math/transform.hpp"

namespace tessera::core {

class Placement {
 public:
  // The map must be invertible and scale no length by more than 1e15 either way: see can_place().
  explicit Placement(const Transform& to_world);
  static bool can_place(const Transform& to_world);
  Transform transform() const {
    return {x_axis_.rounded(), y_axis_.rounded(), z_axis_.rounded(), origin_.rounded()};
  }

  // Object space to world space.
  Vec3d point(Vec3d p) const { return vector(p) + origin_; }
  Vec3d vector(Vec3d v) const { return v.x * x_axis_ + v.y * y_axis_ + v.z * z_axis_; }
  // Transforms by the inverse transpose, which keeps normals outward, also under reflections. The result
  // does not have unit length.
  Vec3d normal(Vec3d n) const { return n.x * inverse_x_ + n.y * inverse_y_ + n.z * inverse_z_; }

  // World space to object space, for a ray or its parts. Vector versions (D is Double8 or Double16) are
  // bit-identical.
  ObjectRay to_object(const Ray& ray) const;
  template <typename D>
  Vec3dOf<D> object_point(Vec3dOf<D> p) const {
    return object_vector(p - Vec3dOf<D>(origin_.x, origin_.y, origin_.z));
  }
  template <typename D>
  Vec3dOf<D> object_vector(Vec3dOf<D> v) const {
    const auto along = [&v](const Vec3d& row) { return dot(Vec3dOf<D>(row.x, row.y, row.z), v); };
    return {along(inverse_x_), along(inverse_y_), along(inverse_z_)};
  }
  // The sums of the magnitudes of the summands of object_point(p), to which its rounding error is
  // proportional.
  Vec3d object_terms(Vec3d p) const {
    const Vec3d v = abs(p - origin_);
    return {dot(abs(inverse_x_), v), dot(abs(inverse_y_), v), dot(abs(inverse_z_), v)};
  }
  Vec3d object_normal(Vec3d n) const { return {dot(x_axis_, n), dot(y_axis_, n), dot(z_axis_, n)}; }

  // Bounds of the transformed points of `box`, including the error of intersection.
  Aabb bounds(const Aabb& box) const;

  // The terms to which the world-space rounding error of a point is proportional, given the object-space
  // `terms`, the magnitudes of its summands. They account for the rounding of rays that leave the point and
  // are transformed back into object space.
  Vec3d error_terms(Vec3d terms) const;

 private:
  Vec3d x_axis_, y_axis_, z_axis_, origin_;  // the columns of the map
  Vec3d inverse_x_, inverse_y_, inverse_z_;  // the rows of the inverse of its linear part
};

// The factor by which the map scales lengths if it is a similarity to within `tolerance`; else 0.
float uniform_scale(const Transform& transform, float tolerance);

// The tolerance for differences of length and angle between axes that rounding alone explains.
inline constexpr float kRoundToRounding = 1e-5f;

}  // namespace tessera::core
