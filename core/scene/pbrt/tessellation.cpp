// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/tessellation.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/math/elementary.hpp"
#include "core/scene/loader/vertex_normals.hpp"

namespace tessera::core::pbrt {
namespace {

constexpr int kSegments = 128;  // of a full turn
constexpr int kPatchSide = 16;

// At poles, where an edge of a cell is a point, one of its triangles has no area and is not added.
void add_triangle(MeshDescription& mesh, const std::array<std::uint32_t, 3>& t) {
  const auto& p = mesh.positions;
  if (area_normal(p[t[0]], p[t[1]], p[t[2]]) != AreaNormal{}) mesh.triangles.push_back(t);
}

// Adds a vertex for each point of a grid of columns x rows cells, and two triangles for each cell. `vertex`
// is called with the fractions along both axes and adds one vertex.
template <typename Vertex>
void add_grid(int columns, int rows, MeshDescription& mesh, const Vertex& vertex) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int row = 0; row <= rows; ++row)
    for (int column = 0; column <= columns; ++column)
      vertex(static_cast<float>(column) / static_cast<float>(columns),
             static_cast<float>(row) / static_cast<float>(rows));
  const auto stride = static_cast<std::uint32_t>(columns) + 1;
  for (std::uint32_t row = 0; row < static_cast<std::uint32_t>(rows); ++row)
    for (std::uint32_t column = 0; column + 1 < stride; ++column) {
      const std::uint32_t a = first + row * stride + column, b = a + 1, c = a + stride, d = c + 1;
      add_triangle(mesh, {a, b, d});
      add_triangle(mesh, {a, d, c});
    }
}

int segments_of(float phi_max) {
  return std::clamp(static_cast<int>(std::ceil(phi_max / 360 * kSegments)), 3, kSegments);
}

// Cosine and sine of the latitude whose height is z, and the angle itself in turns from the lower pole.
float turns_from_lower_pole(float z, float radius) {
  const float height = std::clamp(z / radius, -1.0f, 1.0f);
  return 0.25f + atan2(height, std::sqrt(std::max(0.0f, 1 - height * height))) / (2 * kPi);
}

template <typename T>
T bilinear(T v00, T v10, T v01, T v11, float u, float v) {
  return (v00 * (1 - u) + v10 * u) * (1 - v) + (v01 * (1 - u) + v11 * u) * v;
}

bool is_parallelogram(Vec3 p00, Vec3 p10, Vec3 p01, Vec3 p11) {
  const Vec3 gap = p11 + p00 - p10 - p01;
  const float size = length_squared(p11 - p00) + length_squared(p10 - p01);
  return length_squared(gap) <= 1e-10f * size;
}

struct Patch {
  std::array<Vec3, 4> points;
  std::array<Vec3, 4> normals;
  std::array<Vec2, 4> uvs;
  bool has_normals = false;

  Vec3 normal(float u, float v) const {
    if (has_normals) return bilinear(normals[0], normals[1], normals[2], normals[3], u, v);
    const Vec3 along_u = (points[1] - points[0]) * (1 - v) + (points[3] - points[2]) * v;
    const Vec3 along_v = (points[2] - points[0]) * (1 - u) + (points[3] - points[1]) * u;
    return cross(along_u, along_v);
  }
};

void add_patch(const Patch& patch, MeshDescription& mesh) {
  const auto& p = patch.points;
  const int side = is_parallelogram(p[0], p[1], p[2], p[3]) ? 1 : kPatchSide;
  add_grid(side, side, mesh, [&](float u, float v) {
    mesh.positions.push_back(bilinear(p[0], p[1], p[2], p[3], u, v));
    mesh.normals.push_back(patch.normal(u, v));
    mesh.uvs.push_back(bilinear(patch.uvs[0], patch.uvs[1], patch.uvs[2], patch.uvs[3], u, v));
  });
}

}  // namespace

MeshDescription sphere_mesh(const PartialSphere& sphere) {
  MeshDescription mesh;
  const float lowest = turns_from_lower_pole(sphere.z_min, sphere.radius);
  const float highest = turns_from_lower_pole(sphere.z_max, sphere.radius);
  add_grid(segments_of(sphere.phi_max), kSegments / 2, mesh, [&](float u, float v) {
    const SinCos longitude = sin_cos_turns(u * sphere.phi_max / 360);
    const SinCos latitude = sin_cos_turns(lowest + v * (highest - lowest));
    const Vec3 normal{latitude.sin * longitude.cos, latitude.sin * longitude.sin, -latitude.cos};
    mesh.positions.push_back(normal * sphere.radius);
    mesh.normals.push_back(normal);
    mesh.uvs.push_back({u, v});
  });
  return mesh;
}

MeshDescription disk_mesh(const PartialDisk& disk) {
  MeshDescription mesh;
  add_grid(segments_of(disk.phi_max), 1, mesh, [&](float u, float v) {
    const SinCos longitude = sin_cos_turns(u * disk.phi_max / 360);
    const float radius = disk.radius + v * (disk.inner_radius - disk.radius);
    mesh.positions.push_back({radius * longitude.cos, radius * longitude.sin, disk.height});
    mesh.normals.push_back({0, 0, 1});
    mesh.uvs.push_back({u, v});
  });
  return mesh;
}

MeshDescription cylinder_mesh(const PartialCylinder& cylinder) {
  MeshDescription mesh;
  add_grid(segments_of(cylinder.phi_max), 1, mesh, [&](float u, float v) {
    const SinCos longitude = sin_cos_turns(u * cylinder.phi_max / 360);
    const float z = cylinder.z_min + v * (cylinder.z_max - cylinder.z_min);
    mesh.positions.push_back({cylinder.radius * longitude.cos, cylinder.radius * longitude.sin, z});
    mesh.normals.push_back({longitude.cos, longitude.sin, 0});
    mesh.uvs.push_back({u, v});
  });
  return mesh;
}

std::uint64_t bilinear_triangles(const std::vector<Vec3>& positions,
                                 const std::vector<std::array<std::uint32_t, 4>>& patches) {
  std::uint64_t triangles = 0;
  for (const auto& [a, b, c, d] : patches)
    triangles += is_parallelogram(positions[a], positions[b], positions[c], positions[d])
                     ? 2
                     : std::uint64_t{2} * kPatchSide * kPatchSide;
  return triangles;
}

MeshDescription bilinear_mesh(const std::vector<Vec3>& positions, const std::vector<Vec3>& normals,
                              const std::vector<Vec2>& uvs,
                              const std::vector<std::array<std::uint32_t, 4>>& patches) {
  MeshDescription mesh;
  for (const auto& indices : patches) {
    Patch patch{{}, {}, {{{0, 0}, {1, 0}, {0, 1}, {1, 1}}}, !normals.empty()};
    for (std::size_t corner = 0; corner < 4; ++corner) {
      patch.points[corner] = positions[indices[corner]];
      if (!normals.empty()) patch.normals[corner] = normals[indices[corner]];
      if (!uvs.empty()) patch.uvs[corner] = uvs[indices[corner]];
    }
    add_patch(patch, mesh);
  }
  return mesh;
}

}  // namespace tessera::core::pbrt
