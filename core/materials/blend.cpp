// SPDX-License-Identifier: Apache-2.0
#include "core/materials/blend.hpp"

#include <algorithm>

#include "core/textures/opacity.hpp"

namespace tessera::core {
namespace {

// The opaque part of what each of a blend's materials covers.
struct Coverage {
  float first, second;
};

Coverage coverage_at(const Blend& blend, const std::vector<Material>& all,
                     const std::vector<Texture>& textures, Vec2 uv) {
  const float weight = std::clamp(blend.weight.evaluate(textures, uv), 0.0f, 1.0f);
  const auto of = [&](std::uint32_t part, float share) {
    return share > 0 ? share * opacity_at(all[part], all, textures, uv) : 0.0f;
  };
  return {of(blend.first, 1 - weight), of(blend.second, weight)};
}

}  // namespace

float opacity_at(const Material& material, const std::vector<Material>& all,
                 const std::vector<Texture>& textures, Vec2 uv) {
  if (std::holds_alternative<Null>(material.model)) return 0;
  const float own = opacity_at(material.opacity, textures, uv);
  const auto* blend = std::get_if<Blend>(&material.model);
  if (blend == nullptr || own == 0) return own;
  const auto [first, second] = coverage_at(*blend, all, textures, uv);
  return own * std::min(1.0f, first + second);
}

const Material& scatterer_at(const Material& material, const std::vector<Material>& all,
                             const std::vector<Texture>& textures, Vec2 uv, float u) {
  const Material* scatterer = &material;
  while (const auto* blend = std::get_if<Blend>(&scatterer->model)) {
    const auto [first, second] = coverage_at(*blend, all, textures, uv);
    const float share = first + second > 0 ? first / (first + second) : 1;
    const bool is_first = u < share;
    u = is_first ? u / share : (u - share) / (1 - share);
    scatterer = &all[is_first ? blend->first : blend->second];
  }
  return *scatterer;
}

}  // namespace tessera::core
