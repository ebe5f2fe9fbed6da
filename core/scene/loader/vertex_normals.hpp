// SPDX-License-Identifier: Apache-2.0
// Computes normals for meshes without them, from the faces around each vertex, and transforms tangents.
// Stateless; thread-safe.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/surface.hpp"
#include "core/math/transform.hpp"
#include "core/math/vec3.hpp"
#include "core/scene/loader/obj_reader.hpp"

namespace tessera::core {

// The crease angle for meshes without smoothing groups (40 degrees), as a cosine: faces that meet at a
// sharper angle keep their edge.
inline constexpr float kCreaseCosine = 0.766044443f;

// The triangles around a position that contribute to a corner's normal.
enum class Smoothing {
  kAll,     // all of them
  kByFile,  // those of the same smoothing group, of group 0 the corner's own; before any "s" statement those
            // whose normals are within the crease angle of the corner's own
};

struct ComputedNormals {
  std::vector<Vec3> normals;             // of unit length
  std::vector<std::int32_t> of_corners;  // an index into `normals` for each of the file's corners
};

// The area-weighted mean of the triangles around each corner's position, in the file's space. Takes time n
// log n in the number of corners.
ComputedNormals compute_normals(const ObjFile& file, Smoothing smoothing);

// A triangle's normal, scaled by twice its area. In double precision, so that it neither overflows nor
// underflows.
struct AreaNormal {
  double x = 0, y = 0, z = 0;
  bool operator==(const AreaNormal&) const = default;
};
AreaNormal area_normal(Vec3 a, Vec3 b, Vec3 c);
// Normalises; zero stays zero.
Vec3 unit(const AreaNormal& v);

// The tangent of a transformed mesh, of unit length or zero. A reflection changes its handedness.
VertexTangent transformed(const VertexTangent& tangent, const Transform& transform);

}  // namespace tessera::core
