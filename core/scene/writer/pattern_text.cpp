// SPDX-License-Identifier: Apache-2.0
#include "core/scene/writer/pattern_text.hpp"

#include <variant>

#include "core/scene/tables/texture_tables.hpp"

namespace tessera::core {

std::string pattern_text(const Texture& texture, const SceneNames& names) {
  const ProceduralTexture& procedural = *texture.procedural;
  json_text::Object object;
  object.add("type", json_text::text(scene_keys::kPatternTypes[procedural.pattern.index()]));
  TableWriter writer(names, object);
  std::visit(
      [&]<typename Kind>(const Kind& pattern) { writer.write(kKeys<Kind>, pattern, ParameterTracks()); },
      procedural.pattern);
  writer.write(kKeys<ProceduralTexture>, procedural, ParameterTracks());
  if (procedural.transform != Transform()) object.add("transform", transform_text(procedural.transform));
  object.add_unless(json_text::word(scene_keys::kUvSets, UvSet::kFirst), "uv_set",
                    json_text::word(scene_keys::kUvSets, texture.uv_set));
  return object.on_one_line();
}

}  // namespace tessera::core
