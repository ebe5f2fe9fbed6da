// SPDX-License-Identifier: Apache-2.0
// The pigment of hair (core/shading/hair_bsdf.hpp). T is float for one point, or FloatN for one in each lane.
// Stateless; thread-safe.
#pragma once

#include <array>

#include "core/materials/material.hpp"
#include "core/materials/model_at.hpp"
#include "core/math/elementary.hpp"

namespace tessera::core {

// Below this, lobes are too narrow for the numbers that sample them.
inline constexpr float kMinHairRoughness = 0.02f;

// The polynomial of Chiang et al. 2016, equation 9, in the azimuthal roughness.
template <typename T>
WideOf<T> hair_multiple_scattering(T beta_n) {
  const WideOf<T> b = widened(clamp_between(beta_n, kMinHairRoughness, 1.0f));
  return 5.969 + b * (-0.215 + b * (2.532 + b * (-10.73 + b * (5.574 + b * 0.245))));
}

// The absorption per hair radius that gives hair the reflectance `color` in thick hair, and its inverse
// (Chiang et al. 2016, equation 9).
template <typename T>
RgbOf<T> hair_absorption(RgbOf<T> color, std::type_identity_t<T> beta_n) {
  const WideOf<T> scale = 1 / hair_multiple_scattering<T>(beta_n);
  const auto channel = [scale](T c) {
    constexpr float kDarkest = 1e-4f;
    const WideOf<T> x = log(widened(clamp_between(c, kDarkest, 1.0f))) * scale;
    return to_float(x * x);
  };
  return {channel(color.r), channel(color.g), channel(color.b)};
}
Rgb hair_color(Rgb absorption, float beta_n);

// The absorption of a concentration of eumelanin (brown) and pheomelanin (red) (d'Eon et al. 2011).
template <typename T>
RgbOf<T> melanin_absorption(T eumelanin, T pheomelanin) {
  const T brown = larger(eumelanin, T(0.0f)), red = larger(pheomelanin, T(0.0f));
  return RgbOf<T>{0.419f * brown, 0.697f * brown, 1.37f * brown} +
         RgbOf<T>{0.187f * red, 0.4f * red, 1.05f * red};
}

// What the model absorbs at a point.
template <typename T>
RgbOf<T> absorption_of(const ModelAt<T, Hair>& model) {
  const auto has = [&](HairPigment pigment) {
    return model.holds([pigment](const Hair& m) { return m.pigment == pigment; });
  };
  const MaskOf<T> reflects = has(HairPigment::kReflectance), absorbs = has(HairPigment::kAbsorption);
  RgbOf<T> absorption;
  if (!all(reflects | absorbs))
    absorption = melanin_absorption(model(&Hair::eumelanin), model(&Hair::pheomelanin));
  if (any(reflects))
    absorption =
        select(reflects, hair_absorption(model(&Hair::reflectance), model(&Hair::beta_n)), absorption);
  return any(absorbs) ? select(absorbs, model(&Hair::sigma_a), absorption) : absorption;
}

}  // namespace tessera::core
