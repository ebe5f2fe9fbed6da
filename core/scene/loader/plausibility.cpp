#include "core/scene/loader/plausibility.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <variant>
#include <vector>

#include "core/base/overloaded.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

// The parameters that are shares of light.
std::vector<ColorParameter> shares_of(const MaterialModel& model) {
  std::vector<ColorParameter> shares;
  visit_parameters(model, Overloaded{[&](auto, const ColorParameter& share) { shares.push_back(share); },
                                     [](auto, const ScalarParameter&) {}});
  return shares;
}

// The largest value that a texture of floats gives; those of bytes end at 1.
float largest_value(const Texture& texture) {
  const auto* values = std::get_if<std::vector<float>>(&texture.image->texels);
  return values == nullptr ? 1.0f : *std::max_element(values->begin(), values->end());
}

}  // namespace

void check_plausibility(const SceneDescription& scene, const std::vector<Place>& material_places,
                        const Place& shapes_place, Mistakes& mistakes) {
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    for (const auto& share : shares_of(scene.materials[i].model)) {
      if (share.texture < 0) continue;
      const float largest =
          largest_value(scene.textures[static_cast<std::size_t>(share.texture)]) * max_component(share.value);
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
