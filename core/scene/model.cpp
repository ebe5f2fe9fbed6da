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
  const std::uint32_t first_triangle = primitives.triangle_count();
  primitives.add_mesh(std::move(mesh.positions), mesh.normals, mesh.uvs, std::move(mesh.triangles),
                      mesh.triangle_materials, mesh.colors, mesh.second_uvs, mesh.tangents);
  if (!mesh.steps.empty()) primitives.deform_last_mesh(mesh.steps, first_triangle);
}

// Calls add(shape) for each shape of a type, in order, and notes where its primitives begin.
template <typename Description, typename Add>
void add_each(std::vector<ShapeDescription>& shapes, Model& model, const Add& add) {
  for (std::uint32_t i = 0; i < shapes.size(); ++i) {
    auto* shape = std::get_if<Description>(&shapes[i]);
    if (shape == nullptr) continue;
    model.starts.push_back({model.primitives.shape_count(), i});
    add(*shape);
  }
}

// Meshes and quads, in their order among each other: those that deform, or the others.
void add_triangles(std::vector<ShapeDescription>& shapes, Model& model, bool deforming) {
  for (std::uint32_t i = 0; i < shapes.size(); ++i) {
    if (deforms(shapes[i]) != deforming) continue;
    const ShapeStart start{model.primitives.shape_count(), i};
    if (auto* mesh = std::get_if<MeshDescription>(&shapes[i]))
      add_mesh(std::exchange(*mesh, {}), model.primitives);
    else if (const auto* quad = std::get_if<QuadDescription>(&shapes[i]))
      add_quad(*quad, model);
    else
      continue;
    model.starts.push_back(start);
  }
}

}  // namespace

Model make_model(std::vector<ShapeDescription>& shapes) {
  Model model;
  Primitives& primitives = model.primitives;
  reserve(shapes, primitives);
  add_triangles(shapes, model, false);
  add_triangles(shapes, model, true);
  add_each<SphereDescription>(shapes, model, [&](const SphereDescription& sphere) {
    primitives.add_sphere(sphere.center, sphere.radius, sphere.material);
  });
  add_each<DiskDescription>(shapes, model, [&](const DiskDescription& disk) {
    primitives.add_disk(geometry_of(disk), disk.material);
  });
  add_each<CylinderDescription>(shapes, model, [&](const CylinderDescription& cylinder) {
    primitives.add_cylinder(geometry_of(cylinder), cylinder.material);
  });
  add_each<CurvesDescription>(shapes, model, [&](CurvesDescription& curves) {
    primitives.add_curves(std::exchange(curves.strands, {}), curves.material);
  });
  return model;
}

}  // namespace tessera::core
