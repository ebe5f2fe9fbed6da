// SPDX-License-Identifier: Apache-2.0
#include "scenes/modelling/surface.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

#include "core/math/elementary.hpp"
#include "scenes/modelling/curve.hpp"

namespace tessera::modelling {
namespace {

// For each vertex the first vertex in the same place.
std::vector<std::uint32_t> weld_by_position(const std::vector<Vec3>& positions) {
  std::map<std::tuple<float, float, float>, std::uint32_t> first;
  std::vector<std::uint32_t> welded(positions.size());
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    const Vec3 p = positions[i];
    welded[i] = first.try_emplace({p.x, p.y, p.z}, i).first->second;
  }
  return welded;
}

void add_triangle(MeshDescription& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const auto& p = mesh.positions;
  if (p[a] == p[b] || p[b] == p[c] || p[c] == p[a]) return;
  mesh.triangles.push_back({a, b, c});
}

}  // namespace

std::vector<float> uniform_lines(int n) {
  std::vector<float> lines;
  for (int i = 0; i <= n; ++i) lines.push_back(static_cast<float>(i) / static_cast<float>(n));
  return lines;
}

MeshDescription grid_mesh(const GridLines& lines, const std::function<Vec3(float u, float v)>& p) {
  std::vector<Vec3> points;
  for (const float v : lines.v) {
    for (const float u : lines.u) points.push_back(p(lines.wraps_u && u == 1 ? 0 : u, v));
  }
  return grid_mesh(lines, std::move(points));
}

MeshDescription grid_mesh(const GridLines& lines, std::vector<Vec3> points) {
  MeshDescription mesh;
  mesh.positions = std::move(points);
  for (const float v : lines.v) {
    for (const float u : lines.u) mesh.uvs.push_back({u, v});
  }
  const auto columns = static_cast<std::uint32_t>(lines.u.size());
  for (std::uint32_t j = 0; j + 1 < lines.v.size(); ++j) {
    for (std::uint32_t i = 0; i + 1 < columns; ++i) {
      const std::uint32_t a = j * columns + i, b = a + 1, c = b + columns, d = a + columns;
      add_triangle(mesh, a, b, c);
      add_triangle(mesh, a, c, d);
    }
  }
  smooth_normals(mesh);
  return mesh;
}

void displace(MeshDescription& mesh, const std::function<float(Vec3 position, Vec2 uv)>& height) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    mesh.positions[i] += mesh.normals[i] * height(mesh.positions[i], mesh.uvs[i]);
  }
  smooth_normals(mesh);
}

void smooth_normals(MeshDescription& mesh) {
  const std::vector<std::uint32_t> welded = weld_by_position(mesh.positions);
  std::vector<Vec3> sums(mesh.positions.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 pa = mesh.positions[a];
    const Vec3 twice_area = cross(mesh.positions[b] - pa, mesh.positions[c] - pa);
    for (const std::uint32_t corner : {a, b, c}) sums[welded[corner]] += twice_area;
  }
  mesh.normals.resize(mesh.positions.size());
  for (std::size_t i = 0; i < welded.size(); ++i) {
    const Vec3 sum = sums[welded[i]];
    mesh.normals[i] = length_squared(sum) > 0 ? normalize(sum) : Vec3{0, 1, 0};
  }
}

void append(MeshDescription& mesh, const MeshDescription& part) {
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
  mesh.normals.insert(mesh.normals.end(), part.normals.begin(), part.normals.end());
  mesh.uvs.insert(mesh.uvs.end(), part.uvs.begin(), part.uvs.end());
  for (const auto& [a, b, c] : part.triangles) mesh.triangles.push_back({base + a, base + b, base + c});
}

MeshDescription tube_mesh(const Tube& tube) {
  const auto center = [&](float v) { return spline(tube.centers, v); };
  const auto radius = [&](float v) { return v == 0 || v == 1 ? 0 : spline(tube.radii, v); };
  return grid_mesh({uniform_lines(tube.segments), uniform_lines(tube.rings), true}, [&](float u, float v) {
    const Vec3 along = normalize(center(std::min(v + 0.01f, 1.0f)) - center(std::max(v - 0.01f, 0.0f)));
    const Vec3 side = normalize(cross(along, std::fabs(along.x) < 0.9f ? Vec3{1, 0, 0} : Vec3{0, 0, 1}));
    const float angle = 2 * core::kPi * u;
    return center(v) + radius(v) * (core::cos(angle) * side + core::sin(angle) * cross(along, side));
  });
}

}  // namespace tessera::modelling
