// SPDX-License-Identifier: Apache-2.0
#include "core/scene/writer/material_text.hpp"

#include <variant>

#include "core/scene/tables/effective_keys.hpp"
#include "core/scene/tables/material_tables.hpp"

namespace tessera::core {
namespace {

using json_text::Object;

// Keys without a member.
template <typename Model>
void add_others(const Model&, const SceneNames&, Object&) {}
void add_others(const Blend& model, const SceneNames& names, Object& object) {
  object.add("materials", json_text::list({json_text::text(names.materials[model.first]),
                                           json_text::text(names.materials[model.second])}));
}

}  // namespace

std::string material_text(const Material& material, const SceneNames& names, const ParameterTracks& tracks) {
  Object object;
  object.add("type", json_text::text(scene_keys::kMaterialTypes[material.model.index()]));
  TableWriter writer(names, object);
  std::visit(
      [&]<typename Model>(const Model& model) {
        writer.write(kKeys<Model>, model, tracks,
                     [&](std::string_view key) { return has_effect(model, key); });
        add_others(model, names, object);
        writer.write(kCommonKeys<Model>, material, tracks);
      },
      material.model);
  return object.on_one_line();
}

}  // namespace tessera::core
