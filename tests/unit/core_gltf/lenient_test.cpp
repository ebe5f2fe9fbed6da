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

TEST(GltfLeftOut, TrianglesWhoseIndicesAreOutOfRange) {
  GltfFile file = two_triangles();
  file.json["meshes"][0]["primitives"][0]["indices"] = file.indices({0, 1, 7});
  expect_one_left(file, "triangles left out because they name vertices beyond the 3 that there are: 1");
  file.json["meshes"][0]["primitives"][0]["indices"] = file.indices({0, 1, 7, 0, 1, 2});
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(test::mesh_of(*scene).triangles.size(), 1u);
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

// A part that refers to what is not there, or that is something else than it must be.
struct BrokenPart {
  const char* pointer;
  json value;
  const char* warning;
};

// The file with the parts of each kind that tests break.
GltfFile with_all_parts() {
  GltfFile file = two_triangles();
  file.json["materials"] = {{{"pbrMetallicRoughness", {{"metallicFactor", 0.5}}}}};
  file.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}}}}};
  file.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  auto& primitive = file.json["meshes"][0]["primitives"][0];
  primitive["material"] = 0;
  primitive["targets"] = {{{"POSITION", file.floats("VEC3", {0, 0, 8, 0, 0, 0, 0, 0, 0})}}};
  primitive["attributes"]["JOINTS_0"] = file.accessor(file.view(std::string(12, '\0')), 5121, "VEC4", 3);
  primitive["attributes"]["WEIGHTS_0"] = file.floats("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  file.json["meshes"][0]["weights"] = {1};
  file.json["skins"] = {{{"joints", {2}}}};
  file.json["nodes"][0]["skin"] = 0;
  file.node({{"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  const int times = file.floats("SCALAR", {0, 1}), places = file.floats("VEC3", {0, 0, 1, 0, 0, 2});
  file.json["animations"] = {
      {{"samplers", {{{"input", times}, {"output", places}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "translation"}}}}}}}};
  file.json["scenes"] = {{{"nodes", {0, 1, 2}}}};
  file.json["scene"] = 0;
  return file;
}

TEST(GltfLeftOut, IsOnlyWhatIsBroken) {
  const std::vector<BrokenPart> table{
      {"/nodes/0/mesh", 7, "nodes[0].mesh: the node shows no mesh: there is no meshes[7]; the file has 2"},
      {"/nodes/0/mesh", "first", "nodes[0].mesh: the node shows no mesh: must be a whole number"},
      {"/nodes/2/camera", 7, "nodes[2].camera: it is left out: there is no cameras[7]; the file has 1"},
      {"/nodes/2/extensions/KHR_lights_punctual/light", 7, "light: it is left out: there is no extensions."},
      {"/nodes/0/skin", 7, "nodes[0].skin: the mesh is shown without it: there is no skins[7]"},
      {"/skins/0/joints",
       {7},
       "nodes[0].skin: the mesh is shown without it: skins[0].joints[0]: there is no nodes"},
      {"/skins/0/joints", json::array(),
       "nodes[0].skin: the mesh is shown without it: skins[0]: has no joints"},
      {"/skins/0/inverseBindMatrices", 0,
       "skins[0].inverseBindMatrices: must be an accessor of 16 components"},
      {"/meshes/0/primitives/0/material", 7,
       "material: the default material replaces it: there is no materials[7]; the file has 1"},
      {"/meshes/0/primitives/0/attributes/TEXCOORD_0", 0,
       "attributes.TEXCOORD_0: it is ignored: must be an accessor of 2 components"},
      {"/meshes/0/primitives/0/attributes/NORMAL", 77,
       "attributes.NORMAL: it is ignored: there is no accessors[77]"},
      {"/meshes/0/primitives/0/targets/0/POSITION", 77,
       "targets[0].POSITION: it is ignored: there is no accessors"},
      {"/meshes/0/weights", {"a"}, "meshes[0].weights[0]: it is ignored: must be a number"},
      {"/nodes/0/translation", {1, 2}, "nodes[0].translation: it is ignored: must be a list of 3 numbers"},
      {"/nodes/0/scale", {1, 1, 1e300}, "nodes[0].scale: it is ignored: nodes[0].scale[2]: is too large"},
      {"/nodes/0/children", {0}, "nodes[0]: is its own ancestor; it is no longer the child of a node"},
      {"/nodes/0/children", {1, 1}, "nodes[0].children[1]: it is left out: nodes[1] has two parents"},
      {"/nodes/0/children",
       {9},
       "nodes[0].children[0]: it is left out: there is no nodes[9]; the file has 3"},
      {"/scenes/0/nodes", {0, 1, 0}, "scenes[0].nodes[2]: nodes[0] is there twice; it is shown once"},
      {"/scenes/0/nodes",
       {0, 1, 9},
       "scenes[0].nodes[2]: it is left out: there is no nodes[9]; the file has 3"},
      {"/scene", 9, "scene: the first scene is rendered: there is no scenes[9]; the file has 1"},
      {"/animations/0/channels/0/sampler", 9,
       "channels[0]: it is ignored: animations[0].channels[0].sampler: there"},
      {"/animations/0/channels/0/target/node", 9,
       "channels[0].target.node: there is no nodes[9]; the file has 3"},
      {"/animations/0/samplers/0/input", 0, "samplers[0].input: must be an accessor of 1 components"},
      {"/nodes/1/extensions/EXT_mesh_gpu_instancing/attributes/TRANSLATION", 77,
       "EXT_mesh_gpu_instancing: its mesh is shown once, where the node is: "},
      {"/materials/0/pbrMetallicRoughness/metallicFactor", "much",
       "materials[0].pbrMetallicRoughness.metallicFactor: it is ignored: must be a number, got the text "
       "'much'"},
      {"/nodes/1/extensions/KHR_node_visibility/visible", 1, "visible: it is ignored: must be true or false"},
      {"/materials/0/pbrMetallicRoughness/baseColorTexture/index", 3,
       "baseColorTexture: the texture is ignored: materials[0].pbrMetallicRoughness.baseColorTexture.index: "
       "there"},
      {"/extensions/KHR_lights_punctual/lights/0/color", "red",
       "lights[0].color: it is ignored: must be a list"},
  };
  const auto whole = load_gltf(with_all_parts().text());
  ASSERT_TRUE(whole) << whole.error().message;
  for (const BrokenPart& one : table) {
    GltfFile file = with_all_parts();
    file.json[json::json_pointer(one.pointer)] = one.value;
    const auto scene = load_gltf(file.text());
    ASSERT_TRUE(scene) << one.pointer << ": " << scene.error().message;
    EXPECT_GE(scene->shapes.size(), 1u) << one.pointer;
    EXPECT_THAT(test::warnings_of(*scene), HasSubstr(one.warning)) << one.pointer;
    EXPECT_THAT(test::warnings_of(*whole), testing::Not(HasSubstr(one.warning))) << one.pointer;
  }
}

TEST(GltfLeftOut, AreNodesThatAreTheirOwnAncestors) {
  GltfFile file = two_triangles();
  file.json["nodes"][0]["children"] = {1};
  file.json["nodes"][1]["children"] = {2};
  file.node({{"children", {0}}, {"translation", {0, 3, 0}}});
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->shapes.size(), 2u);
  EXPECT_EQ(test::mesh_of(*scene, 1).positions[0], (Vec3{5, 0, 0}));
}

// The joints of a skin are fewer than vertices name.
TEST(GltfLeftOut, WeightsOfJointsThatASkinLacks) {
  GltfFile file = with_all_parts();
  auto& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] =
      file.accessor(file.view(std::string("\0\7\0\0\0\7\0\0\0\7\0\0", 12)), 5121, "VEC4", 3);
  attributes["WEIGHTS_0"] = file.floats("VEC4", {1, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->shapes.size(), 2u);
  EXPECT_THAT(test::warnings_of(*scene),
              HasSubstr("weights ignored because their joints are beyond the 1 of the skin: 1"));
}

// One of two buffers is missing, or shorter than the file says.
TEST(GltfLeftOut, WhatIsInAMissingBuffer) {
  GltfFile file = two_triangles();
  const auto positions = file.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].get<std::size_t>();
  const auto view = file.json["accessors"][positions]["bufferView"].get<std::size_t>();
  file.json["bufferViews"][view]["buffer"] = 1;
  json text = json::parse(file.text());
  text["buffers"].push_back({{"byteLength", 100}, {"uri", "lost.bin"}});
  const auto scene = load_gltf(text.dump());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->shapes.size(), 1u);
  EXPECT_THAT(test::warnings_of(*scene), HasSubstr("buffers[1].uri: there is no file 'lost.bin'"));
  text["buffers"][1] = {{"byteLength", 100}, {"uri", "data:;base64,AAAA"}};
  const auto shorter = load_gltf(text.dump());
  ASSERT_TRUE(shorter) << shorter.error().message;
  EXPECT_EQ(shorter->shapes.size(), 1u);
  EXPECT_THAT(test::warnings_of(*shorter), HasSubstr("buffers[1]: is truncated: it has 3 bytes"));
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

TEST(GltfExtensions, ThatAreNotListedAreTold) {
  GltfFile file;
  file.node({{"mesh", file.triangle()}, {"extensions", {{"MSFT_lod", {{"ids", {1}}}}}}});
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(test::warnings_of(*scene), HasSubstr("the optional extension 'MSFT_lod' is not supported"));
}

TEST(GltfExtensions, WithoutInfluenceOnImagesMayBeRequired) {
  GltfFile file;
  file.node(
      {{"mesh", file.triangle()},
       {"extensions", {{"KHR_node_selectability", {{"selectable", false}}}, {"KHR_xmp", {{"xmp", 0}}}}}});
  file.json["extensionsRequired"] = {"KHR_node_selectability", "EXT_mesh_features", "GODOT_single_root"};
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(test::warnings_of(*scene), "");
}

TEST(GltfExtensions, InstancesWithColorsOrSkinsAreTold) {
  GltfFile file;
  const int places = file.floats("VEC3", {0, 0, 0, 1, 0, 0}),
            colors = file.floats("VEC3", {1, 0, 0, 0, 1, 0});
  const json instances{
      {"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}, {"_COLOR_0", colors}}}}}};
  file.node({{"mesh", file.triangle()}, {"extensions", instances}});
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(test::warnings_of(*scene), HasSubstr("colours of instances are ignored"));
  file.json["skins"] = {{{"joints", {0}}}};
  file.json["nodes"][0]["skin"] = 0;
  const auto skinned = load_gltf(file.text());
  ASSERT_TRUE(skinned) << skinned.error().message;
  EXPECT_THAT(test::warnings_of(*skinned), HasSubstr("a mesh with a skin is shown once"));
}

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

TEST(GltfReplacedValues, OfNodes) {
  const std::vector<BrokenPart> table{
      {"/nodes/0/rotation",
       {0, 0, 0, 0},
       "nodes[0].rotation: a rotation must be a unit quaternion, got one "
       "without a finite length above 0; it turns nothing"},
      {"/nodes/0/rotation",
       {0, 0, 0, 2},
       "nodes[0].rotation: a rotation must be a unit quaternion, got one of "
       "length 2; it is normalised"},
      {"/meshes/0/weights",
       {1, 0},
       "meshes[0].weights: has 2 weights for 1 morph targets; the further ones are ignored"},
      {"/nodes/1/weights",
       {1},
       "nodes[1].weights: has 1 weights for 0 morph targets; the further ones are ignored"},
  };
  for (const BrokenPart& one : table) {
    GltfFile file = with_all_parts();
    file.json[json::json_pointer(one.pointer)] = one.value;
    const auto scene = load_gltf(file.text());
    ASSERT_TRUE(scene) << one.pointer << ": " << scene.error().message;
    EXPECT_EQ(scene->shapes.size(), 2u) << one.pointer;
    EXPECT_EQ(test::mesh_of(*scene).positions[0], (Vec3{0, 0, 9})) << one.pointer;
    EXPECT_THAT(test::warnings_of(*scene), HasSubstr(one.warning)) << one.pointer;
  }
}

TEST(GltfReplacedValues, OfNodesWithTwoPlacements) {
  GltfFile file = two_triangles();
  for (json& node : file.json["nodes"]) {
    node["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 7, 0, 0, 1};
    node["translation"] = {5, 0, 0};
  }
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(test::mesh_of(*scene, 1).positions[0], (Vec3{7, 0, 0}));
  EXPECT_THAT(
      test::warnings_of(*scene),
      HasSubstr("nodes[0]: has a matrix and a translation, rotation or scale; only the matrix is used (2 "
                "times)"));
}

TEST(GltfReplacedValues, OfWeightsThatAreFewerThanMorphTargets) {
  GltfFile file = with_all_parts();
  auto& targets = file.json["meshes"][0]["primitives"][0]["targets"];
  targets.push_back(targets[0]);
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(test::mesh_of(*scene).positions[0], (Vec3{0, 0, 9}));
  EXPECT_THAT(test::warnings_of(*scene),
              HasSubstr("meshes[0].weights: has 1 weights for 2 morph targets; the missing ones are 0"));
}

TEST(GltfReplacedValues, OfAnimationsAndInstances) {
  GltfFile file = two_triangles();
  file.json["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 7, 0, 0, 1};
  const int times = file.floats("SCALAR", {0, 1}), turns = file.floats("VEC4", {0, 0, 0, 3, 0, 0, 0, 0}),
            weights = file.floats("SCALAR", {0, 1});
  file.json["nodes"][1]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["ROTATION"] = turns;
  file.json["animations"] = {
      {{"samplers", {{{"input", times}, {"output", turns}}, {{"input", times}, {"output", weights}}}},
       {"channels",
        {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "rotation"}}}},
         {{"sampler", 1}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  const std::string warnings = test::warnings_of(*scene);
  EXPECT_THAT(warnings,
              HasSubstr("nodes[0]: is animated and has a matrix; its translation, rotation and scale "
                        "replace the matrix"));
  EXPECT_THAT(warnings,
              HasSubstr("animations[0].samplers[0].output: a rotation must be a unit quaternion, got "
                        "one of length 3; it is normalised (2 times)"));
  EXPECT_THAT(warnings, HasSubstr("without a finite length above 0; it turns nothing (2 times)"));
  EXPECT_THAT(warnings, HasSubstr("animations[0].samplers[1].output: has 1 weights for 0 morph targets"));
}

TEST(GltfReplacedValues, OfCoordinatesFarFromTheOrigin) {
  GltfFile file;
  file.node({{"mesh", file.triangle()}, {"translation", {4.5e6, 0, 0}}, {"scale", {50, 50, 50}}});
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(test::warnings_of(*scene), HasSubstr("rounded to multiples of 0.5"));
}

}  // namespace
}  // namespace tessera::core
