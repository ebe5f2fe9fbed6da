// SPDX-License-Identifier: Apache-2.0
// Animations of any values of a glTF file (KHR_animation_pointer). Not thread-safe; functions throw Refusals.
#pragma once

#include <string>

#include "core/scene/gltf/document.hpp"

namespace tessera::core::gltf {

// What the target of an animation's channel points to: "/materials/0/emissiveFactor"; empty for a node's.
std::string pointer_of(const Value& target);

// Replaces the values that the chosen animation points to by those at the chosen time. Those of materials,
// nodes, meshes, cameras and lights can be; warnings name others. Values of the document that were taken
// before are no longer valid.
void apply_pointers(Document& document);

}  // namespace tessera::core::gltf
