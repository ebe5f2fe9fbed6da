#include "core/scene/scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/scene/validation.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core {
namespace {

std::string error_of(const SceneDescription& description) {
  const auto scene = Scene::build(description, 1);
  return scene ? "" : scene.error().message;
}

MeshDescription triangle() {
  return {.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
          .normals = {},
          .uvs = {},
          .triangles = {{0, 1, 2}},
          .triangle_materials = {0}};
}

SceneDescription with(ShapeDescription shape) {
  SceneDescription description = test::room();
  description.shapes = {std::move(shape)};
  return description;
}

TEST(Scene, FindsEveryLightAndItsPrimitives) {
  const Scene scene = Scene::build(test::room(), 1).value();
  ASSERT_EQ(scene.lights().size(), 2u);
  EXPECT_EQ(scene.primitives().triangle_count(), 12u);
  EXPECT_EQ(scene.light_of(10), 0u);
  EXPECT_EQ(scene.light_of(11), 0u) << "both triangles of a quad are one light";
  EXPECT_EQ(scene.light_of(14), 1u) << "spheres come last";
  EXPECT_EQ(scene.light_of(0), kNoLight);
}

TEST(Scene, TrianglesWithoutAreaAreNoLights) {
  MeshDescription flat = triangle();
  flat.positions[2] = {2, 0, 0};
  flat.triangle_materials = {2};
  EXPECT_TRUE(Scene::build(with(flat), 1)->lights().empty());
}

TEST(Scene, IsDarkWhereNoShapeEmits) {
  EXPECT_TRUE(gives_light(test::room()));
  EXPECT_FALSE(gives_light(with(triangle()))) << "materials that no shape has do not count";
  MeshDescription lit = triangle();
  lit.triangle_materials = {2};
  EXPECT_TRUE(gives_light(with(lit)));
}

TEST(Scene, CanBeEmpty) {
  SceneDescription description = test::room();
  description.shapes.clear();
  EXPECT_TRUE(Scene::build(description, 1).has_value());
}

TEST(Scene, RefusesWhatCannotBeRendered) {
  using testing::HasSubstr;
  MeshDescription mesh = triangle();
  mesh.positions[1].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(error_of(with(mesh)), HasSubstr("shapes[0]: vertex 2: coordinates must be numbers"));
  mesh = triangle();
  mesh.triangles[0][2] = 3;
  EXPECT_THAT(error_of(with(mesh)), HasSubstr("triangle 1: there is no vertex 4"));
  mesh = triangle();
  mesh.normals = {{0, 0, 1}};
  EXPECT_THAT(error_of(with(mesh)), HasSubstr("1 normals for 3 vertices"));
  EXPECT_THAT(error_of(with(SphereDescription{{0, 0, 0}, -1, 0})), HasSubstr("radius above 0"));
  EXPECT_THAT(error_of(with(QuadDescription{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 99})),
              HasSubstr("there is no material 99"));
  EXPECT_THAT(error_of(with(QuadDescription{{1e30f, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0})),
              HasSubstr("at most 1e"));

  SceneDescription description = test::room();
  description.settings.width_px = 0;
  EXPECT_THAT(error_of(description), HasSubstr("render: width: must be between 1 and 65536 pixels, got 0"));
  description = test::room();
  description.camera.look_at = description.camera.position;
  EXPECT_THAT(error_of(description), HasSubstr("camera.look_at: must differ"));
  description = test::room();
  description.camera.up = {0, 0, 1};
  EXPECT_THAT(error_of(description), HasSubstr("camera.up"));
  description = test::room();
  description.materials[0].emission.value.g = -1;
  EXPECT_THAT(error_of(description), HasSubstr("material 'm0': emission"));
}

}  // namespace
}  // namespace tessera::core
