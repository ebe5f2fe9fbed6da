// Every kind of mistake in a scene file or in what it names, and exactly what is said about it.
#include <gtest/gtest.h>

#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core {
namespace {

using test::MemoryAssets;
using test::mistakes_in;
using test::scene_with;

struct Case {
  std::string text, message;
};

// Where the text stands in a scene of scene_with, and thus its line.
std::string with_render(const std::string& render) {
  return scene_with("\"render\": {" + render + "}", "", "");
}
std::string with_textures(const std::string& textures) {
  return scene_with("\"textures\": {" + textures + "}", "", "");
}
std::string with_materials(const std::string& materials) {
  return scene_with("", materials, "");
}
std::string with_shapes(const std::string& shapes) {
  return scene_with("", "", shapes);
}
std::string with_camera(const std::string& camera) {
  return "{\"materials\": {\"l\": {\"type\": \"lambert\", \"emission\": 1}},\n\"camera\": {" + camera +
         "},\n\"shapes\": [{\"type\": \"sphere\", \"radius\": 1, \"material\": \"l\"}]}";
}

void expect_mistakes(const std::vector<Case>& cases, std::string (*scene)(const std::string&), int line) {
  for (const auto& [text, message] : cases)
    EXPECT_EQ(mistakes_in(scene(text)), "scene.json:" + std::to_string(line) + ": " + message) << text;
}

TEST(SceneMistakes, NoneInTheScenesThatTheOthersAreMadeFrom) {
  EXPECT_EQ(mistakes_in(with_render("")), "no mistake");
  EXPECT_EQ(mistakes_in(with_textures("")), "no mistake");
  EXPECT_EQ(mistakes_in(with_camera("\"position\": [0, 0, 5], \"look_at\": [0, 0, 0]")), "no mistake");
}

TEST(SceneMistakes, OfTheWholeFile) {
  EXPECT_EQ(mistakes_in(""),
            "scene.json:1:1: not valid JSON: found the end of the file where a value is due");
  EXPECT_EQ(mistakes_in("\n[1, 2]"), "scene.json:2: must be an object in braces, got a list of 2");
  EXPECT_EQ(mistakes_in("{}"),
            "scene.json:1: a scene needs the key 'camera'\nscene.json:1: a scene needs the key 'shapes'");
  EXPECT_EQ(mistakes_in(scene_with("\"material\": {}", "", "")),
            "scene.json:2: unknown key 'material'; did you mean 'materials'?");
  EXPECT_EQ(mistakes_in(scene_with("\"$schema\": 3", "", "")),
            "scene.json:2: $schema: must be a text in double quotes, got 3");
  EXPECT_EQ(mistakes_in(scene_with("\"materials\": {}", "", "")),
            "scene.json:3: the key 'materials' is already there in line 2\n"
            "scene.json:4: shapes[0].material: there is no material 'light'");
}

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
           "render: 65536 x 65536 pixels are more than the 1073741824 that a picture may have"},
          {"\"seed\": -1", "render.seed: must be a whole number between 0 and 18446744073709551615, got -1"},
          {"\"seed\": 18446744073709551616",
           "render.seed: must be a whole number between 0 and 18446744073709551615, got "
           "1.8446744073709552e+19"},
          {"\"max_depth\": -1", "render.max_depth: must be a whole number between 0 and 1048576, got -1"},
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
           "picture, got 5, 0, 5, 5"},
          {"\"width\": 60, \"crop\": [0, 0, 61, 5]",
           "render.crop: must be x0, y0, x1, y1 with x0 < x1 and y0 < y1, within the 60 x 512 pixels of the "
           "picture, got 0, 0, 61, 5"},
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
          {view + ", \"aperture_radius\": -1", "camera.aperture_radius: must be 0 or greater, got -1"},
          {view + ", \"focus_distance\": 0", "camera.focus_distance: must be greater than 0, got 0"},
          {view + ", \"vertical_fov\": 40",
           "camera: unknown key 'vertical_fov'; known are 'position', 'look_at', 'up', "
           "'vertical_fov_degrees', 'aperture_radius', 'focus_distance', 'aperture_blades', "
           "'aperture_rotation_degrees'"},
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

TEST(SceneMistakes, InTextures) {
  expect_mistakes(
      {
          {"\"wood\": {}", "textures.wood: a texture needs the key 'file'"},
          {"\"wood\": \"wood.png\"", "textures.wood: must be an object in braces, got the text 'wood.png'"},
          {"\"\": {\"file\": \"gray.png\"}", "textures: a name must not be empty"},
          {"\"wood\": {\"file\": 3}", "textures.wood.file: must be a text in double quotes, got 3"},
          {"\"wood\": {\"file\": \"\"}",
           "textures.wood.file: must be a text in double quotes, got the text ''"},
          {"\"wood\": {\"file\": \"none.png\"}", "textures.wood.file: 'none.png' does not exist"},
          {"\"wood\": {\"file\": \"triangle.obj\"}",
           "textures.wood.file: 'triangle.obj' is not a PNG, JPEG or HDR picture"},
          {"\"wood\": {\"file\": \"gray.png\", \"color_space\": \"sRGB\"}",
           "textures.wood.color_space: unknown value 'sRGB'; known are 'srgb', 'linear'"},
          {"\"wood\": {\"file\": \"gray.png\", \"wrap\": \"clmap\"}",
           "textures.wood.wrap: unknown value 'clmap'; did you mean 'clamp'?"},
          {"\"wood\": {\"file\": \"gray.png\", \"scale\": 2}",
           "textures.wood.scale: must be a list of 2 numbers, got 2"},
          {"\"wood\": {\"file\": \"gray.png\", \"offset\": [0, 0, 0]}",
           "textures.wood.offset: must be a list of 2 numbers, got a list of 3"},
          {"\"wood\": {\"file\": \"gray.png\", \"flie\": 3}",
           "textures.wood: unknown key 'flie'; did you mean 'file'?"},
      },
      with_textures, 2);
}

TEST(SceneMistakes, InMaterials) {
  expect_mistakes(
      {
          {"\"m\": {}",
           "materials.m: a material needs the key 'type', one of \"lambert\", \"mirror\", \"glass\", "
           "\"phong\", \"cook_torrance\""},
          {"\"m\": 3", "materials.m: must be an object in braces, got 3"},
          {"\"m\": {\"type\": \"lambertian\"}",
           "materials.m.type: unknown value 'lambertian'; did you mean 'lambert'?"},
          {"\"m\": {\"type\": \"lambert\", \"albdo\": 1}",
           "materials.m: unknown key 'albdo'; did you mean 'albedo'?"},
          {"\"m\": {\"type\": \"lambert\", \"albedo\": 3}",
           "materials.m.albedo: must be between 0 and 1, got 3"},
          {"\"m\": {\"type\": \"lambert\", \"albedo\": [0.5, 0.5, -0.1]}",
           "materials.m.albedo[2]: must be between 0 and 1, got -0.1"},
          {"\"m\": {\"type\": \"lambert\", \"albedo\": \"red\"}",
           "materials.m.albedo: must be a number, a list of 3 numbers or a texture as {\"texture\": "
           "\"NAME\"}, got the text 'red'"},
          {"\"m\": {\"type\": \"lambert\", \"albedo\": {\"texture\": \"wood\"}}",
           "materials.m.albedo.texture: there is no texture 'wood'"},
          {"\"m\": {\"type\": \"lambert\", \"albedo\": {\"tint\": 1}}",
           "materials.m.albedo: a textured colour needs the key 'texture'"},
          {"\"m\": {\"type\": \"lambert\", \"emission\": -1}",
           "materials.m.emission: must be 0 or greater, got -1"},
          {"\"m\": {\"type\": \"lambert\", \"emission\": \"lamp\"}",
           "materials.m.emission: must be a number, a list of 3 numbers or a texture as {\"texture\": "
           "\"NAME\"}, got the text 'lamp'"},
          {"\"m\": {\"type\": \"lambert\", \"emission\": [1, 1]}",
           "materials.m.emission: must be a list of 3 numbers, got a list of 2"},
          {"\"m\": {\"type\": \"lambert\", \"emission_sides\": \"back\"}",
           "materials.m.emission_sides: unknown value 'back'; known are 'both', 'front'"},
          {"\"m\": {\"type\": \"lambert\", \"ior\": 1.5}",
           "materials.m: unknown key 'ior'; known are 'type', 'albedo', 'emission', 'emission_sides', "
           "'sampling', 'normal_map'"},
          {"\"m\": {\"type\": \"mirror\", \"reflectance\": 1.1}",
           "materials.m.reflectance: must be between 0 and 1, got 1.1"},
          {"\"m\": {\"type\": \"glass\", \"ior\": 0.67}",
           "materials.m.ior: must be between 1 and 10 (it is that of the inside; for air in glass, turn the "
           "surface inside "
           "out), got 0.67"},
          {"\"m\": {\"type\": \"glass\", \"transmitance\": 1}",
           "materials.m: unknown key 'transmitance'; did you mean 'transmittance'?"},
          {"\"a \\u0001\": {\"type\": \"mirror\", \"reflectance\": 2}",
           "materials.'a \\x01'.reflectance: must be between 0 and 1, got 2"},
      },
      with_materials, 3);
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
           "lights[0]: unknown key 'radiance'; known are 'type', 'position', 'intensity'"},
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
          {"\"rotation\": 30",
           "environment: unknown key 'rotation'; known are 'radiance', 'texture', 'rotation_degrees'"},
          {"\"texture\": \"sun\"", "environment.texture: there is no texture 'sun'; known is 'sky'"},
          {"\"texture\": \"sky\"",
           "environment.texture: the surroundings are one whole picture: leave out the texture's 'scale', "
           "'offset' and 'wrap'; 'rotation_degrees' turns it"},
      },
      with_environment, 2);
}

TEST(SceneMistakes, InGlossyMaterials) {
  expect_mistakes(
      {
          {"\"m\": {\"type\": \"glass\", \"fresnel\": \"schlik\"}",
           "materials.m.fresnel: unknown value 'schlik'; did you mean 'schlick'?"},
          {"\"m\": {\"type\": \"glass\", \"roughness\": 1.5}",
           "materials.m.roughness: must be between 0 and 1, got 1.5"},
          {"\"m\": {\"type\": \"glass\", \"roughness\": [0.1, 0.2, 0.3]}",
           "materials.m.roughness: must be between 0 and 1, got a list of 3"},
          {"\"m\": {\"type\": \"glass\", \"roughness\": \"rough\"}",
           "materials.m.roughness: must be a number without quotes, between 0 and 1, or a texture as "
           "{\"texture\": \"NAME\"}, got the text 'rough'"},
          {"\"m\": {\"type\": \"phong\", \"exponent\": \"30\"}",
           "materials.m.exponent: must be a number without quotes, between 0 and 100000, or a texture as "
           "{\"texture\": \"NAME\"}, got the text '30'"},
          {"\"m\": {\"type\": \"glass\", \"roughness\": {\"scale\": 1}}",
           "materials.m.roughness: a textured number needs the key 'texture'"},
          {"\"m\": {\"type\": \"phong\", \"exponent\": -1}",
           "materials.m.exponent: must be between 0 and 100000, got -1"},
          {"\"m\": {\"type\": \"phong\", \"lobe\": \"n+3\"}",
           "materials.m.lobe: unknown value 'n+3'; did you mean 'n+1'?"},
          {"\"m\": {\"type\": \"phong\", \"diffuse\": 0.6, \"specular\": [0.3, 0.5, 0.3]}",
           "materials.m: 'diffuse' and 'specular' add up to 1.1, and nothing reflects more than 1; lower one "
           "of them"},
          {"\"m\": {\"type\": \"phong\", \"specular\": 0.7}",
           "materials.m: 'diffuse' (0.5 unless given) and 'specular' add up to 1.2, and nothing reflects "
           "more than 1; lower one of them"},
          {"\"m\": {\"type\": \"cook_torrance\", \"diffuse\": 0.5}",
           "materials.m: 'diffuse' and 'specular' (1 unless given) add up to 1.5, and nothing reflects more "
           "than 1; lower one of them"},
          {"\"m\": {\"type\": \"cook_torrance\", \"conductor\": \"aluminum\"}",
           "materials.m.conductor: unknown value 'aluminum'; did you mean 'aluminium'?"},
          {"\"m\": {\"type\": \"cook_torrance\", \"conductor\": \"gold\", \"f0\": 0.9}",
           "materials.m.conductor: a conductor has its own reflectance; leave 'f0' out, or this"},
          {"\"m\": {\"type\": \"cook_torrance\", \"masking\": 1}",
           "materials.m.masking: must be one of \"smith\", \"schlick\", got 1"},
          {"\"m\": {\"type\": \"phong\", \"sampling\": \"half_vector\"}",
           "materials.m.sampling: unknown value 'half_vector'; known are 'bsdf', 'uniform'"},
          {"\"m\": {\"type\": \"lambert\", \"normal_map\": \"dents\"}",
           "materials.m.normal_map: must be a texture as {\"texture\": \"NAME\"}, got the text 'dents'"},
          {"\"m\": {\"type\": \"lambert\", \"normal_map\": {\"texture\": \"dents\"}}",
           "materials.m.normal_map.texture: there is no texture 'dents'"},
          {"\"m\": {\"type\": \"lambert\", \"normal_map\": {\"strength\": 1}}",
           "materials.m.normal_map: a normal map needs the key 'texture'"},
      },
      with_materials, 3);
}

TEST(SceneMistakes, SuggestTextures) {
  EXPECT_EQ(mistakes_in(scene_with("\"textures\": {\"wood\": {\"file\": \"gray.png\"}}",
                                   "\"m\": {\"type\": \"lambert\", \"albedo\": {\"texture\": \"wod\"}}", "")),
            "scene.json:3: materials.m.albedo.texture: there is no texture 'wod'; did you mean 'wood'?");
}

TEST(SceneMistakes, InShapes) {
  const std::string sphere = "{\"type\": \"sphere\", \"material\": \"light\", \"radius\": 1, ";
  const std::string mesh = "{\"type\": \"mesh\", \"file\": \"triangle.obj\", \"material\": \"light\", ";
  const std::string quad = "{\"type\": \"quad\", \"material\": \"light\", \"corner\": [0, 0, 0], ";
  expect_mistakes(
      {
          {"3", "shapes[0]: must be an object in braces, got 3"},
          {"{}",
           "shapes[0]: a shape needs the key 'type', one of \"mesh\", \"sphere\", \"quad\", \"instance\""},
          {"{\"type\": \"shpere\"}", "shapes[0].type: unknown value 'shpere'; did you mean 'sphere'?"},
          {"{\"type\": \"sphere\", \"radius\": 1}", "shapes[0]: a sphere needs the key 'material'"},
          {"{\"type\": \"sphere\", \"material\": \"light\"}", "shapes[0]: a sphere needs the key 'radius'"},
          {"{\"type\": \"sphere\", \"radius\": 1, \"material\": \"ligth\"}",
           "shapes[0].material: there is no material 'ligth'; did you mean 'light'?"},
          {"{\"type\": \"sphere\", \"radius\": 0, \"material\": \"light\"}",
           "shapes[0].radius: must be greater than 0, got 0"},
          {"{\"type\": \"sphere\", \"radius\": 1e-50, \"material\": \"light\"}",
           "shapes[0].radius: must be greater than 0, got 1e-50"},
          {sphere + "\"transform\": [{\"scale\": [1, 2, 1]}]}",
           "shapes[0]: a sphere must stay round: its transform must scale by the same factor in all "
           "directions"},
          {sphere + "\"transform\": {\"scale\": 2}}",
           "shapes[0].transform: must be a list of steps such as [{\"scale\": 2}, {\"translate\": [0, 1, "
           "0]}], got an "
           "object"},
          {sphere + "\"transform\": [{\"scale\": 0}]}",
           "shapes[0].transform[0].scale: must be other than 0, got 0"},
          {sphere + "\"transform\": [{\"scale\": [1, 0, 1]}]}",
           "shapes[0].transform[0].scale[1]: must be other than 0, got 0"},
          {sphere + "\"transform\": [{\"scale\": 1, \"translate\": [0, 0, 0]}]}",
           "shapes[0].transform[0]: a step is one of 'scale', 'rotate', 'translate' and 'matrix'; write "
           "several "
           "as a list of steps"},
          {sphere + "\"transform\": [{}]}",
           "shapes[0].transform[0]: a step is one of 'scale', 'rotate', 'translate' and 'matrix'; write "
           "several "
           "as a list of steps"},
          {sphere + "\"transform\": [{\"move\": [0, 0, 0]}]}",
           "shapes[0].transform[0]: unknown key 'move'; known are 'scale', 'rotate', 'translate', 'matrix'"},
          {sphere + "\"transform\": [{\"rotate\": {\"axis\": [0, 0, 0], \"degrees\": 3}}]}",
           "shapes[0].transform[0].rotate: 'axis' must have a length that is greater than 0 and can be "
           "computed"},
          {sphere + "\"transform\": [{\"rotate\": {\"axis\": [0, 1, 0], \"degrees\": 3601}}]}",
           "shapes[0].transform[0].rotate.degrees: must be between -3600 and 3600, got 3601"},
          {sphere + "\"transform\": [{\"rotate\": {\"axis\": [0, 1, 0]}}]}",
           "shapes[0].transform[0].rotate: a rotation needs the key 'degrees'"},
          {sphere + "\"transform\": [{\"scale\": 1e-30}, {\"scale\": 1e-30}]}",
           "shapes[0].transform: the steps together scale or move too far to be computed"},
          {mesh + "\"normals\": \"soft\"}",
           "shapes[0].normals: unknown value 'soft'; known are 'file', 'smooth', 'flat'"},
          {"{\"type\": \"mesh\", \"material\": \"light\"}", "shapes[0]: a mesh needs the key 'file'"},
          {"{\"type\": \"mesh\", \"file\": \"none.obj\"}", "shapes[0].file: 'none.obj' does not exist"},
          {"{\"type\": \"mesh\", \"file\": \"gray.png\", \"material\": \"light\"}",
           "shapes[0].file: gray.png:1: '\\x89PNG' is not a statement of OBJ files"},
          {"{\"type\": \"mesh\", \"file\": \"triangle.obj\"}",
           "shapes[0].file: triangle.obj:7: a face has no material (no 'usemtl' comes before it); give the "
           "shape a "
           "\"material\" in the scene file"},
          {mesh + "\"transform\": [{\"translate\": [3e38, 0, 0]}, {\"scale\": 10}]}",
           "shapes[0].transform: the steps together scale or move too far to be computed"},
          {quad + "\"edge_u\": [1, 0, 0], \"edge_v\": [2, 0, 0]}",
           "shapes[0]: 'edge_u' and 'edge_v' must span an area that is greater than 0 and can be computed"},
          {quad + "\"edge_u\": [1, 0, 0]}", "shapes[0]: a quad needs the key 'edge_v'"},
      },
      with_shapes, 4);
}

// An instance of an object with a ball that emits and one that does not.
std::string with_instance(const std::string& instance) {
  const std::string ball = "{\"type\": \"sphere\", \"radius\": 1, \"material\": ";
  return scene_with("\"objects\": {\"pair\": {\"shapes\": [" + ball + "\"light\"}, " + ball + "\"matt\"}]}}",
                    "\"matt\": {\"type\": \"lambert\"}", "{\"type\": \"instance\", " + instance + "}");
}

TEST(SceneMistakes, InInstances) {
  const std::string pair = "\"object\": \"pair\", \"transform\": ";
  EXPECT_EQ(mistakes_in(with_instance("\"object\": \"pair\"")), "no mistake");
  EXPECT_EQ(mistakes_in(with_instance(pair + "[{\"scale\": [1, 2, 1]}], \"material\": \"matt\"")),
            "no mistake");
  expect_mistakes(
      {
          {"\"object\": \"pear\"", "shapes[0].object: there is no object 'pear'; known is 'pair'"},
          {"\"material\": \"matt\"", "shapes[0]: an instance needs the key 'object'"},
          {"\"object\": \"pair\", \"radius\": 1",
           "shapes[0]: unknown key 'radius'; known are 'type', 'object', 'material', 'transform'"},
          {pair + "[{\"matrix\": [[1, 0, 0, 0], [0, 1, 0, 0]]}]",
           "shapes[0].transform[0].matrix: must be three rows of four numbers such as [[1, 0, 0, 5], [0, 1, "
           "0, "
           "0], [0, 0, 1, 0]], got a list of 2"},
          {pair + "[{\"matrix\": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 1, 0, 0]]}]",
           "shapes[0].transform: the steps together scale or move too far to be computed"},
          {pair + "[{\"matrix\": [[1, 1, 0, 0], [0, 1e-12, 0, 0], [0, 0, 1, 0]]}]",
           "shapes[0]: the transform flattens the object, or scales or moves it too far to be computed"},
          {pair + "[{\"scale\": [1, 2, 1]}]",
           "shapes[0]: a sphere of the object emits light and must stay round: the transform must scale by "
           "the "
           "same factor in all directions"},
      },
      with_instance, 4);
}

TEST(SceneMistakes, InObjects) {
  const auto with_objects = [](const std::string& objects) {
    return scene_with("\"objects\": " + objects, "", "");
  };
  const std::vector<Case> cases{
      {"[]", "objects: must be an object in braces, from names to what they stand for, got a list of 0"},
      {"{\"tree\": {}}", "objects.tree: an object needs the key 'shapes'"},
      {"{\"tree\": {\"shapes\": []}}",
       "objects.tree.shapes: must be a list of at least one shape, got a list of 0"},
      {"{\"tree\": {\"shapes\": [{\"type\": \"mesh\", \"file\": \"none.obj\"}]}}",
       "objects.tree.shapes[0].file: 'none.obj' does not exist"},
      {"{\"tree\": {\"shapes\": [{\"type\": \"instance\", \"object\": \"tree\"}]}}",
       "objects.tree.shapes[0]: an object cannot hold instances of others; write them in the scene's own "
       "'shapes'"}};
  for (const auto& [text, message] : cases)
    EXPECT_EQ(mistakes_in(with_objects(text)), "scene.json:2: " + message) << text;
}

TEST(SceneMistakes, OfShapesAsAList) {
  const std::string start = "{\"camera\": {\"position\": [0, 0, 5], \"look_at\": [0, 0, 0]},\n\"shapes\": ";
  EXPECT_EQ(mistakes_in(start + "[]}"),
            "scene.json:2: shapes: must be a list of at least one shape, got a list of 0");
  EXPECT_EQ(mistakes_in(start + "{}}"),
            "scene.json:2: shapes: must be a list of at least one shape, got an object");
}

TEST(SceneMistakes, AreAllToldInTheOrderOfTheFile) {
  EXPECT_EQ(
      mistakes_in(scene_with("\"render\": {\"spp\": 0, \"with\": 5},\n\"textures\": []",
                             "\"m\": {\"type\": \"mirror\", \"reflectance\": 2}", "{\"type\": \"quad\"}")),
      "scene.json:2: render: unknown key 'with'; did you mean 'width'?\n"
      "scene.json:2: render.spp: must be a whole number between 1 and 16777216, got 0\n"
      "scene.json:3: textures: must be an object in braces, from names to what they stand for, got a list of "
      "0\n"
      "scene.json:4: materials.m.reflectance: must be between 0 and 1, got 2\n"
      "scene.json:5: shapes[0]: a quad needs the key 'corner'\n"
      "scene.json:5: shapes[0]: a quad needs the key 'edge_u'\n"
      "scene.json:5: shapes[0]: a quad needs the key 'edge_v'\n"
      "scene.json:5: shapes[0]: a quad needs the key 'material'");
}

TEST(SceneMistakes, OfEveryAssetAreToldAtOnce) {
  EXPECT_EQ(
      mistakes_in(scene_with("\"textures\": {\"a\": {\"file\": \"a.png\"},\n\"b\": {\"file\": \"b.png\"}}",
                             "", "{\"type\": \"mesh\", \"file\": \"c.obj\", \"material\": \"light\"}")),
      "scene.json:2: textures.a.file: 'a.png' does not exist\n"
      "scene.json:3: textures.b.file: 'b.png' does not exist\n"
      "scene.json:5: shapes[0].file: 'c.obj' does not exist");
}

TEST(SceneMistakes, AreCutShortWhereThereAreVeryMany) {
  std::string materials = "\"m0\": {}";
  for (int i = 1; i < 1000; ++i) materials += ", \"m" + std::to_string(i) + "\": {}";
  const std::string message = mistakes_in(with_materials(materials));
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 20);
  EXPECT_TRUE(message.ends_with("\nscene.json: and 980 more mistakes")) << message;
}

TEST(SceneMistakes, HaveTheCodeOfTheFirst) {
  const auto code = [](const std::string& scene) { return test::load(scene).error().code; };
  EXPECT_EQ(code(with_render("\"spp\": 0")), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code(with_textures("\"a\": {\"file\": \"none.png\"}")), ErrorCode::kNotFound);
  EXPECT_EQ(code(with_textures("\"a\": {\"file\": \"triangle.obj\"}")), ErrorCode::kInvalidArgument);
}

std::string with_mesh(const std::string& more = "") {
  return with_shapes("{\"type\": \"mesh\", \"file\": \"m/a.obj\"" + more + "}");
}

TEST(SceneMistakes, InObjFiles) {
  const auto told = [](const std::string& obj) {
    return mistakes_in(with_mesh(", \"material\": \"light\""), {{"m/a.obj", obj}});
  };
  EXPECT_EQ(told("v 0 0 0\nv 1 nan 0\n"),
            "scene.json:4: shapes[0].file: m/a.obj:2: a vertex must be 3 finite numbers, got '1 nan 0'");
  EXPECT_EQ(told("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"),
            "scene.json:4: shapes[0].file: 'm/a.obj' has no face with an area greater than 0");
}

TEST(SceneMistakes, InMtlFiles) {
  const std::string obj = "mtllib my a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";
  const auto told = [&](const std::string& mtl) {
    return mistakes_in(with_mesh(), {{"m/a.obj", obj}, {"m/my a.mtl", mtl}});
  };
  EXPECT_EQ(mistakes_in(with_mesh(), {{"m/a.obj", "mtllib a.mtl\n" + obj}}),
            "scene.json:4: shapes[0].file: m/a.obj:1: 'm/a.mtl' does not exist; mend it, or give the shape a "
            "\"material\" in "
            "the scene file");
  EXPECT_EQ(told("newmtl red\nKd 2 0 0\n"),
            "scene.json:4: shapes[0].file: m/a.obj:1: m/my a.mtl:2: 'Kd' must be 3 numbers between 0 and 1, "
            "got '2 0 0'; "
            "mend it, or give the shape a \"material\" in the scene file");
  EXPECT_EQ(told("newmtl reed\nKd 1 0 0\n"),
            "scene.json:4: shapes[0].file: m/a.obj:5: the 'mtllib' files have no material 'red'; did you "
            "mean 'reed'?; mend "
            "it, or give the shape a \"material\" in the scene file");
  EXPECT_EQ(told("newmtl red\nmap_Kd red.png\n"),
            "scene.json:4: shapes[0].file: m/my a.mtl:2: map_Kd: 'm/red.png' does not exist");
  EXPECT_EQ(told("newmtl red\nmap_Kd -s 2 red.png # wood\n"),
            "scene.json:4: shapes[0].file: m/my a.mtl:2: map_Kd: 'm/red.png' does not exist");
}

TEST(SceneMistakes, OfTexturesThatReflectMoreThanTheyGet) {
  const MemoryAssets::Files files{{"sky.hdr", test::hdr(test::one_color(8, 8, Rgb::gray(4)))}};
  const std::string textures = "\"textures\": {\"sky\": {\"file\": \"sky.hdr\"}}";
  const auto material = [](const std::string& tint) {
    return "\"m\": {\"type\": \"lambert\", \"albedo\": {\"texture\": \"sky\", \"tint\": " + tint + "}}";
  };
  EXPECT_EQ(
      mistakes_in(scene_with(textures, material("0.5"), ""), files),
      "scene.json:3: materials.m: the texture of material 'm' times 'tint' reaches 2, and nothing reflects "
      "more than 1");
  EXPECT_EQ(mistakes_in(scene_with(textures, material("0.25"), ""), files), "no mistake");
  EXPECT_EQ(
      mistakes_in(
          scene_with("\"textures\": {\"sky\": {\"file\": \"sky.hdr\", \"color_space\": \"srgb\"}}", "", ""),
          files),
      "scene.json:2: textures.sky.file: 'sky.hdr' is an HDR picture, which is linear; leave 'color_space' "
      "out");
}

}  // namespace
}  // namespace tessera::core
