// SPDX-License-Identifier: Apache-2.0
// Turns an OBJ file's triangles into a mesh in world space: corners unified into vertices, normals computed
// where they are asked for, transform applied. Stateless; thread-safe.
#pragma once

#include "core/base/error.hpp"
#include "core/math/transform.hpp"
#include "core/scene/description.hpp"
#include "core/scene/loader/obj_reader.hpp"
#include "core/scene/loader/scene_file.hpp"

namespace tessera::core {

enum class VertexColors { kUse, kIgnore };

// Triangles that cannot be seen are left out (triangle_filter.hpp). `materials` holds the scene's material of
// each of the file's runs, or a single one for all triangles. Errors complete a sentence that
// begins with the file's name.
Result<MeshDescription> build_mesh(const ObjFile& file, NormalsMode normals, const Transform& transform,
                                   const std::vector<std::uint32_t>& materials,
                                   VertexColors colors = VertexColors::kUse);

}  // namespace tessera::core
