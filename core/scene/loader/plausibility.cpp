// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/plausibility.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <variant>
#include <vector>

#include "core/base/overloaded.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

// The parameters that are reflectances or transmittances.
std::vector<ColorParameter> shares_of(const MaterialModel& model) {
  std::vector<ColorParameter> shares;
  const auto add = [&](std::string_view key, const ColorParameter& parameter) {
    if (key != "eta" && key != "k" && key != "sigma_a") shares.push_back(parameter);
  };
  visit_parameters(model, Overloaded{add, [](auto, const ScalarParameter&) {}});
  return shares;
}

}  // namespace

void check_plausibility(const SceneDescription& scene, const std::vector<Place>& material_places,
                        const Place& shapes_place, Mistakes& mistakes) {
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    for (const auto& share : shares_of(scene.materials[i].model)) {
      if (share.texture < 0) continue;
      const Texture& texture = scene.textures[static_cast<std::size_t>(share.texture)];
      const float largest = max_component(texture.image->largest() * share.value);
      if (largest > 1)
        mistakes.add(
            i < material_places.size() ? material_places[i] : shapes_place,
            fmt::format(
                "the texture of material {} times 'tint' reaches {}, and nothing reflects more than 1",
                in_quotes(scene.materials[i].name), largest));
    }
  }
}

}  // namespace tessera::core
