// SPDX-License-Identifier: Apache-2.0
// Corrections for surfaces whose shading normal (interpolated or from a map) differs from the geometric
// one. They conserve energy, prevent light leaks and leave no facet black; see docs/materials.md. All
// vectors have unit length. `side` is the geometric normal on the side of the viewer, who looks along -wo.
#pragma once

#include "core/math/vec3.hpp"

namespace tessera::core::integrators {

inline constexpr float kMinShadingCos = 1e-4f;

// Tilts `w` towards `normal` just far enough that their cosine is at least min_cos.
template <typename T>
Vec3Of<T> clamped_to_hemisphere(Vec3Of<T> w, Vec3Of<T> normal, T min_cos) {
  const T cos_w = dot(w, normal);
  const MaskOf<T> high = cos_w >= min_cos;
  return all(high) ? w : select(high, w, normalize(w + normal * (min_cos - cos_w)));
}

// Tilts `normal` just far enough that wo is above its plane.
template <typename T = float>
Vec3Of<T> clamp_toward_viewer(Vec3Of<T> normal, Vec3Of<T> wo) {
  return clamped_to_hemisphere(normal, wo, T(kMinShadingCos));
}

// Tilts `normal` just far enough that the mirror direction of wo is above the geometric surface (Keller et
// al. 2017).
template <typename T = float>
Vec3Of<T> ensure_valid_reflection(Vec3Of<T> normal, Vec3Of<T> side, Vec3Of<T> wo) {
  const Vec3Of<T> mirrored = normal * (2 * dot(wo, normal)) - wo;
  // At grazing incidence the mirror direction may graze too.
  const T min_cos = smaller(T(0.01f), 0.9f * dot(wo, side));
  const MaskOf<T> high = dot(mirrored, side) >= min_cos;
  return all(high) ? normal
                   : select(high, normal, normalize(wo + clamped_to_hemisphere(mirrored, side, min_cos)));
}

// Clamps `wi` to graze the geometric surface if it is not on the side of `side`.
template <typename T = float>
Vec3Of<T> clamp_above_surface(Vec3Of<T> wi, Vec3Of<T> side) {
  return clamped_to_hemisphere(wi, side, T(kMinShadingCos));
}

// The directions below are local: +z is the shading normal, `side` the geometric normal in that frame.

// Reflects `w`, whose cosine with `side` is cos_side, at the plane of the geometric surface.
template <typename T = float>
Vec3Of<T> mirrored(Vec3Of<T> w, Vec3Of<T> side, T cos_side) {
  return w - side * (2 * cos_side);
}

// The cosine with which diffuse reflection receives light. The surface is modelled as one wall of a
// symmetric V-groove, whose other wall shadows it at grazing angles (Torrance and Sparrow 1967; Blinn
// 1977). Its integral over the directions above both planes is pi * side.z, which diffuse_scale()
// compensates.
template <typename T = float>
T groove_cos(T cos_shading, T cos_side, Vec3Of<T> side) {
  return smaller(cos_shading, 2 * side.z * cos_side);
}

// The area of the groove's wall per unit of surface area.
template <typename T = float>
T diffuse_scale(Vec3Of<T> side) {
  return 1 / side.z;
}

}  // namespace tessera::core::integrators
