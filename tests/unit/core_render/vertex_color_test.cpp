// SPDX-License-Identifier: Apache-2.0
// Vertex colours multiply what surfaces reflect.
#include <gtest/gtest.h>

#include <vector>

#include "core/integrators/vertex.hpp"
#include "tests/support/mean_radiance.hpp"
#include "tests/support/near.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators::vertex_color_test {
namespace {

MeshDescription square(const std::vector<Rgb>& colors, std::uint32_t material) {
  return {.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}},
          .normals = {},
          .uvs = {},
          .triangles = {{0, 1, 2}, {0, 2, 3}},
          .triangle_materials = {material},
          .colors = colors};
}

// The colour of a square in a white furnace, whose vertices are all of one colour.
Rgb color_in_furnace(const MaterialModel& model, Rgb vertex_color, bool in_instance = false) {
  test::SceneMaker maker({.position = {0, 0, 4}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 2});
  maker.description().environment.emplace().radiance = {Rgb::gray(1)};
  const auto material = maker.material(model);
  const MeshDescription mesh = square(std::vector(4, vertex_color), material);
  if (in_instance) {
    maker.description().objects = {{"square", {mesh}, {}}};
    maker.add(InstanceDescription{0, translation({0, 0, 0.5f}), std::nullopt});
  } else {
    maker.add(mesh);
  }
  maker.add(SphereDescription{{0, 0, -9}, 0.1f, material});
  const Scene scene = maker.build();
  constexpr std::uint32_t kSpp = 1024;
  const RenderSettings settings{.width_px = 1, .height_px = 1, .spp = kSpp};
  const FilmTile tile = render(prepare(scene, settings, 1), {0, 0, 1, 1}, {0, kSpp}, 1);
  const auto value = [&](std::size_t channel) {
    return static_cast<float>(static_cast<double>(tile.sums[channel]) * kFilmUnit / kSpp);
  };
  return {value(0), value(1), value(2)};
}

void expect_color(Rgb actual, Rgb expected, float tolerance) {
  expect_near(Vec3{actual.r, actual.g, actual.b}, Vec3{expected.r, expected.g, expected.b}, tolerance);
}

constexpr Rgb kColor{0.25f, 0.5f, 1};

TEST(VertexColors, MultiplyTheBaseColorOfEachModel) {
  const Lambert matt{{{0.8f, 0.5f, 0.5f}}};
  expect_color(color_in_furnace(matt, kColor), {0.2f, 0.25f, 0.5f}, 3e-3f);
  expect_color(color_in_furnace(matt, kColor, true), {0.2f, 0.25f, 0.5f}, 3e-3f);
  expect_color(color_in_furnace(Mirror{{Rgb::gray(0.8f)}}, kColor), kColor * 0.8f, 3e-3f);
  expect_color(color_in_furnace(Phong{.diffuse = {Rgb::gray(0.8f)}, .specular = {Rgb{}}}, kColor),
               kColor * 0.8f, 3e-3f);
  const CookTorrance paint{.diffuse = {Rgb::gray(0.8f)}, .specular = {Rgb{}}};
  expect_color(color_in_furnace(paint, kColor), kColor * 0.8f, 3e-3f);
}

// A metal without a diffuse part has its colour in f0; seen head-on that is what it reflects.
TEST(VertexColors, MultiplyTheReflectanceOfMetals) {
  const CookTorrance metal{.f0 = {Rgb::gray(0.8f)}, .roughness = 0.05f};
  expect_color(color_in_furnace(metal, kColor), kColor * 0.8f, 5e-3f);
  const CookTorrance lacquer{.diffuse = {Rgb::gray(0.01f)}, .f0 = {Rgb::gray(0.8f)}, .roughness = 0.05f};
  expect_color(color_in_furnace(lacquer, {}), Rgb::gray(0.8f), 1e-2f);
}

TEST(VertexColors, LeaveConductorsAndGlassAsTheyAre) {
  for (const MaterialModel& model :
       {MaterialModel{CookTorrance{.conductor = Conductor::kGold}}, MaterialModel{Glass{}}})
    EXPECT_EQ(color_in_furnace(model, kColor), color_in_furnace(model, Rgb::gray(1)));
}

TEST(VertexColors, AreInterpolatedAndWhiteWhereThereAreNone) {
  test::SceneMaker maker({});
  const auto matt = maker.material(test::lambert(1));
  maker.add(square({}, matt));
  MeshDescription colored = square({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}, matt);
  for (Vec3& p : colored.positions) p = p + Vec3{5, 0, 0};
  maker.add(colored);
  MeshDescription plain = square({}, matt);
  for (Vec3& p : plain.positions) p = p + Vec3{10, 0, 0};
  maker.add(plain);
  maker.add(SphereDescription{{15, 0, 0}, 1, matt});
  const Scene scene = maker.build();
  const auto color_at = [&](float x, float y) {
    const Hit hit = scene.bvh().closest_hit(scene.primitives(), {{x, y, 5}, {0, 0, -1}});
    EXPECT_TRUE(hit.found());
    return scene.primitives().vertex_color(hit);
  };
  for (const float x : {0.2f, 10.2f, 15.2f}) EXPECT_EQ(color_at(x, 0.1f), Rgb::gray(1));
  // (x, y) = (5.5, -0.5) is 1/4 of the first corner, 1/2 of the second and 1/4 of the third.
  expect_color(color_at(5.5f, -0.5f), {0.25f, 0.5f, 0.25f}, 1e-6f);
}

TEST(VertexColors, MustBeAsManyAsVerticesAndSharesOfLight) {
  const auto error = [](const std::vector<Rgb>& colors) {
    test::SceneMaker maker({});
    maker.add(square(colors, maker.material(test::lambert(1))));
    const auto scene = Scene::build(maker.description(), 1);
    return scene ? std::string("none") : scene.error().message;
  };
  EXPECT_EQ(error(std::vector(4, Rgb::gray(1))), "none");
  EXPECT_EQ(error(std::vector(3, Rgb::gray(1))), "shapes[0]: 3 colours for 4 vertices");
  EXPECT_EQ(error({{}, {1, 1.5f, 1}, {}, {}}),
            "shapes[0]: vertex 2: colours must be numbers between 0 and 1");
  EXPECT_EQ(error({{}, {}, {}, {-1, 0, 0}}), "shapes[0]: vertex 4: colours must be numbers between 0 and 1");
}

}  // namespace
}  // namespace tessera::core::integrators::vertex_color_test
