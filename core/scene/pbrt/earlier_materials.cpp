// SPDX-License-Identifier: Apache-2.0
// Materials of pbrt-v3, as the nearest of pbrt-v4.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/scene/loader/wording.hpp"
#include "core/scene/pbrt/materials.hpp"

namespace tessera::core::pbrt {

Materials::Model Materials::earlier_model(const std::string& type, const Parameters& p) {
  constexpr std::string_view kKnown[] = {"matte", "plastic",   "metal",       "glass", "mirror",
                                         "uber",  "substrate", "translucent", "disney"};
  if (std::find(std::begin(kKnown), std::end(kKnown), type) == std::end(kKnown)) return unknown(type, p);
  const std::string text =
      fmt::format("the material {} is one of pbrt-v3; the nearest of pbrt-v4 is used", in_quotes(type));
  report_.warn(p.place(), text, text);
  if (type == "matte") return diffuse(p, "Kd");
  if (type == "plastic") return plastic_of_version_3(p, 0.1f);
  if (type == "substrate") return plastic_of_version_3(p, 0.1f);
  if (type == "metal") return conductor(p);
  if (type == "glass") return glass_of_version_3(p);
  if (type == "uber") return uber_of_version_3(p);
  if (type == "disney") return disney_of_version_3(p);
  if (type == "translucent") {
    auto reflected = color(p, "Kd", Rgb::gray(0.25f));
    if (!reflected) return fail(reflected.error());
    const Rgb half = reflected->value * 0.5f;
    return DiffuseTransmission{{half, reflected->texture}, {half, reflected->texture}};
  }
  auto reflectance = color(p, "Kr", Rgb::gray(0.9f));
  if (!reflectance) return fail(reflectance.error());
  return Mirror{*reflectance};
}

Materials::Model Materials::plastic_of_version_3(const Parameters& p, float default_roughness) {
  auto diffuse = color(p, "Kd", Rgb::gray(0.25f));
  if (!diffuse) return fail(diffuse.error());
  auto specular = color(p, "Ks", Rgb::gray(0.25f));
  if (!specular) return fail(specular.error());
  auto rough = roughness(p, "", default_roughness, false);
  if (!rough) return fail(rough.error());
  Plastic plastic;
  plastic.diffuse = *diffuse;
  plastic.specular = *specular;
  plastic.roughness = rough->value;
  return plastic;
}

Materials::Model Materials::glass_of_version_3(const Parameters& p) {
  auto reflected = color(p, "Kr", Rgb::gray(1));
  if (!reflected) return fail(reflected.error());
  auto transmitted = color(p, "Kt", Rgb::gray(1));
  if (!transmitted) return fail(transmitted.error());
  auto glass = dielectric(p, p.has("index") ? "index" : "eta");
  if (!glass) return glass;
  auto& made = std::get<Glass>(*glass);
  made.reflectance = *reflected;
  made.transmittance = *transmitted;
  return glass;
}

Materials::Model Materials::uber_of_version_3(const Parameters& p) {
  for (const char* ignored : {"Kr", "Kt", "opacity"})
    if (p.has(ignored))
      report_.warn(p.place(),
                   "Kr, Kt and opacity of the material 'uber' are not supported; they are ignored");
  auto plastic = plastic_of_version_3(p, 0.1f);
  if (!plastic) return plastic;
  std::get<Plastic>(*plastic).ior = index_of_refraction(p, p.has("index") ? "index" : "eta", 1.5f);
  return plastic;
}

// Its diffuse transmission goes up to 2.
Materials::Model Materials::disney_of_version_3(const Parameters& p) {
  auto base = color(p, "color", Rgb::gray(0.5f));
  if (!base) return fail(base.error());
  Disney surface;
  surface.base_color = *base;
  surface.thin_walled = p.boolean("thin", false);
  struct Weight {
    const char* name;
    ScalarParameter& value;
    float otherwise, most;
  };
  const Weight weights[] = {
      {"metallic", surface.metallic, 0, 1},
      {"roughness", surface.roughness, 0.5f, 1},
      {"anisotropic", surface.anisotropic, 0, 1},
      {"speculartint", surface.specular_tint, 0, 1},
      {"spectrans", surface.specular_transmission, 0, 1},
      {"flatness", surface.flatness, 0, 1},
      {"sheen", surface.sheen, 0, 1},
      {"sheentint", surface.sheen_tint, 0.5f, 1},
      {"clearcoat", surface.clearcoat, 0, 1},
      {"clearcoatgloss", surface.clearcoat_gloss, 1, 1},
      {"difftrans", surface.diffuse_transmission, 1, 2},
  };
  for (const auto& [name, value, otherwise, most] : weights) {
    auto read = scalar(p, name, otherwise, most);
    if (!read) return fail(read.error());
    value = *read;
  }
  surface.diffuse_transmission.value /= 2;
  if (!surface.thin_walled) surface.diffuse_transmission = 0;
  surface.ior = index_of_refraction(p, "eta", 1.5f);
  const Rgb distance =
      p.has("scatterdistance") ? colors_.color(p, "scatterdistance", SpectrumRole::kUnbounded, {}) : Rgb{};
  if (!is_black(distance))
    report_.warn(p.place(), "the subsurface scattering of 'disney' is not supported; it reflects diffusely");
  return surface;
}

}  // namespace tessera::core::pbrt
