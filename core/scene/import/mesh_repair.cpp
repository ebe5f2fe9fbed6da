// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import/mesh_repair.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/geometry/primitives.hpp"
#include "core/scene/loader/triangle_filter.hpp"
#include "core/scene/loader/vertex_normals.hpp"

namespace tessera::core {
namespace {

bool is_usable_position(Vec3 p) {
  const auto in_range = [](float c) { return std::fabs(c) <= kMaxCoordinate; };
  return in_range(p.x) && in_range(p.y) && in_range(p.z);
}

// Whether the list was dropped.
template <typename T>
bool drop_if_incomplete(std::vector<T>& list, std::size_t vertices) {
  if (list.empty() || list.size() == vertices) return false;
  list = {};
  return true;
}

// Calls what(positions, normals, tangents) for the mesh and each of its steps.
template <typename What>
void for_each_step(MeshDescription& mesh, const What& what) {
  what(mesh.positions, mesh.normals, mesh.tangents);
  for (MeshStep& step : mesh.steps) what(step.positions, step.normals, step.tangents);
}

bool is_usable_vertex(const MeshDescription& mesh, std::uint32_t v) {
  return v < mesh.positions.size() && is_usable_position(mesh.positions[v]) &&
         std::ranges::all_of(mesh.steps,
                             [v](const MeshStep& step) { return is_usable_position(step.positions[v]); });
}

std::size_t remove_broken_triangles(MeshDescription& mesh) {
  const auto is_broken = [&](const std::array<std::uint32_t, 3>& triangle) {
    return !std::ranges::all_of(triangle, [&](std::uint32_t v) { return is_usable_vertex(mesh, v); });
  };
  const bool one_material = mesh.triangle_materials.size() == 1;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (is_broken(mesh.triangles[t])) continue;
    mesh.triangles[kept] = mesh.triangles[t];
    if (!one_material) mesh.triangle_materials[kept] = mesh.triangle_materials[t];
    ++kept;
  }
  const std::size_t removed = mesh.triangles.size() - kept;
  mesh.triangles.resize(kept);
  if (!one_material) mesh.triangle_materials.resize(kept);
  // No triangle uses these vertices.
  for_each_step(mesh, [](std::vector<Vec3>& positions, auto&, auto&) {
    for (Vec3& p : positions)
      if (!is_usable_position(p)) p = {};
  });
  return removed;
}

bool has_direction(Vec3 normal) {
  return is_finite(normal) && normal != Vec3{};
}

std::size_t repair_normals(const std::vector<std::array<std::uint32_t, 3>>& triangles,
                           const std::vector<Vec3>& positions, std::vector<Vec3>& normals) {
  const auto broken = static_cast<std::size_t>(
      std::ranges::count_if(normals, [](Vec3 normal) { return !has_direction(normal); }));
  if (broken == 0) return 0;
  for (const auto& t : triangles) {
    const Vec3 own = unit(area_normal(positions[t[0]], positions[t[1]], positions[t[2]]));
    for (const std::uint32_t v : t)
      if (!has_direction(normals[v])) normals[v] = own;
  }
  for (Vec3& normal : normals)
    if (!has_direction(normal)) normal = {0, 0, 1};
  return broken;
}

std::size_t repair_tangents(std::vector<VertexTangent>& tangents) {
  std::size_t broken = 0;
  for (VertexTangent& tangent : tangents) {
    if (is_finite(tangent.direction) && std::isfinite(tangent.handedness)) continue;
    tangent = {};
    ++broken;
  }
  return broken;
}

std::size_t repair_uvs(std::vector<Vec2>& uvs) {
  std::size_t broken = 0;
  for (Vec2& uv : uvs) {
    if (std::isfinite(uv.x) && std::isfinite(uv.y)) continue;
    uv = {};
    ++broken;
  }
  return broken;
}

std::size_t clamp_colors(MeshDescription& mesh) {
  const auto clamped = [](float value) { return value > 0 ? std::min(value, 1.0f) : 0; };
  std::size_t count = 0;
  for (Rgb& color : mesh.colors) {
    const Rgb usable{clamped(color.r), clamped(color.g), clamped(color.b)};
    if (usable == color) continue;
    color = usable;
    ++count;
  }
  return count;
}

}  // namespace

MeshRepairs repair_mesh(MeshDescription& mesh) {
  MeshRepairs repairs;
  const std::size_t vertices = mesh.positions.size();
  repairs.dropped_normals = drop_if_incomplete(mesh.normals, vertices);
  repairs.dropped_tangents = drop_if_incomplete(mesh.tangents, vertices);
  repairs.dropped_uvs = drop_if_incomplete(mesh.uvs, vertices);
  repairs.dropped_uvs |= drop_if_incomplete(mesh.second_uvs, mesh.uvs.size());
  repairs.dropped_colors = drop_if_incomplete(mesh.colors, vertices);
  if (mesh.triangle_materials.size() != mesh.triangles.size()) mesh.triangle_materials.resize(1);
  repairs.broken_triangles = remove_broken_triangles(mesh);
  if (mesh.steps.empty()) repairs.flat_triangles = remove_superfluous_triangles(mesh);
  for_each_step(mesh, [&](const auto& positions, auto& normals, auto& tangents) {
    repairs.broken_normals += repair_normals(mesh.triangles, positions, normals);
    repairs.broken_tangents += repair_tangents(tangents);
  });
  repairs.broken_uvs = repair_uvs(mesh.uvs) + repair_uvs(mesh.second_uvs);
  repairs.clamped_colors = clamp_colors(mesh);
  return repairs;
}

void tell_repairs(const MeshRepairs& repairs, int line, FileWarnings& warnings) {
  const auto tell = [&](std::size_t count, std::string_view unit, std::string_view what) {
    if (count > 0)
      warnings.add(
          what, line, [what] { return std::string(what); }, count, unit);
  };
  tell(repairs.broken_triangles, "triangles",
       "triangles whose corners are no vertices, or no usable ones, are left out");
  tell(repairs.flat_triangles, "triangles", "triangles without an area are left out");
  tell(repairs.broken_normals, "normals", "normals without a direction become those of triangles");
  tell(repairs.broken_tangents, "tangents",
       "tangents that are not finite become those of texture coordinates");
  tell(repairs.broken_uvs, "vertices", "texture coordinates that are not finite become 0");
  tell(repairs.clamped_colors, "vertices", "vertex colours are clamped to [0, 1]");
  tell(repairs.dropped_normals ? 1 : 0, "meshes", "normals are ignored: there is not one for each vertex");
  tell(repairs.dropped_tangents ? 1 : 0, "meshes", "tangents are ignored: there is not one for each vertex");
  tell(repairs.dropped_uvs ? 1 : 0, "meshes",
       "texture coordinates are ignored: there is not one for each vertex");
  tell(repairs.dropped_colors ? 1 : 0, "meshes",
       "vertex colours are ignored: there is not one for each vertex");
}

void transform_mesh(MeshDescription& mesh, const Transform& transform) {
  if (transform == Transform()) return;
  const bool reflects = transform.determinant() < 0;
  for_each_step(mesh, [&](auto& positions, auto& normals, auto& tangents) {
    for (VertexTangent& tangent : tangents) tangent = transformed(tangent, transform);
    for (Vec3& p : positions) p = transform.point(p);
    for (Vec3& normal : normals) {
      // Unit length first, so that the cofactors of large scales do not overflow.
      const Vec3 n = transform.normal(unit({normal.x, normal.y, normal.z}));
      normal = unit({reflects ? -n.x : n.x, reflects ? -n.y : n.y, reflects ? -n.z : n.z});
    }
  });
  if (reflects)
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

}  // namespace tessera::core
