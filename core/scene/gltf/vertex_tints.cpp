// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/vertex_tints.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <tuple>

namespace tessera::core::gltf {
namespace {

// What is no number becomes 0.
float in_unit(float value) {
  return value > 0 ? std::min(value, 1.0f) : 0.0f;
}

using Corners = std::array<VertexTint, 3>;

bool differ(const Corners& corners) {
  return !(corners[0] == corners[1] && corners[1] == corners[2]);
}

VertexTint mean_of(const Corners& corners) {
  if (!differ(corners)) return corners[0];
  const Rgb color = (corners[0].color + corners[1].color + corners[2].color) / 3.0f;
  return {color, (corners[0].alpha + corners[1].alpha + corners[2].alpha) / 3};
}

VertexTint rounded(const VertexTint& tint, int steps) {
  const auto scale = static_cast<float>(steps);
  const auto round = [scale](float value) { return std::round(value * scale) / scale; };
  return {{round(tint.color.r), round(tint.color.g), round(tint.color.b)}, round(tint.alpha)};
}

// At most one more than `max`.
std::size_t count_different(const std::vector<VertexTint>& tints, std::size_t max) {
  std::set<std::tuple<float, float, float, float>> different;
  for (const auto& [color, alpha] : tints) {
    different.emplace(color.r, color.g, color.b, alpha);
    if (different.size() > max) break;
  }
  return different.size();
}

}  // namespace

TriangleTints triangle_tints(const MeshDescription& mesh, const std::vector<Rgb>& colors,
                             const std::vector<float>& alphas) {
  TriangleTints result;
  const auto tint_of = [&](std::uint32_t vertex) {
    const Rgb color = colors.empty() ? Rgb::gray(1) : colors[vertex];
    return VertexTint{{in_unit(color.r), in_unit(color.g), in_unit(color.b)},
                      alphas.empty() ? 1 : in_unit(alphas[vertex])};
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    const Corners corners{tint_of(a), tint_of(b), tint_of(c)};
    result.varies_in_triangles |= differ(corners);
    result.tints.push_back(mean_of(corners));
  }
  const std::vector<VertexTint> exact = result.tints;
  for (const int steps : {255, 63, 15, 7, 3}) {
    if (count_different(result.tints, kMaxVertexTints) <= kMaxVertexTints) break;
    result.steps = steps;
    for (std::size_t i = 0; i < exact.size(); ++i) result.tints[i] = rounded(exact[i], steps);
  }
  return result;
}

}  // namespace tessera::core::gltf
