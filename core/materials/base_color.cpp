// SPDX-License-Identifier: Apache-2.0
#include "core/materials/base_color.hpp"

#include <algorithm>

#include "core/base/overloaded.hpp"
#include "core/materials/hair.hpp"

namespace tessera::core {
namespace {

Rgb within_unit(Rgb color) {
  const auto limited = [](float value) { return value > 0 ? std::min(value, 1.0f) : 0.0f; };
  return {limited(color.r), limited(color.g), limited(color.b)};
}

// The reflectance of a metal in air at normal incidence.
float normal_reflectance(float eta, float k) {
  const float below = (eta - 1) * (eta - 1) + k * k, above = (eta + 1) * (eta + 1) + k * k;
  return above > 0 ? below / above : 0;
}
Rgb normal_reflectance(Rgb eta, Rgb k) {
  return {normal_reflectance(eta.r, k.r), normal_reflectance(eta.g, k.g), normal_reflectance(eta.b, k.b)};
}

}  // namespace

Rgb base_color_at(const Material& material, const std::vector<Texture>& textures, const TexturePoint& point,
                  Rgb tint) {
  const auto at = [&](const auto& parameter) { return parameter.evaluate(textures, point); };
  const Rgb color = std::visit(
      Overloaded{
          [&](const Lambert& m) { return at(m.albedo) * tint; },
          [&](const Mirror& m) { return at(m.reflectance) * tint; },
          [&](const Phong& m) { return at(m.diffuse) * tint + at(m.specular); },
          [&](const CookTorrance& m) {
            if (m.conductor) {
              const ComplexIndex index = complex_index(*m.conductor);
              return at(m.diffuse) * tint + at(m.specular) * normal_reflectance(index.eta, index.k);
            }
            const Rgb f0 = at(m.f0) * (f0_is_base_color(m) ? tint : Rgb::gray(1));
            return at(m.diffuse) * tint + at(m.specular) * f0;
          },
          [&](const Principled& m) {
            const float transmitted = std::clamp(at(m.transmission_weight), 0.0f, 1.0f);
            const Rgb base = at(m.base_color) * tint * at(m.base_weight);
            return base * (1 - transmitted) + at(m.transmission_color) * transmitted;
          },
          [&](const Disney& m) { return at(m.base_color) * tint; },
          [&](const Plastic& m) { return at(m.diffuse) * tint; },
          [&](const ConductorMaterial& m) { return at(m.specular) * normal_reflectance(at(m.eta), at(m.k)); },
          [&](const DiffuseTransmission& m) { return (at(m.reflectance) + at(m.transmittance)) * tint; },
          [&](const Glass& m) { return at(m.transmittance); },
          [&](const ThinDielectric& m) { return at(m.transmittance); },
          [](const Blend&) { return Rgb{}; },
          [](const Null&) { return Rgb{}; },
          [&](const Hair& m) {
            const MaterialPoint seen{textures, point, true, tint};
            const Rgb absorption = absorption_of(ModelAt<float, Hair>(&m, seen));
            return hair_color(absorption, std::clamp(at(m.beta_n), 0.0f, 1.0f)) * tint;
          },
      },
      material.model);
  return within_unit(color);
}

}  // namespace tessera::core
