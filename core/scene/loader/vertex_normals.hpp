// SPDX-License-Identifier: Apache-2.0
// Normals for meshes that have none, from the faces around each vertex. Stateless; thread-safe.
#pragma once

#include <cstdint>
#include <vector>

#include "core/math/vec3.hpp"
#include "core/scene/loader/obj_reader.hpp"

namespace tessera::core {

// Without smoothing groups, faces that meet at a sharper angle than this (40 degrees) keep their edge: a
// box's sides stay flat, a scanned animal is smooth. Given as a cosine.
inline constexpr float kCreaseCosine = 0.766044443f;

// Which triangles around a position count for a corner's normal.
enum class Smoothing {
  kAll,     // all of them
  kByFile,  // those of the same smoothing group, of group 0 the corner's own; before any "s" statement those
            // whose normals are within the crease angle of the corner's own
};

struct ComputedNormals {
  std::vector<Vec3> normals;             // of unit length
  std::vector<std::int32_t> of_corners;  // an index into `normals` for each of the file's corners
};

// At each corner the mean of triangles around its position, weighed by area. In the file's space. Takes time
// n log n in the number of corners, however many meet.
ComputedNormals compute_normals(const ObjFile& file, Smoothing smoothing);

// Twice the area times the normal of a triangle. In double precision, so that no triangle is too small or too
// large.
struct AreaNormal {
  double x = 0, y = 0, z = 0;
  bool operator==(const AreaNormal&) const = default;
};
AreaNormal area_normal(Vec3 a, Vec3 b, Vec3 c);
// Of unit length; zero stays zero.
Vec3 unit(const AreaNormal& v);

}  // namespace tessera::core
