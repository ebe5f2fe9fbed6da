// SPDX-License-Identifier: Apache-2.0
// Where nodes of a glTF file show their meshes (EXT_mesh_gpu_instancing). Functions throw Refusals.
#pragma once

#include <cstddef>
#include <optional>

#include "core/math/transform.hpp"
#include "core/scene/gltf/accessor.hpp"
#include "core/scene/gltf/document.hpp"
#include "core/scene/gltf/nodes.hpp"

namespace tessera::core::gltf {

// The attributes of EXT_mesh_gpu_instancing.
struct InstanceAttributes {
  std::optional<Accessor> translation, rotation, scale;
  std::size_t count = 0;

  Transform transform(std::size_t i) const;
};

// Where a node shows its mesh: where it is itself, or where EXT_mesh_gpu_instancing places it.
struct Placements {
  const Node& node;
  std::optional<InstanceAttributes> attributes{};

  std::size_t count() const { return attributes ? attributes->count : 1; }
  Transform at(std::size_t i, std::size_t moment) const {
    const Transform& to_world = node.to_world[moment];
    return attributes ? compose(to_world, attributes->transform(i)) : to_world;
  }
};

// Attributes that are broken leave the mesh where the node is, after a warning.
Placements placements_of(const Node& node, const Document& document, Accessors& accessors);

}  // namespace tessera::core::gltf
