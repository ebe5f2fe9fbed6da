// SPDX-License-Identifier: Apache-2.0
// The scenes of the figures load, and those that are compared with each other differ in what is compared
// alone.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "core/scene/loader/loader.hpp"

namespace tessera {
namespace {

using nlohmann::json;

const std::string kScenes = TESSERA_SCENES_DIR "/";

class SceneFile : public testing::TestWithParam<const char*> {};

TEST_P(SceneFile, Loads) {
  const auto scene = core::load_scene_file(kScenes + GetParam());
  EXPECT_TRUE(scene) << scene.error().message;
}

INSTANTIATE_TEST_SUITE_P(Figures, SceneFile,
                         testing::Values("whitted_and_path/whitted.json", "whitted_and_path/path.json",
                                         "small_light/scene.json", "cook_torrance_sampling/uniform.json",
                                         "cook_torrance_sampling/half_vector.json",
                                         "cook_torrance_sampling/visible_normals.json",
                                         "veach_mis/scene.json", "glass_and_water/no_fresnel.json",
                                         "glass_and_water/fresnel.json", "menagerie/scene.json",
                                         "turntable/scene.json", "fog/scene.json", "motion/scene.json",
                                         "prism/scene.json", "swatches/scene.json"));

json read(const std::string& path) {
  std::ifstream file(kScenes + path);
  return json::parse(file, nullptr, true, true);
}

json without_material_key(json scene, const std::string& key) {
  for (auto& material : scene["materials"]) material.erase(key);
  return scene;
}

json without_lamp(json scene) {
  scene.erase("render");
  scene.erase("lights");
  scene["materials"].erase("lamp");
  json shapes;
  for (const json& shape : scene["shapes"]) {
    if (shape["material"] != "lamp") shapes.push_back(shape);
  }
  scene["shapes"] = shapes;
  return scene;
}

TEST(WhittedAndPath, AreTheSameRoomButForTheLamp) {
  const json whitted = read("whitted_and_path/whitted.json"), path = read("whitted_and_path/path.json");
  EXPECT_EQ(without_lamp(whitted), without_lamp(path));
  EXPECT_EQ(whitted["lights"][0]["type"], "point");
  EXPECT_EQ(whitted["render"]["integrator"], "whitted");
  EXPECT_EQ(path["render"]["integrator"], "nee");
}

TEST(CookTorranceSampling, DiffersInSamplingAlone) {
  const json uniform = read("cook_torrance_sampling/uniform.json");
  const json half_vector = read("cook_torrance_sampling/half_vector.json");
  const json visible = read("cook_torrance_sampling/visible_normals.json");
  EXPECT_EQ(without_material_key(uniform, "sampling"), without_material_key(visible, "sampling"));
  EXPECT_EQ(without_material_key(half_vector, "sampling"), without_material_key(visible, "sampling"));
  EXPECT_NE(uniform, visible);
  EXPECT_NE(half_vector, visible);
}

TEST(GlassAndWater, DiffersInFresnelAlone) {
  const json with = read("glass_and_water/fresnel.json"), without = read("glass_and_water/no_fresnel.json");
  EXPECT_EQ(without["materials"]["water"]["fresnel"], "none");
  EXPECT_EQ(without_material_key(with, "fresnel"), without_material_key(without, "fresnel"));
}

TEST(VeachMis, RegionsLieInTheImage) {
  const json scene = read("veach_mis/scene.json");
  std::ifstream file(kScenes + "veach_mis/regions.txt");
  int count = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream fields(line);
    std::string name;
    int x = -1, y = -1, width = 0, height = 0;
    ASSERT_TRUE(fields >> name >> x >> y >> width >> height) << line;
    EXPECT_TRUE(x >= 0 && y >= 0 && width > 0 && height > 0) << line;
    EXPECT_LE(x + width, scene["render"]["width"].get<int>()) << line;
    EXPECT_LE(y + height, scene["render"]["height"].get<int>()) << line;
    ++count;
  }
  EXPECT_GE(count, 12);
}

}  // namespace
}  // namespace tessera
