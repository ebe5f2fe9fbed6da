// SPDX-License-Identifier: Apache-2.0
#include "core/scene/absorbing_media.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "core/math/elementary.hpp"

namespace tessera::core {
namespace {

// Absorption beyond it is black after any distance that matters.
constexpr float kMinTransmittance = 1e-6f;

float absorption(float transmittance, float depth) {
  const double share = static_cast<double>(std::clamp(transmittance, kMinTransmittance, 1.0f));
  return static_cast<float>(
      std::min(-log(share) / static_cast<double>(depth), double{kMaxMediumCoefficient}));
}

}  // namespace

Rgb absorption_of(Rgb color, float depth) {
  return {absorption(color.r, depth), absorption(color.g, depth), absorption(color.b, depth)};
}

void add_absorbing_media(std::vector<Material>& materials, std::vector<MediumDescription>& media) {
  const auto first_added = static_cast<int>(media.size());
  const auto is_added = [&](const Material& material) { return material.media.interior >= first_added; };
  for (Material& material : materials) {
    if (const auto* blend = std::get_if<Blend>(&material.model)) {
      // Its parts stand before it. What names a medium keeps it; of two parts that absorb, the first counts.
      for (const std::uint32_t part : {blend->second, blend->first})
        if (is_added(materials[part]) && (material.media.interior == kNoMedium || is_added(material)))
          material.media.interior = materials[part].media.interior;
      continue;
    }
    const auto* solid = std::get_if<Principled>(&material.model);
    if (solid == nullptr || !absorbs_inside(*solid) || material.media.interior != kNoMedium) continue;
    MediumDescription medium;
    medium.name = material.name;
    medium.sigma_a = absorption_of(solid->transmission_color.value, solid->transmission_depth.value);
    material.media.interior = static_cast<int>(media.size());
    media.push_back(std::move(medium));
  }
}

}  // namespace tessera::core
