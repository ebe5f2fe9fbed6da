// SPDX-License-Identifier: Apache-2.0
// Affine maps.
#pragma once

#include "core/math/vec3.hpp"

namespace tessera::core {

// p -> x_axis * p.x + y_axis * p.y + z_axis * p.z + origin.
struct Transform {
  Vec3 x_axis{1, 0, 0}, y_axis{0, 1, 0}, z_axis{0, 0, 1}, origin{0, 0, 0};

  bool operator==(const Transform&) const = default;

  Vec3 point(Vec3 p) const { return direction(p) + origin; }
  Vec3 direction(Vec3 d) const { return x_axis * d.x + y_axis * d.y + z_axis * d.z; }
  // Transforms by the cofactor matrix (the inverse transpose times the determinant). The result does not
  // have unit length, but is defined for singular maps. For reflections the caller must flip it.
  Vec3 normal(Vec3 n) const;
  // Negative if the map reflects; 0 if it is singular.
  float determinant() const { return dot(x_axis, cross(y_axis, z_axis)); }
  // The factors by which lengths along x, y and z grow.
  Vec3 scales() const { return {length(x_axis), length(y_axis), length(z_axis)}; }
};

// Applies `inner`, then `outer`.
Transform compose(const Transform& outer, const Transform& inner);

Transform translation(Vec3 offset);
Transform scaling(Vec3 factors);
// Counter-clockwise seen from the tip of `axis`, which must not be zero (Rodrigues 1840).
Transform rotation(Vec3 axis, float degrees);

}  // namespace tessera::core
