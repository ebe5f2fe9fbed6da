// SPDX-License-Identifier: Apache-2.0
// KHR_materials_pbrSpecularGlossiness, which is older than KHR_materials_specular: a diffuse colour below a
// boundary of any reflectance F0 becomes a dielectric, or a mixture of one and a metal.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/materials/fresnel.hpp"
#include "core/materials/limits.hpp"
#include "core/scene/gltf/materials.hpp"

namespace tessera::core::gltf {
namespace {

struct Mixture {
  Rgb base_color;
  float metalness = 0;
  Rgb specular_color = Rgb::gray(1);
};

// As the extension's text weighs channels.
float brightness(Rgb color) {
  return std::sqrt(0.299f * color.r * color.r + 0.587f * color.g * color.g + 0.114f * color.b * color.b);
}

// The share of a dielectric of reflectance `dielectric` such that, for grays, (1 - metalness) base = diffuse
// and metalness base + (1 - metalness) dielectric = f0.
float dielectric_share(float diffuse, float f0, float dielectric) {
  if (f0 <= dielectric) return 1;
  const float sum = f0 + diffuse;
  return 2 * diffuse / (sum + std::sqrt(std::max(0.0f, sum * sum - 4 * dielectric * diffuse)));
}

float kept_in_unit(float value) {
  return std::clamp(value, 0.0f, 1.0f);
}

// The metal takes what the dielectric cannot reflect; what remains of one channel's F0 tints the dielectric.
Mixture mixture_of(Rgb diffuse, Rgb f0, float dielectric) {
  const Rgb below = diffuse * (1 - max_component(f0));
  const float share = dielectric_share(brightness(below), brightness(f0), dielectric), metal = 1 - share;
  const auto base = [&](float diffuse_part, float reflected) {
    if (metal <= 0) return diffuse_part;
    const float of_metal = (reflected - dielectric * share) / metal;
    return kept_in_unit(share > 0 ? of_metal * metal * metal + diffuse_part / share * (1 - metal * metal)
                                  : of_metal);
  };
  const auto tint = [&](float reflected, float base_part) {
    const float boundary = dielectric * share;
    return boundary > 0 ? kept_in_unit((reflected - metal * base_part) / boundary) * share + metal : 1;
  };
  const Rgb color{base(below.r, f0.r), base(below.g, f0.g), base(below.b, f0.b)};
  return {color, metal, {tint(f0.r, color.r), tint(f0.g, color.g), tint(f0.b, color.b)}};
}

}  // namespace

// Without a texture of F0, the index is that of its reflectance as far as there is one.
void Materials::add_specular_glossiness(const Value& extension, Principled& model) {
  const Value f0_info = extension["specularGlossinessTexture"];
  const Rgb diffuse = model.base_color.value;
  const Rgb f0 = clamped(extension, extension.color_or("specularFactor", Rgb::gray(1)));
  const float strongest = max_component(f0);
  constexpr float kCommonIor = 1.5f;
  const bool is_dielectric = !f0_info.exists() && strongest <= normal_reflectance(kMaxIor);
  model.specular_ior = is_dielectric ? index_of_reflectance(strongest, kMaxIor) : kCommonIor;
  const float dielectric = is_dielectric ? strongest : normal_reflectance(kCommonIor);
  const Mixture even = mixture_of(diffuse, f0, dielectric);
  if (is_dielectric) {
    model.base_color.value = even.base_color;
    model.specular_color = {even.specular_color};
    return;
  }
  document_.warn(extension, "specular glossiness",
                 "specular-glossiness is approximated by a mixture of a dielectric and a metal");
  const std::vector<Textures::Input> inputs{{extension["diffuseTexture"], {ColorSpace::kSrgb}},
                                            {f0_info, {ColorSpace::kSrgb}}};
  const std::string name =
      fmt::format("{} {} {} {} {} {}", diffuse.r, diffuse.g, diffuse.b, f0.r, f0.g, f0.b);
  const auto texture = [&](const char* kind, ColorSpace space, const auto& value_of) {
    return textures_.combined(inputs, space, fmt::format("{} {}", kind, name),
                              [&](const std::vector<Rgb>& texels) {
                                return value_of(mixture_of(diffuse * texels[0], f0 * texels[1], dielectric));
                              });
  };
  const int base = texture("base", ColorSpace::kSrgb, [](const Mixture& m) { return m.base_color; });
  const int metal =
      texture("metal", ColorSpace::kLinear, [](const Mixture& m) { return Rgb::gray(m.metalness); });
  const int tint = texture("tint", ColorSpace::kSrgb, [](const Mixture& m) { return m.specular_color; });
  model.base_color = base < 0 ? ColorParameter{even.base_color} : ColorParameter{Rgb::gray(1), base};
  model.base_metalness = metal < 0 ? ScalarParameter(even.metalness) : ScalarParameter(1, metal);
  model.specular_color = tint < 0 ? ColorParameter{even.specular_color} : ColorParameter{Rgb::gray(1), tint};
}

}  // namespace tessera::core::gltf
