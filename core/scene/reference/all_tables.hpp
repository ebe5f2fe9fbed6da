// SPDX-License-Identifier: Apache-2.0
// All tables of keys, with the names of their types. Stateless.
#pragma once

#include <string>
#include <type_traits>
#include <variant>

#include "core/scene/tables/camera_tables.hpp"
#include "core/scene/tables/light_tables.hpp"
#include "core/scene/tables/material_tables.hpp"
#include "core/scene/tables/medium_tables.hpp"
#include "core/scene/tables/shape_tables.hpp"
#include "core/scene/tables/texture_tables.hpp"

namespace tessera::core {

// Calls visit(type, word) for each alternative of the variant, with its word.
template <typename Variant, typename Visit>
void for_each_type(std::span<const std::string_view> words, const Visit& visit) {
  [&]<std::size_t... index>(std::index_sequence<index...>) {
    (visit(std::type_identity<std::variant_alternative_t<index, Variant>>(), words[index]), ...);
  }
  (std::make_index_sequence<std::variant_size_v<Variant>>());
}

// Calls visit(owner type, name, table): "glass", "material" (the keys that all materials have), "camera".
template <typename Visit>
void for_each_table(const Visit& visit) {
  const auto visit_own = [&]<typename T>(std::type_identity<T> type, std::string_view name) {
    visit(type, name, kKeys<T>);
  };
  visit_own(std::type_identity<CameraDescription>(), "camera");
  for_each_type<Pattern>(scene_keys::kPatternTypes, visit_own);
  visit_own(std::type_identity<ProceduralTexture>(), "procedural_texture");
  for_each_type<MaterialModel>(scene_keys::kMaterialTypes, visit_own);
  visit_own(std::type_identity<Material>(), "material");
  visit_own(std::type_identity<MediumDescription>(), "medium");
  for_each_type<LightDescription>(scene_keys::kLightTypes, visit_own);
  visit_own(std::type_identity<lights::ProjectedImage>(), "projected_image");
  visit_own(std::type_identity<EnvironmentDescription>(), "environment");
  for_each_type<ShapeKeys>(scene_keys::kShapeTypes, visit_own);
}

}  // namespace tessera::core
