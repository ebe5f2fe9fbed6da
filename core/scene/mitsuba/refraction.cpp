// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/refraction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "core/base/letter_case.hpp"
#include "core/base/suggestion.hpp"
#include "core/materials/material.hpp"

namespace tessera::core::mitsuba {
namespace {

constexpr std::pair<std::string_view, float> kDielectrics[] = {
    {"vacuum", 1.0f},      {"helium", 1.000036f},        {"hydrogen", 1.000132f},
    {"air", 1.000277f},    {"carbon dioxide", 1.00045f}, {"water", 1.3330f},
    {"acetone", 1.36f},    {"ethanol", 1.361f},          {"carbon tetrachloride", 1.461f},
    {"glycerol", 1.4729f}, {"benzene", 1.501f},          {"silicone oil", 1.52045f},
    {"bromine", 1.661f},   {"water ice", 1.31f},         {"fused quartz", 1.458f},
    {"pyrex", 1.470f},     {"acrylic glass", 1.49f},     {"polypropylene", 1.49f},
    {"bk7", 1.5046f},      {"sodium chloride", 1.544f},  {"amber", 1.55f},
    {"pet", 1.5750f},      {"diamond", 2.419f},
};

struct NamedMetal {
  std::string_view name;
  Metal metal;
};

// Those without published indices here have those of the nearest reflectance in the visible.
constexpr NamedMetal kMetals[] = {
    {"Ag", {Conductor::kSilver}},
    {"Al", {Conductor::kAluminium}},
    {"Au", {Conductor::kGold}},
    {"Be", {Conductor::kBeryllium}},
    {"Cr", {Conductor::kChromium}},
    {"CsI", {Conductor::kCaesiumIodide}},
    {"Cu", {Conductor::kCopper}},
    {"CuZn", {Conductor::kBrass}},
    {"d-C", {Conductor::kDiamond}},
    {"Hg", {Conductor::kMercury}},
    {"MgO", {Conductor::kMagnesiumOxide}},
    {"Ni", {Conductor::kNickel}},
    {"SiC", {Conductor::kSiliconCarbide}},
    {"TiN", {Conductor::kTitaniumNitride}},
    {"TiO2", {Conductor::kTitaniumDioxide}},
    {"TiO2-e", {Conductor::kTitaniumDioxideExtraordinary}},
    {"W", {Conductor::kTungsten}},
    {"a-C", {Conductor::kSiliconCarbide, true}},
    {"AlAs", {Conductor::kTitaniumDioxideExtraordinary, true}},
    {"AlSb", {Conductor::kTungsten, true}},
    {"CuO", {Conductor::kSiliconCarbide, true}},
    {"Cu2O", {Conductor::kTitaniumDioxideExtraordinary, true}},
    {"HgTe", {Conductor::kTungsten, true}},
    {"Ir", {Conductor::kMercury, true}},
    {"K", {Conductor::kSilver, true}},
    {"Li", {Conductor::kAluminium, true}},
    {"Mo", {Conductor::kChromium, true}},
    {"Na", {Conductor::kSilver, true}},
    {"Nb", {Conductor::kTungsten, true}},
    {"Rh", {Conductor::kMercury, true}},
    {"Se", {Conductor::kTitaniumDioxideExtraordinary, true}},
    {"Se-e", {Conductor::kTitaniumDioxideExtraordinary, true}},
    {"SnTe", {Conductor::kTungsten, true}},
    {"Ta", {Conductor::kTungsten, true}},
    {"Te", {Conductor::kTungsten, true}},
    {"Te-e", {Conductor::kTungsten, true}},
    {"ThF4", {Conductor::kMagnesiumOxide, true}},
    {"TiC", {Conductor::kTungsten, true}},
    {"VC", {Conductor::kTungsten, true}},
    {"V", {Conductor::kBeryllium, true}},
    {"VN", {Conductor::kTungsten, true}},
};

}  // namespace

std::optional<float> refractive_index(std::string_view name) {
  const std::string lower = in_lower_case(name);
  for (const auto& [known, index] : kDielectrics)
    if (known == lower) return index;
  return std::nullopt;
}

float refractive_index(const Plugin& plugin, std::string_view name, std::string_view otherwise) {
  const float missing = refractive_index(otherwise).value_or(1);
  const Property* property = plugin.property(name);
  if (property == nullptr) return missing;
  const auto* written = std::get_if<std::string>(&property->value);
  if (written == nullptr) return plugin.real(name, missing);
  const auto known = refractive_index(*written);
  if (!known)
    plugin.warn(fmt::format("there is no dielectric {}; {} replaces it", in_quotes(*written), otherwise));
  return known.value_or(missing);
}

// Mitsuba has the indices of several metals by two sources; those of Palik have names of their own.
std::optional<Metal> find_metal(std::string_view name) {
  constexpr std::string_view kPalik = "_palik";
  if (name.ends_with(kPalik)) name.remove_suffix(kPalik.size());
  for (const auto& [known, metal] : kMetals)
    if (known == name) return metal;
  return std::nullopt;
}

Boundary boundary_of(const Plugin& plugin, std::string_view default_inside) {
  const float inside = refractive_index(plugin, "int_ior", default_inside);
  const float outside = refractive_index(plugin, "ext_ior", "air");
  if (!(inside > 0 && outside > 0)) {
    plugin.warn("an index of refraction is not above 0; 1 replaces both");
    return {};
  }
  const bool is_reversed = inside < outside;
  const float ratio = is_reversed ? outside / inside : inside / outside;
  if (ratio > kMaxIor)
    plugin.warn(fmt::format("the ratio of the indices of refraction is limited to {}", kMaxIor));
  return {std::min(ratio, kMaxIor), is_reversed};
}

}  // namespace tessera::core::mitsuba
