// What keeps surfaces shaded with other normals than their own (interpolated, or bent by a map) from going
// black or letting light through. docs/materials.md says why. All vectors are of unit length; `side` is the
// surface's true normal on the side of the viewer, who looks along -wo.
#pragma once

#include "core/math/vec3.hpp"

namespace tessera::core {

inline constexpr float kMinShadingCos = 1e-4f;

// `w`, bent towards `normal` just far enough that their cosine is not below min_cos.
template <typename T>
Vec3Of<T> lifted(Vec3Of<T> w, Vec3Of<T> normal, T min_cos) {
  const T cos_w = dot(w, normal);
  const MaskOf<T> high = cos_w >= min_cos;
  return all(high) ? w : select(high, w, normalize(w + normal * (min_cos - cos_w)));
}

// `normal`, bent just far enough that wo is above it.
template <typename T = float>
Vec3Of<T> bend_toward_viewer(Vec3Of<T> normal, Vec3Of<T> wo) {
  return lifted(normal, wo, T(kMinShadingCos));
}

// Bent just far enough that the mirror direction of wo is above the true surface (Keller et al. 2017).
template <typename T = float>
Vec3Of<T> bend_for_reflection(Vec3Of<T> normal, Vec3Of<T> side, Vec3Of<T> wo) {
  const Vec3Of<T> mirrored = normal * (2 * dot(wo, normal)) - wo;
  // A viewer who grazes the surface sees what grazes it.
  const T min_cos = smaller(T(0.01f), 0.9f * dot(wo, side));
  const MaskOf<T> high = dot(mirrored, side) >= min_cos;
  return all(high) ? normal : select(high, normal, normalize(wo + lifted(mirrored, side, min_cos)));
}

// A direction that should be on the true surface's side `side`, bent to graze it if it is not.
template <typename T = float>
Vec3Of<T> bend_above(Vec3Of<T> wi, Vec3Of<T> side) {
  return lifted(wi, side, T(kMinShadingCos));
}

// What reflected light is multiplied by, from 0 where wi sinks below the true surface to 1 where its
// elevation is that above the shading normal's plane (Chiang, Li and Burley 2019).
template <typename T = float>
T smooth_terminator(Vec3Of<T> normal, Vec3Of<T> side, Vec3Of<T> wi) {
  const T true_cos = dot(wi, side), shading_cos = dot(wi, normal) * dot(normal, side);
  const T g = true_cos / shading_cos;
  const T above = select(true_cos >= shading_cos, T(1.0f), g * (1 + g * (1 - g)));
  return select((true_cos <= 0) | (shading_cos <= 0), T(0.0f), above);
}

}  // namespace tessera::core
