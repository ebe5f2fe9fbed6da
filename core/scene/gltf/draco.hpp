// SPDX-License-Identifier: Apache-2.0
// Meshes compressed by KHR_draco_mesh_compression, decoded by libdraco. Stateless; thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/gltf/accessor.hpp"
#include "core/scene/gltf/value.hpp"

namespace tessera::core::gltf {

struct DracoMesh {
  std::vector<std::array<std::uint32_t, 3>> triangles;  // indices of vertices that exist
  std::map<std::string, Accessor> attributes;           // floats, one for each vertex
};

// What an attribute of the primitive is in the stream.
struct DracoAttribute {
  std::string name;
  std::uint32_t id = 0;
  Accessor::Layout layout;  // of its accessor
};

// Throws a Refusal at `extension` if the bytes are no such mesh, or have more triangles than `max_triangles`.
DracoMesh decode_draco(const Value& extension, std::string_view bytes,
                       const std::vector<DracoAttribute>& attributes, std::uint64_t max_triangles);

}  // namespace tessera::core::gltf
