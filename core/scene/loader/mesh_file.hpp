// SPDX-License-Identifier: Apache-2.0
// Reads meshes with shared vertices: PLY (ascii, binary, gzip) and STL (ascii, binary). Designed for files of
// hundreds of megabytes: binary files are read by columns. Stateless; thread-safe.
//
// Turk, "The PLY Polygon File Format" (1994); 3D Systems, "StereoLithography Interface Specification" (1989).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/scene/description.hpp"
#include "core/scene/loader/file_warnings.hpp"
#include "core/scene/loader/scene_limits.hpp"

namespace tessera::core {

// A property that has no meaning for Tessera, for formats that give it one.
struct MeshAttribute {
  std::string name;           // as in the file
  bool of_triangles = false;  // one value for each triangle, else for each vertex
  std::vector<float> values;
};

struct MeshFile {
  // In the file's space, as written: triangles may be flat, name no vertex, or have corners that are not
  // finite. triangle_materials has one value for each triangle, the file's "material_index", or a single 0.
  MeshDescription mesh;
  std::vector<MeshAttribute> attributes;
  // Images of the base colour, as the file names them, and the number of that of each triangle, "texnumber";
  // an empty list: the first.
  std::vector<std::string> images;
  std::vector<std::uint32_t> triangle_images;
  FileWarnings warnings;
};

enum class MeshAttributes { kIgnore, kKeep };

// Reads faces of any number of corners, and triangle strips. Polygons are triangulated. Normals are nx, ny,
// nz; tangents tx, ty, tz, with the handedness tw or 1; texture coordinates u, v or s, t, also with the
// prefix "texture_"; the second ones u1, v1; colours red, green, blue or r, g, b, also with the prefix
// "diffuse_", where integers are sRGB and floats linear. Images are those of "comment TextureFile";
// "texcoord" are the texture coordinates of the corners of faces. Errors are "NAME: what", where `name` is
// the file's name in messages: INVALID_ARGUMENT for a broken file or one without faces, RESOURCE_EXHAUSTED
// beyond the limit. kKeep returns the other properties that are single numbers, and neither images nor
// "texcoord".
Result<MeshFile> read_ply(std::string_view bytes, const std::string& name, const SceneLimit& triangles = {},
                          MeshAttributes attributes = MeshAttributes::kIgnore);

// Whether the bytes are text with the first keywords of STL files, or have the size that the header of a
// binary STL file says.
bool is_stl(std::string_view bytes);
// Equal corners become one vertex, if their facets have the same colour. The file's normals are ignored,
// because they are those of the triangles. Errors as above.
Result<MeshFile> read_stl(std::string_view bytes, const std::string& name, const SceneLimit& triangles = {});

}  // namespace tessera::core
