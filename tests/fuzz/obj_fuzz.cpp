// SPDX-License-Identifier: Apache-2.0
// An OBJ file, and the mesh that is made of it in each way of computing normals.
#include <algorithm>

#include "core/scene/loader/mesh_builder.hpp"
#include "core/scene/loader/obj_reader.hpp"
#include "tests/fuzz/expect.hpp"
#include "tests/fuzz/fuzzer.hpp"

namespace tessera::fuzz::obj_fuzz {
namespace {

// Every index of a mesh that was built refers to something.
void expect_sound(const core::MeshDescription& mesh, std::size_t material_count) {
  const std::size_t vertices = mesh.positions.size();
  expect(mesh.normals.empty() || mesh.normals.size() == vertices, "a normal for each vertex, or none");
  expect(mesh.uvs.empty() || mesh.uvs.size() == vertices, "texture coordinates for each vertex, or none");
  expect(mesh.colors.empty() || mesh.colors.size() == vertices, "a colour for each vertex, or none");
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) expect(vertex < vertices, "corners are vertices");
  for (const std::uint32_t material : mesh.triangle_materials)
    expect(material < material_count, "materials are those that were given");
}

void read_and_build(std::string_view input) {
  const auto file = core::read_obj(input, "x.obj");
  if (!expect_answer(file)) return;
  std::vector<std::uint32_t> materials(file->runs.size());
  for (std::uint32_t i = 0; i < materials.size(); ++i) materials[i] = i;
  for (const auto mode : {core::NormalsMode::kFile, core::NormalsMode::kSmooth, core::NormalsMode::kFlat}) {
    const auto mesh = core::build_mesh(*file, mode, {}, materials);
    if (expect_answer(mesh)) expect_sound(*mesh, materials.size());
  }
}

}  // namespace

TESSERA_FUZZER(obj, std::string_view input) {
  read_and_build(input);
}

}  // namespace tessera::fuzz::obj_fuzz
