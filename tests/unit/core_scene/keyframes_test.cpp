// SPDX-License-Identifier: Apache-2.0
// Keyframes in scene files: what they turn into, and what is said about mistakes.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/near.hpp"
#include "tests/unit/core_scene/scene_mistakes.hpp"

namespace tessera::core {
namespace {

using test::expect_mistakes;
using test::scene_with;
using test::with_camera;
using test::with_shapes;

SceneDescription loaded_scene(const std::string& scene) {
  auto loaded = test::load(scene);
  EXPECT_TRUE(loaded.has_value()) << loaded.error().message;
  return loaded ? std::move(*loaded) : SceneDescription{};
}

std::string keyframes(const std::string& list) {
  return "{\"keyframes\": [" + list + "]}";
}

std::string two_keyframes(const std::string& a, const std::string& b) {
  return keyframes("{\"frame\": 1, \"value\": " + a + "}, {\"frame\": 5, \"value\": " + b + "}");
}

std::string lit(const std::string& light) {
  return scene_with("\"lights\": [" + light + "]", "", "");
}

TEST(Keyframes, OfTheCameraAreRead) {
  const SceneDescription scene = loaded_scene(
      with_camera("\"position\": " + two_keyframes("[0, 0, 5]", "[4, 0, 5]") + ", \"look_at\": [0, 0, 0], " +
                  "\"vertical_fov_degrees\": " + two_keyframes("40", "20") + ", \"focus_distance\": " +
                  two_keyframes("1", "2") + ", \"up\": " + two_keyframes("[0, 1, 0]", "[1, 1, 0]") +
                  ", \"aperture_radius\": " + two_keyframes("0", "1") +
                  ", \"aperture_rotation_degrees\": " + two_keyframes("0", "90")));
  EXPECT_EQ(scene.camera.position, (Vec3{0, 0, 5})) << "at frame 0";
  const CameraDescription at = camera_at(scene.camera, scene.animation.camera, 3);
  EXPECT_EQ(at.position, (Vec3{2, 0, 5}));
  EXPECT_EQ(at.look_at, (Vec3{0, 0, 0}));
  EXPECT_EQ(at.up, (Vec3{0.5f, 1, 0}));
  EXPECT_EQ(at.vertical_fov_degrees, 30);
  EXPECT_EQ(at.focus_distance, 1.5f);
  EXPECT_EQ(at.aperture_radius, 0.5f);
  EXPECT_EQ(at.aperture_rotation_degrees, 45);
}

TEST(Keyframes, OfAnOrthographicCameraAreRead) {
  const SceneDescription scene = loaded_scene(
      with_camera("\"type\": \"orthographic\", \"position\": [0, 0, 5], \"look_at\": [0, 0, 0], "
                  "\"view_height\": " +
                  two_keyframes("2", "4") + ", \"lens_shift\": " + two_keyframes("[0, 0]", "[1, -1]")));
  const CameraDescription at = camera_at(scene.camera, scene.animation.camera, 3);
  EXPECT_EQ(at.type, CameraType::kOrthographic);
  EXPECT_EQ(at.view_height, 3);
  EXPECT_EQ(at.lens_shift, (Vec2{0.5f, -0.5f}));
  EXPECT_TRUE(is_animated(scene.animation));
}

TEST(Keyframes, OfLightsAreRead) {
  const SceneDescription scene = loaded_scene(scene_with(
      "\"lights\": [{\"type\": \"point\", \"position\": [0, 1, 0], \"intensity\": 1}, "
      "{\"type\": \"spot\", \"position\": [0, 1, 0], \"look_at\": [0, 0, 0], \"intensity\": " +
          two_keyframes("1", "[3, 1, 1]") + ", \"softness\": " + two_keyframes("0", "1") +
          "}, {\"type\": \"directional\", \"direction\": " + two_keyframes("[0, -1, 0]", "[1, -1, 0]") +
          ", \"irradiance\": 2}]",
      "", ""));
  ASSERT_EQ(scene.lights.size(), 3u);
  ASSERT_EQ(scene.animation.lights.size(), 2u);
  EXPECT_EQ(scene.animation.lights[0].light, 1u);
  EXPECT_EQ(value_at(scene.animation.lights[0].color, 3, Rgb{}), (Rgb{2, 1, 1}));
  EXPECT_EQ(value_at(scene.animation.lights[0].softness, 3, 0.0f), 0.5f);
  EXPECT_EQ(scene.animation.lights[1].light, 2u);
  EXPECT_EQ(value_at(scene.animation.lights[1].direction, 3, Vec3{}), (Vec3{0.5f, -1, 0}));
}

// What moves is an object of its own, in its own space.
TEST(Keyframes, OfATransformMakeTheShapeAnInstance) {
  const SceneDescription scene = loaded_scene(
      with_shapes("{\"type\": \"mesh\", \"file\": \"triangle.obj\", \"material\": \"light\", \"transform\": "
                  "[{\"scale\": 2}, {\"translate\": " +
                  two_keyframes("[0, 0, 0]", "[0, 4, 0]") + "}]}"));
  ASSERT_EQ(scene.objects.size(), 1u);
  EXPECT_EQ(std::get<MeshDescription>(scene.objects[0].shapes[0]).positions[1], (Vec3{1, 0, 0}));
  ASSERT_EQ(scene.animation.instances.size(), 1u);
  EXPECT_EQ(scene.animation.instances[0].shape, 0u);
  EXPECT_TRUE(std::holds_alternative<InstanceDescription>(scene.shapes[0]));
  expect_near(transform_at(scene.animation.instances[0].steps, 2).point({1, 0, 0}), {2, 1, 0}, 1e-6f);
}

TEST(Keyframes, OfInstancesAndOfAllStepsAreRead) {
  const SceneDescription scene = loaded_scene(scene_with(
      "\"objects\": {\"o\": {\"shapes\": [{\"type\": \"sphere\", \"radius\": 1, \"material\": \"m\"}]}}",
      "\"m\": {\"type\": \"lambert\"}",
      "{\"type\": \"instance\", \"object\": \"o\", \"transform\": [{\"scale\": " +
          two_keyframes("1", "[3, 1, 1]") + "}, {\"rotate\": {\"axis\": [0, 0, 1], \"degrees\": " +
          two_keyframes("0", "720") + "}}, {\"rotate\": " +
          two_keyframes("{\"axis\": [0, 0, 1], \"degrees\": 0}", "{\"axis\": [0, 0, 1], \"degrees\": 120}") +
          "}]}"));
  EXPECT_EQ(scene.objects.size(), 1u);
  ASSERT_EQ(scene.animation.instances.size(), 1u);
  // Half-way: twice as long, a whole turn, and a sixth of one.
  expect_near(transform_at(scene.animation.instances[0].steps, 3).point({1, 0, 0}), {1, 1.7320508f, 0},
              1e-5f);
}

TEST(Keyframes, OfATransformThatIsConstantChangeNothing) {
  const SceneDescription scene = loaded_scene(with_shapes(
      "{\"type\": \"sphere\", \"radius\": 1, \"material\": \"light\", \"transform\": [{\"scale\": 2}]}"));
  EXPECT_TRUE(scene.objects.empty());
  EXPECT_TRUE(scene.animation.instances.empty());
  EXPECT_FALSE(is_animated(scene.animation));
}

TEST(Keyframes, OfMaterialsAreReadByTheirKeys) {
  const SceneDescription scene = loaded_scene(
      scene_with("\"textures\": {\"t\": {\"file\": \"gray.png\"}}",
                 "\"still\": {\"type\": \"lambert\"}, \"m\": {\"type\": \"glass\", \"ior\": " +
                     two_keyframes("1.5", "2") +
                     ", \"reflectance\": {\"texture\": \"t\", \"tint\": " + two_keyframes("1", "0.5") +
                     "}, \"roughness\": {\"texture\": \"t\", \"scale\": " + two_keyframes("0", "1") +
                     "}, \"emission\": " + two_keyframes("0", "[2, 0, 0]") +
                     ", \"opacity\": " + two_keyframes("1", "0") +
                     ", \"normal_map\": {\"texture\": \"t\", \"strength\": " + two_keyframes("1", "3") +
                     "}, \"bump\": {\"texture\": \"t\", \"height\": " + two_keyframes("-1", "1") + "}}",
                 "{\"type\": \"sphere\", \"radius\": 1, \"material\": \"m\"}"));
  ASSERT_EQ(scene.animation.materials.size(), 1u);
  const auto& [index, tracks] = scene.animation.materials[0];
  EXPECT_EQ(index, 1u);
  const Material m = values_at(scene.materials[1], tracks, 3);
  const auto& glass = std::get<Glass>(m.model);
  EXPECT_EQ(glass.ior.value, 1.75f);
  EXPECT_EQ(glass.reflectance.value, Rgb::gray(0.75f));
  EXPECT_EQ(glass.reflectance.texture, 0);
  EXPECT_EQ(glass.roughness.value, 0.5f);
  EXPECT_EQ(m.emission.value, (Rgb{1, 0, 0}));
  EXPECT_EQ(m.opacity.value, 0.5f);
  EXPECT_EQ(m.normal_map.strength, 2);
  EXPECT_EQ(m.bump.height, 0);
  EXPECT_EQ(std::get<Glass>(scene.materials[1].model).ior.value, 1.5f) << "at frame 0";
}

TEST(Keyframes, OfMediaAndTheEnvironmentAreRead) {
  const SceneDescription scene = loaded_scene(
      scene_with("\"media\": {\"fog\": {\"sigma_a\": " + two_keyframes("0", "[1, 2, 3]") +
                     ", \"scale\": " + two_keyframes("1", "3") + ", \"g\": " + two_keyframes("-0.5", "0.5") +
                     "}}, \"environment\": {\"radiance\": " + two_keyframes("0", "1") +
                     ", \"rotation_degrees\": " + two_keyframes("0", "720") + "}",
                 "\"m\": {\"type\": \"lambert\", \"interior_medium\": \"fog\"}",
                 "{\"type\": \"sphere\", \"radius\": 1, \"material\": \"m\"}"));
  ASSERT_EQ(scene.animation.media.size(), 1u);
  const MediumDescription fog = values_at(scene.media[0], scene.animation.media[0].tracks, 3);
  EXPECT_EQ(fog.sigma_a, (Rgb{0.5f, 1, 1.5f}));
  EXPECT_EQ(fog.scale, 2);
  EXPECT_EQ(fog.g, 0);
  const EnvironmentDescription sky = values_at(*scene.environment, scene.animation.environment, 3);
  EXPECT_EQ(sky.radiance.value, Rgb::gray(0.5f));
  EXPECT_EQ(sky.rotation_degrees, 360);
}

TEST(Keyframes, OfParametersHaveTheLimitsOfTheirNumbers) {
  EXPECT_EQ(test::mistakes_in(scene_with(
                "", "\"m\": {\"type\": \"lambert\", \"albedo\": " + two_keyframes("1", "1.5") + "}",
                "{\"type\": \"sphere\", \"radius\": 1, \"material\": \"m\"}")),
            "scene.json:3: materials.m.albedo.keyframes[1].value: must be between 0 and 1, got 1.5");
}

TEST(Keyframes, AreSeenWhileTheShutterIsOpen) {
  const std::string rest = "\"position\": [0, 0, 5], \"look_at\": [0, 0, 0]";
  EXPECT_EQ(loaded_scene(with_camera(rest + ", \"shutter\": [-0.25, 0.25]")).camera.shutter_open, -0.25f);
  EXPECT_EQ(loaded_scene(with_camera(rest + ", \"shutter\": [0.5, 0.5]")).camera.shutter_close, 0.5f);
  expect_mistakes({{rest + ", \"shutter\": [1, 0]",
                    "camera.shutter: the shutter must open before it closes: write [open, close]"},
                   {rest + ", \"shutter\": [0, 1e4]",
                    "camera.shutter[1]: must be between -1000 and 1000 frames, got 10000"},
                   {rest + ", \"shutter\": 0.5", "camera.shutter: must be a list of 2 numbers, got 0.5"}},
                  with_camera, 2);
}

TEST(KeyframeMistakes, InTheCamera) {
  const std::string rest = ", \"look_at\": [0, 0, 0]";
  expect_mistakes(
      {
          {"\"position\": {\"keyframes\": []}" + rest,
           "camera.position.keyframes: must be a list of at least one keyframe such as {\"frame\": 1, "
           "\"value\": 0}, got a list of 0"},
          {"\"position\": {\"keyframes\": 3}" + rest,
           "camera.position.keyframes: must be a list of at least one keyframe such as {\"frame\": 1, "
           "\"value\": 0}, got 3"},
          {"\"position\": " + keyframes("{\"frame\": 1, \"vlaue\": [0, 0, 5]}") + rest,
           "camera.position.keyframes[0]: unknown key 'vlaue'; did you mean 'value'?\nscene.json:2: "
           "camera.position.keyframes[0]: a keyframe needs the key 'value'"},
          {"\"position\": " + keyframes("{\"frame\": 1, \"value\": [0, 5]}") + rest,
           "camera.position.keyframes[0].value: must be a list of 3 numbers, got a list of 2"},
          {"\"position\": " + two_keyframes("[0, 0, 5]", "[0, 0, 1e16]") + rest,
           "camera.position.keyframes[1].value[2]: must be a number between -1e15 and 1e15, got 1e+16"},
          {"\"position\": " +
               keyframes("{\"frame\": 4, \"value\": [0, 0, 5]}, {\"frame\": 4, \"value\": [0, 0, 6]}") + rest,
           "camera.position.keyframes[1].frame: keyframes must be in the order of their frames: 4 follows 4"},
          {"\"position\": " + keyframes("{\"frame\": 1e7, \"value\": [0, 0, 5]}") + rest,
           "camera.position.keyframes[0].frame: must be a number between -1000000 and 1000000, got 10000000"},
          {"\"position\": {\"keyframes\": [{\"frame\": 0, \"value\": [0, 0, 5]}], \"loop\": true}" + rest,
           "camera.position: unknown key 'loop'; known is 'keyframes'"},
          {"\"position\": [0, 0, 5], \"vertical_fov_degrees\": " + two_keyframes("40", "180") + rest,
           "camera.vertical_fov_degrees.keyframes[1].value: must be greater than 0 and less than 180, got "
           "180"},
          {"\"position\": [0, 0, 5], \"aperture_blades\": " + two_keyframes("0", "5") + rest,
           "camera.aperture_blades: must be 0 for a round opening, or a whole number from 3 to 64, got an "
           "object"},
      },
      with_camera, 2);
}

TEST(KeyframeMistakes, InTransforms) {
  const auto sphere = [](const std::string& step) {
    return "{\"type\": \"sphere\", \"radius\": 1, \"material\": \"light\", \"transform\": [" + step + "]}";
  };
  expect_mistakes(
      {
          {sphere("{\"matrix\": " + two_keyframes("1", "2") + "}"),
           "shapes[0].transform[0].matrix: a matrix cannot be animated; write it as the steps 'scale', "
           "'rotate' and 'translate'"},
          {sphere("{\"scale\": " + two_keyframes("1", "0") + "}"),
           "shapes[0].transform[0].scale.keyframes[1].value: must be other than 0, got 0"},
          {sphere("{\"rotate\": " + two_keyframes("90", "{\"axis\": [0, 1, 0], \"degrees\": 1}") + "}"),
           "shapes[0].transform[0].rotate.keyframes[0].value: must be an object in braces, got 90"},
          {sphere("{\"rotate\": {\"axis\": " + two_keyframes("[0, 1, 0]", "[1, 0, 0]") +
                  ", \"degrees\": 3}}"),
           "shapes[0].transform[0].rotate.axis: must be a list of 3 numbers, got an object"},
          {sphere("{\"scale\": " + two_keyframes("1", "1e-30") + "}, {\"scale\": 1e-5}"),
           "shapes[0].transform: at frame 5, the steps together flatten, scale or move the shape too far to "
           "be "
           "computed"},
      },
      with_shapes, 4);
}

TEST(KeyframeMistakes, InShapesOfObjects) {
  const std::string scene = scene_with(
      "\"objects\": {\"o\": {\"shapes\": [{\"type\": \"sphere\", \"radius\": 1, \"material\": \"light\", "
      "\"transform\": [{\"translate\": " +
          two_keyframes("[0, 0, 0]", "[1, 0, 0]") + "}]}]}}",
      "", "");
  EXPECT_EQ(
      test::mistakes_in(scene),
      "scene.json:2: objects.o.shapes[0].transform: a shape of an object cannot move by itself: animate the "
      "transforms of its instances");
}

// A strip of two triangles whose far end is at height z.
struct Strip {
  float z = 0;
  std::string normal{};  // of all vertices; empty for none
  int vertices = 4;      // the last ones are unused
  std::vector<std::string> faces{"3 0 1 2", "3 0 2 3"};

  std::string ply() const {
    std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertices) +
                       "\nproperty float x\nproperty float y\nproperty float z\n";
    if (!normal.empty()) text += "property float nx\nproperty float ny\nproperty float nz\n";
    text += "element face " + std::to_string(faces.size()) +
            "\nproperty list uchar int vertex_indices\nend_header\n";
    const std::string far = " 1 " + std::to_string(z);
    for (int i = 0; i < vertices; ++i)
      text += (i == 1 ? "1 0 0" : i == 2 ? "1" + far : i == 3 ? "0" + far : "0 0 0") + (" " + normal) + "\n";
    for (const std::string& face : faces) text += face + "\n";
    return text;
  }
};
std::string strip(float z) {
  return Strip{.z = z}.ply();
}

std::string with_strip(const std::string& file, const std::string& more = "") {
  return with_shapes("{\"type\": \"mesh\", \"file\": " + file + more + "}");
}

TEST(Keyframes, OfMeshesAreRead) {
  const auto loaded = test::load(
      with_strip(two_keyframes("\"a.ply\"", "\"b.ply\""), ", \"transform\": [{\"translate\": [0, 0, 3]}]"),
      {{"a.ply", strip(0)}, {"b.ply", strip(1)}});
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_TRUE(is_animated(loaded->animation));
  const auto& mesh = std::get<MeshDescription>(loaded->shapes[0]);
  ASSERT_EQ(mesh.steps.size(), 2u);
  EXPECT_EQ(mesh.steps[0].frame, 1);
  EXPECT_EQ(mesh.steps[1].frame, 5);
  EXPECT_EQ(mesh.steps[0].positions[2], (Vec3{1, 1, 3}));
  EXPECT_EQ(mesh.steps[1].positions[2], (Vec3{1, 1, 4}));
  EXPECT_EQ(mesh.positions, mesh.steps[0].positions) << "at frame 0";
  EXPECT_NEAR(mesh.steps[1].normals[0].z, std::sqrt(0.5f), 1e-6f) << "means of the triangles at each step";
  EXPECT_EQ(mesh.steps[0].normals[0], (Vec3{0, 0, 1}));
}

// At frame 0, between two keyframes. A flat triangle stays, since it may gain an area.
TEST(Keyframes, OfMeshesThatAreFlatAtTimesAreRead) {
  std::string folded = strip(0);
  folded.replace(folded.find("1 1 0"), 3, "0 0");
  const auto loaded = test::load(
      with_strip(keyframes("{\"frame\": -1, \"value\": \"a.ply\"}, {\"frame\": 1, \"value\": \"b.ply\"}")),
      {{"a.ply", strip(0)}, {"b.ply", folded}});
  ASSERT_TRUE(loaded) << loaded.error().message;
  const auto& mesh = std::get<MeshDescription>(loaded->shapes[0]);
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.positions[2], (Vec3{0.5f, 0.5f, 0}));
}

TEST(Keyframes, OfOneFileAreAMesh) {
  const auto loaded =
      test::load(with_strip(keyframes("{\"frame\": 3, \"value\": \"a.ply\"}")), {{"a.ply", strip(0)}});
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_TRUE(std::get<MeshDescription>(loaded->shapes[0]).steps.empty());
  EXPECT_FALSE(is_animated(loaded->animation));
}

TEST(KeyframeMistakes, InMeshes) {
  const auto mistake = [](const std::string& b) {
    return test::mistakes_in(with_strip(two_keyframes("\"a.ply\"", "\"b.ply\"")),
                             {{"a.ply", strip(0)}, {"b.ply", b}});
  };
  const std::string at = "scene.json:4: shapes[0].file: ";
  EXPECT_EQ(mistake(Strip{.vertices = 5}.ply()),
            at + "'b.ply' has 5 vertices, but 'a.ply' has 4: a mesh that deforms has the same vertices and "
                 "triangles at all frames");
  EXPECT_EQ(mistake(Strip{.faces = {"3 0 1 2"}}.ply()),
            at + "'b.ply' has 1 triangles, but 'a.ply' has 2: a mesh that deforms has the same vertices and "
                 "triangles at all frames");
  EXPECT_EQ(mistake(Strip{.faces = {"3 0 1 2", "3 0 3 2"}}.ply()),
            at + "triangle 2 of 'b.ply' has other vertices than that of 'a.ply': a mesh that deforms has the "
                 "same triangles at all frames");
  EXPECT_EQ(mistake(Strip{.normal = "0 0 1"}.ply()),
            at + "either both 'a.ply' and 'b.ply' have normals, or neither");
  const std::string broken = Strip{.faces = {"3 0 1 2", "3 0 2 9"}}.ply();
  EXPECT_EQ(test::mistakes_in(with_strip(two_keyframes("\"a.ply\"", "\"b.ply\"")),
                              {{"a.ply", broken}, {"b.ply", strip(0)}}),
            at + "'b.ply' has 2 triangles, but 'a.ply' has 1: a mesh that deforms has the same vertices and "
                 "triangles at all frames")
      << "the face of a vertex that is not there is left out";
  std::string endless = strip(0);
  endless.replace(endless.find("\n1 0 0"), 2, "\nnan");
  EXPECT_EQ(mistake(endless), at + "'b.ply': vertex 2 of a triangle does not exist or is not finite");
  EXPECT_EQ(test::mistakes_in(with_strip(two_keyframes("\"a.ply\"", "\"b.obj\"")), {{"a.ply", strip(0)}}),
            at + "'b.obj' is no PLY file: only those can be the keyframes of a mesh, because their vertices "
                 "keep their order");
}

TEST(KeyframeMistakes, InLights) {
  EXPECT_EQ(test::mistakes_in(lit("{\"type\": \"point\", \"position\": [0, 1, 0], \"intensity\": " +
                                  two_keyframes("1", "-1") + "}")),
            "scene.json:2: lights[0].intensity.keyframes[1].value: must be 0 or greater, got -1");
}

}  // namespace
}  // namespace tessera::core
