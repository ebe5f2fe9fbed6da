// SPDX-License-Identifier: Apache-2.0
// A PLY or STL file, the curves of a PLY file, and the mesh that is made of it in each way of computing
// normals.
#include "core/scene/import/indexed_mesh.hpp"
#include "core/scene/loader/curve_file.hpp"
#include "core/scene/loader/gunzip.hpp"
#include "core/scene/loader/mesh_file.hpp"
#include "tests/fuzz/expect.hpp"
#include "tests/fuzz/fuzzer.hpp"

namespace tessera::fuzz::mesh_fuzz {
namespace {

void expect_sound(const core::MeshDescription& mesh) {
  const std::size_t vertices = mesh.positions.size();
  expect(mesh.normals.empty() || mesh.normals.size() == vertices, "a normal for each vertex, or none");
  expect(mesh.uvs.empty() || mesh.uvs.size() == vertices, "texture coordinates for each vertex, or none");
  expect(mesh.colors.empty() || mesh.colors.size() == vertices, "a colour for each vertex, or none");
  expect(mesh.triangle_materials.size() == 1 || mesh.triangle_materials.size() == mesh.triangles.size(),
         "a material for each triangle, or one");
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) expect(vertex < vertices, "corners are vertices");
}

void read_and_build(std::string_view input) {
  const bool is_ply = input.starts_with("ply") || core::is_gzip(input);
  if (is_ply) {
    const auto strands = core::read_curve_file(input, "x.ply");
    if (expect_answer(strands))
      expect(strands->radii.empty() || strands->radii.size() == strands->points.size(),
             "a radius for each point, or none");
  }
  const auto file = is_ply ? core::read_ply(input, "x.ply", {}, core::MeshAttributes::kKeep)
                           : core::read_stl(input, "x.stl");
  if (!expect_answer(file)) return;
  for (const core::MeshAttribute& attribute : file->attributes)
    expect(attribute.values.size() ==
               (attribute.of_triangles ? file->mesh.triangles.size() : file->mesh.positions.size()),
           "a value for each vertex or triangle");
  for (const auto mode : {core::NormalsMode::kFile, core::NormalsMode::kSmooth, core::NormalsMode::kFlat}) {
    core::FileWarnings warnings;
    const auto mesh = core::build_indexed_mesh(file->mesh, mode, {}, core::VertexColors::kUse, warnings);
    if (expect_answer(mesh)) expect_sound(*mesh);
  }
}

}  // namespace

TESSERA_FUZZER(mesh, std::string_view input) {
  read_and_build(input);
}

}  // namespace tessera::fuzz::mesh_fuzz
