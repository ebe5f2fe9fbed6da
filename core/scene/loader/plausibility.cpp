// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/plausibility.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <concepts>
#include <vector>

#include "core/scene/loader/wording.hpp"
#include "core/scene/priorities.hpp"
#include "core/scene/tables/material_tables.hpp"
#include "core/scene/validate_materials.hpp"

namespace tessera::core {
namespace {

// The parameters that are reflectances or transmittances.
std::vector<ColorParameter> shares_of(const Material& material) {
  std::vector<ColorParameter> shares;
  visit_keys(material, [&]<typename Value>(const auto& key, const Value& value) {
    if constexpr (std::same_as<Value, ColorParameter>)
      if (&key.domain == &domains::kShare) shares.push_back(value);
  });
  return shares;
}

void check_shares(const SceneDescription& scene, const std::vector<Place>& material_places,
                  const Place& shapes_place, Mistakes& mistakes) {
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    for (const auto& share : shares_of(scene.materials[i])) {
      if (share.texture < 0) continue;
      const Texture& texture = scene.textures[static_cast<std::size_t>(share.texture)];
      const float largest = max_component(texture.largest() * share.value);
      if (largest > 1)
        mistakes.add(
            i < material_places.size() ? material_places[i] : shapes_place,
            fmt::format(
                "the texture of material {} times 'tint' reaches {}, and nothing reflects more than 1",
                in_quotes(scene.materials[i].name), largest));
    }
  }
}

}  // namespace

void check_plausibility(const SceneDescription& scene, const std::vector<Place>& material_places,
                        const Place& shapes_place, Mistakes& mistakes) {
  check_shares(scene, material_places, shapes_place, mistakes);
  const auto refuse = [&](std::size_t i, std::string_view what) {
    if (i < material_places.size()) return mistakes.add(material_places[i], what);
    mistakes.add(shapes_place, fmt::format("material {}: {}", in_quotes(scene.materials[i].name), what));
  };
  check_each_material(scene, [&](std::size_t i, const Error& error) { refuse(i, error.message); });
  if (!mistakes.empty()) return;
  if (const auto mistake = find_priority_mistake(scene.materials)) refuse(mistake->material, mistake->what);
}

}  // namespace tessera::core
