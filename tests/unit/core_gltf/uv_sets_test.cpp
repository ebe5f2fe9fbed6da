// SPDX-License-Identifier: Apache-2.0
// Each texture of a glTF material is looked up by the texture coordinates that it names.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/integrators/render.hpp"
#include "core/scene/scene.hpp"
#include "tests/unit/core_gltf/gltf_file.hpp"

namespace tessera::core::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const std::vector<float> kNear{0.1f, 0.1f, 0.6f, 0.2f, 0.3f, 0.9f}, kFar{0.9f, 0.3f, 0.2f, 0.8f, 0.4f, 0.1f};

json texture_by(int index, int set) {
  return {{"index", index}, {"texCoord", set}};
}

// Texture 0 is one colour everywhere, with an alpha of one half; texture 1 is not.
MemoryAssets::Files images() {
  Image image(4, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x)
      image.at(x, y) = {0.2f + 0.2f * static_cast<float>(x), 0.9f - 0.2f * static_cast<float>(y), 0.8f};
  const std::string tga_header("\0\0\2\0\0\0\0\0\0\0\0\0\2\0\1\0\x20\x28", 18), texel("\x40\x80\xff\x80", 4);
  return {{"even.tga", tga_header + texel + texel}, {"picture.png", png(image)}};
}

// A triangle whose first material is `material`, with these texture coordinates as TEXCOORD_0, 1, ...
GltfFile file_with(const json& material, const std::vector<std::vector<float>>& sets) {
  GltfFile file;
  file.json["images"] = {{{"uri", "even.tga"}}, {{"uri", "picture.png"}}};
  file.json["textures"] = {{{"source", 0}}, {{"source", 1}}};
  file.json["materials"] = json::array({material});
  const int mesh = file.triangle(0);
  auto& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
  attributes.erase("TEXCOORD_0");
  for (std::size_t i = 0; i < sets.size(); ++i)
    attributes["TEXCOORD_" + std::to_string(i)] = file.floats("VEC2", sets[i]);
  file.node({{"mesh", mesh}});
  return file;
}

Result<SceneDescription> load_with_images(const GltfFile& file) {
  return load_gltf(file.text(), images());
}

// What depends on texture 1: emission and normals.
json lamp(int even_set, int picture_set) {
  return {{"pbrMetallicRoughness", {{"baseColorTexture", texture_by(0, even_set)}, {"metallicFactor", 0}}},
          {"alphaMode", "BLEND"},
          {"doubleSided", true},
          {"emissiveFactor", {1, 1, 1}},
          {"emissiveTexture", texture_by(1, picture_set)},
          {"normalTexture", texture_by(1, picture_set)}};
}

TEST(GltfUvSets, BelongToTextures) {
  const auto scene = load_with_images(file_with(lamp(0, 1), {kNear, kFar}));
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(warnings_of(*scene), "");
  const MeshDescription& mesh = mesh_of(*scene);
  EXPECT_EQ(mesh.uvs[1], (Vec2{0.6f, 1 - 0.2f}));
  ASSERT_EQ(mesh.second_uvs.size(), 3u);
  EXPECT_EQ(mesh.second_uvs[1], (Vec2{0.2f, 1 - 0.8f}));
  const Material& material = scene->materials[0];
  const auto set_of = [&](int index) { return scene->textures.at(static_cast<std::size_t>(index)).uv_set; };
  EXPECT_EQ(set_of(std::get<Principled>(material.model).base_color.texture), UvSet::kFirst);
  EXPECT_EQ(set_of(material.opacity.texture), UvSet::kFirst);
  EXPECT_EQ(set_of(material.emission.texture), UvSet::kSecond);
  EXPECT_EQ(set_of(material.normal_map.texture), UvSet::kSecond);
}

TEST(GltfUvSets, AreReplacedByTransforms) {
  json material = lamp(0, 0);
  material["emissiveTexture"]["extensions"]["KHR_texture_transform"] = {{"texCoord", 1}, {"scale", {2, 2}}};
  const auto scene = load_with_images(file_with(material, {kNear, kFar}));
  ASSERT_TRUE(scene) << scene.error().message;
  const auto emission = static_cast<std::size_t>(scene->materials[0].emission.texture);
  EXPECT_EQ(scene->textures[emission].uv_set, UvSet::kSecond);
  EXPECT_EQ(mesh_of(*scene).second_uvs.size(), 3u);
}

// A mesh has but one set where its material needs no other, or both are the same.
TEST(GltfUvSets, AreReadWhereTheyAreUsed) {
  for (const int set : {0, 1}) {
    const auto scene = load_with_images(file_with(lamp(set, set), {kNear, kFar}));
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(mesh_of(*scene).uvs[1].x, set == 0 ? 0.6f : 0.2f);
    EXPECT_TRUE(mesh_of(*scene).second_uvs.empty());
  }
  GltfFile file = file_with(lamp(0, 1), {kNear, kFar});
  auto& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["TEXCOORD_1"] = attributes["TEXCOORD_0"];
  const auto scene = load_with_images(file);
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(warnings_of(*scene), "");
  EXPECT_TRUE(mesh_of(*scene).second_uvs.empty());
}

TEST(GltfUvSets, ThatAreMissingAreReplacedAndTold) {
  const auto without_second = load_with_images(file_with(lamp(0, 1), {kNear}));
  ASSERT_TRUE(without_second) << without_second.error().message;
  EXPECT_THAT(warnings_of(*without_second), HasSubstr("it has no TEXCOORD_1; TEXCOORD_0 replaces it"));
  GltfFile file = file_with(lamp(0, 1), {kNear, kFar});
  file.json["meshes"][0]["primitives"][0]["attributes"].erase("TEXCOORD_0");
  const auto without_first = load_with_images(file);
  ASSERT_TRUE(without_first) << without_first.error().message;
  EXPECT_THAT(warnings_of(*without_first), HasSubstr("it has no TEXCOORD_0; TEXCOORD_1 replaces it"));
  EXPECT_EQ(mesh_of(*without_first).uvs[1].x, 0.2f);
  const auto without_any = load_with_images(file_with(lamp(0, 1), {}));
  ASSERT_TRUE(without_any) << without_any.error().message;
  EXPECT_THAT(warnings_of(*without_any), HasSubstr("no TEXCOORD_0; its textures show a single texel"));
}

TEST(GltfUvSets, OfBrokenNumbersAreTheFirst) {
  json material = lamp(0, 1);
  material["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = -1;
  const auto scene = load_with_images(file_with(material, {kNear, kFar}));
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(warnings_of(*scene), HasSubstr("TEXCOORD_0 is used"));
  EXPECT_EQ(mesh_of(*scene).uvs[1].x, 0.6f);
}

TEST(GltfUvSets, BeyondTheSecondAreTold) {
  json material = lamp(0, 1);
  material["normalTexture"] = texture_by(1, 2);
  const auto scene = load_with_images(file_with(material, {kNear, kFar, kFar}));
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(warnings_of(*scene),
              HasSubstr("materials[0].emissiveTexture: the textures of a material have two sets of texture "
                        "coordinates at most; TEXCOORD_0 is used for this one, too"));
}

FilmTile rendered(Result<SceneDescription> description) {
  EXPECT_TRUE(description) << description.error().message;
  const auto scene = Scene::build(std::move(*description), 1);
  EXPECT_TRUE(scene) << scene.error().message;
  return render(integrators::prepare(*scene, scene->settings(), 1), {320, 200, 448, 296}, {0, 2}, 1);
}

// Two triangles that face each other, and a camera.
GltfFile seen(GltfFile file) {
  file.json["nodes"][0]["scale"] = {2, 1.5, 1};
  json other = file.json["nodes"][0];
  other["translation"] = {0.8, 0, 0.7};
  other["rotation"] = {0, 1, 0, 0};
  file.node(other);
  file.json["cameras"] = {{{"type", "orthographic"}, {"orthographic", {{"xmag", 1.5}, {"ymag", 1}}}}};
  file.node({{"camera", 0}, {"translation", {0.5, 0.5, 4}}});
  file.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 5}}};
  file.node({{"translation", {0, 1, 3}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  return file;
}

// Largest difference, in parts of the brightest sum.
double difference(const FilmTile& a, const FilmTile& b) {
  double brightest = 0, largest = 0;
  for (std::size_t i = 0; i < a.sums.size(); ++i) {
    const auto x = static_cast<double>(a.sums[i]), y = static_cast<double>(b.sums[i]);
    brightest = std::max({brightest, x, y});
    largest = std::max(largest, std::fabs(x - y));
  }
  return largest / brightest;
}

// `make(even_set, picture_set, sets)` is a file with such a material. Where both textures are looked up by
// one set, only the picture decides, but for the rounding between texels of one colour.
template <typename Make>
void expect_only_the_picture_decides(const Make& make) {
  const FilmTile both = rendered(load_with_images(make(0, 1, {kNear, kFar})));
  EXPECT_LT(difference(both, rendered(load_with_images(make(0, 0, {kFar})))), 1e-5);
  EXPECT_GT(difference(both, rendered(load_with_images(make(0, 0, {kNear})))), 1e-2);
}

using Sets = std::vector<std::vector<float>>;

// As emission that rays hit and that is sampled, and as a normal map, here in instances.
TEST(GltfUvSets, RenderAsIfTheyWereTheOnlyOnes) {
  expect_only_the_picture_decides([](int even_set, int picture_set, const Sets& sets) {
    return seen(file_with(lamp(even_set, picture_set), sets));
  });
}

TEST(GltfUvSets, RenderWithoutInstances) {
  expect_only_the_picture_decides([](int even_set, int picture_set, const Sets& sets) {
    GltfFile file = seen(file_with(lamp(even_set, picture_set), sets));
    file.json["meshes"].push_back(file.json["meshes"][0]);
    file.json["nodes"][1]["mesh"] = 1;
    return file;
  });
}

// Morph targets move while the shutter is open; what deforms does not emit.
TEST(GltfUvSets, RenderWhereMeshesDeform) {
  const auto deforming = [](int even_set, int picture_set, const Sets& sets) {
    json material = lamp(even_set, picture_set);
    material.erase("emissiveFactor");
    material["pbrMetallicRoughness"]["metallicRoughnessTexture"] = texture_by(1, picture_set);
    GltfFile file = seen(file_with(material, sets));
    file.json["meshes"][0]["primitives"][0]["targets"] = {
        {{"POSITION", file.floats("VEC3", {0, 0, 0, 0, 0, 1, 0, 0.3f, 0})}}};
    const int times = file.floats("SCALAR", {0, 1}), weights = file.floats("SCALAR", {0, 1});
    file.json["animations"] = {
        {{"samplers", {{{"input", times}, {"output", weights}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
    file.json["extensions"]["TESSERA_selection"] = {{"time", 0}, {"shutter", 1}};
    return file;
  };
  const GltfFile two_sets = deforming(0, 1, {kNear, kFar});
  const auto scene = load_with_images(two_sets);
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_TRUE(std::any_of(scene->shapes.begin(), scene->shapes.end(),
                          [](const ShapeDescription& shape) { return deforms(shape); }) ||
              std::any_of(scene->objects.begin(), scene->objects.end(),
                          [](const ObjectDescription& object) { return deforms(object.shapes.at(0)); }));
  expect_only_the_picture_decides(deforming);
}

}  // namespace
}  // namespace tessera::core::test
