// SPDX-License-Identifier: Apache-2.0
// Where an instance puts its object: an affine map and its inverse, in double. Immutable.
#pragma once

#include "core/geometry/aabb.hpp"
#include "core/geometry/object_ray.hpp"
#include "core/geometry/vec3d.hpp"
#include "core/math/transform.hpp"

namespace tessera::core {

class Placement {
 public:
  // The map must not flatten space, and no length may grow or shrink more than 1e15-fold: can_place().
  explicit Placement(const Transform& to_world);
  static bool can_place(const Transform& to_world);

  // From the object into the world.
  Vec3d point(Vec3d p) const { return vector(p) + origin_; }
  Vec3d vector(Vec3d v) const { return v.x * x_axis_ + v.y * y_axis_ + v.z * z_axis_; }
  // By the inverse transpose, which keeps outside what is outside, mirrored or not. Not of unit length.
  Vec3d normal(Vec3d n) const { return n.x * inverse_x_ + n.y * inverse_y_ + n.z * inverse_z_; }

  // From the world into the object. A ray, or its parts; of many at once (D is Double8 or Double16) to the
  // bit the same.
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
  Vec3d object_normal(Vec3d n) const { return {dot(x_axis_, n), dot(y_axis_, n), dot(z_axis_, n)}; }

  // Contains what the map makes of the points in `box`, and where rays find them.
  Aabb bounds(const Aabb& box) const;

  // For a point that was computed in the object as a sum of terms with the magnitudes `terms`: what the
  // rounding error of the same point in the world is in proportion to. It counts that a ray which leaves the
  // point is rounded on its way back into the object.
  Vec3d error_terms(Vec3d terms) const;

 private:
  Vec3d x_axis_, y_axis_, z_axis_, origin_;  // the map's columns
  Vec3d inverse_x_, inverse_y_, inverse_z_;  // the rows of the inverse of the first three
};

// By how much the map scales lengths if it keeps spheres round to within `tolerance`; 0 if it does not.
float uniform_scale(const Transform& transform, float tolerance);

// Two axes that are not quite as long, or not quite at right angles, are so by rounding alone.
inline constexpr float kRoundToRounding = 1e-5f;

}  // namespace tessera::core
