// SPDX-License-Identifier: Apache-2.0
// Vertices in lanes are to the bit what each is alone.
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "tests/unit/core_render/vertex_lanes.hpp"

namespace tessera::core::integrators {
namespace {

MeshDescription as_mesh(const QuadDescription& quad) {
  const Vec3 c = quad.corner, u = quad.edge_u, v = quad.edge_v;
  return {.positions = {c, c + u, c + u + v, c + v},
          .normals = {},
          .uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}},
          .triangles = {{0, 1, 2}, {0, 2, 3}},
          .triangle_materials = {quad.material}};
}

TEST_F(VertexLanes, OfDiffuseTriangles) {
  compare_diffuse();
}

TEST_F(VertexLanes, OfGlossyTriangles) {
  compare_glossy();
}

TEST_F(VertexLanes, OfAllMaterialsAndShapes) {
  compare_all();
}

// The same scene whose triangles have vertex colours, with bump maps and lamps that let light pass.
SceneDescription with_vertex_colors_and_opacity() {
  SceneDescription scene = fingerprint_scene();
  for (ShapeDescription& shape : scene.shapes)
    if (const auto* quad = std::get_if<QuadDescription>(&shape)) shape = as_mesh(*quad);
  for (auto* shapes : {&scene.shapes, &scene.objects[0].shapes})
    for (ShapeDescription& shape : *shapes)
      if (auto* mesh = std::get_if<MeshDescription>(&shape))
        for (std::size_t i = 0; i < mesh->positions.size(); ++i)
          mesh->colors.push_back({1, 0.25f * static_cast<float>(i % 5), 0.5f});
  for (Material& material : scene.materials) {
    if (material.name == "varnish" || material.name == "tiles") material.bump = {0, 0.1f};
    if (material.name == "lamp") material.opacity = 0.5f;
    if (material.name == "screen") material.opacity = {0.5f, 2};
    if (material.name == "lacquer") std::get<CookTorrance>(material.model).diffuse = {Rgb{}};
  }
  return scene;
}

class ColoredLanes : public VertexLanes {
 protected:
  ColoredLanes() : VertexLanes(with_vertex_colors_and_opacity()) {}
};

TEST_F(ColoredLanes, OfDiffuseTriangles) {
  compare_diffuse();
}

TEST_F(ColoredLanes, OfGlossyTriangles) {
  compare_glossy();
}

TEST_F(ColoredLanes, OfAllMaterialsAndShapes) {
  compare_all();
}

// Whether a mesh or sphere of one material reflects only.
bool only_reflects(const SceneDescription& scene, const ShapeDescription& shape) {
  const auto reflects = [&](std::uint32_t material) {
    return is_black(scene.materials[material].emission.value);
  };
  if (const auto* sphere = std::get_if<SphereDescription>(&shape)) return reflects(sphere->material);
  const auto* mesh = std::get_if<MeshDescription>(&shape);
  return mesh != nullptr && mesh->triangle_materials.size() == 1 && reflects(mesh->triangle_materials[0]);
}

// The same scene with such shapes in objects of their own, shown at two places: moved, turned, stretched and
// reflected.
SceneDescription with_instances() {
  SceneDescription scene = fingerprint_scene();
  const std::array places{compose(translation({0.2f, 0.1f, -0.1f}), rotation({0.3f, 1, 0.2f}, 7)),
                          compose(translation({-0.1f, 0.4f, 0.3f}),
                                  compose(rotation({1, 0.2f, -0.4f}, 25), scaling({-0.9f, 1.2f, 0.8f})))};
  std::vector<ShapeDescription> shapes;
  for (ShapeDescription& shape : scene.shapes) {
    if (const auto* quad = std::get_if<QuadDescription>(&shape)) shape = as_mesh(*quad);
    if (!only_reflects(scene, shape)) {
      shapes.push_back(shape);
      continue;
    }
    const auto object = static_cast<std::uint32_t>(scene.objects.size());
    scene.objects.push_back({.name = "part", .shapes = {shape}, .shape_names = {}});
    for (const Transform& place : places) shapes.push_back(InstanceDescription{object, place, std::nullopt});
  }
  scene.shapes = std::move(shapes);
  return scene;
}

class InstancedLanes : public VertexLanes {
 protected:
  InstancedLanes() : VertexLanes(with_instances()) {}
};

TEST_F(InstancedLanes, OfAllMaterialsAndShapes) {
  compare_all();
  int instanced = 0;
  for (int i = 0; i < 1000; ++i) {
    const Ray ray{random_point(), random_point()};
    instanced += scene_.bvh().closest_hit(scene_.primitives(), ray).in_instance() ? 1 : 0;
  }
  EXPECT_GT(instanced, 300);
}

TEST_F(InstancedLanes, OfTheKernelsOfFrequentMaterials) {
  const auto look_at_instances = [&](bool (*only_at)(const Material&)) {
    return look(
        [&](const Ray& ray, const Hit& hit) { return hit.in_instance() && only_at(scatterer(ray, hit)); });
  };
  for (int i = 0; i < 500 && !HasFatalFailure(); ++i) {
    compare_batch(look_at_instances(is_of<Kernel::kDiffuse>), false, diffuse_vertices);
    compare_batch(look_at_instances(is_of<Kernel::kGlossy>), false, glossy_vertices);
  }
  EXPECT_GT(samples_found_, 5000);
}

}  // namespace
}  // namespace tessera::core::integrators
