// SPDX-License-Identifier: Apache-2.0
// The camera of a glTF file's scene. Functions throw Refusals.
#pragma once

#include <cstdint>
#include <vector>

#include "core/scene/gltf/document.hpp"
#include "core/scene/gltf/nodes.hpp"
#include "core/scene/gltf/selection.hpp"

namespace tessera::core::gltf {

// Gives the scene the chosen camera of the nodes in `order`, if they have any, and the size of its image. One
// that cannot be read is told.
void set_camera(const Document& document, const Selection& selection, const std::vector<Node>& nodes,
                const std::vector<std::uint32_t>& order);

}  // namespace tessera::core::gltf
