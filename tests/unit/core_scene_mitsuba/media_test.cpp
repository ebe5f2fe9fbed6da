// SPDX-License-Identifier: Apache-2.0
// The media of Mitsuba scenes with grids.
#include <gmock/gmock.h>

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

// A grid volume file of one channel.
std::string volume_file(std::array<std::uint32_t, 3> size, const std::vector<float>& values) {
  std::string bytes = "VOL\3";
  append_word(bytes, 1);
  for (const std::uint32_t side : size) append_word(bytes, side);
  append_word(bytes, 1);
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

}  // namespace
}  // namespace tessera::core::test
