// SPDX-License-Identifier: Apache-2.0
// What is written is read as the same scene, bit for bit.
#include "core/scene/writer/scene_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/cache/scene_digest.hpp"
#include "core/scene/writer/json_text.hpp"
#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core {
namespace {

using test::MemoryAssets;
using testing::HasSubstr;

MemoryAssets::Files written(const SceneDescription& scene) {
  MemoryAssets::Files files;
  const auto done = write_scene(scene, "out", [&](const std::string& name, std::string_view bytes) {
    files[name] = bytes;
    return Status();
  });
  EXPECT_TRUE(done) << done.error().message;
  return files;
}

SceneDigest plain_digest(SceneDescription scene) {
  scene.shape_names.clear();
  for (Material& material : scene.materials) material.name.clear();
  for (ObjectDescription& object : scene.objects) {
    object.name.clear();
    object.shape_names.clear();
  }
  return digest_of(scene);
}

void expect_round_trip(const SceneDescription& scene) {
  MemoryAssets::Files files = written(scene);
  MemoryAssets assets(files);
  const auto again = load_scene(assets, "out.json", "out.json");
  ASSERT_TRUE(again) << again.error().message << "\n" << files["out.json"];
  EXPECT_EQ(again->settings, scene.settings);
  EXPECT_EQ(again->display, scene.display);
  const SceneDigest a = plain_digest(scene), b = plain_digest(*again);
  EXPECT_EQ(a.camera, b.camera) << files["out.json"];
  EXPECT_EQ(a.textures, b.textures) << files["out.json"];
  EXPECT_EQ(a.materials, b.materials) << files["out.json"];
  EXPECT_EQ(a.shapes, b.shapes) << files["out.json"];
  EXPECT_EQ(a.lights, b.lights) << files["out.json"];
  EXPECT_EQ(a.environment, b.environment) << files["out.json"];
}

SceneDescription loaded(const std::string& scene, const MemoryAssets::Files& files = {}) {
  auto description = test::load(scene, files);
  EXPECT_TRUE(description) << description.error().message;
  return description ? std::move(*description) : SceneDescription();
}

TEST(SceneDigest, OfEachMaterialTellsWhichOneDiffers) {
  SceneDescription scene;
  scene.materials = {{"a", Lambert{}}, {"b", Glass{}}};
  const std::vector<Checksum> before = digests_of_materials(scene);
  std::get<Glass>(scene.materials[1].model).ior = 1.7f;
  const std::vector<Checksum> after = digests_of_materials(scene);
  ASSERT_EQ(after.size(), 2u);
  EXPECT_EQ(after[0], before[0]);
  EXPECT_NE(after[1], before[1]);
}

TEST(SceneWriter, WritesLightGroups) {
  const SceneDescription scene = loaded(R"({
    "render": {"layers": ["depth", "light_groups", "group.key"]},
    "camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]},
    "materials": {"l": {"type": "lambert", "emission": 2, "group": "lamps"}},
    "shapes": [{"type": "sphere", "radius": 1, "material": "l"}],
    "lights": [{"type": "point", "position": [0, 3, 0], "intensity": 1, "group": "key"},
               {"type": "spot", "position": [0, 3, 0], "look_at": [0, 0, 0], "intensity": 1, "group": "fill-2"},
               {"type": "directional", "direction": [0, -1, 0], "irradiance": 1, "group": "key"}],
    "environment": {"radiance": 0.1, "group": "sky"}})");
  EXPECT_EQ(scene.materials[0].light_group, "lamps");
  EXPECT_EQ(light_group_of(scene.lights[1]), "fill-2");
  EXPECT_EQ(light_group_of(scene.lights[2]), "key");
  EXPECT_EQ(scene.environment->light_group, "sky");
  EXPECT_TRUE(scene.settings.layers.light_groups);
  EXPECT_EQ(scene.settings.layers.groups, std::vector<std::string>{"key"});
  expect_round_trip(scene);
}

TEST(SceneWriter, WritesMeshesThatDeform) {
  const auto bent = [](const char* z) {
    return std::string("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n") +
           "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 " + z +
           "\n1 0 0.25\n0 1 0.1\n3 0 1 2\n";
  };
  const SceneDescription scene = loaded(
      R"({
    "camera": {"position": [0, 0, 5], "look_at": [0, 0, 0], "shutter": [0, 1]},
    "materials": {"l": {"type": "lambert"}},
    "shapes": [{"type": "mesh", "material": "l", "transform": [{"rotate": {"axis": [1, 2, 3], "degrees": 77}}],
                "file": {"keyframes": [{"frame": -0.3, "value": "a.ply"}, {"frame": 0.4, "value": "b.ply"},
                                       {"frame": 2, "value": "a.ply"}]}},
               {"type": "mesh", "file": "a.ply", "material": "l"}]})",
      {{"a.ply", bent("0.3")}, {"b.ply", bent("-0.7")}});
  ASSERT_EQ(std::get<MeshDescription>(scene.shapes[0]).steps.size(), 3u);
  expect_round_trip(scene);
}

// Also where vertices are split at creases, which computes normals.
TEST(SceneWriter, WritesSecondTextureCoordinates) {
  const std::string bent =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "property float u\nproperty float v\nproperty float u1\nproperty float v1\nelement face 2\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0 0 0 0.1 3\n1 0 0 1 0 0.2 4\n0 1 0 0 1 0.3 "
      "5\n"
      "0 0 1 1 1 0.4 6\n3 0 1 2\n3 0 3 1\n";
  const SceneDescription scene = loaded(
      R"({
    "camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]},
    "textures": {"a": {"file": "a.png"}, "b": {"file": "a.png", "uv_set": "second"}},
    "materials": {"l": {"type": "lambert", "albedo": {"texture": "a"}, "emission": {"texture": "b"}}},
    "shapes": [{"type": "mesh", "file": "bent.ply", "material": "l"}]})",
      {{"bent.ply", bent}, {"a.png", test::png(test::one_color(2, 2, Rgb::gray(0.5f)))}});
  const auto& mesh = std::get<MeshDescription>(scene.shapes[0]);
  EXPECT_GT(mesh.positions.size(), 4u);
  ASSERT_EQ(mesh.second_uvs.size(), mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    EXPECT_FLOAT_EQ(mesh.second_uvs[i].x, 0.1f + 0.1f * mesh.positions[i].x + 0.2f * mesh.positions[i].y +
                                              0.3f * mesh.positions[i].z);
  EXPECT_EQ(scene.textures[1].uv_set, UvSet::kSecond);
  expect_round_trip(scene);
}

TEST(SceneWriter, WritesTangents) {
  const auto turned = [](const std::string& tangent) {
    const auto vertex = [&](const std::string& p) { return p + " 0 0 1 " + tangent + "\n"; };
    return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
           "property float nx\nproperty float ny\nproperty float nz\nproperty float tx\nproperty float ty\n"
           "property float tz\nproperty float tw\nelement face 1\nproperty list uchar int vertex_indices\n"
           "end_header\n" +
           vertex("0 0 0") + vertex("1 0 0") + vertex("0 1 0") + "3 0 1 2\n";
  };
  const SceneDescription scene = loaded(
      R"({
    "camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]},
    "materials": {"m": {"type": "conductor", "metal": "gold", "roughness": 0.3, "anisotropy": 0.5}},
    "shapes": [{"type": "mesh", "file": "a.ply", "material": "m", "transform": [{"scale": [1, -2, 1]}]},
               {"type": "mesh", "material": "m",
                "file": {"keyframes": [{"frame": 0, "value": "a.ply"}, {"frame": 1, "value": "b.ply"}]}}]})",
      {{"a.ply", turned("0 3 0 1")}, {"b.ply", turned("1 0 0 1")}});
  EXPECT_EQ(std::get<MeshDescription>(scene.shapes[0]).tangents.at(2), (VertexTangent{{0, -1, 0}, -1}));
  EXPECT_EQ(std::get<MeshDescription>(scene.shapes[1]).steps.at(1).tangents.size(), 3u);
  expect_round_trip(scene);
}

TEST(SceneWriter, WritesAllPartsOfAScene) {
  const std::string scene = R"({
    "render": {"width": 33, "height": 20, "spp": 5, "seed": 18446744073709551615, "integrator": "nee",
               "filter": "gaussian", "filter_radius": 1.3, "crop": [1, 2, 30, 19], "max_depth": 7},
    "camera": {"position": [0.1, 0.2, 5], "look_at": [0, 0.3333333, 0], "aperture_radius": 0.01,
               "focus_distance": 4.7, "aperture_blades": 6, "aperture_rotation_degrees": 12},
    "output": {"exposure": -0.5, "tone_curve": "agx"},
    "textures": {"t": {"file": "gray.png", "wrap": "clamp", "scale": [2, 3], "offset": [0.1, 0]},
                 "n": {"file": "gray.png", "color_space": "linear", "channel": "green"}},
    "materials": {
      "first one": {"type": "phong", "diffuse": [0.1, 0.2, 0.3], "specular": 0.4, "exponent": 17, "lobe": "n+2"},
      "gold": {"type": "cook_torrance", "conductor": "gold", "roughness": {"texture": "n", "scale": 0.7},
               "masking": "schlick", "sampling": "half_vector"},
      "pane": {"type": "glass", "ior": 1.33, "fresnel": "schlick", "opacity": 0.5, "distribution": "beckmann"},
      "bucket": {"type": "plastic", "roughness": 0.5, "masking": "separable", "compensated": false, "internal_reflection": 0.5},
      "painted": {"type": "lambert", "albedo": {"texture": "t", "tint": [0.9, 0.8, 0.7]},
                  "normal_map": {"texture": "n", "strength": 0.5}, "bump": {"texture": "n", "height": -0.02}},
      "brushed": {"type": "principled", "specular_roughness_anisotropy": 0.7, "geometry_tangent": {"texture": "n"},
                  "geometry_tangent_rotation": 0.3, "coat_roughness_anisotropy": 0.5,
                  "geometry_coat_tangent_rotation": {"texture": "n", "scale": 0.5},
                  "geometry_coat_normal": {"texture": "n", "strength": 0.25}},
      "foil": {"type": "conductor", "anisotropy": 0.5, "tangent": {"texture": "n"}, "tangent_rotation": -0.25},
      "cloth": {"type": "disney", "anisotropic": 0.5, "tangent_rotation": 0.125, "sheen": 0.5, "thin_walled": true, "shading_normals": "plain"},
      "fur": {"type": "hair", "reflectance": 0.5, "beta_m": 0.2, "tilt_degrees": 3},
      "brown hair": {"type": "hair", "pheomelanin": 0.3, "ior": 1.5},
      "pigment": {"type": "hair", "sigma_a": [0.1, 0.2, 0]},
      "lamp": {"type": "lambert", "albedo": 0, "emission": [3, 2, 1], "emission_sides": "front"}},
    "objects": {"pair": {"shapes": [{"type": "mesh", "file": "triangle.obj", "material": "painted"},
                                    {"type": "sphere", "radius": 0.1, "material": "gold"}]}},
    "shapes": [
      {"type": "mesh", "file": "triangle.obj", "material": "first one", "normals": "flat",
       "transform": [{"rotate": {"axis": [1, 2, 3], "degrees": 40}}]},
      {"type": "quad", "corner": [0, 0, 0], "edge_u": [0.1, 0, 0], "edge_v": [0, 0, 0.3], "material": "lamp"},
      {"type": "disk", "center": [1, 2, 3], "normal": [1, 1, 0.2], "radius": 0.7, "inner_radius": 0.2,
       "flip_normal": true, "material": "pane"},
      {"type": "cylinder", "start": [1, 0, 0], "end": [1.1, 2, 0.3], "radius": 0.3, "material": "gold"},
      {"type": "curves", "points": [[[0, 0, 0, 0.1], [1, 0.3, 0, 0.2], [2, 0, 0.1, 0.3], [3, 0, 0, 0.1]]],
       "basis": "bezier", "material": "fur"},
      {"type": "curves", "points": [[[0, 0, 0], [1, 0.3, 0]], [[2, 0, 0.1], [3, 0, 0], [4, 1, 0.7]]],
       "basis": "linear", "shape": "ribbon", "radius": 0.07, "material": "brown hair",
       "normals": [[[0, 0, 1], [0, 1, 1]], [[1, 0, 0], [0, 0.3, 1], [0, 0, 1]]]},
      {"type": "instance", "object": "pair", "material": "pane",
       "transform": [{"scale": 0.3}, {"rotate": {"axis": [0, 1, 0], "degrees": 33}}, {"translate": [0.1, 0, 7]}]}],
    "lights": [{"type": "point", "position": [1, 2, 3], "intensity": 4},
               {"type": "spot", "position": [1, 2, 3], "look_at": [0, 0, 0], "intensity": [1, 2, 3],
                "angle_degrees": 33, "softness": 0.1, "falloff": "linear",
                "image": {"texture": "t", "right": [0.1, 0, 0], "up": [0, 0.2, 0.1], "flat_field": true}},
               {"type": "point", "position": [1, 2, 0], "intensity": 1, "texture": "sky",
                "orientation": [{"rotate": {"axis": [0, 1, 0], "degrees": 30}}]},
               {"type": "directional", "direction": [0.1, -1, 0.3], "irradiance": 0.7}],
    "environment": {"texture": "sky", "radiance": [0.5, 0.6, 0.7], "rotation_degrees": 33,
                    "orientation": [{"rotate": {"axis": [1, 0, 0], "degrees": 90}}], "visible_to_camera": false}
  })";
  std::string with_sky = scene;
  with_sky.replace(with_sky.find("\"n\": {"), 6, "\"sky\": {\"file\": \"sky.hdr\"}, \"n\": {");
  expect_round_trip(loaded(with_sky, {{"sky.hdr", test::hdr(test::one_color(4, 2, Rgb{0.1f, 7, 3000}))}}));
}

TEST(SceneWriter, KeepsNegativeZerosOfTransforms) {
  SceneDescription scene =
      loaded(test::scene_with(R"("environment": {"radiance": 1})", R"("a": {"type": "lambert"})",
                              R"({"type": "sphere", "radius": 1, "material": "a"})"));
  ASSERT_TRUE(scene.environment);
  const Transform turned{{0, -0.0f, -1}, {-0.0f, 1, 0}, {1, -0.0f, 0}, {0, 0, -0.0f}};
  scene.environment->orientation = turned;
  scene.objects.push_back({.name = "one", .shapes = {scene.shapes[0]}, .shape_names = {}});
  scene.shapes.push_back(InstanceDescription{0, turned, {}});
  expect_round_trip(scene);
}

TEST(SceneWriter, WritesKeyframes) {
  expect_round_trip(loaded(R"({
    "camera": {"position": {"keyframes": [{"frame": 0, "value": [0, 0, 5]}, {"frame": 9, "value": [1, 0, 5]}]},
               "look_at": [0, 0, 0], "shutter": [-0.25, 0.3]},
    "textures": {"t": {"file": "gray.png"}},
    "media": {"fog": {"scale": {"keyframes": [{"frame": 0, "value": 1}, {"frame": 5, "value": 2}]},
                      "sigma_s": {"keyframes": [{"frame": 0, "value": 0}, {"frame": 5, "value": [1, 2, 3]}]}}},
    "materials": {
      "l": {"type": "lambert", "emission": {"keyframes": [{"frame": 0, "value": 1}, {"frame": 2, "value": 3}]},
            "interior_medium": "fog",
            "normal_map": {"texture": "t", "strength": {"keyframes": [{"frame": 0, "value": 1}]}},
            "bump": {"texture": "t", "height": {"keyframes": [{"frame": 3, "value": 0.1}]}},
            "opacity": {"texture": "t", "scale": {"keyframes": [{"frame": 0, "value": 0.5}]}}},
      "g": {"type": "glass", "ior": {"keyframes": [{"frame": 0, "value": 1.5}, {"frame": 9, "value": 2}]},
            "reflectance": {"texture": "t", "tint": {"keyframes": [{"frame": 0, "value": [1, 0, 0]}]}}},
      "c": {"type": "conductor", "anisotropy": 0.5,
            "tangent_rotation": {"keyframes": [{"frame": 0, "value": 0}, {"frame": 8, "value": 1}]}}},
    "environment": {"radiance": {"keyframes": [{"frame": 0, "value": 0}, {"frame": 9, "value": 1}]},
                    "rotation_degrees": {"keyframes": [{"frame": 0, "value": 0}, {"frame": 9, "value": 90}]}},
    "objects": {"o": {"shapes": [{"type": "sphere", "radius": 1, "material": "l"}]}},
    "shapes": [{"type": "instance", "object": "o", "transform": [
      {"scale": {"keyframes": [{"frame": 1, "value": 2}, {"frame": 2, "value": 3}]}},
      {"rotate": {"axis": [0, 1, 0], "degrees": {"keyframes": [{"frame": 0, "value": 0},
                                                               {"frame": 4, "value": 720}]}}},
      {"rotate": {"keyframes": [{"frame": 0, "value": {"axis": [1, 1, 0], "degrees": 10}},
                                {"frame": 7, "value": {"quaternion": [0, 1, 0, 0]}}]}},
      {"translate": {"keyframes": [{"frame": 0, "value": [0, 0, 0]}, {"frame": 3, "value": [0, 0.1, 0]}]}}]}],
    "lights": [{"type": "point", "position": [0, 1, 0],
                "intensity": {"keyframes": [{"frame": 0, "value": 1}, {"frame": 5, "value": [1, 2, 3]}]}}]
  })"));
}

TEST(SceneWriter, WritesMeshesWithAllThatTheyHave) {
  SceneDescription scene = loaded(test::scene_with("", R"("a": {"type": "lambert"}, "b": {"type": "mirror"})",
                                                   R"({"type": "sphere", "radius": 1, "material": "a"})"));
  MeshDescription mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 1e-7f}, {0, 1.0f / 3, 0}, {1, 1, 0.1f}};
  mesh.normals = {{0, 0.1f, 1}, {0, 0, 3}, {0.3f, 0, 1}, {0, 0, 1}};
  mesh.uvs = {{0, 0}, {1, 0.1f}, {-7, 0.7f}, {1, 1}};
  mesh.colors = {{0.1f, 0.2f, 0.3f}, {1, 1, 1}, {0, 0, 0}, {0.5f, 0.5f, 0.5f}};
  mesh.triangles = {{0, 1, 2}, {1, 3, 2}};
  mesh.triangle_materials = {1, 0};
  scene.shapes.emplace_back(mesh);
  scene.shape_names.emplace_back("mesh");
  mesh.triangle_materials = {1};
  scene.shapes.emplace_back(mesh);
  scene.shape_names.emplace_back("mesh");
  expect_round_trip(scene);
}

TEST(SceneWriter, GivesNamesToWhatHasNone) {
  SceneDescription scene =
      loaded(test::scene_with("", R"("a \"b\" \\c": {"type": "lambert"})",
                              R"({"type": "sphere", "radius": 1, "material": "light"})"));
  scene.materials.resize(scene.materials.size() + 2);
  expect_round_trip(scene);
}

TEST(SceneWriter, KeepsTheNamesOfShapes) {
  SceneDescription scene = loaded(test::scene_with(
      "", "", R"({"type": "sphere", "name": "a \"ball\"", "radius": 1, "material": "light"})"));
  MemoryAssets files(written(scene));
  const auto again = load_scene(files, "out.json", "out.json");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->shape_names, scene.shape_names);
  EXPECT_EQ(again->shape_names.front(), "a \"ball\"");
}

TEST(SceneWriter, WritesPixelsOfEachFormat) {
  SceneDescription scene =
      loaded(test::scene_with("", "", R"({"type": "sphere", "radius": 1, "material": "light"})"));
  std::vector<std::uint8_t> bytes(5 * 5 * 3);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i * 255 / 74);
  std::vector<float> floats;
  for (const std::uint8_t byte : bytes) floats.push_back(std::exp2(static_cast<float>(byte) / 16) / 3);
  const auto add = [&](TextureImage image) {
    Texture texture;
    texture.image = std::make_shared<const TextureImage>(std::move(image));
    scene.textures.push_back(texture);
  };
  add(TextureImage(5, 5, bytes, ColorSpace::kSrgb));
  add(TextureImage(5, 5, bytes, ColorSpace::kLinear));
  add(TextureImage(5, 5, floats));
  add(TextureImage(1, 1, std::vector<float>{0.5f, 8, 2}));
  expect_round_trip(scene);
}

TEST(SceneWriter, EndsWithTheFirstFileThatCannotBeWritten) {
  const SceneDescription scene =
      loaded(test::scene_with("", "", R"({"type": "mesh", "file": "triangle.obj", "material": "light"})"));
  const auto done = write_scene(scene, "out", [](const std::string& name, std::string_view) -> Status {
    return fail(ErrorCode::kUnavailable, name + " is full");
  });
  ASSERT_FALSE(done);
  EXPECT_THAT(done.error().message, HasSubstr("out.files/mesh_0000.ply is full"));
}

TEST(JsonText, WritesNumbersThatAreReadAsTheSameBits) {
  EXPECT_EQ(json_text::number(0.1f), "0.1");
  EXPECT_EQ(json_text::number(1.0f), "1");
  EXPECT_EQ(json_text::number(-0.0f), "-0.0");
  std::uint32_t bits = 1;
  for (int i = 0; i < 100000; ++i) {
    bits = bits * 1664525u + 1013904223u;
    const float value = std::bit_cast<float>(bits);
    if (!std::isfinite(value)) continue;
    ASSERT_EQ(static_cast<float>(std::stod(json_text::number(value))), value) << json_text::number(value);
  }
}

}  // namespace
}  // namespace tessera::core
