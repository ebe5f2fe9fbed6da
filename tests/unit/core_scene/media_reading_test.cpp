// SPDX-License-Identifier: Apache-2.0
// Media and grids in scene files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <vector>

#include "core/scene/loader/volume_reader.hpp"
#include "core/scene/scene.hpp"
#include "core/scene/validation.hpp"
#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core::media_reading_test {
namespace {

using testing::HasSubstr;

std::string with_word(std::string bytes, std::uint32_t word) {
  for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<char>(word >> (8 * i)));
  return bytes;
}

// A grid volume file of one channel, or of three.
std::string volume(std::array<std::uint32_t, 3> size, const std::vector<float>& values,
                   std::uint32_t channels = 1, std::uint32_t encoding = 1) {
  std::string bytes = with_word("VOL\3", encoding);
  for (const std::uint32_t side : size) bytes = with_word(std::move(bytes), side);
  bytes = with_word(std::move(bytes), channels);
  bytes.append(24, '\0');  // bounds
  const std::size_t header = bytes.size();
  bytes.resize(header + values.size() * sizeof(float));
  if (!values.empty()) std::memcpy(bytes.data() + header, values.data(), values.size() * sizeof(float));
  return bytes;
}

const test::MemoryAssets::Files kFiles{{"smoke.vol", volume({2, 1, 1}, {1, 3})}};

constexpr const char* kMedia = R"("media": {
  "fog": {"sigma_s": 0.5, "g": 0.3},
  "smoke": {"sigma_a": [1, 2, 3], "sigma_s": 4, "scale": 2, "emission": 5, "absorption_grid": "density",
            "scattering_grid": "density", "transform": [{"scale": 3}, {"translate": [1, 0, 0]}]}},
  "grids": {"density": {"file": "smoke.vol", "filter": "nearest", "border": "zero"}})";
constexpr const char* kMaterials =
    R"("jar": {"type": "glass", "interior_medium": "smoke", "exterior_medium": "fog"})";

TEST(MediaReading, ReadsEverything) {
  const auto scene = test::load(test::scene_with(kMedia, kMaterials, ""), kFiles);
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->media.size(), 2u);
  const MediumDescription &fog = scene->media[0], &smoke = scene->media[1];
  EXPECT_EQ(fog.name, "fog");
  EXPECT_EQ(fog.sigma_s, Rgb::gray(0.5f));
  EXPECT_EQ(fog.g, 0.3f);
  EXPECT_FALSE(fog.has_grid());
  EXPECT_EQ(smoke.sigma_a, (Rgb{1, 2, 3}));
  EXPECT_EQ(smoke.scale, 2);
  EXPECT_EQ(smoke.emission, Rgb::gray(5));
  EXPECT_EQ(smoke.absorption_grid, 0);
  EXPECT_EQ(smoke.scattering_grid, 0);
  EXPECT_EQ(smoke.emission_grid, -1);
  EXPECT_EQ(smoke.grid_to_world.point({1, 1, 1}), (Vec3{4, 3, 3}));
  ASSERT_EQ(scene->grids.size(), 1u);
  EXPECT_EQ(scene->grids[0].values, (std::vector<float>{1, 3}));
  EXPECT_EQ(scene->grids[0].filter, GridFilter::kNearest);
  EXPECT_EQ(scene->grids[0].border, GridBorder::kZero);
  EXPECT_EQ(scene->materials[0].media, (MediumInterface{1, 0}));
  EXPECT_EQ(scene->camera_medium, kNoMedium);
  EXPECT_TRUE(Scene::build(*scene, 1)->has_media());
}

TEST(MediaReading, TheCameraMayBeInAMedium) {
  const auto scene = test::load(R"({
    "camera": {"position": [0, 0, 5], "look_at": [0, 0, 0], "medium": "fog"},
    "media": {"fog": {"sigma_a": 1, "emission": 1}},
    "materials": {"m": {"type": "lambert"}},
    "shapes": [{"type": "sphere", "radius": 1, "material": "m"}]})");
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->camera_medium, 0);
  EXPECT_TRUE(gives_light(*scene));
}

TEST(MediaReading, NamesMistakes) {
  const auto mistakes_of = [](const std::string& medium) {
    return test::mistakes_in(test::scene_with("\"media\": {\"fog\": " + medium + "}", "", ""));
  };
  EXPECT_EQ(mistakes_of("{}"), "no mistake");
  EXPECT_THAT(mistakes_of(R"({"sigma_s": -1})"), HasSubstr("0 or greater"));
  EXPECT_THAT(mistakes_of(R"({"g": 1})"), HasSubstr("greater than -1 and less than 1"));
  EXPECT_THAT(mistakes_of(R"({"sigma": 1})"), HasSubstr("sigma"));
  EXPECT_THAT(mistakes_of(R"({"absorption_grid": "mist"})"), HasSubstr("there is no grid 'mist'"));
  EXPECT_THAT(mistakes_of(R"({"transform": [{"scale": 2}]})"), HasSubstr("without grids"));
  EXPECT_THAT(
      test::mistakes_in(
          test::scene_with(kMedia, R"("jar": {"type": "glass", "interior_medium": "fogg"})", ""), kFiles),
      HasSubstr("there is no medium 'fogg'"));
}

std::string mistake_in_volume(const std::string& bytes) {
  const auto grid = read_volume(bytes);
  return grid ? "no mistake" : grid.error().message;
}

TEST(VolumeReader, ReadsChannelsAndRefusesDamage) {
  const std::string good = volume({1, 2, 1}, {1, 2, 3, 4, 5, 6}, 3);
  const auto grid = read_volume(good);
  ASSERT_TRUE(grid) << grid.error().message;
  EXPECT_TRUE(is_sound(*grid));
  EXPECT_EQ(value_at(*grid, {0.5f, 0.1f, 0.5f}), (Rgb{1, 2, 3}));
  EXPECT_THAT(mistake_in_volume(good.substr(0, good.size() - 1)), HasSubstr("cut short"));
  EXPECT_THAT(mistake_in_volume(good.substr(0, 40)), HasSubstr("not a grid volume"));
  EXPECT_THAT(mistake_in_volume(volume({1, 1, 1}, {1}, 1, 3)), HasSubstr("encoding 3"));
  EXPECT_THAT(mistake_in_volume(volume({1, 1, 1}, {1, 1}, 2)), HasSubstr("2 channels"));
  EXPECT_THAT(mistake_in_volume(volume({1, 0, 1}, {})), HasSubstr("a side may have"));
  EXPECT_THAT(mistake_in_volume(volume({16384, 16384, 16384}, {1})), HasSubstr("cut short"));
  EXPECT_THAT(mistake_in_volume(volume({1, 1, 1}, {-1})), HasSubstr("the value -1 in voxel 0"));
  EXPECT_THAT(mistake_in_volume(volume({1, 1, 1}, {std::numeric_limits<float>::infinity()})),
              HasSubstr("inf"));
}

}  // namespace
}  // namespace tessera::core::media_reading_test
