// SPDX-License-Identifier: Apache-2.0
// Tangent-space normal mapping. T is float for one point, or FloatN for points in lanes.
#pragma once

#include "core/materials/material.hpp"
#include "core/math/rgb.hpp"
#include "core/math/vec3.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

// The surface's direction of growing u or v of the image. If the texture's scale is negative, the image is
// mirrored and the direction is reversed.
inline Vec3 along_image(Vec3 along, float scale) {
  return scale < 0 ? -along : along;
}

// `normal` perturbed by the map's texel. Red tilts it towards growing u, green towards growing v of the
// image (the OpenGL convention); blue is along the normal. It is unchanged if the directions along the
// image are zero or parallel to it. All vectors have unit length.
template <typename T>
Vec3Of<T> perturb_by_normal_map(RgbOf<T> texel, T strength, Vec3Of<T> normal, Vec3Of<T> along_u,
                                Vec3Of<T> along_v) {
  // Gram-Schmidt; the frame is left-handed if the texture coordinates are mirrored.
  const Vec3Of<T> flat_u = along_u - normal * dot(normal, along_u);
  constexpr float kParallel = 1e-4f;
  const MaskOf<T> has_frame = length(flat_u) > kParallel;
  const Vec3Of<T> tangent = normalize(flat_u);
  const Vec3Of<T> bitangent = face_toward(cross(normal, tangent), along_v);
  const T x = strength * (2 * texel.r - 1), y = strength * (2 * texel.g - 1);
  constexpr float kMinHeight = 0.05f;
  const T z = larger(2 * texel.b - 1, T(kMinHeight));
  return select(has_frame, normalize(tangent * x + bitangent * y + normal * z), normal);
}

}  // namespace tessera::core
