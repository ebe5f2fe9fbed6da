// SPDX-License-Identifier: Apache-2.0
// Reads Mitsuba's "serialized" meshes, versions 3 and 4: several meshes in one file, each compressed by zlib,
// and a table of where they begin. Stateless; thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/scene/description.hpp"
#include "core/scene/loader/scene_limits.hpp"

namespace tessera::core::mitsuba {

struct SerializedMesh {
  MeshDescription mesh;  // without materials; corners may name no vertex
  bool face_normals = false;
};

// The mesh number `index`, from 0. Errors complete a sentence that begins with the file's name:
// INVALID_ARGUMENT for a broken file or an index that it does not have, RESOURCE_EXHAUSTED beyond the limit,
// or for data that expand more than 256 times.
Result<SerializedMesh> read_serialized_mesh(std::string_view bytes, std::int64_t index,
                                            const SceneLimit& triangles);

}  // namespace tessera::core::mitsuba
