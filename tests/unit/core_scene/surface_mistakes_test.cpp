// SPDX-License-Identifier: Apache-2.0
// Every kind of mistake in textures, materials and shapes, and exactly what is said about it.
#include <gtest/gtest.h>

#include "tests/unit/core_scene/scene_mistakes.hpp"

namespace tessera::core {
namespace {

using test::expect_mistakes;
using test::Mistake;
using test::mistakes_in;
using test::scene_with;
using test::with_materials;
using test::with_shapes;
using test::with_textures;

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
           "textures.wood.file: 'triangle.obj' is not an image of a known format (PNG, JPEG, HDR, EXR, PFM, "
           "TIFF, WebP, BMP, QOI or TGA)"},
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
           "\"phong\", \"cook_torrance\", \"principled\", \"plastic\", \"conductor\", "
           "\"diffuse_transmission\", \"thin_dielectric\", \"blend\", \"null\", \"hair\", \"disney\""},
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
           "'group', 'visible_to_camera', 'sampling', 'normal_map', 'bump', 'opacity', 'sides', "
           "'shading_normals', "
           "'interior_medium', 'exterior_medium'"},
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

TEST(SceneMistakes, InMaterialsBesideOthers) {
  expect_mistakes(
      {
          {R"("m": {"type": "glass", "priority": 1, "emission": 1})",
           "materials.m: what emits light cannot have a priority"},
          {R"("g": {"type": "glass", "priority": 1}, "m": {"type": "blend", "materials": ["g", "g"]})",
           "materials.m: the materials of a blend cannot have a priority"},
          {R"("g": {"type": "lambert", "opacity": 0.5},)"
           R"("m": {"type": "blend", "materials": ["g", "g"], "emission": 1})",
           "materials.m: a blend of what light passes through cannot emit"},
      },
      with_materials, 3);
}

TEST(SceneMistakes, InNormalMapsThatAreNoImages) {
  EXPECT_EQ(mistakes_in(scene_with(R"("textures": {"t": {"type": "windy"}})",
                                   R"("m": {"type": "lambert", "normal_map": {"texture": "t"}})", "")),
            "scene.json:3: materials.m: normal_map: the texture must be an image");
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
          {"\"m\": {\"type\": \"conductor\", \"metal\": \"gold\", \"k\": 2}",
           "materials.m.metal: a metal has its own 'eta' and 'k'; leave them out"},
          {"\"m\": {\"type\": \"principled\", \"base_colour\": 0.5}",
           "materials.m: unknown key 'base_colour'; did you mean 'base_color'?"},
          {"\"m\": {\"type\": \"principled\", \"geometry_thin_walled\": 1}",
           "materials.m.geometry_thin_walled: must be true or false, got 1"},
          {"\"m\": {\"type\": \"principled\", \"base_weight\": 2}",
           "materials.m.base_weight: must be between 0 and 1, got 2"},
          {"\"m\": {\"type\": \"blend\", \"materials\": [\"m\"]}",
           "materials.m.materials: must be a list of 2 names of materials, got a list of 1"},
          {"\"n\": {\"type\": \"null\"}, \"m\": {\"type\": \"blend\", \"materials\": [\"n\", \"o\"]}",
           "materials.m.materials[1]: there is no material 'o' above this blend; did you mean 'n'?"},
          {"\"m\": {\"type\": \"cook_torrance\", \"masking\": 1}",
           "materials.m.masking: must be one of \"smith\", \"schlick\", got 1"},
          {"\"m\": {\"type\": \"phong\", \"sampling\": \"half_vector\"}",
           "materials.m.sampling: unknown value 'half_vector'; known are 'bsdf', 'uniform'"},
          {"\"m\": {\"type\": \"lambert\", \"normal_map\": \"dents\"}",
           "materials.m.normal_map: must be a texture as {\"texture\": \"NAME\"}, got the text 'dents'"},
          {"\"m\": {\"type\": \"conductor\", \"tangent\": \"dents\"}",
           "materials.m.tangent: must be a texture as {\"texture\": \"NAME\"}, got the text 'dents'"},
          {"\"m\": {\"type\": \"conductor\", \"tangent\": {}}",
           "materials.m.tangent: a tangent map needs the key 'texture'"},
          {"\"m\": {\"type\": \"lambert\", \"normal_map\": {\"texture\": \"dents\"}}",
           "materials.m.normal_map.texture: there is no texture 'dents'"},
          {"\"m\": {\"type\": \"lambert\", \"normal_map\": {\"strength\": 1}}",
           "materials.m.normal_map: a normal map needs the key 'texture'"},
          {"\"m\": {\"type\": \"lambert\", \"bump\": 1}",
           "materials.m.bump: must be an object in braces, got 1"},
          {"\"m\": {\"type\": \"glass\", \"bump\": {\"height\": 1}}",
           "materials.m.bump: a bump map needs the key 'texture'"},
          {"\"m\": {\"type\": \"mirror\", \"opacity\": 1.5}",
           "materials.m.opacity: must be between 0 and 1, got 1.5"},
          {"\"m\": {\"type\": \"lambert\", \"opacity\": {\"texture\": \"leaf\"}}",
           "materials.m.opacity.texture: there is no texture 'leaf'"},
      },
      with_materials, 3);
}

TEST(SceneMistakes, SuggestTextures) {
  EXPECT_EQ(mistakes_in(scene_with("\"textures\": {\"wood\": {\"file\": \"gray.png\"}}",
                                   "\"m\": {\"type\": \"lambert\", \"albedo\": {\"texture\": \"wod\"}}", "")),
            "scene.json:3: materials.m.albedo.texture: there is no texture 'wod'; did you mean 'wood'?");
}

TEST(SceneMistakes, InDisksAndCylinders) {
  const std::string disk = "{\"type\": \"disk\", \"material\": \"light\", ";
  const std::string cylinder = "{\"type\": \"cylinder\", \"material\": \"light\", \"start\": [0, 0, 0], ";
  expect_mistakes(
      {
          {disk + "\"center\": [0, 0, 0]}", "shapes[0]: a disk needs the key 'radius'"},
          {disk + "\"radius\": 1, \"normal\": [0, 0, 0]}",
           "shapes[0]: 'normal' must have a length that is greater than 0 and can be computed"},
          {disk + "\"radius\": 1, \"inner_radius\": 1}",
           "shapes[0]: 'inner_radius' must be less than 'radius'"},
          {disk + "\"radius\": 1, \"flip_normal\": 1}",
           "shapes[0].flip_normal: must be true or false, got 1"},
          {cylinder + "\"radius\": 1}", "shapes[0]: a cylinder needs the key 'end'"},
          {cylinder + "\"end\": [0, 0, 0], \"radius\": 1}",
           "shapes[0]: 'start' and 'end' must be two points"},
          {cylinder + "\"end\": [0, 0, 1], \"radius\": -1}",
           "shapes[0].radius: must be greater than 0, got -1"},
      },
      with_shapes, 4);
}

TEST(SceneMistakes, InShapes) {
  const std::string sphere = "{\"type\": \"sphere\", \"material\": \"light\", \"radius\": 1, ";
  const std::string mesh = "{\"type\": \"mesh\", \"file\": \"triangle.obj\", \"material\": \"light\", ";
  const std::string quad = "{\"type\": \"quad\", \"material\": \"light\", \"corner\": [0, 0, 0], ";
  expect_mistakes(
      {
          {"3", "shapes[0]: must be an object in braces, got 3"},
          {"{}",
           "shapes[0]: a shape needs the key 'type', one of \"mesh\", \"sphere\", \"quad\", \"instance\", "
           "\"disk\", \"cylinder\", \"curves\""},
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
           "shapes[0].file: gray.png: the file has no faces (no 'f' statement), and '\\x89PNG' is not a "
           "statement of OBJ files; is it one?"},
          {mesh + "\"default_material\": \"dark\"}",
           "shapes[0].default_material: there is no material 'dark'; known is 'light'"},
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
           "shapes[0]: unknown key 'radius'; known are 'type', 'name', 'object', 'material', 'transform'"},
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
  const std::vector<Mistake> cases{
      {"[]", "objects: must be an object in braces, from names to what they stand for, got a list of 0"},
      {"{\"tree\": {}}", "objects.tree: an object needs the key 'shapes'"},
      {"{\"tree\": {\"shapes\": []}}",
       "objects.tree.shapes: must be a list of at least one shape, got a list of 0"},
      {"{\"tree\": {\"shapes\": [{\"type\": \"mesh\", \"file\": \"none.obj\"}]}}",
       "objects.tree.shapes[0].file: 'none.obj' does not exist"},
      {"{\"tree\": {\"shapes\": [{\"type\": \"instance\", \"object\": \"leaf\"}]}}",
       "objects.tree.shapes[0].object: there is no object 'leaf'; known is 'tree'"}};
  for (const auto& [text, message] : cases)
    EXPECT_EQ(mistakes_in(with_objects(text)), "scene.json:2: " + message) << text;
  EXPECT_EQ(
      mistakes_in(with_objects("{\"tree\": {\"shapes\": [{\"type\": \"instance\", \"object\": \"tree\"}]}}")),
      "scene.json: object 'tree' holds an instance of itself, directly or through others");
}

TEST(SceneMistakes, OfShapesAsAList) {
  const std::string start = "{\"camera\": {\"position\": [0, 0, 5], \"look_at\": [0, 0, 0]},\n\"shapes\": ";
  EXPECT_EQ(mistakes_in(start + "[]}"),
            "scene.json:2: shapes: must be a list of at least one shape, got a list of 0");
  EXPECT_EQ(mistakes_in(start + "{}}"),
            "scene.json:2: shapes: must be a list of at least one shape, got an object");
}

}  // namespace
}  // namespace tessera::core
