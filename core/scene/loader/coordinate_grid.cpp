// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/coordinate_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace tessera::core {
namespace {

// Moving a mesh to the origin makes its coordinates at least about so many times finer.
constexpr double kMinGain = 100;
// Steps across a mesh: with fewer, vertices are off by more than a pixel of an image that is 10,000 wide.
constexpr double kMinStepsOfMesh = 10'000;
// Steps across a triangle: with fewer, its edges turn by more than 1/16, which is 3.6 degrees.
constexpr double kMinStepsOfTriangle = 16;

float greatest_coordinate(Vec3 v) {
  return std::max({v.x, v.y, v.z});
}

Aabb finite_bounds(const std::vector<Vec3>& positions) {
  Aabb bounds;
  for (const Vec3 p : positions)
    if (is_finite(p)) bounds.include(p);
  return bounds;
}

// corner(t, k) is the position of corner k of triangle t.
template <typename Corner>
void tell_triangles(const Aabb& bounds, std::size_t triangles, const Corner& corner, FileWarnings& warnings) {
  const CoordinateGrid grid(bounds);
  if (grid.is_fine()) return;
  std::size_t coarse = 0;
  for (std::size_t t = 0; t < triangles; ++t)
    coarse += grid.is_too_coarse_for(corner(t, 0), corner(t, 1), corner(t, 2)) ? 1 : 0;
  grid.tell(coarse, warnings);
}

}  // namespace

CoordinateGrid::CoordinateGrid(const Aabb& bounds) {
  if (bounds.empty()) return;
  const double size = std::max({bounds.extent(0), bounds.extent(1), bounds.extent(2)});
  const float farthest = std::max(greatest_coordinate(bounds.upper), greatest_coordinate(-bounds.lower));
  if (!(size > 0) || !(farthest > kMinGain * size)) return;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  step_ = std::nextafter(farthest, kInfinity) - farthest;
  const bool spares_no_triangle = size < kMinStepsOfMesh * step_;
  min_size_ = spares_no_triangle ? kInfinity : static_cast<float>(kMinStepsOfTriangle * step_);
}

bool CoordinateGrid::is_too_coarse_for(Vec3 a, Vec3 b, Vec3 c) const {
  return greatest_coordinate(max(max(a, b), c) - min(min(a, b), c)) < min_size_;
}

void CoordinateGrid::tell(std::size_t triangles, FileWarnings& warnings) const {
  if (triangles == 0) return;
  const auto text = [this] {
    return fmt::format(
        "coordinates so far from the origin are rounded to multiples of {:g}, which changes the shape of "
        "triangles; subtract an offset from all coordinates when you export the file",
        step_);
  };
  warnings.add("coarse coordinates", 0, text, triangles, "triangles");
}

void tell_coarse_coordinates(const MeshDescription& mesh, FileWarnings& warnings) {
  const auto corner = [&](std::size_t t, std::size_t k) {
    const std::uint32_t vertex = mesh.triangles[t][k];
    return vertex < mesh.positions.size() ? mesh.positions[vertex] : Vec3{};
  };
  tell_triangles(finite_bounds(mesh.positions), mesh.triangles.size(), corner, warnings);
}

void tell_coarse_coordinates(const ObjFile& file, FileWarnings& warnings) {
  const auto corner = [&](std::size_t t, std::size_t k) {
    return file.text.positions[static_cast<std::size_t>(file.corners.positions[3 * t + k])];
  };
  tell_triangles(finite_bounds(file.text.positions), file.triangle_count(), corner, warnings);
}

}  // namespace tessera::core
