// SPDX-License-Identifier: Apache-2.0
// The shape of a spot light's cone, as scenes describe it.
#pragma once

#include "core/math/vec3.hpp"

namespace tessera::core::lights {

// From the full intensity to zero at the edge of the cone.
enum class SpotFalloff {
  kSmooth,   // a cubic in the cosine of the angle to the axis, with slope 0 at both ends
  kLinear,   // in the angle
  kSquared,  // the square of a ramp that is linear in the cosine, as in glTF
};

// An image that a spot light projects. At a distance of 1 it covers the points axis + a right + b up with a
// and b from -1 to 1; beyond, there is no light. right and up are perpendicular to the axis and to each
// other.
struct ProjectedImage {
  int texture = -1;  // index among the scene's textures, -1 for none; it multiplies the intensity
  Vec3 right{1, 0, 0}, up{0, 1, 0};
  // Whether it multiplies the irradiance on planes perpendicular to the axis, rather than the intensity.
  bool flat_field = false;

  bool operator==(const ProjectedImage&) const = default;
};

}  // namespace tessera::core::lights
