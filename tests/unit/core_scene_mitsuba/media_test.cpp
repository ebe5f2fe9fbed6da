// SPDX-License-Identifier: Apache-2.0
// Grid volumes of Mitsuba scenes: media and textures.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include "tests/unit/core_scene_mitsuba/mitsuba_scene.hpp"

namespace tessera::core::test {
namespace {

using testing::ElementsAre;
using testing::FloatEq;
using testing::HasSubstr;
using testing::Not;

void append_word(std::string& bytes, std::uint32_t word) {
  for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<char>(word >> (8 * i)));
}

std::string volume_file(std::array<std::uint32_t, 3> size, const std::vector<float>& values,
                        std::uint32_t channels = 1) {
  std::string bytes = "VOL\3";
  append_word(bytes, 1);
  for (const std::uint32_t side : size) append_word(bytes, side);
  append_word(bytes, channels);
  bytes.append(24, '\0');  // bounds
  const std::size_t header = bytes.size();
  bytes.resize(header + values.size() * sizeof(float));
  std::memcpy(bytes.data() + header, values.data(), values.size() * sizeof(float));
  return bytes;
}

std::string grid(const std::string& name, const std::string& file, const std::string& inside = {}) {
  return "<volume type=\"gridvolume\" name=\"" + name + "\"><string name=\"filename\" value=\"" + file +
         "\"/>" + inside + "</volume>";
}

SceneDescription with_medium(const std::string& coefficients, const MemoryAssets::Files& files) {
  return scene_of("<medium type=\"heterogeneous\" id=\"m\">" + coefficients +
                      "</medium><shape type=\"cube\"><bsdf type=\"null\"/><ref name=\"interior\" "
                      "id=\"m\"/></shape>",
                  files);
}

SceneDescription with_volume_light(const std::string& coefficients, const std::string& radiance,
                                   const MemoryAssets::Files& files = {}) {
  return scene_of("<medium type=\"heterogeneous\" id=\"m\">" + coefficients +
                      "</medium><shape type=\"cube\"><bsdf type=\"null\"/><ref name=\"interior\" id=\"m\"/>"
                      "<emitter type=\"volumelight\">" +
                      radiance + "</emitter></shape>",
                  files);
}

// The red channel of the voxels.
std::vector<float> reds(const SceneDescription& scene, int index) {
  const VoxelGrid& made = scene.grids.at(static_cast<std::size_t>(index));
  EXPECT_EQ(made.channels, 3u);
  std::vector<float> values;
  for (std::size_t i = 0; i < made.voxel_count(); ++i) values.push_back(made.values.at(3 * i));
  return values;
}

TEST(MitsubaMedium, AlbedosAreGridsUnderAConstantExtinction) {
  const SceneDescription scene = with_medium(
      "<float name=\"sigma_t\" value=\"8\"/>" +
          grid("albedo", "a.vol", "<transform name=\"to_world\"><translate x=\"3\"/></transform>"),
      {{"a.vol", volume_file({2, 1, 1}, {0.25f, 1})}});
  ASSERT_EQ(scene.media.size(), 1u);
  const MediumDescription& medium = scene.media[0];
  EXPECT_EQ(medium.sigma_s, Rgb::gray(8));
  EXPECT_EQ(medium.sigma_a, Rgb::gray(8));
  EXPECT_THAT(reds(scene, medium.scattering_grid), ElementsAre(0.25f, 1));
  EXPECT_THAT(reds(scene, medium.absorption_grid), ElementsAre(0.75f, 0));
  EXPECT_EQ(medium.grid_to_world.origin, (Vec3{3, 0, 0}));
}

TEST(MitsubaMedium, TheCoarserGridIsResampledToTheFinerOne) {
  const SceneDescription scene =
      with_medium(grid("sigma_t", "t.vol") + grid("albedo", "a.vol"),
                  {{"t.vol", volume_file({1, 1, 1}, {4})}, {"a.vol", volume_file({2, 1, 1}, {0.25f, 0.5f})}});
  ASSERT_EQ(scene.media.size(), 1u);
  EXPECT_THAT(reds(scene, scene.media[0].scattering_grid), ElementsAre(1, 2));
  EXPECT_THAT(reds(scene, scene.media[0].absorption_grid), ElementsAre(3, 2));
  EXPECT_THAT(warnings_of(scene), HasSubstr("'sigma_t' is resampled"));
}

// The albedo's grid has the upper half of the extinction's; below, it is that of its face.
TEST(MitsubaMedium, GridsInDifferentPlacesShareThatOfTheExtinction) {
  const SceneDescription scene = with_medium(
      grid("sigma_t", "t.vol") +
          grid("albedo", "a.vol",
               "<transform name=\"to_world\"><scale x=\"0.5\"/><translate x=\"0.5\"/></transform>"),
      {{"t.vol", volume_file({4, 1, 1}, {1, 1, 1, 1})}, {"a.vol", volume_file({2, 1, 1}, {0, 1})}});
  ASSERT_EQ(scene.media.size(), 1u);
  EXPECT_EQ(scene.media[0].grid_to_world, Transform{});
  EXPECT_THAT(reds(scene, scene.media[0].scattering_grid), ElementsAre(0, 0, FloatEq(0), FloatEq(1)));
  EXPECT_THAT(warnings_of(scene), HasSubstr("the albedo is resampled"));
}

TEST(MitsubaMedium, GridsOfOneLatticeAreMultipliedAsTheyAre) {
  const SceneDescription scene = with_medium(
      grid("sigma_t", "t.vol") + grid("albedo", "a.vol"),
      {{"t.vol", volume_file({2, 1, 1}, {4, 2})}, {"a.vol", volume_file({2, 1, 1}, {0.25f, 0.5f})}});
  ASSERT_EQ(scene.media.size(), 1u);
  EXPECT_THAT(reds(scene, scene.media[0].scattering_grid), ElementsAre(1, 1));
  EXPECT_THAT(warnings_of(scene), Not(HasSubstr("resampled")));
}

// The radiance per unit of length is sigma_a * scale * emission.
TEST(MitsubaMedium, OfASensorIsAroundTheCamera) {
  const std::string fog = "<medium type='homogeneous' id='fog'><float name='sigma_t' value='2'/></medium>";
  const std::string camera = "<sensor type='perspective'>";
  const SceneDescription referred =
      scene_of(camera + "<ref id='fog'/></sensor>" + fog +
               "<shape type='cube'><bsdf type='null'/><ref name='interior' id='fog'/></shape>");
  EXPECT_EQ(referred.camera_medium, 0);
  EXPECT_EQ(referred.materials.at(0).media.interior, 0);
  EXPECT_EQ(referred.media.size(), 1u);
  EXPECT_THAT(warnings_of(referred), Not(HasSubstr("is ignored")));
  const SceneDescription nested = scene_of(camera + fog + "</sensor>");
  EXPECT_EQ(nested.camera_medium, 0);
  EXPECT_EQ(nested.media.at(0).name, "fog");
  EXPECT_THAT(warnings_of(nested), Not(HasSubstr("is ignored")));
  const SceneDescription two = scene_of(camera + fog + "<medium type='homogeneous'/></sensor>");
  EXPECT_EQ(two.media.size(), 1u);
  EXPECT_THAT(warnings_of(two), HasSubstr("has several media, which Mitsuba refuses; the first one is used"));
}

TEST(MitsubaMedia, EmitByTheirShapesVolumeLights) {
  const std::string radiance = "<rgb name=\"radiance\" value=\"2 0 1\"/>";
  const SceneDescription even = with_volume_light(
      "<float name=\"scale\" value=\"4\"/><rgb name=\"sigma_t\" value=\"1 1 1\"/>"
      "<rgb name=\"albedo\" value=\"0.5 0.5 0.5\"/>",
      radiance);
  EXPECT_EQ(warnings_of(even), "");
  EXPECT_EQ(even.media.at(0).emission, (Rgb{1, 0, 0.5f}));
  EXPECT_TRUE(is_black(even.materials.back().emission.value));
  const SceneDescription clear = with_volume_light("<float name=\"sigma_t\" value=\"0\"/>", radiance);
  EXPECT_THAT(warnings_of(clear), HasSubstr("needs a medium that absorbs"));
  EXPECT_FLOAT_EQ(clear.media.at(0).sigma_a.r * clear.media.at(0).emission.r, 2);
  EXPECT_EQ(clear.media.at(0).sigma_a.g, 0);
  const SceneDescription grids = with_volume_light(
      grid("sigma_t", "t.vol") + "<float name=\"albedo\" value=\"0.5\"/>", grid("radiance", "e.vol"),
      {{"t.vol", volume_file({2, 1, 1}, {1, 4})}, {"e.vol", volume_file({2, 1, 1}, {3, 8})}});
  EXPECT_EQ(warnings_of(grids), "");
  EXPECT_THAT(reds(grids, grids.media.at(0).emission_grid), ElementsAre(FloatEq(6), FloatEq(4)));
  const SceneDescription without =
      scene_of("<shape type=\"cube\"><emitter type=\"volumelight\">" + radiance + "</emitter></shape>");
  EXPECT_THAT(warnings_of(without), HasSubstr("needs a medium inside of its shape"));
}

// A plastic in the colours of a grid.
SceneDescription in_volume(const std::string& inside, const MemoryAssets::Files& files,
                           const std::string& name) {
  return scene_of("<shape type=\"rectangle\"><bsdf type=\"roughplastic\"><texture type=\"volume\" name=\"" +
                      name + "\">" + grid("volume", "t.vol", inside) + "</texture></bsdf></shape>",
                  files);
}

Rgb color_at(const SceneDescription& scene, Vec3 position) {
  const auto& plastic = std::get<Plastic>(scene.materials.at(0).model);
  return plastic.diffuse.evaluate(scene.textures, {UvSets(), position});
}

TEST(MitsubaGridTexture, LiesInTheWorld) {
  const MemoryAssets::Files files{
      {"t.vol", volume_file({2, 1, 2}, {1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5f, 0.5f, 0.5f}, 3)}};
  const SceneDescription scene =
      in_volume("<transform name=\"to_world\"><scale value=\"4\"/><translate x=\"10\"/></transform>", files,
                "diffuse_reflectance");
  EXPECT_EQ(warnings_of(scene), "");
  EXPECT_EQ(color_at(scene, {11, 0, 1}), (Rgb{1, 0, 0}));
  EXPECT_EQ(color_at(scene, {13, 3, 1}), (Rgb{0, 1, 0}));
  EXPECT_EQ(color_at(scene, {13, 3, 3}), Rgb::gray(0.5f));
  EXPECT_EQ(color_at(scene, {12, 0, 1}), (Rgb{0.5f, 0.5f, 0}));
  EXPECT_EQ(color_at(scene, {-100, 0, 100}), (Rgb{0, 0, 1}));
}

TEST(MitsubaGridTexture, MayRepeatWithoutInterpolation) {
  const SceneDescription scene = in_volume(
      "<string name=\"wrap_mode\" value=\"repeat\"/><string name=\"filter_type\" value=\"nearest\"/>",
      {{"t.vol", volume_file({4, 1, 1}, {0, 0.25f, 0.5f, 0.75f})}}, "diffuse_reflectance");
  EXPECT_EQ(warnings_of(scene), "");
  EXPECT_EQ(color_at(scene, {-0.1f, 5, 5}), Rgb::gray(0.75f));
  EXPECT_EQ(color_at(scene, {2.3f, 5, 5}), Rgb::gray(0.25f));
}

// Ours is the square root of the interpolated alpha.
TEST(MitsubaGridTexture, OfAlphaIsRoughness) {
  const SceneDescription scene = in_volume("", {{"t.vol", volume_file({2, 1, 1}, {0.04f, 0.28f})}}, "alpha");
  const auto& plastic = std::get<Plastic>(scene.materials.at(0).model);
  EXPECT_FLOAT_EQ(plastic.roughness.evaluate(scene.textures, {UvSets(), {0.5f, 0, 0}}), 0.4f);
}

TEST(MitsubaGridTexture, IsReadOnceForShapesOfAnyLayout) {
  const SceneDescription scene =
      scene_of("<bsdf type=\"diffuse\" id=\"b\"><texture type=\"volume\" name=\"reflectance\">" +
                   grid("volume", "t.vol") +
                   "</texture></bsdf><shape type=\"rectangle\"><ref id=\"b\"/></shape>"
                   "<shape type=\"sphere\"><ref id=\"b\"/></shape>",
               {{"t.vol", volume_file({2, 1, 1}, {0, 1})}});
  EXPECT_EQ(std::count_if(scene.textures.begin(), scene.textures.end(),
                          [](const Texture& texture) { return texture.image != nullptr; }),
            1);
}

TEST(MitsubaGridTexture, WithoutAFileIsTold) {
  const SceneDescription scene = in_volume("", {}, "diffuse_reflectance");
  EXPECT_THAT(warnings_of(scene), HasSubstr("'t.vol' does not exist"));
  EXPECT_THAT(warnings_of(scene), HasSubstr("the constant 0.5 replaces it"));
  EXPECT_EQ(color_at(scene, {}), Rgb::gray(0.5f));
}

TEST(MitsubaGridTexture, OfLightsIsItsMean) {
  const SceneDescription scene =
      scene_of("<emitter type=\"point\"><texture type=\"volume\" name=\"intensity\">" +
                   grid("volume", "t.vol") + "</texture></emitter>",
               {{"t.vol", volume_file({1, 1, 1}, {3})}});
  EXPECT_THAT(warnings_of(scene), HasSubstr("the mean replaces the texture of 'intensity'"));
  EXPECT_NEAR(std::get<PointLightDescription>(scene.lights.at(0)).intensity.r, 3, 1e-4f);
}

}  // namespace
}  // namespace tessera::core::test
