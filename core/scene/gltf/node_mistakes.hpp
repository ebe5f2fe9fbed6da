// SPDX-License-Identifier: Apache-2.0
// Warnings about values that glTF forbids in nodes, their instances and their animations, with what is done
// instead (Khronos Group 2021, glTF 2.0 specification, sections 3.5 and 3.11). Stateless.
#pragma once

#include <cstddef>
#include <vector>

#include "core/scene/gltf/document.hpp"

namespace tessera::core::gltf {

// A node with a matrix and a translation, rotation or scale.
void tell_second_placement(const Document& document, const Value& node);

// A rotation, x, y, z, w, that is no unit quaternion.
void tell_odd_rotation(const Document& document, const Value& place, const std::vector<float>& quaternion);

// Another number of weights than the mesh has morph targets.
void tell_odd_weights(const Document& document, const Value& place, std::size_t weights, const Value& mesh);

}  // namespace tessera::core::gltf
