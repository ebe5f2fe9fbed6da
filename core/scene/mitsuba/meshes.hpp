// SPDX-License-Identifier: Apache-2.0
// The meshes of Mitsuba's shapes, in world space. Not thread-safe.
#pragma once

#include <optional>
#include <vector>

#include "core/scene/description.hpp"
#include "core/scene/loader/mesh_file.hpp"
#include "core/scene/mitsuba/plugin.hpp"
#include "core/scene/mitsuba/textures.hpp"

namespace tessera::core::mitsuba {

// A mesh without materials.
struct ShapeMesh {
  MeshDescription mesh;
  std::vector<MeshAttribute> attributes{};  // of a PLY file
  UvLayout layout = UvLayout::kSame;
};

// The mesh of an "obj", "ply", "serialized", "cube" or "rectangle", with its "to_world" applied and its
// triangles facing where its normals point, as Mitsuba's shading does. Missing normals are computed, by
// Mitsuba's rule, and so are missing texture coordinates if the shape `has_images`. nullopt after a warning,
// or an error in `conversion`.
std::optional<ShapeMesh> load_mesh(Conversion& conversion, const Plugin& shape, bool has_images);

// Whether all triangles have vertices that are there.
bool names_only_vertices(const MeshDescription& mesh);

// The path of the file that the shape names; nullopt after a warning.
std::optional<std::string> find_shape_file(const Conversion& conversion, const Plugin& shape);

// Whether load_mesh() has a mesh for the shape.
bool is_mesh(const Plugin& shape);

// The unit sphere as a mesh, with Mitsuba's texture coordinates.
MeshDescription sphere_mesh();

// Applies the transform. Triangles then face where their normals point; those without keep their corners'
// order.
void place_mesh(MeshDescription& mesh, const Transform& to_world);
// Turns it inside out.
void flip_mesh(MeshDescription& mesh);

// The mean of the normals of the triangles around each vertex, weighted by their angles there (Thürmer and
// Wüthrich 1998). Zero where a vertex has no triangle with an area.
std::vector<Vec3> angle_weighted_normals(const MeshDescription& mesh);

}  // namespace tessera::core::mitsuba
