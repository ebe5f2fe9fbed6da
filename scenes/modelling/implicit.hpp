// SPDX-License-Identifier: Apache-2.0
// Shapes as fields: functions of position that are negative inside, positive outside, and change about as
// fast as the distance does. They blend where they meet, as clay does; marching_cubes.hpp makes meshes of
// them. Stateless; thread-safe.
#pragma once

#include <functional>

#include "core/math/vec3.hpp"

namespace tessera::modelling {

using core::Vec3;

using Field = std::function<float(Vec3 p)>;

Field ball(Vec3 center, float radius);

// `radii` along side, up and forward; up and forward need neither unit length nor a right angle: up is
// kept. The field is the distance to first order near the surface.
struct Ellipsoid {
  Vec3 center, radii;
  Vec3 up{0, 1, 0}, forward{0, 0, 1};
};
Field ellipsoid(const Ellipsoid& shape);

// Swept by a ball whose centre goes from `a` to `b` while its radius goes from `radius_a` to `radius_b`.
Field limb(Vec3 a, float radius_a, Vec3 b, float radius_b);

// The union of two shapes, and what is left of one without the other, rounded where the surfaces meet: to
// within about `blend` of the seam. A blend of 0 leaves a crease.
Field unite(Field a, Field b, float blend);
Field carve(Field from, Field tool, float blend);
// The union of a shape with its mirror image at x = 0.
Field both_sides(Field shape, float blend);

// The unit vector along which the field grows fastest at p, by differences over 2 * step.
Vec3 gradient_direction(const Field& field, Vec3 p, float step);

}  // namespace tessera::modelling
