// SPDX-License-Identifier: Apache-2.0
// Converts an OBJ file's triangles to a world-space mesh: merges corners into vertices, computes normals if
// requested, and applies the transform. Stateless; thread-safe.
#pragma once

#include "core/base/error.hpp"
#include "core/math/transform.hpp"
#include "core/scene/description.hpp"
#include "core/scene/loader/obj_reader.hpp"
#include "core/scene/loader/scene_file.hpp"

namespace tessera::core {

// Invisible triangles are left out (triangle_filter.hpp). `materials` holds the scene's material for each
// of the file's runs, or a single one for all triangles. Error messages complete a sentence that begins
// with the file's name.
Result<MeshDescription> build_mesh(const ObjFile& file, NormalsMode normals, const Transform& transform,
                                   const std::vector<std::uint32_t>& materials,
                                   VertexColors colors = VertexColors::kUse);

}  // namespace tessera::core
