// SPDX-License-Identifier: Apache-2.0
#include "core/scene/model.hpp"

#include <utility>
#include <variant>

#include "core/scene/analytic_shapes.hpp"

namespace tessera::core {
namespace {

void add_quad(const QuadDescription& quad, Model& model) {
  const Vec3 c = quad.corner, u = quad.edge_u, v = quad.edge_v;
  model.quads.push_back({model.primitives.triangle_count(), {c, u, v}});
  model.primitives.add_mesh({c, c + u, c + u + v, c + v}, {}, {{0, 0}, {1, 0}, {1, 1}, {0, 1}},
                            {{0, 1, 2}, {0, 2, 3}}, {quad.material});
}

// Reserves memory for several meshes, which are copied; a single one is moved.
void reserve(const std::vector<ShapeDescription>& shapes, Primitives& primitives) {
  std::size_t meshes = 0, vertices = 0, triangles = 0;
  for (const ShapeDescription& shape : shapes)
    if (const auto* mesh = std::get_if<MeshDescription>(&shape)) {
      ++meshes;
      vertices += mesh->positions.size();
      triangles += mesh->triangles.size();
    }
  if (meshes > 1) primitives.reserve(vertices, triangles);
}

// Moves the mesh's memory or frees it before the next is added.
void add_mesh(MeshDescription mesh, Primitives& primitives) {
  primitives.add_mesh(std::move(mesh.positions), mesh.normals, mesh.uvs, std::move(mesh.triangles),
                      mesh.triangle_materials, mesh.colors);
}

}  // namespace

Model make_model(std::vector<ShapeDescription>& shapes) {
  Model model;
  reserve(shapes, model.primitives);
  for (auto& shape : shapes) {
    if (auto* mesh = std::get_if<MeshDescription>(&shape)) {
      add_mesh(std::move(*mesh), model.primitives);
    } else if (const auto* quad = std::get_if<QuadDescription>(&shape)) {
      add_quad(*quad, model);
    }
  }
  for (const auto& shape : shapes)
    if (const auto* sphere = std::get_if<SphereDescription>(&shape))
      model.primitives.add_sphere(sphere->center, sphere->radius, sphere->material);
  for (const auto& shape : shapes)
    if (const auto* disk = std::get_if<DiskDescription>(&shape))
      model.primitives.add_disk(geometry_of(*disk), disk->material);
  for (const auto& shape : shapes)
    if (const auto* cylinder = std::get_if<CylinderDescription>(&shape))
      model.primitives.add_cylinder(geometry_of(*cylinder), cylinder->material);
  return model;
}

}  // namespace tessera::core
