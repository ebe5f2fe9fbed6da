// SPDX-License-Identifier: Apache-2.0
// Clamps for texture-evaluated parameters, so that surfaces conserve energy. T is float or FloatN.
#pragma once

#include "core/materials/microfacet.hpp"
#include "core/math/rgb.hpp"

namespace tessera::core {

// The largest index of refraction, and the least relative to what is outside, among nested dielectrics.
inline constexpr float kMaxIor = 10, kMinRelativeIor = 1 / kMaxIor;

// With indices of refraction that differ less, floats cannot recover the half vector from the directions.
inline constexpr float kMinBending = 1e-3f;

template <typename T>
T squared_roughness(T roughness) {
  const T r = select(roughness < 0, T(0.0f), select(roughness > 1, T(1.0f), roughness));
  return r * r;
}

// The alpha of a surface that is always treated as rough.
template <typename T>
GgxOf<T> rough_ggx(T roughness) {
  return GgxOf<T>(larger(squared_roughness(roughness), T(kMinAlpha)));
}

// The scale of the diffuse and the specular part.
template <typename T>
RgbOf<T> normalize_energy(RgbOf<T> diffuse, RgbOf<T> specular) {
  const RgbOf<T> sum = diffuse + specular;
  return {1 / larger(T(1.0f), sum.r), 1 / larger(T(1.0f), sum.g), 1 / larger(T(1.0f), sum.b)};
}

}  // namespace tessera::core
