// SPDX-License-Identifier: Apache-2.0
// Converts a mesh with shared vertices, as PLY and STL files have it, to a world-space mesh. Stateless;
// thread-safe.
#pragma once

#include "core/base/error.hpp"
#include "core/math/transform.hpp"
#include "core/scene/description.hpp"
#include "core/scene/loader/file_warnings.hpp"
#include "core/scene/loader/mesh_builder.hpp"
#include "core/scene/loader/scene_file.hpp"

namespace tessera::core {

// The mesh of a MeshFile (mesh_file.hpp), with normals as requested and the transform applied. What is broken
// is repaired (mesh_repair.hpp), and told. Normals and positions keep their bits where the transform is the
// identity and the file has the normals. Error messages complete a sentence that begins with the file's name.
Result<MeshDescription> build_indexed_mesh(MeshDescription mesh, NormalsMode normals,
                                           const Transform& transform, VertexColors colors,
                                           FileWarnings& warnings);

}  // namespace tessera::core
