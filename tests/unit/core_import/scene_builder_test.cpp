// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import/scene_builder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "core/scene/import/indexed_mesh.hpp"
#include "core/scene/import/mesh_repair.hpp"
#include "core/scene/import/scene_bounds.hpp"
#include "core/scene/import/scene_counts.hpp"
#include "core/scene/validation.hpp"
#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

const FilePlace kPlace{"s.xyz", 7};

MeshDescription triangle() {
  MeshDescription mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.triangle_materials = {0};
  return mesh;
}

class SceneBuilderTest : public testing::Test {
 protected:
  SceneBuilderTest()
      : assets_({{"a.png", test::png(test::one_color(2, 2, Rgb{0.5f, 0.25f, 1}))},
                 {"Textures/Wood.PNG", test::png(test::one_color(1, 1, Rgb{}))}}) {
    limits_.triangles = {.most = 10, .option = "--triangles"};
  }

  test::MemoryAssets assets_;
  SceneLimits limits_;
  SceneBuilder builder_{assets_, "s.xyz", "folder/s.xyz", limits_};
};

TEST_F(SceneBuilderTest, ParametersWithoutEffectHaveTheirDefaults) {
  Hair dyed;
  dyed.pigment = HairPigment::kAbsorption;
  dyed.sigma_a.value = Rgb::gray(2);
  dyed.eumelanin = 5;
  dyed.reflectance.value = Rgb{};
  CookTorrance gold;
  gold.conductor = Conductor::kGold;
  gold.f0.value = Rgb::gray(1);
  Material bumpy;
  bumpy.normal_map.strength = 3;
  bumpy.bump.height = 2;
  for (const auto& model : {MaterialModel(dyed), MaterialModel(gold)}) {
    bumpy.model = model;
    builder_.add_material(bumpy);
  }
  const auto& materials = builder_.scene().materials;
  const auto& hair = std::get<Hair>(materials[0].model);
  EXPECT_EQ(hair.sigma_a.value, Rgb::gray(2));
  EXPECT_EQ(hair.eumelanin.value, Hair().eumelanin.value);
  EXPECT_EQ(hair.reflectance.value, Hair().reflectance.value);
  const auto& metal = std::get<CookTorrance>(materials[1].model);
  EXPECT_EQ(metal.conductor, Conductor::kGold);
  EXPECT_EQ(metal.f0.value, CookTorrance().f0.value);
  EXPECT_EQ(materials[1].normal_map.strength, 1);
  EXPECT_EQ(materials[1].bump.height, Material().bump.height);
}

TEST_F(SceneBuilderTest, DecodesAnImageOnceAndKeepsEqualTexturesOnce) {
  const auto first = builder_.add_texture("a.png", {});
  const auto second = builder_.add_texture("a.png", {});
  const auto red = builder_.add_texture("a.png", {ColorSpace::kLinear, TextureChannel::kRed});
  ASSERT_TRUE(first && second && red);
  EXPECT_EQ(*first, *second);
  EXPECT_NE(*first, *red);
  const auto& image = *builder_.scene().textures[static_cast<std::size_t>(*red)].image;
  EXPECT_EQ(image.texel(0, 0), Rgb::gray(188.0f / 255)) << "the code of 0.5 in sRGB, in all channels";
}

TEST_F(SceneBuilderTest, DecodesImagesInMemory) {
  const std::string bytes = test::png(test::one_color(1, 1, Rgb{0.5f, 0.25f, 1}));
  const auto blue =
      builder_.image_bytes("s.xyz, image 0", bytes, {ColorSpace::kLinear, TextureChannel::kBlue});
  ASSERT_TRUE(blue);
  EXPECT_EQ((*blue)->texel(0, 0), Rgb::gray(1));
  const auto broken = builder_.image_bytes("s.xyz, image 1", "nonsense", {});
  ASSERT_FALSE(broken);
  EXPECT_THAT(broken.error().message, HasSubstr("'s.xyz, image 1'"));
}

// So that what is written is what is rendered.
TEST_F(SceneBuilderTest, KeepsOnlyTheKeysThatAModelHas) {
  const auto added = [&](MaterialModel model) {
    return builder_.material(builder_.add_material({.name = "m",
                                                    .model = std::move(model),
                                                    .emission = Rgb::gray(2),
                                                    .two_sided = false,
                                                    .shading_normals = ShadingNormals::kPlain,
                                                    .media = {0, 1}}));
  };
  EXPECT_EQ(added(Lambert{}).shading_normals, ShadingNormals::kPlain);
  const Material open = added(Null{});
  EXPECT_EQ(open.shading_normals, ShadingNormals::kConserving);
  EXPECT_TRUE(open.two_sided);
  EXPECT_EQ(open.emission.value, Rgb::gray(2));
  EXPECT_EQ(open.media.exterior, 1);
  EXPECT_EQ(open.name, "m");
}

TEST_F(SceneBuilderTest, RepairsMeshesAndCountsWhatItChanges) {
  MeshDescription mesh = triangle();
  mesh.triangles.push_back({0, 1, 9});
  mesh.triangles.push_back({0, 0, 1});
  mesh.normals = {{0, 0, 1}, {0, 0, 0}, {0, 0, 1}};
  mesh.uvs = {{0, 0}};
  ASSERT_TRUE(builder_.add_mesh(std::move(mesh), "t", std::nullopt, "s.xyz", 7));
  builder_.default_material();
  const auto scene = builder_.finish({});
  ASSERT_TRUE(scene) << scene.error().message;
  const auto& kept = *std::get_if<MeshDescription>(&scene->shapes.at(0));
  EXPECT_THAT(kept.triangles, SizeIs(1));
  EXPECT_EQ(kept.normals.at(1), (Vec3{0, 0, 1}));
  EXPECT_TRUE(kept.uvs.empty());
  EXPECT_THAT(scene->warnings,
              ElementsAre(HasSubstr("folder/s.xyz:7: triangles whose corners"),
                          HasSubstr("triangles without an area are left out"), HasSubstr("normals without"),
                          HasSubstr("texture coordinates are ignored")));
}

// A render tells each kind once, a report each place.
TEST(FileWarningsTest, TellKindsOrPlaces) {
  const auto told = [](const WarningLimits& limits) {
    FileWarnings warnings(limits);
    warnings.add("film", 9, [] { return "film is ignored"; });
    for (const int line : {7, 3, 7}) warnings.add("hair", line, [] { return "hair is ignored"; });
    return warnings.messages("f");
  };
  EXPECT_THAT(told({}), ElementsAre("f:7: hair is ignored (3 times)", "f:9: film is ignored"));
  EXPECT_THAT(told(kReportLimits),
              ElementsAre("f:3: hair is ignored", "f:7: hair is ignored (2 times)", "f:9: film is ignored"));
  EXPECT_THAT(told({2, 9, true}),
              ElementsAre("f:7: hair is ignored", "f:9: film is ignored", "f: and 2 more warnings"));
}

TEST(SceneWarningsTest, CountWhatIsBeyondTheLimit) {
  SceneWarnings warnings({1, 2, false});
  for (const char* file : {"a", "b", "c"}) warnings.of(file).add("x", 1, [] { return "odd"; });
  EXPECT_THAT(warnings.messages(), ElementsAre("a:1: odd", "b:1: odd", "and 1 more warnings"));
}

TEST_F(SceneBuilderTest, RefusesMoreTrianglesThanTheLimit) {
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(builder_.add_mesh(triangle(), "t", std::nullopt, "s.xyz")) << i;
  const auto more = builder_.add_mesh(triangle(), "t", std::nullopt, "b.ply");
  ASSERT_FALSE(more);
  EXPECT_EQ(more.error().code, ErrorCode::kResourceExhausted);
  EXPECT_THAT(more.error().message, HasSubstr("(--triangles)"));
}

TEST_F(SceneBuilderTest, RemovesObjectsThatHaveNoShape) {
  const auto empty = builder_.add_object("empty");
  const auto full = builder_.add_object("full");
  builder_.default_material();
  MeshDescription flat = triangle();
  flat.positions[2] = {2, 0, 0};
  ASSERT_TRUE(builder_.add_mesh(std::move(flat), "flat", empty, "s.xyz"));
  ASSERT_TRUE(builder_.add_mesh(triangle(), "t", full, "s.xyz"));
  builder_.add_instance(empty, Transform(), "i", kPlace);
  builder_.add_instance(full, translation({5, 0, 0}), "j", kPlace);
  const auto scene = builder_.finish({});
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_THAT(scene->objects, SizeIs(1));
  ASSERT_THAT(scene->shapes, SizeIs(1));
  EXPECT_EQ(std::get_if<InstanceDescription>(&scene->shapes[0])->object, 0u);
  EXPECT_EQ(scene_bounds(*scene).upper, (Vec3{6, 1, 0}));
}

TEST_F(SceneBuilderTest, LeavesOutWhatCannotBeRendered) {
  const auto gray = builder_.default_material();
  ASSERT_TRUE(builder_.add_mesh(triangle(), "t", std::nullopt, "s.xyz"));
  const auto object = builder_.add_object("o");
  ASSERT_TRUE(builder_.add_mesh(triangle(), "t", object, "s.xyz"));
  EXPECT_TRUE(builder_.add_shape(SphereDescription{{}, 1, gray}, "ball", std::nullopt, kPlace));
  EXPECT_FALSE(builder_.add_shape(SphereDescription{{}, 0, gray}, "dot", std::nullopt, kPlace));
  EXPECT_FALSE(builder_.add_instance(object, scaling({0, 1, 1}), "i", kPlace));
  builder_.add_light(PointLightDescription{{}, Rgb::gray(0)}, kPlace);
  builder_.add_light(PointLightDescription{{}, Rgb::gray(-1)}, kPlace);
  builder_.set_camera({.position = {}, .look_at = {}});
  Material wrong;
  wrong.name = "wrong";
  wrong.opacity = 2;
  const auto wrong_index = builder_.add_material(wrong);
  wrong.name = "blinding";
  wrong.opacity = 1;
  wrong.emission = {Rgb::gray(std::numeric_limits<float>::infinity())};
  builder_.add_material(wrong);
  builder_.set_environment({{Rgb::gray(-1)}});
  const auto scene = builder_.finish({});
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_TRUE(validate_scene(*scene));
  EXPECT_THAT(scene->shapes, SizeIs(2));
  EXPECT_THAT(scene->lights, SizeIs(0));
  EXPECT_EQ(scene->materials[wrong_index].opacity.value, 1);
  EXPECT_THAT(
      scene->warnings,
      ElementsAre(
          HasSubstr("folder/s.xyz: material 'wrong': opacity is out of range; it is clamped"),
          HasSubstr("folder/s.xyz: the emission of the material 'blinding' is negative or too bright"),
          HasSubstr("folder/s.xyz: environment: radiance must be 0 or greater, got [-1, -1, -1]; it is left "
                    "out"),
          HasSubstr("folder/s.xyz: camera.look_at: must differ from camera.position; a camera that sees"),
          HasSubstr(
              "folder/s.xyz:7: a shape is left out: the centre must be numbers of at most 1e+15 and the "
              "radius above 0 (2 times)"),
          HasSubstr("folder/s.xyz:7: a light without power is left out"),
          HasSubstr("folder/s.xyz:7: a light is left out: intensity must be 0 or greater, got")));
}

TEST_F(SceneBuilderTest, KeepsCameraAndLightsOfTheFile) {
  builder_.default_material();
  ASSERT_TRUE(builder_.add_mesh(triangle(), "t", std::nullopt, "s.xyz"));
  builder_.set_camera({.position = {0, 0, 9}});
  builder_.add_light(PointLightDescription{{0, 0, 1}, Rgb::gray(1)}, kPlace);
  const auto scene = builder_.finish({});
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->camera.position, (Vec3{0, 0, 9}));
  EXPECT_FALSE(scene->environment);
}

TEST_F(SceneBuilderTest, RefusesAFileWithoutShapes) {
  const auto scene = builder_.finish({});
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().message, "folder/s.xyz: has no shape that can be rendered");
}

TEST(MeshRepair, KeepsTheOutsideUnderReflections) {
  MeshDescription mesh = triangle();
  mesh.normals = {{0, 0, 2}, {0, 0, 2}, {0, 0, 2}};
  transform_mesh(mesh, scaling({-1, 1, 1}));
  EXPECT_EQ(mesh.triangles[0], (std::array<std::uint32_t, 3>{0, 2, 1}));
  EXPECT_EQ(mesh.normals[0], (Vec3{0, 0, 1}));
}

TEST(MeshRepair, ClampsColorsAndDropsWhatIsNotFinite) {
  MeshDescription mesh = triangle();
  mesh.positions.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
  mesh.triangles.push_back({0, 1, 3});
  mesh.colors = {{2, 0, 0}, {0, 0, 0}, {0, -1, 0}, {0, 0, 0}};
  const MeshRepairs repairs = repair_mesh(mesh);
  EXPECT_EQ(repairs.broken_triangles, 1u);
  EXPECT_EQ(repairs.clamped_colors, 2u);
  EXPECT_EQ(mesh.colors[0], (Rgb{1, 0, 0}));
  EXPECT_THAT(mesh.triangles, SizeIs(1));
}

// Two triangles that share an edge, bent by the height of the last corner.
MeshDescription bent(float height) {
  MeshDescription mesh;
  mesh.positions = {{0, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {1, 0, height}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}};
  mesh.triangle_materials = {0};
  return mesh;
}

TEST(IndexedMesh, IsSmoothExceptAtSharpEdges) {
  FileWarnings warnings;
  const auto build = [&](float height, NormalsMode mode) {
    return *build_indexed_mesh(bent(height), mode, Transform(), VertexColors::kUse, warnings);
  };
  const MeshDescription smooth = build(0.2f, NormalsMode::kFile);
  EXPECT_THAT(smooth.positions, SizeIs(4));
  EXPECT_EQ(smooth.normals[0], smooth.normals[1]);
  EXPECT_NE(smooth.normals[0], smooth.normals[3]);
  EXPECT_THAT(build(2, NormalsMode::kFile).positions, SizeIs(6)) << "split at the edge";
  EXPECT_THAT(build(2, NormalsMode::kSmooth).positions, SizeIs(4));
  EXPECT_TRUE(build(2, NormalsMode::kFlat).normals.empty());
}

TEST(SceneCounts, CountInstancesAndWhatIsStored) {
  SceneDescription scene;
  scene.materials.resize(1);
  scene.objects.resize(1);
  scene.objects[0].shapes = {triangle()};
  scene.shapes = {triangle(), InstanceDescription{}, InstanceDescription{}, SphereDescription{}};
  const SceneCounts counts = count_scene(scene);
  EXPECT_EQ(counts.triangles, 2u);
  EXPECT_EQ(counts.triangles_with_instances, 3u);
  EXPECT_EQ(counts.shapes.at("instance"), 2u);
  EXPECT_EQ(counts.shapes.at("sphere"), 1u);
  EXPECT_EQ(counts.materials.at("lambert"), 1u);
}

}  // namespace
}  // namespace tessera::core
