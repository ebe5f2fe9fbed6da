// SPDX-License-Identifier: Apache-2.0
// The media of pbrt files.
#include <gmock/gmock.h>

#include <span>

#include "core/scene/pbrt/cloud_density.hpp"
#include "tests/support/nanovdb_bytes.hpp"
#include "tests/unit/core_scene_pbrt/pbrt_scene.hpp"

namespace tessera::core::test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::Ge;
using testing::Gt;
using testing::HasSubstr;
using testing::Le;

TEST(PbrtMedia, MediaLieOnTheSidesOfSurfaces) {
  const SceneDescription scene = pbrt_world(
      "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [1 2 3] \"rgb sigma_s\" [4 5 "
      "6]\n"
      "  \"float scale\" 2 \"float g\" 0.5\n"
      "AttributeBegin MediumInterface \"fog\" \"\" Material \"interface\" Shape \"sphere\" AttributeEnd\n"
      "Material \"interface\" Shape \"sphere\" Shape \"disk\"\n");
  ASSERT_EQ(scene.media.size(), 1u);
  EXPECT_EQ(scene.media[0].sigma_a, (Rgb{1, 2, 3}));
  EXPECT_EQ(scene.media[0].sigma_s, (Rgb{4, 5, 6}));
  EXPECT_EQ(scene.media[0].scale, 2);
  EXPECT_EQ(scene.media[0].g, 0.5f);
  // An interface between equal media has no effect.
  ASSERT_EQ(scene.shapes.size(), 1u);
  const Material& material = scene.materials.at(sphere_of(scene).material);
  EXPECT_TRUE(std::holds_alternative<Null>(material.model));
  EXPECT_EQ(material.media, (MediumInterface{0, kNoMedium}));
}

TEST(PbrtMedia, MediaHaveMeasuredCoefficients) {
  const auto medium = [](const std::string& preset) {
    const SceneDescription scene =
        pbrt_world("MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"string preset\" \"" + preset +
                   "\"\nMediumInterface \"m\" \"\" Material \"interface\" Shape \"sphere\"\n");
    return std::pair(scene.media.at(0), warnings_of(scene));
  };
  const auto [coke, nothing] = medium("Coke");
  EXPECT_EQ(coke.sigma_a, (Rgb{0.10014f, 0.16503f, 0.2468f}));
  EXPECT_EQ(coke.sigma_s, (Rgb{8.9053e-5f, 8.372e-5f, 0}));
  EXPECT_THAT(nothing, testing::Not(HasSubstr("medium")));
  const auto [tar, told] = medium("Tar");
  EXPECT_EQ(tar.sigma_s, Rgb::gray(1));
  EXPECT_THAT(told, HasSubstr("the medium 'Tar' is not known; its sigma_a and sigma_s are used"));
}

TEST(PbrtMedia, GridsOfMediaFillTheirBox) {
  const SceneDescription scene = pbrt_world(
      "Translate 1 0 0\n"
      "MakeNamedMedium \"smoke\" \"string type\" \"uniformgrid\" \"integer nx\" 2 \"integer ny\" 1 \"integer "
      "nz\" 1\n"
      "  \"float density\" [0.5 1] \"point3 p0\" [0 0 0] \"point3 p1\" [2 2 2] \"rgb sigma_a\" [1 1 1]\n"
      "MediumInterface \"smoke\" \"\" Material \"interface\" Shape \"sphere\"\n");
  ASSERT_EQ(scene.grids.size(), 1u);
  EXPECT_EQ(scene.grids[0].values, (std::vector<float>{0.5f, 1}));
  ASSERT_EQ(scene.media.size(), 1u);
  EXPECT_EQ(scene.media[0].absorption_grid, 0);
  EXPECT_EQ(scene.media[0].scattering_grid, 0);
  EXPECT_LT(length(scene.media[0].grid_to_world.point({1, 1, 1}) - Vec3{3, 2, 2}), 1e-5f);
}

// A single value is interpolated with the 0 around the box.
TEST(PbrtMedia, EmissionOfAGridWithoutSharesFallsOffTowardsItsFaces) {
  const SceneDescription scene = pbrt_world(
      "MakeNamedMedium \"fire\" \"string type\" \"uniformgrid\" \"float density\" 1 \"rgb Le\" [1 1 1]\n"
      "MediumInterface \"fire\" \"\" Material \"interface\" Shape \"sphere\"\n");
  ASSERT_EQ(scene.media.at(0).emission_grid, 1);
  EXPECT_EQ(value_at(scene.grids.at(1), {0.5f, 0.5f, 0.5f}), Rgb::gray(1));
  EXPECT_EQ(value_at(scene.grids.at(1), {0, 0.5f, 0.5f}), Rgb::gray(0.5f));
}

// Pharr et al. 2023, section 11.4.6: full below the height 0.5, nothing at 1, noise between.
TEST(PbrtMedia, CloudsAreGrids) {
  const SceneDescription scene = pbrt_world(
      "MakeNamedMedium \"cloud\" \"string type\" \"cloud\" \"float density\" 2\n"
      "  \"point3 p0\" [-1 0.25 -0.02] \"point3 p1\" [1 1 0.02]\n"
      "MediumInterface \"cloud\" \"\" Material \"interface\" Shape \"sphere\"\n");
  ASSERT_EQ(scene.grids.size(), 1u);
  const VoxelGrid& grid = scene.grids[0];
  EXPECT_EQ(grid.size, (std::array<std::uint32_t, 3>{128, 48, 3}));
  EXPECT_TRUE(is_sound(grid));
  // At the heights 0.258 and 0.992.
  const auto layer = [&](std::size_t y) {
    std::vector<float> values;
    for (std::size_t z = 0; z < 3; ++z)
      for (std::size_t x = 0; x < 128; ++x) values.push_back(grid.values[(z * 48 + y) * 128 + x]);
    return values;
  };
  EXPECT_THAT(layer(0), Each(AllOf(Ge(0.48f), Le(1.0f))));
  EXPECT_THAT(layer(47), Each(AllOf(Ge(0.0f), Le(0.05f))));
  EXPECT_THAT(layer(24), Contains(0.0f));
  EXPECT_THAT(layer(24), Contains(Gt(0.5f)));
  EXPECT_EQ(scene.media.at(0).scattering_grid, 0);
  EXPECT_THAT(warnings_of(scene), HasSubstr("a grid of 128 x 48 x 3 voxels"));
}

TEST(PbrtMedia, CloudsReachAboveTheHeight1) {
  const pbrt::CloudDensity cloud;
  int clouded = 0;
  for (int i = 0; i < 200; ++i) clouded += cloud.at({0.013f * static_cast<float>(i), 1.5f, 0.2f}) > 0 ? 1 : 0;
  EXPECT_GT(clouded, 20);
  EXPECT_LT(clouded, 180);
  EXPECT_EQ(cloud.at({0.1f, 1, 0.2f}), 0);
}

TEST(PbrtMedia, NanoVdbFilesAreGrids) {
  const std::string grid = NanoVdbGridBytes().bytes;
  const std::string file = nanovdb_file("density", grid, grid.size());
  const SceneDescription scene = pbrt_world(
      "Translate 10 0 0 MakeNamedMedium \"smoke\" \"string type\" \"nanovdb\" \"string filename\" "
      "\"a.nvdb\"\n"
      "  \"rgb sigma_s\" [2 2 2] \"float LeScale\" 3 \"float temperaturescale\" 3\n"
      "MediumInterface \"smoke\" \"\" Material \"interface\" Shape \"sphere\"\n",
      {{"a.nvdb", file + nanovdb_file("temperature", grid, grid.size())}});
  ASSERT_EQ(scene.grids.size(), 2u);
  const MediumDescription& smoke = scene.media.at(0);
  EXPECT_EQ(smoke.sigma_s, Rgb::gray(2));
  EXPECT_EQ(smoke.sigma_a, Rgb::gray(1));
  EXPECT_LT(length(smoke.grid_to_world.point({1, 1, 1}) - Vec3{14.75f, 5.75f, 6.75f}), 1e-5f);
  EXPECT_EQ(smoke.emission, Rgb::gray(3));
  const VoxelGrid& light = scene.grids.at(static_cast<std::size_t>(smoke.emission_grid));
  EXPECT_EQ(light.channels, 3u);
  EXPECT_EQ(light.values[0], 0);
  EXPECT_GT(light.values[3 * 511], light.values[3 * 511 + 1]);
  EXPECT_GT(light.values[3 * 511 + 1], 0.01f);
  EXPECT_THAT(warnings_of(scene), HasSubstr("the light of temperatures is computed at the voxels"));
}

TEST(PbrtMedia, NanoVdbFilesThatCannotBeReadAreTold) {
  const auto told = [](const MemoryAssets::Files& files) {
    return warnings_of(
        pbrt_world("MakeNamedMedium \"smoke\" \"string type\" \"nanovdb\" \"string filename\" "
                   "\"a.nvdb\"\n" +
                       kPbrtTriangle,
                   files));
  };
  EXPECT_THAT(told({}), HasSubstr("scene.pbrt:2: the file 'a.nvdb' does not exist"));
  EXPECT_THAT(told({{"a.nvdb", "NanoVDB"}}), HasSubstr("the file 'a.nvdb' is a broken NanoVDB file"));
  EXPECT_THAT(told({{"a.nvdb", nanovdb_file("heat", "", 0)}}), HasSubstr("has no grid 'density'"));
}

// The colour of a black body at 6500 K is nearly white, and it is brightest at a visible wavelength.
TEST(PbrtMedia, TemperaturesGlow) {
  const SceneDescription scene = pbrt_world(
      "MakeNamedMedium \"fire\" \"string type\" \"uniformgrid\" \"integer nx\" 3 \"float density\" [1 1 1]\n"
      "  \"float temperature\" [1000 3500 50] \"float temperaturescale\" 2 \"float temperatureoffset\" 250\n"
      "MediumInterface \"fire\" \"\" Material \"interface\" Shape \"sphere\"\n");
  const MediumDescription& fire = scene.media.at(0);
  const VoxelGrid& light = scene.grids.at(static_cast<std::size_t>(fire.emission_grid));
  ASSERT_EQ(light.values.size(), 9u);
  EXPECT_LT(light.values[0], 0.05f);
  for (std::size_t channel = 3; channel < 6; ++channel) EXPECT_NEAR(light.values[channel], 0.95f, 0.1f);
  EXPECT_THAT(std::span(light.values).last(3), Each(0.0f));
}

}  // namespace
}  // namespace tessera::core::test
