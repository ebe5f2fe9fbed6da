// SPDX-License-Identifier: Apache-2.0
// Bump mapping: normals tilted by a height texture.
#pragma once

#include <cmath>
#include <vector>

#include "core/materials/material.hpp"
#include "core/math/vec3.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

// The derivative of the height by the texture coordinates of the image's set, which are `uv`, from central
// differences over one texel.
struct HeightSlope {
  float along_u = 0, along_v = 0;
};
inline HeightSlope height_slope(const Texture& texture, float height, Vec2 uv) {
  const auto slope = [&](float texels, float scale, Vec2 one) {
    const float step = 1 / (texels * std::fabs(scale));
    if (!std::isfinite(step)) return 0.0f;
    const auto at = [&](float offset) { return texture.evaluate(uv + one * offset).r; };
    return height * (at(0.5f * step) - at(-0.5f * step)) / step;
  };
  const auto width = static_cast<float>(texture.image->width()),
             height_px = static_cast<float>(texture.image->height());
  if (!texture.is_sheared())
    return {slope(width, texture.scale.x, {1, 0}), slope(height_px, texture.scale.y, {0, 1})};
  // The texels that are crossed along each of the surface's coordinates.
  const auto texels_along = [&](float of_u, float of_v) {
    return std::sqrt(of_u * of_u * width * width + of_v * of_v * height_px * height_px);
  };
  return {slope(texels_along(texture.scale.x, texture.shear.y), 1, {1, 0}),
          slope(texels_along(texture.shear.x, texture.scale.y), 1, {0, 1})};
}

// That of a procedural texture, also over the point in space, which moves by dp_du and dp_dv. The steps are
// those of pbrt for surfaces without ray differentials.
inline HeightSlope height_slope(const Texture& texture, const std::vector<Texture>& all, float height,
                                const TexturePoint& at, Vec3 dp_du, Vec3 dp_dv) {
  constexpr float kStep = 0.0005f;
  const auto slope = [&](Vec2 one, Vec3 derivative) {
    const auto moved = [&](float step) {
      const UvSets uv{at.uv.first + one * step, at.uv.second + one * step};
      return texture.evaluate_unclamped(all, {uv, at.position + derivative * step, at.normal}).r;
    };
    return height * (moved(0.5f * kStep) - moved(-0.5f * kStep)) / kStep;
  };
  return {slope({1, 0}, dp_du), slope({0, 1}, dp_dv)};
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
