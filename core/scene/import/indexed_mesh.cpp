// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import/indexed_mesh.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/scene/import/mesh_repair.hpp"
#include "core/scene/loader/obj_reader.hpp"
#include "core/scene/loader/vertex_normals.hpp"

namespace tessera::core {
namespace {

// The same mesh with corners that are not merged. A run for each change of material; `materials` gets theirs.
ObjFile as_obj_file(MeshDescription mesh, std::vector<std::uint32_t>& materials) {
  ObjFile file;
  std::vector<std::int32_t> corners;
  corners.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle) corners.push_back(static_cast<std::int32_t>(corner));
  file.text.positions = std::move(mesh.positions);
  file.text.uvs = std::move(mesh.uvs);
  file.text.second_uvs = std::move(mesh.second_uvs);
  file.text.colors = std::move(mesh.colors);
  file.text.tangents = std::move(mesh.tangents);
  if (!file.text.uvs.empty()) file.corners.uvs = corners;
  file.corners.positions = std::move(corners);
  for (std::size_t t = 0; t < mesh.triangle_materials.size(); ++t) {
    if (t > 0 && mesh.triangle_materials[t] == materials.back()) continue;
    ObjFile::Run run;
    run.first_triangle = t;
    file.runs.push_back(run);
    materials.push_back(mesh.triangle_materials[t]);
  }
  return file;
}

Result<MeshDescription> with_computed_normals(MeshDescription mesh, NormalsMode normals,
                                              const Transform& transform, VertexColors colors) {
  std::vector<std::uint32_t> materials;
  const ObjFile file = as_obj_file(std::move(mesh), materials);
  return build_mesh(file, normals, transform, materials, colors);
}

// The means of the triangles around each vertex; nothing if there are creases, at which vertices must be
// split. Where the triangles around a vertex are all within half the crease angle of their mean, any two of
// them are within the crease angle.
std::optional<std::vector<Vec3>> normals_without_creases(const MeshDescription& mesh, NormalsMode mode) {
  constexpr float kHalfCreaseCosine = 0.939692621f;
  std::vector<AreaNormal> sums(mesh.positions.size());
  const auto normal_of = [&](const std::array<std::uint32_t, 3>& t) {
    return area_normal(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]);
  };
  for (const auto& triangle : mesh.triangles) {
    const AreaNormal normal = normal_of(triangle);
    for (const std::uint32_t v : triangle) {
      sums[v].x += normal.x;
      sums[v].y += normal.y;
      sums[v].z += normal.z;
    }
  }
  std::vector<Vec3> normals(sums.size());
  std::transform(sums.begin(), sums.end(), normals.begin(), [](const AreaNormal& sum) { return unit(sum); });
  const float least = mode == NormalsMode::kSmooth ? -1.0f : kHalfCreaseCosine;
  for (const auto& triangle : mesh.triangles) {
    const Vec3 normal = unit(normal_of(triangle));
    for (const std::uint32_t v : triangle)
      if (normals[v] == Vec3{} || dot(normals[v], normal) < least) return std::nullopt;
  }
  for (Vec3& normal : normals)
    if (normal == Vec3{}) normal = {0, 0, 1};  // of a vertex without triangles
  return normals;
}

}  // namespace

Result<MeshDescription> build_indexed_mesh(MeshDescription mesh, NormalsMode normals,
                                           const Transform& transform, VertexColors colors,
                                           FileWarnings& warnings) {
  if (normals != NormalsMode::kFile) mesh.normals = {};
  if (colors == VertexColors::kIgnore) mesh.colors = {};
  tell_repairs(repair_mesh(mesh), 0, warnings);
  if (mesh.triangles.empty())
    return fail(ErrorCode::kInvalidArgument, "has no face with an area greater than 0");
  if (normals != NormalsMode::kFlat && mesh.normals.empty()) {
    auto means = normals_without_creases(mesh, normals);
    if (!means) return with_computed_normals(std::move(mesh), normals, transform, colors);
    mesh.normals = std::move(*means);
  }
  transform_mesh(mesh, transform);
  if (!std::all_of(mesh.positions.begin(), mesh.positions.end(), [](Vec3 p) { return is_finite(p); }))
    return fail(ErrorCode::kInvalidArgument, "reaches farther than can be computed after its transform");
  return mesh;
}

}  // namespace tessera::core
