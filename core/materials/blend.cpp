// SPDX-License-Identifier: Apache-2.0
#include "core/materials/blend.hpp"

#include <algorithm>

#include "core/textures/opacity.hpp"

namespace tessera::core {
namespace {

// Where a material is met.
struct MeetingPoint {
  const std::vector<Material>& all;
  const std::vector<Texture>& textures;
  const TexturePoint& point;
  float cosine;
  bool from_behind;

  Interception of(const Material& material) const {
    return interception_at(material, all, textures, point, cosine, from_behind);
  }
};

// What each of a blend's materials does, weighted.
struct BlendParts {
  Interception first{.hit = 0}, second{.hit = 0};
};

BlendParts parts_at(const Blend& blend, const MeetingPoint& at) {
  const float back = at.from_behind ? 1.0f : 0.0f;
  const float weight =
      blend.by_side ? back : std::clamp(blend.weight.evaluate(at.textures, at.point), 0.0f, 1.0f);
  const auto of = [&](std::uint32_t part, float share) -> Interception {
    if (!(share > 0)) return {.hit = 0};
    const auto [hit, transmittance] = at.of(at.all[part]);
    return {share * hit, transmittance * share};
  };
  return {of(blend.first, 1 - weight), of(blend.second, weight)};
}

// With all reflections between its two sides (Born and Wolf 1999, section 7.6, without interference).
Interception pane_at(const ThinDielectric& pane, const MeetingPoint& at) {
  const float ior = std::clamp(pane.ior.evaluate(at.textures, at.point), 1.0f, kMaxIor);
  const float one_side = fresnel_dielectric(at.cosine, ior), reflected = 2 * one_side / (1 + one_side);
  return {reflected, pane.transmittance.evaluate(at.textures, at.point) * (1 - reflected)};
}

Interception model_at(const Material& material, const MeetingPoint& at) {
  if (std::holds_alternative<Null>(material.model)) return {0, Rgb::gray(1)};
  if (const auto* blend = std::get_if<Blend>(&material.model)) {
    const auto [first, second] = parts_at(*blend, at);
    return {std::min(1.0f, first.hit + second.hit), first.transmittance + second.transmittance};
  }
  if (!passes_straight(material)) return {};
  if (const auto* pane = std::get_if<ThinDielectric>(&material.model)) return pane_at(*pane, at);
  return {0, std::get_if<Glass>(&material.model)->transmittance.evaluate(at.textures, at.point)};
}

}  // namespace

Interception interception_at(const Material& material, const std::vector<Material>& all,
                             const std::vector<Texture>& textures, const TexturePoint& point, float cosine,
                             bool from_behind) {
  const float opacity = opacity_at(material.opacity, textures, point);
  if (opacity == 0) return {0, Rgb::gray(1)};
  const auto [hit, transmittance] = model_at(material, {all, textures, point, cosine, from_behind});
  return {opacity * hit, Rgb::gray(1 - opacity) + transmittance * opacity};
}

const Material& scatterer_at(const Material& material, const std::vector<Material>& all,
                             const std::vector<Texture>& textures, const TexturePoint& point, float cosine,
                             float u, bool from_behind) {
  const Material* scatterer = &material;
  while (const auto* blend = std::get_if<Blend>(&scatterer->model)) {
    const auto parts = parts_at(*blend, {all, textures, point, cosine, from_behind});
    const float first = parts.first.hit, second = parts.second.hit;
    const float share = first + second > 0 ? first / (first + second) : 1;
    const bool is_first = u < share;
    u = is_first ? u / share : (u - share) / (1 - share);
    scatterer = &all[is_first ? blend->first : blend->second];
  }
  return *scatterer;
}

}  // namespace tessera::core
