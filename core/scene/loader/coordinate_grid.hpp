// SPDX-License-Identifier: Apache-2.0
// Finds meshes that are too far from the origin for coordinates of 32 bits, as those of surveys and maps are:
// rounding moves their vertices. Stateless; thread-safe.
#pragma once

#include "core/geometry/aabb.hpp"
#include "core/scene/description.hpp"
#include "core/scene/loader/file_warnings.hpp"
#include "core/scene/loader/obj_reader.hpp"

namespace tessera::core {

class CoordinateGrid {
 public:
  // Of everything in these bounds. A mesh that is not far from the origin for its size gets a grid that is
  // fine enough for all triangles, because moving it would gain little.
  explicit CoordinateGrid(const Aabb& bounds);

  bool is_fine() const { return min_size_ == 0; }
  // Whether rounding changes the triangle visibly.
  bool is_too_coarse_for(Vec3 a, Vec3 b, Vec3 c) const;
  // Says how many triangles it is too coarse for, and what to do.
  void tell(std::size_t triangles, FileWarnings& warnings) const;

 private:
  float step_ = 0;      // between coordinates
  float min_size_ = 0;  // of triangles that keep their shape
};

// Tells how many of a file's triangles the coordinates in the file are too coarse for.
void tell_coarse_coordinates(const MeshDescription& mesh, FileWarnings& warnings);
void tell_coarse_coordinates(const ObjFile& file, FileWarnings& warnings);

}  // namespace tessera::core
