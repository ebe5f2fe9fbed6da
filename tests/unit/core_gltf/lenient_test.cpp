// SPDX-License-Identifier: Apache-2.0
// What of a glTF file cannot be rendered is left out, and what is replaced is told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/unit/core_gltf/gltf_file.hpp"

namespace tessera::core {
namespace {

using nlohmann::json;
using test::GltfFile;
using test::load_gltf;
using testing::HasSubstr;

// Two triangles, each of its own mesh and node; meshes[0] is the one that tests break.
GltfFile two_triangles() {
  GltfFile file;
  file.node({{"mesh", file.triangle()}});
  file.node({{"mesh", file.triangle()}, {"translation", {5, 0, 0}}});
  return file;
}

void expect_one_left(const GltfFile& file, const std::string& warning) {
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->shapes.size(), 1u);
  EXPECT_THAT(test::warnings_of(*scene), HasSubstr(warning));
}

TEST(GltfLeftOut, AMeshWhoseIndicesAreOutOfRange) {
  GltfFile file = two_triangles();
  file.json["meshes"][0]["primitives"][0]["indices"] = file.indices({0, 1, 7});
  expect_one_left(file, "meshes[0].primitives[0]: it cannot be read and is left out: ");
}

TEST(GltfLeftOut, AMeshWhoseAccessorReachesTooFar) {
  GltfFile file = two_triangles();
  const auto positions = file.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].get<std::size_t>();
  file.json["accessors"][positions]["count"] = 1000000;
  expect_one_left(file, "meshes[0].primitives[0]: it cannot be read and is left out: ");
}

TEST(GltfLeftOut, ANodeThatFlattensItsMesh) {
  GltfFile file = two_triangles();
  file.json["nodes"][0]["scale"] = {0, 0, 0};
  expect_one_left(file, "a mesh without a triangle that has an area is left out");
}

TEST(GltfLeftOut, ACameraWithoutAnAngle) {
  GltfFile file = two_triangles();
  file.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0}}}}};
  file.json["nodes"][0]["camera"] = 0;
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(
      test::warnings_of(*scene),
      HasSubstr("cameras[0]: a camera that sees the whole scene replaces it: cameras[0].perspective: yfov"));
}

struct BrokenLight {
  json light;
  const char* warning;
};

TEST(GltfLeftOut, LightsWithoutPowerOrSense) {
  const std::vector<BrokenLight> table{
      {{{"type", "point"}, {"intensity", 0}}, "a light without power is left out"},
      {{{"type", "point"}, {"intensity", -1}}, "a light is left out: intensity must be 0 or greater"},
      {{{"type", "disc"}}, "there is no light type 'disc'; the light is left out"},
  };
  for (const BrokenLight& one : table) {
    GltfFile file = two_triangles();
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = json::array({one.light});
    file.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
    const auto scene = load_gltf(file.text());
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_TRUE(scene->lights.empty());
    EXPECT_THAT(test::warnings_of(*scene), HasSubstr(one.warning));
  }
}

struct ReplacedValue {
  json material;
  const char* warning;
};

TEST(GltfReplacedValues, OfMaterials) {
  const std::vector<ReplacedValue> table{
      {{{"alphaMode", "CUTOUT"}},
       "materials[0].alphaMode: there is no alpha mode 'CUTOUT'; the material is opaque"},
      {{{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 2}}}}},
       "materials[0].pbrMetallicRoughness.baseColorFactor: must be between 0 and 1; it becomes 1"},
      {{{"pbrMetallicRoughness", {{"baseColorFactr", {1, 1, 1, 1}}}}},
       "materials[0].pbrMetallicRoughness.baseColorFactr: this key is not known, and ignored; did you mean "
       "'baseColorFactor'?"},
      {{{"emissiveFactor", {-1, 0, 0}}},
       "materials[0]: its emission must be finite and not negative; it does not emit"},
      {{{"extensions", {{"KHR_materials_ior", {{"ior", 0.5}}}}}},
       "materials[0].extensions.KHR_materials_ior.ior: must be between 1 and 10; it becomes 1"},
      {{{"extensions", {{"KHR_materials_iridescence", {{"iridescenceFactor", 1}, {"iridescenceIor", 0.5}}}}}},
       "iridescenceIor: must be between 1 and 10; it becomes 1"},
      {{{"extensions", {{"KHR_materials_anisotropy", {{"anisotropyStrength", 3}}}}}},
       "anisotropyStrength: must be between 0 and 1; it becomes 1"},
  };
  for (const ReplacedValue& one : table) {
    GltfFile file;
    file.json["materials"] = json::array({one.material});
    file.node({{"mesh", file.triangle(0)}});
    const auto scene = load_gltf(file.text());
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_THAT(test::warnings_of(*scene), HasSubstr(one.warning));
  }
}

}  // namespace
}  // namespace tessera::core
