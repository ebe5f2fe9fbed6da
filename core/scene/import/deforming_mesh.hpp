// SPDX-License-Identifier: Apache-2.0
// Makes one mesh that deforms of the meshes of its steps. Stateless; thread-safe.
#pragma once

#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/math/transform.hpp"
#include "core/scene/description.hpp"
#include "core/scene/loader/file_warnings.hpp"
#include "core/scene/loader/scene_file.hpp"

namespace tessera::core {

struct StepFile {
  float frame = 0;
  std::string name;        // in messages
  MeshDescription mesh{};  // as a file has it (mesh_file.hpp), without steps
};

// Of two files or more, whose vertices and triangles correspond by their order. All but positions and normals
// is that of the first. Without normals in the files, a vertex has the mean of its triangles' at each step,
// also where they meet at an edge. INVALID_ARGUMENT if the files do not correspond, or have a corner that is
// no usable vertex.
Result<MeshDescription> join_steps(std::vector<StepFile> files, NormalsMode normals,
                                   const Transform& transform, VertexColors colors, FileWarnings& warnings);

// Sets positions and normals of a mesh with steps to those at frame 0.
void set_rest(MeshDescription& mesh);

}  // namespace tessera::core
