// SPDX-License-Identifier: Apache-2.0
// Every kind of mistake in how a scene is rendered, seen and lit, and exactly what is said about it.
#include <gtest/gtest.h>

#include "tests/unit/core_scene/scene_mistakes.hpp"

namespace tessera::core {
namespace {

using test::expect_mistakes;
using test::mistakes_in;
using test::scene_with;
using test::with_camera;
using test::with_render;

TEST(SceneMistakes, InRender) {
  expect_mistakes(
      {
          {"\"spp\": -3", "render.spp: must be a whole number between 1 and 16777216, got -3"},
          {"\"spp\": 0", "render.spp: must be a whole number between 1 and 16777216, got 0"},
          {"\"spp\": 2.5", "render.spp: must be a whole number between 1 and 16777216, got 2.5"},
          {"\"spp\": \"64\"", "render.spp: must be a whole number between 1 and 16777216, got the text '64'"},
          {"\"spp\": 1e12", "render.spp: must be a whole number between 1 and 16777216, got 1000000000000"},
          {"\"spp\": null", "render.spp: must be a whole number between 1 and 16777216, got null"},
          {"\"width\": 0", "render.width: must be a whole number between 1 and 65536, got 0"},
          {"\"height\": 65537", "render.height: must be a whole number between 1 and 65536, got 65537"},
          {"\"height\": -4294967295",
           "render.height: must be a whole number between 1 and 65536, got -4294967295"},
          {"\"width\": 65536, \"height\": 65536",
           "render: 65536 x 65536 pixels are more than the 1073741824 that an image may have"},
          {"\"seed\": -1", "render.seed: must be a whole number between 0 and 18446744073709551615, got -1"},
          {"\"seed\": 18446744073709551616",
           "render.seed: must be a whole number between 0 and 18446744073709551615, got "
           "1.8446744073709552e+19"},
          {"\"max_depth\": -1",
           "render.max_depth: must be a whole number between 1 and 1024, or 0 for 8 with whitted and no "
           "limit "
           "otherwise, got -1"},
          {"\"max_depth\": 1025",
           "render.max_depth: must be a whole number between 1 and 1024, or 0 for 8 with whitted and no "
           "limit "
           "otherwise, got 1025"},
          {"\"clamp_indirect\": -0.5", "render.clamp_indirect: must be 0 or greater, got -0.5"},
          {"\"integrator\": \"miss\"", "render.integrator: unknown value 'miss'; did you mean 'mis'?"},
          {"\"integrator\": \"bdpt\"",
           "render.integrator: unknown value 'bdpt'; known are 'naive', 'nee', 'mis', 'whitted'"},
          {"\"integrator\": 1",
           "render.integrator: must be one of \"naive\", \"nee\", \"mis\", \"whitted\", got 1"},
          {"\"heuristic\": \"powr\"", "render.heuristic: unknown value 'powr'; did you mean 'power'?"},
          {"\"widht\": 5", "render: unknown key 'widht'; did you mean 'width'?"},
          {"\"filter\": \"lanczos\"",
           "render.filter: unknown value 'lanczos'; known are 'box', 'tent', 'gaussian'"},
          {"\"filter_radius\": 0",
           "render.filter_radius: must be greater than 0 and at most 16 pixels, got 0"},
          {"\"filter_radius\": 16.5",
           "render.filter_radius: must be greater than 0 and at most 16 pixels, got 16.5"},
          {"\"crop\": [0, 0, 5]",
           "render.crop: must be a list of 4 whole numbers, [x0, y0, x1, y1], got a list of 3"},
          {"\"crop\": \"0,0,5,5\"",
           "render.crop: must be a list of 4 whole numbers, [x0, y0, x1, y1], got the text '0,0,5,5'"},
          {"\"crop\": [0, 0.5, 5, 5]", "render.crop[1]: must be a whole number between 0 and 65536, got 0.5"},
          {"\"crop\": [-1, 0, 5, 5]", "render.crop[0]: must be a whole number between 0 and 65536, got -1"},
          {"\"crop\": [5, 0, 5, 5]",
           "render.crop: must be x0, y0, x1, y1 with x0 < x1 and y0 < y1, within the 512 x 512 pixels of the "
           "image, got 5, 0, 5, 5"},
          {"\"width\": 60, \"crop\": [0, 0, 61, 5]",
           "render.crop: must be x0, y0, x1, y1 with x0 < x1 and y0 < y1, within the 60 x 512 pixels of the "
           "image, got 0, 0, 61, 5"},
          {"\"width\": 0, \"crop\": [0, 0, 5, 5]",
           "render.width: must be a whole number between 1 and 65536, got 0"},
      },
      with_render, 2);
}

TEST(SceneMistakes, InTheCamera) {
  const std::string view = "\"position\": [0, 0, 5], \"look_at\": [0, 0, 0]";
  expect_mistakes(
      {
          {"\"look_at\": [0, 0, 1]", "camera: a camera needs the key 'position'"},
          {"\"position\": [0, 0, 1]", "camera: a camera needs the key 'look_at'"},
          {"\"position\": [0, 0], \"look_at\": [0, 0, 0]",
           "camera.position: must be a list of 3 numbers, got a list of 2"},
          {"\"position\": 0, \"look_at\": [0, 0, 0]", "camera.position: must be a list of 3 numbers, got 0"},
          {"\"position\": [0, \"a\", 0], \"look_at\": [0, 0, 1]",
           "camera.position[1]: must be a number without quotes, between -1e15 and 1e15, got the text 'a'"},
          {"\"position\": [0, 1e39, 0], \"look_at\": [0, 0, 1]",
           "camera.position[1]: must be between -3.4e38 and 3.4e38, got 1e+39"},
          {"\"position\": [1, 2, 3], \"look_at\": [1, 2, 3]",
           "camera: 'look_at' must be another point than 'position', and not too far from it to be computed"},
          {view + ", \"up\": [0, 0, 2]",
           "camera: 'up' must not point along the line from 'position' to 'look_at'"},
          {view + ", \"up\": [0, 0, 0]",
           "camera: 'up' must have a length that is greater than 0 and can be computed"},
          {view + ", \"vertical_fov_degrees\": 0",
           "camera.vertical_fov_degrees: must be greater than 0 and less than 180, got 0"},
          {view + ", \"vertical_fov_degrees\": \"90\"",
           "camera.vertical_fov_degrees: must be a number without quotes, greater than 0 and less than 180, "
           "got the text '90'"},
          {view + ", \"up\": [0, \"1\", 0]",
           "camera.up[1]: must be a number without quotes, got the text '1'"},
          {view + ", \"vertical_fov_degrees\": 180",
           "camera.vertical_fov_degrees: must be greater than 0 and less than 180, got 180"},
          {view + ", \"vertical_fov_degrees\": 1e-60",
           "camera.vertical_fov_degrees: must be greater than 0 and less than 180, got 1e-60"},
          {view + ", \"aperture_radius\": -1", "camera.aperture_radius: must be between 0 and 1e15, got -1"},
          {view + ", \"focus_distance\": 0", "camera.focus_distance: must be greater than 0, got 0"},
          {view + ", \"vertical_fov\": 40",
           "camera: unknown key 'vertical_fov'; did you mean 'vertical_fov_degrees'?"},
          {view + ", \"type\": \"fisheye\"",
           "camera.type: unknown value 'fisheye'; known are 'perspective', 'orthographic', 'panoramic'"},
          {view + ", \"type\": \"orthographic\"",
           "camera: an orthographic camera needs the key 'view_height'"},
          {view + ", \"type\": \"orthographic\", \"view_height\": 0",
           "camera.view_height: must be greater than 0 and at most 1e15, got 0"},
          {view + ", \"type\": \"orthographic\", \"view_height\": 1, \"vertical_fov_degrees\": 40",
           "camera.vertical_fov_degrees: a camera of the type 'orthographic' does not have this key"},
          {view + ", \"view_height\": 1",
           "camera.view_height: a camera of the type 'perspective' does not have this key"},
          {view + ", \"type\": \"panoramic\", \"aperture_radius\": 1",
           "camera.aperture_radius: a camera of the type 'panoramic' does not have this key"},
          {view + ", \"lens_shift\": [0, 2000]",
           "camera.lens_shift[1]: must be between -1000 and 1000 widths or heights of the image, got 2000"},
          {view + ", \"aperture_blades\": 2",
           "camera.aperture_blades: must be 0 for a round opening, or a whole number from 3 to 64, got 2"},
          {view + ", \"aperture_blades\": 65",
           "camera.aperture_blades: must be 0 for a round opening, or a whole number from 3 to 64, got 65"},
          {view + ", \"aperture_blades\": 5.5",
           "camera.aperture_blades: must be 0 for a round opening, or a whole number from 3 to 64, got 5.5"},
          {view + ", \"aperture_blades\": \"six\"",
           "camera.aperture_blades: must be 0 for a round opening, or a whole number from 3 to 64, got the "
           "text 'six'"},
          {view + ", \"aperture_rotation_degrees\": 361",
           "camera.aperture_rotation_degrees: must be between -360 and 360, got 361"},
      },
      with_camera, 2);
}

TEST(SceneMistakes, InTheOutput) {
  const auto with_output = [](const std::string& output) {
    return scene_with("\"output\": {" + output + "}", "", "");
  };
  expect_mistakes(
      {
          {"\"exposure\": 65", "output.exposure: must be between -64 and 64 stops, got 65"},
          {"\"exposure\": \"+1\"",
           "output.exposure: must be a number without quotes, between -64 and 64 stops, got the text '+1'"},
          {"\"tone_curve\": \"filmic\"",
           "output.tone_curve: unknown value 'filmic'; known are 'none', 'aces', 'agx'"},
          {"\"tone_cuve\": \"agx\"", "output: unknown key 'tone_cuve'; did you mean 'tone_curve'?"},
      },
      with_output, 2);
}

std::string with_lights(const std::string& lights) {
  return scene_with("\"lights\": [" + lights + "]", "", "");
}

TEST(SceneMistakes, InLights) {
  EXPECT_EQ(mistakes_in(with_lights("")), "no mistake");
  EXPECT_EQ(mistakes_in(scene_with("\"lights\": {}", "", "")),
            "scene.json:2: lights: must be a list of lights in brackets, got an object");
  const std::string spot = "{\"type\": \"spot\", \"position\": [0, 1, 0], \"intensity\": 1, ";
  expect_mistakes(
      {
          {"{\"type\": \"sun\"}",
           "lights[0].type: unknown value 'sun'; known are 'point', 'spot', 'directional'"},
          {"{\"type\": \"point\", \"intensity\": 1}", "lights[0]: a point light needs the key 'position'"},
          {"{\"type\": \"point\", \"position\": [0, 1, 0], \"intensity\": -1}",
           "lights[0].intensity: must be 0 or greater, got -1"},
          {"{\"type\": \"point\", \"position\": [0, 1, 0], \"radiance\": 1, \"intensity\": 1}",
           "lights[0]: unknown key 'radiance'; known are 'type', 'position', 'intensity', 'texture', "
           "'orientation', 'group'"},
          {spot + "\"look_at\": [0, 1, 0]}",
           "lights[0]: 'look_at' must be another point than 'position', and not too near it to be computed"},
          {spot + "\"look_at\": [0, 0, 0], \"angle_degrees\": 200}",
           "lights[0].angle_degrees: must be greater than 0 and at most 180, got 200"},
          {spot + "\"look_at\": [0, 0, 0], \"softness\": 2}",
           "lights[0].softness: must be between 0 and 1, got 2"},
          {"{\"type\": \"directional\", \"direction\": [0, 0, 0], \"irradiance\": 1}",
           "lights[0]: 'direction' must have a length that is greater than 0 and can be computed"},
      },
      with_lights, 2);
}

std::string with_environment(const std::string& environment) {
  return scene_with(
      "\"textures\": {\"sky\": {\"file\": \"gray.png\", \"scale\": [2, 1]}}, "
      "\"environment\": {" +
          environment + "}",
      "", "");
}

TEST(SceneMistakes, InTheEnvironment) {
  EXPECT_EQ(mistakes_in(with_environment("")), "no mistake");
  expect_mistakes(
      {
          {"\"radiance\": -1", "environment.radiance: must be 0 or greater, got -1"},
          {"\"radiance\": {\"texture\": \"sky\"}",
           "environment.radiance: must be a number or a list of 3 numbers, got an object; the texture is a "
           "key of "
           "its own: \"texture\": \"NAME\""},
          {"\"radiance\": \"sky\"",
           "environment.radiance: must be a number or a list of 3 numbers, got the text 'sky'; the texture "
           "is a key "
           "of its own: \"texture\": \"NAME\""},
          {"\"rotation\": 30", "environment: unknown key 'rotation'; did you mean 'rotation_degrees'?"},
          {"\"texture\": \"sun\"", "environment.texture: there is no texture 'sun'; known is 'sky'"},
          {"\"texture\": \"sky\"",
           "environment.texture: the environment is one whole image: leave out the texture's 'scale', "
           "'offset', 'shear', 'uv_set', 'wrap' and 'filter'; 'rotation_degrees' turns it"},
      },
      with_environment, 2);
}

TEST(LightGroupMistakes, AreNamed) {
  expect_mistakes(
      {{"\"layers\": [\"group.\"]",
        "render.layers[0]: the name of a light group must be 1 to 64 letters, digits, '_' and '-'"}},
      test::with_render, 2);
  const auto with_light = [](const std::string& group) {
    return test::scene_with(
        "\"lights\": [{\"type\": \"point\", \"position\": [0, 3, 0], \"intensity\": 1, "
        "\"group\": " +
            group + "}]",
        "", "");
  };
  expect_mistakes(
      {{"\"a.b\"", "lights[0].group: must be 1 to 64 letters, digits, '_' and '-', got the text 'a.b'"}},
      +with_light, 2);
}

}  // namespace
}  // namespace tessera::core
