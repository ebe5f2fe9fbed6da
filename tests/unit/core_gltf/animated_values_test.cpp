// SPDX-License-Identifier: Apache-2.0
// KHR_animation_pointer: animations of any values.
#include <gmock/gmock.h>

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "tests/unit/core_gltf/gltf_file.hpp"

namespace tessera::core::test {
namespace {

using testing::HasSubstr;
using testing::Not;

// A triangle, and an animation of a second at whose middle the scene is rendered.
class Animated {
 public:
  Animated() {
    file.json["materials"] = {{{"pbrMetallicRoughness", {{"metallicFactor", 0.25}}}}};
    file.node({{"mesh", file.triangle(0)}});
    file.json["animations"] = {
        {{"samplers", nlohmann::json::array()}, {"channels", nlohmann::json::array()}}};
    file.json["extensionsRequired"] = {"KHR_animation_pointer"};
    file.json["extensions"]["TESSERA_selection"]["time"] = 0.5;
    times_ = file.floats("SCALAR", {0, 1});
  }

  Animated& channel(const std::string& pointer, const char* type, const std::vector<float>& values) {
    auto& animation = file.json["animations"][0];
    const auto sampler = animation["samplers"].size();
    animation["samplers"].push_back({{"input", times_}, {"output", file.floats(type, values)}});
    animation["channels"].push_back(
        {{"sampler", sampler},
         {"target",
          {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}});
    return *this;
  }

  SceneDescription scene() const {
    auto loaded = load_gltf(file.text());
    EXPECT_TRUE(loaded.has_value()) << loaded.error().message;
    return loaded ? *std::move(loaded) : SceneDescription();
  }
  Principled surface() const { return std::get<Principled>(scene().materials.at(0).model); }

  GltfFile file;

 private:
  int times_ = 0;
};

TEST(GltfAnimatedValues, ReplaceThoseOfMaterials) {
  Animated animated;
  animated.channel("/materials/0/pbrMetallicRoughness/metallicFactor", "SCALAR", {0, 1})
      .channel("/materials/0/pbrMetallicRoughness/baseColorFactor", "VEC4", {1, 0, 0, 1, 0, 0, 1, 1})
      .channel("/materials/0/emissiveFactor", "VEC3", {0, 0, 0, 1, 0.5f, 0});
  const SceneDescription scene = animated.scene();
  const auto& surface = std::get<Principled>(scene.materials.at(0).model);
  EXPECT_EQ(warnings_of(scene), "");
  EXPECT_EQ(surface.base_metalness.value, 0.5f);
  EXPECT_EQ(surface.base_color.value, (Rgb{0.5f, 0, 0.5f}));
  EXPECT_EQ(scene.materials.at(0).emission.value, (Rgb{0.5f, 0.25f, 0}));
}

TEST(GltfAnimatedValues, AddDefaultsThatAreNotWritten) {
  Animated animated;
  animated.file.json["materials"] = nlohmann::json::array({nlohmann::json::object()});
  animated.channel("/materials/0/pbrMetallicRoughness/roughnessFactor", "SCALAR", {0.2f, 0.4f});
  EXPECT_FLOAT_EQ(animated.surface().specular_roughness.value, 0.3f);
}

TEST(GltfAnimatedValues, HideNodesAndMoveThem) {
  Animated animated;
  animated.file.json["extensionsUsed"] = {"KHR_node_visibility"};
  animated.file.node({{"mesh", 0}, {"extensions", {{"KHR_node_visibility", {{"visible", true}}}}}});
  animated.channel("/nodes/1/extensions/KHR_node_visibility/visible", "SCALAR", {0, 0});
  EXPECT_EQ(animated.scene().shapes.size(), 1u);
  Animated moved;
  moved.channel("/nodes/0/translation", "VEC3", {0, 0, 0, 4, 0, 0});
  EXPECT_EQ(mesh_of(moved.scene()).positions.at(0), (Vec3{2, 0, 0}));
}

TEST(GltfAnimatedValues, OfWeightsAreLists) {
  Animated animated;
  auto& mesh = animated.file.json["meshes"][0];
  mesh["primitives"][0]["targets"] = {
      {{"POSITION", animated.file.floats("VEC3", {0, 0, 8, 0, 0, 8, 0, 0, 8})}}};
  mesh["weights"] = nlohmann::json::array({0});
  animated.channel("/meshes/0/weights", "SCALAR", {0, 0.5f});
  EXPECT_EQ(mesh_of(animated.scene()).positions.at(0), (Vec3{0, 0, 2}));
}

TEST(GltfAnimatedValues, ThatAreNotThereAreTold) {
  const auto told = [](const std::string& pointer, const char* type = "SCALAR",
                       std::vector<float> values = {0, 1}) {
    Animated animated;
    animated.channel(pointer, type, values);
    return warnings_of(animated.scene());
  };
  EXPECT_THAT(told("/materials/7/alphaCutoff"), HasSubstr("there is no '/materials/7/alphaCutoff'"));
  EXPECT_THAT(told("/materials/0/extensions/KHR_materials_ior/ior"), HasSubstr("there is no "));
  EXPECT_THAT(told("/accessors/0/count"), HasSubstr("an animation of '/accessors/0/count' is not supported"));
  EXPECT_THAT(told("materials"), HasSubstr("is not supported"));
  EXPECT_THAT(told("/materials/0/alphaCutoff", "SCALAR", {0}), HasSubstr("has no keyframes"));
  EXPECT_THAT(told("/materials/0/name/x"), HasSubstr("there is no "));
}

// Also those of channels that are refused afterwards.
TEST(GltfAnimatedValues, AreCountedBeforeTheyAreRead) {
  std::vector<float> values(std::size_t{1} << 20, 0.0f);
  values[0] = std::numeric_limits<float>::quiet_NaN();
  Animated animated;
  const auto metalness = [&animated] {
    return Animated(animated)
        .channel("/materials/0/pbrMetallicRoughness/metallicFactor", "SCALAR", {0, 1})
        .surface()
        .base_metalness.value;
  };
  animated.channel("/meshes/0/weights", "SCALAR", values);
  EXPECT_EQ(metalness(), 0.5f);
  animated.channel("/meshes/0/weights", "SCALAR", values);
  EXPECT_EQ(metalness(), 0.25f) << "there are too many animated numbers";
}

TEST(GltfAnimatedValues, WithoutAnimationAreThoseOfTheFile) {
  Animated animated;
  animated.channel("/materials/0/pbrMetallicRoughness/metallicFactor", "SCALAR", {0, 1});
  animated.file.json["extensions"]["TESSERA_selection"] = {{"animation", "none"}};
  EXPECT_EQ(animated.surface().base_metalness.value, 0.25f);
}

}  // namespace
}  // namespace tessera::core::test
