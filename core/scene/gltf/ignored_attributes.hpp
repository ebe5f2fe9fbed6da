// SPDX-License-Identifier: Apache-2.0
// Tells which attributes of a primitive no image depends on. Stateless; thread-safe.
#pragma once

#include <string>
#include <vector>

#include "core/scene/gltf/document.hpp"

namespace tessera::core::gltf {

// Whether tangents of meshes change what the material looks like: it has a normal map or stretches
// highlights.
bool follows_tangents(const Value& material);

// The names of the texture coordinates that a material's textures use. Without textures, the first set
// counts: tangents follow it.
std::vector<std::string> coordinate_names(const Value& material);

// `material` is that of the primitive; absent for the default one. `used`: its coordinate_names(). Attributes
// of applications, whose names begin with "_", and joints and weights are not told.
void tell_ignored_attributes(const Document& document, const Value& primitive, const Value& material,
                             const std::vector<std::string>& used);

}  // namespace tessera::core::gltf
