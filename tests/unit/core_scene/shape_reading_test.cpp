// SPDX-License-Identifier: Apache-2.0
// What shapes of good scene files turn into.
#include <gtest/gtest.h>

#include "tests/support/near.hpp"
#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core {
namespace {

using test::load_valid;
using test::MemoryAssets;
using test::scene_with;

TEST(SceneReading, ShapesHaveTheirNamesOrTheirPlaces) {
  const SceneDescription scene = load_valid(
      R"({"camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]}, "materials": {"m": {"type": "lambert"}},
"objects": {"o": {"shapes": [{"type": "sphere", "name": "part", "radius": 1, "material": "m"}]}},
"shapes": [{"type": "mesh", "file": "t.obj", "material": "m"}, {"type": "mesh", "file": "t.obj", "name": "sheet"},
{"type": "sphere", "name": "ball", "radius": 1, "material": "m", "transform": [{"translate": {"keyframes": [{"frame": 0, "value": [0, 0, 0]}, {"frame": 9, "value": [1, 0, 0]}]}}]},
{"type": "instance", "object": "o", "name": "one"}]})",
      {{"t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"}});
  EXPECT_EQ(scene.shape_names, (std::vector<std::string>{"shapes[0] (t.obj)", "sheet", "ball", "one"}));
  ASSERT_FALSE(scene.objects.empty());
  EXPECT_EQ(scene.objects[0].shape_names, std::vector<std::string>{"part"});
}

TEST(SceneReading, AppliesTransformsInTheOrderWritten) {
  const SceneDescription scene = load_valid(scene_with(
      "", "",
      "{\"type\": \"sphere\", \"center\": [1, 0, 0], \"radius\": 1, \"material\": \"light\", \"transform\":"
      "[{\"scale\": 2}, {\"rotate\": {\"axis\": [0, 0, 5], \"degrees\": 90}}, {\"translate\": [10, 20, "
      "30]}]}"));
  const auto& sphere = std::get<SphereDescription>(scene.shapes[0]);
  expect_near(sphere.center, {10, 22, 30}, 1e-5f);
  EXPECT_NEAR(sphere.radius, 2, 1e-5f);
}

TEST(SceneReading, KeepsObjectsOnceAndPlacesTheirInstances) {
  const SceneDescription scene = load_valid(scene_with(
      "\"objects\": {\"ball\": {\"shapes\": [{\"type\": \"sphere\", \"radius\": 2, \"material\": "
      "\"light\"}]}, \"tile\": {\"shapes\": [{\"type\": \"mesh\", \"file\": \"triangle.obj\", "
      "\"material\": \"light\", \"transform\": [{\"scale\": 3}]}]}}",
      "\"red\": {\"type\": \"lambert\"}",
      "{\"type\": \"instance\", \"object\": \"tile\", \"material\": \"red\", \"transform\": [{\"scale\": 2}, "
      "{\"matrix\": [[0, -1, 0, 10], [1, 0, 0, 20], [0, 0, 1, 30]]}]},"
      "{\"type\": \"instance\", \"object\": \"ball\"}"));
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_EQ(scene.objects[0].name, "ball");
  EXPECT_EQ(std::get<SphereDescription>(scene.objects[0].shapes[0]).radius, 2);
  EXPECT_EQ(std::get<MeshDescription>(scene.objects[1].shapes[0]).positions[1], (Vec3{3, 0, 0}));
  EXPECT_EQ(scene.objects[1].shape_names[0], "shapes[0] (triangle.obj)");
  const auto& tile = std::get<InstanceDescription>(scene.shapes[0]);
  EXPECT_EQ(tile.object, 1u);
  EXPECT_EQ(tile.material, 0u);
  EXPECT_EQ(tile.to_world.point({1, 0, 0}), (Vec3{10, 22, 30}));
  EXPECT_EQ(std::get<InstanceDescription>(scene.shapes[1]).material, std::nullopt);
}

// An object may be written before those that it holds.
TEST(SceneReading, ReplacesInstancesInObjects) {
  const SceneDescription scene = load_valid(scene_with(
      "\"objects\": {\"tree\": {\"shapes\": [{\"type\": \"instance\", \"object\": \"leaf\", \"transform\": "
      "[{\"translate\": [1, 0, 0]}]}, {\"type\": \"instance\", \"object\": \"leaf\"}]},"
      "\"leaf\": {\"shapes\": [{\"type\": \"sphere\", \"radius\": 2, \"material\": \"light\"}]}}",
      "", "{\"type\": \"instance\", \"object\": \"tree\", \"transform\": [{\"scale\": 3}]}"));
  ASSERT_EQ(scene.objects.size(), 1u);
  EXPECT_EQ(scene.objects[0].name, "leaf");
  ASSERT_EQ(scene.shapes.size(), 3u) << "with the lamp of every test";
  EXPECT_EQ(std::get<InstanceDescription>(scene.shapes[0]).to_world.point({}), (Vec3{3, 0, 0}));
  EXPECT_EQ(std::get<InstanceDescription>(scene.shapes[1]).to_world.point({}), (Vec3{}));
}

TEST(SceneReading, MirrorsSpheresAndQuads) {
  const SceneDescription scene = load_valid(
      scene_with("", "",
                 "{\"type\": \"sphere\", \"center\": [1, 2, 3], \"radius\": 1, \"material\": \"light\", "
                 "\"transform\": [{\"scale\": [-1, 1, 1]}]},"
                 "{\"type\": \"quad\", \"corner\": [0, 0, 1], \"edge_u\": [2, 0, 0], \"edge_v\": [0, 1, "
                 "0], \"material\": \"light\"},"
                 "{\"type\": \"quad\", \"corner\": [0, 0, 1], \"edge_u\": [2, 0, 0], \"edge_v\": [0, 1, "
                 "0], \"material\": \"light\","
                 " \"transform\": [{\"scale\": [-1, 1, 1]}]}"));
  EXPECT_EQ(std::get<SphereDescription>(scene.shapes[0]).center, (Vec3{-1, 2, 3}));
  EXPECT_EQ(std::get<QuadDescription>(scene.shapes[1]).edge_u, (Vec3{2, 0, 0}));
  // Mirrored in x, the normal still points to z, and each corner keeps its texture coordinate.
  const auto& mesh = std::get<MeshDescription>(scene.shapes[2]);
  for (const auto& [a, b, c] : mesh.triangles)
    EXPECT_GT(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]).z, 0);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(mesh.positions[i].x, -2 * mesh.uvs[i].x);
    EXPECT_EQ(mesh.positions[i].y, mesh.uvs[i].y);
  }
}

TEST(SceneReading, PlacesDisksAndCylinders) {
  const SceneDescription scene = load_valid(scene_with(
      "", "",
      "{\"type\": \"disk\", \"center\": [1, 0, 0], \"radius\": 2, \"inner_radius\": 0.5, \"material\": "
      "\"light\", \"transform\": [{\"scale\": [-3, 1, 1]}]},"
      "{\"type\": \"cylinder\", \"start\": [0, 0, 1], \"end\": [0, 0, 3], \"radius\": 0.5, \"material\": "
      "\"light\", \"flip_normal\": true, \"transform\": [{\"translate\": [5, 0, 0]}]},"
      "{\"type\": \"disk\", \"normal\": [0, 9, 0], \"radius\": 1, \"material\": \"light\"}"));
  const auto& disk = std::get<DiskDescription>(scene.shapes[0]);
  EXPECT_EQ(disk.center, (Vec3{-3, 0, 0}));
  EXPECT_EQ(disk.radius_u, (Vec3{-6, 0, 0}));
  EXPECT_EQ(disk.radius_v, (Vec3{0, 2, 0}));
  EXPECT_EQ(disk.inner, 0.25f);
  EXPECT_TRUE(disk.flipped) << "the front stays at +z";
  const auto& cylinder = std::get<CylinderDescription>(scene.shapes[1]);
  EXPECT_EQ(cylinder.start, (Vec3{5, 0, 1}));
  EXPECT_EQ(cylinder.axis, (Vec3{0, 0, 2}));
  EXPECT_EQ(cylinder.radius_u, (Vec3{0.5f, 0, 0}));
  EXPECT_EQ(cylinder.radius_v, (Vec3{0, 0.5f, 0}));
  EXPECT_TRUE(cylinder.flipped);
  const auto& facing_up = std::get<DiskDescription>(scene.shapes[2]);
  expect_near(cross(facing_up.radius_u, facing_up.radius_v), {0, 1, 0}, 1e-6f);
}

TEST(SceneReading, ReadsAMeshOnceForAllItsShapes) {
  const std::string shape = "{\"type\": \"mesh\", \"file\": \"triangle.obj\", \"material\": \"light\"";
  MemoryAssets assets(
      {{"triangle.obj", test::kTriangleObj},
       {"scene.json",
        scene_with("", "", shape + "}, " + shape + ", \"transform\": [{\"translate\": [0, 0, 7]}]}")}});
  const auto scene = load_scene(assets, "scene.json", "scene.json");
  ASSERT_TRUE(scene.has_value()) << scene.error().message;
  EXPECT_EQ(assets.reads().at("triangle.obj"), 1);
  EXPECT_EQ(scene->shape_names[1], "shapes[1] (triangle.obj)");
  const auto& mesh = std::get<MeshDescription>(scene->shapes[1]);
  EXPECT_EQ(mesh.positions, (std::vector<Vec3>{{0, 0, 7}, {1, 0, 7}, {0, 1, 7}}));
  EXPECT_EQ(mesh.uvs, (std::vector<Vec2>{{0, 0}, {1, 0}, {0, 1}}));
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}}));
}

}  // namespace
}  // namespace tessera::core
