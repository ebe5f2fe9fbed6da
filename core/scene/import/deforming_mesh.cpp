// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import/deforming_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "core/scene/import/mesh_repair.hpp"
#include "core/scene/loader/vertex_normals.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Status check_correspondence(const StepFile& first, const StepFile& other) {
  const auto differ = [&](std::string_view what, std::size_t a, std::size_t b) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} has {} {}, but {} has {}: a mesh that deforms has the same vertices and "
                            "triangles at all frames",
                            in_quotes(other.name), b, what, in_quotes(first.name), a));
  };
  if (other.mesh.positions.size() != first.mesh.positions.size())
    return differ("vertices", first.mesh.positions.size(), other.mesh.positions.size());
  if (other.mesh.triangles.size() != first.mesh.triangles.size())
    return differ("triangles", first.mesh.triangles.size(), other.mesh.triangles.size());
  const auto [a, b] = std::ranges::mismatch(first.mesh.triangles, other.mesh.triangles);
  if (a != first.mesh.triangles.end())
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("triangle {} of {} has other vertices than that of {}: a mesh that deforms has "
                    "the same triangles at all frames",
                    a - first.mesh.triangles.begin() + 1, in_quotes(other.name), in_quotes(first.name)));
  const auto either = [&](std::string_view what) {
    return fail(ErrorCode::kInvalidArgument, fmt::format("either both {} and {} have {}, or neither",
                                                         in_quotes(first.name), in_quotes(other.name), what));
  };
  if (other.mesh.normals.empty() != first.mesh.normals.empty()) return either("normals");
  if (other.mesh.tangents.empty() != first.mesh.tangents.empty()) return either("tangents");
  return {};
}

Status check_vertices(const StepFile& file) {
  const auto& [frame, name, mesh] = file;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle)
      if (v >= mesh.positions.size() || !is_finite(mesh.positions[v]))
        return fail(ErrorCode::kInvalidArgument,
                    fmt::format("{}: vertex {} of a triangle does not exist or is not finite",
                                in_quotes(name), v + 1));
  if (mesh.triangles.empty())
    return fail(ErrorCode::kInvalidArgument, fmt::format("{} has no triangle", in_quotes(name)));
  return {};
}

// The means of the triangles around each vertex, weighted by area.
std::vector<Vec3> mean_normals(const std::vector<Vec3>& positions, const Triangles& triangles) {
  std::vector<AreaNormal> sums(positions.size());
  for (const auto& triangle : triangles) {
    const AreaNormal normal =
        area_normal(positions[triangle[0]], positions[triangle[1]], positions[triangle[2]]);
    for (const std::uint32_t v : triangle) {
      sums[v].x += normal.x;
      sums[v].y += normal.y;
      sums[v].z += normal.z;
    }
  }
  std::vector<Vec3> normals(sums.size());
  // Of vertices without triangles, any will do.
  std::ranges::transform(sums, normals.begin(), [](const AreaNormal& sum) {
    const Vec3 normal = unit(sum);
    return dot(normal, normal) > 0 ? normal : Vec3{0, 0, 1};
  });
  return normals;
}

}  // namespace

Result<MeshDescription> join_steps(std::vector<StepFile> files, NormalsMode normals,
                                   const Transform& transform, VertexColors colors, FileWarnings& warnings) {
  for (const StepFile& file : files) {
    if (auto ok = check_correspondence(files.front(), file); !ok) return fail(ok.error());
    if (auto ok = check_vertices(file); !ok) return fail(ok.error());
  }
  MeshDescription all = files.front().mesh;
  if (colors == VertexColors::kIgnore) all.colors = {};
  for (auto& [frame, name, mesh] : files) {
    if (normals != NormalsMode::kFile) mesh.normals = {};
    if (normals != NormalsMode::kFlat && mesh.normals.empty())
      mesh.normals = mean_normals(mesh.positions, all.triangles);
    all.steps.push_back(
        {frame, std::move(mesh.positions), std::move(mesh.normals), std::move(mesh.tangents)});
  }
  set_rest(all);
  tell_repairs(repair_mesh(all), 0, warnings);
  transform_mesh(all, transform);
  set_rest(all);
  return all;
}

void set_rest(MeshDescription& mesh) {
  const VertexMotion motion(mesh.steps);
  const VertexMotion::Moment rest = motion.at(0);
  mesh.normals.resize(motion.has_normals() ? motion.vertex_count() : 0);
  mesh.positions.resize(motion.vertex_count());
  mesh.tangents = motion.has_tangents() ? mesh.steps.front().tangents : std::vector<VertexTangent>();
  for (std::size_t v = 0; v < motion.vertex_count(); ++v) {
    mesh.positions[v] = motion.position(v, rest);
    if (motion.has_normals()) mesh.normals[v] = motion.normal(v, rest);
    if (motion.has_tangents()) mesh.tangents[v].direction = motion.tangent(v, rest);
  }
}

}  // namespace tessera::core
