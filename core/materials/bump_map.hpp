// SPDX-License-Identifier: Apache-2.0
// Bump mapping: normals tilted by a height texture.
#pragma once

#include <cmath>

#include "core/materials/material.hpp"
#include "core/math/vec3.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

// The derivative of the height by the surface's texture coordinates, from central differences over one
// texel.
struct HeightSlope {
  float along_u = 0, along_v = 0;
};
inline HeightSlope height_slope(const Texture& texture, float height, Vec2 uv) {
  const auto slope = [&](int texels, float scale, Vec2 one) {
    const float step = 1 / (static_cast<float>(texels) * std::fabs(scale));
    if (!std::isfinite(step)) return 0.0f;
    const auto at = [&](float offset) { return texture.evaluate(uv + one * offset).r; };
    return height * (at(0.5f * step) - at(-0.5f * step)) / step;
  };
  return {slope(texture.image->width(), texture.scale.x, {1, 0}),
          slope(texture.image->height(), texture.scale.y, {0, 1})};
}

// The unit `normal` of the surface displaced along it by a height with this slope (Blinn 1978). dp_du and
// dp_dv are those of the flat surface. The normal is unchanged if they span no area.
inline Vec3 tilt_by_heights(HeightSlope slope, Vec3 normal, Vec3 dp_du, Vec3 dp_dv) {
  const float area = dot(normal, cross(dp_du, dp_dv));
  const Vec3 gradient =
      (cross(dp_dv, normal) * slope.along_u + cross(normal, dp_du) * slope.along_v) * (1 / area);
  const Vec3 tilted = normalize(normal - gradient);
  return is_finite(tilted) ? tilted : normal;
}

}  // namespace tessera::core
