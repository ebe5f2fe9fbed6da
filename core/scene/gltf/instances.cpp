// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/instances.hpp"

#include <string_view>
#include <vector>

#include "core/scene/gltf/node_mistakes.hpp"

namespace tessera::core::gltf {
namespace {

std::vector<float> quaternion_of(const Accessor& rotations, std::size_t i) {
  return {rotations.number(i, 0), rotations.number(i, 1), rotations.number(i, 2), rotations.number(i, 3)};
}

InstanceAttributes instance_attributes(const Value& list, const Document& document, Accessors& accessors) {
  InstanceAttributes attributes;
  bool is_first = true;
  const auto read = [&](std::string_view name, std::size_t components, std::optional<Accessor>& values) {
    if (!list[name].exists()) return;
    values = accessors.read(list[name], components);
    if (!is_first && values->count() != attributes.count)
      list[name].refuse("has another count than the other attributes");
    attributes.count = values->count();
    is_first = false;
  };
  read("TRANSLATION", 3, attributes.translation);
  read("ROTATION", 4, attributes.rotation);
  read("SCALE", 3, attributes.scale);
  for (std::size_t i = 0; attributes.rotation && i < attributes.count; ++i)
    tell_odd_rotation(document, list["ROTATION"], quaternion_of(*attributes.rotation, i));
  return attributes;
}

}  // namespace

Transform InstanceAttributes::transform(std::size_t i) const {
  return placed(translation ? translation->vec3(i) : Vec3{0, 0, 0},
                rotation ? quaternion_of(*rotation, i) : std::vector<float>{0, 0, 0, 1},
                scale ? scale->vec3(i) : Vec3{1, 1, 1});
}

Placements placements_of(const Node& node, const Document& document, Accessors& accessors) {
  const Value extension = node.value.extension("EXT_mesh_gpu_instancing");
  Placements placements{node};
  if (const Value colors = extension["attributes"]["_COLOR_0"]; colors.exists())
    document.warn(colors, "colours of instances", "colours of instances are ignored");
  if (extension.exists())
    document.try_to(extension, "instances", "its mesh is shown once, where the node is", [&] {
      placements.attributes = instance_attributes(extension["attributes"], document, accessors);
    });
  return placements;
}

}  // namespace tessera::core::gltf
