// SPDX-License-Identifier: Apache-2.0
// Values of Mitsuba files that are replaced, and shapes and lights that are left out, are told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/core_scene_mitsuba/mitsuba_scene.hpp"

namespace tessera::core {
namespace {

using test::material_of;
using test::scene_of;
using test::warnings_of;
using testing::HasSubstr;
using testing::Not;

struct Replaced {
  const char* content;  // from line 2 on
  const char* warning;  // "LINE: WHAT", of scene.xml
};

void expect_told(const Replaced& one) {
  const SceneDescription scene = scene_of(one.content);
  EXPECT_THAT(warnings_of(scene), HasSubstr(std::string("scene.xml:") + one.warning)) << one.content;
  EXPECT_FALSE(scene.shapes.empty()) << one.content;
}

std::string sensor(const std::string& inside) {
  return "<sensor type=\"perspective\">" + inside + "</sensor>";
}

TEST(MitsubaReplacedValues, OfTheView) {
  const std::vector<std::pair<const char*, const char*>> table{
      {R"(<float name="fov" value="200"/>)",
       R"(2: <sensor type="perspective">: 'fov' must be from 0.001 to 179.9, got 200; 179.9 is used)"},
      {R"(<float name="fov" value="50"/><string name="fov_axis" value="z"/>)",
       "2: <sensor type=\"perspective\">: the fov_axis 'z' is not known; 'x' replaces it"},
      {R"(<float name="principal_point_offset_x" value="9999"/>)",
       "2: <sensor type=\"perspective\">: 'principal_point_offset_x' must be from"},
      {R"(<float name="shutter_open" value="1"/>)",
       "2: <sensor type=\"perspective\">: 'shutter_close' must be from 'shutter_open' to"},
      {R"(<sampler type="independent"><integer name="sample_count" value="0"/></sampler>)",
       "2: <sampler type=\"independent\">: 'sample_count' must be from 1 to"},
      {R"(<sampler type="independent"><integer name="seed" value="-4"/></sampler>)",
       "2: <sampler type=\"independent\">: 'seed' must be from 0 to"},
      {R"(<film type="hdrfilm"><rfilter type="box"><float name="radius" value="-1"/></rfilter></film>)",
       "2: <rfilter type=\"box\">: 'radius' must be from 0.01 to"},
      {R"(<film type="hdrfilm"><integer name="crop_offset_x" value="-1"/></film>)",
       "2: <film type=\"hdrfilm\">: 'crop_offset_x' must be from 0 to"},
      {R"(<film type="hdrfilm"><string name="width" value="wide"/></film>)",
       "2: <film type=\"hdrfilm\">: 'width' is no whole number; it is left out"},
      {R"(<film type="hdrfilm"><integer name="widht" value="9"/></film>)",
       "2: <film type=\"hdrfilm\">: the parameter 'widht' is ignored"},
  };
  for (const auto& [inside, warning] : table) expect_told({sensor(inside).c_str(), warning});
}

TEST(MitsubaReplacedValues, OfMaterialsAndMedia) {
  const std::vector<std::pair<const char*, const char*>> table{
      {R"(<bsdf type="roughconductor"><float name="alpha_u" value="2"/></bsdf>)",
       R"(2: <bsdf type="roughconductor">: 'alpha_u' must be from 0 to 1; 1 is used)"},
      {R"(<bsdf type="roughconductor"><float name="alpha" value="4"/></bsdf>)",
       R"(2: <bsdf type="roughconductor">: 'alpha' must be from 0 to 1; 1 is used)"},
      {R"(<bsdf type="principled"><float name="metallic" value="3"/></bsdf>)",
       R"(2: <bsdf type="principled">: 'metallic' must be from 0 to 1; 1 is used)"},
      {R"(<bsdf type="principled"><float name="eta" value="0.5"/></bsdf>)",
       R"(2: <bsdf type="principled">: 'eta' must be from 1 to 10, got 0.5; 1 is used)"},
      {R"(<bsdf type="hair"><float name="longitudinal_roughness" value="-1"/></bsdf>)",
       R"(2: <bsdf type="hair">: 'longitudinal_roughness' must be from 0 to 1, got -1; 0 is used)"},
      {R"(<bsdf type="mask"><float name="opacity" value="2"/><bsdf type="diffuse"/></bsdf>)",
       R"(2: <bsdf type="mask">: 'opacity' must be from 0 to 1; 1 is used)"},
      {R"(<bsdf type="measured"><string name="filename" value="a.bsdf"/></bsdf>)",
       R"(2: <bsdf type="measured">: is refused: 'a.bsdf' cannot be read; a gray diffuse BSDF replaces it)"},
      {R"(<medium name="interior" type="homogeneous"><float name="scale" value="-1"/></medium>)",
       R"(2: <medium type="homogeneous">: 'scale' must be from 0 to)"},
      {R"(<medium name="interior" type="homogeneous"><phase type="hg"><float name="g" value="3"/></phase></medium>)",
       R"(2: <phase type="hg">: 'g' must be from -0.999 to 0.999, got 3; 0.999 is used)"},
  };
  for (const auto& [inside, warning] : table)
    expect_told({("<shape type=\"sphere\">" + std::string(inside) + "</shape>").c_str(), warning});
}

TEST(MitsubaReplacedValues, OfLights) {
  const std::vector<Replaced> table{
      {R"(<emitter type="point"><rgb name="intensity" value="0"/></emitter>)",
       "2: a light without power is left out"},
      {R"(<emitter type="point"><rgb name="intensity" value="-1"/></emitter>)",
       "2: a light without power is left out"},
      {R"(<emitter type="point"><point name="position" x="1e30" y="0" z="0"/></emitter>)",
       "2: a light is left out: position must be a number between -1e15 and 1e15"},
      {R"(<emitter type="spot"><float name="cutoff_angle" value="0"/></emitter>)",
       R"(2: <emitter type="spot">: 'cutoff_angle' must be from 0.01 to 90, got 0; 0.01 is used)"},
      {R"(<emitter type="spot"><float name="beam_width" value="70"/></emitter>)",
       R"(2: <emitter type="spot">: 'beam_width' must be from 0 to 20, got 70; 20 is used)"},
      {R"(<emitter type="projector"><float name="scale" value="-1"/></emitter>)",
       R"(2: <emitter type="projector">: 'scale' must be from 0 to 1e+30, got -1; 0 is used)"},
      {R"(<emitter type="constant"><rgb name="radiance" value="0"/></emitter>)",
       R"(2: <emitter type="constant">: emits no light)"},
  };
  for (const Replaced& one : table) expect_told(one);
}

TEST(MitsubaLeftOut, ShapesThatCannotBeRendered) {
  const std::vector<Replaced> table{
      {R"(<shape type="sphere"><float name="radius" value="0"/></shape>)",
       "2: a mesh without a triangle that has an area is left out"},
      {R"(<shape type="sphere"><float name="radius" value="1e30"/></shape>)",
       "2: a mesh without a triangle that has an area is left out"},
      {R"(<shape type="disk"><transform name="to_world"><scale value="0"/></transform></shape>)",
       "2: a shape is left out: the disk has no area"},
      {R"(<shape type="cylinder"><float name="radius" value="0"/></shape>)",
       "2: a shape is left out: the cylinder is flat"},
      {R"(<shape type="rectangle"><transform name="to_world"><translate x="1e30"/></transform></shape>)",
       "2: a mesh without a triangle that has an area is left out"},
      {R"(<shape type="shapegroup" id="g"><shape type="sphere"/></shape><shape type="instance"><ref id="g"/><transform name="to_world"><scale value="1e-30"/></transform></shape>)",
       "2: a shape is left out: the transform flattens the object"},
      {R"(<shape type="shapegroup" id="g"><shape type="sphere"><emitter type="area"/></shape></shape><shape type="instance" id="stretched"><ref id="g"/><transform name="to_world"><scale x="2"/></transform></shape>)",
       " stretched is left out: a sphere that emits must stay round"},
  };
  for (const Replaced& one : table) {
    const SceneDescription scene = scene_of(one.content);
    EXPECT_THAT(warnings_of(scene), HasSubstr("scene.xml:" + std::string(one.warning))) << one.content;
    EXPECT_EQ(scene.shapes.size(), 1u) << one.content;
  }
}

TEST(MitsubaReplacedValues, AMaskWithoutItsImageIsOpaque) {
  const char* const content =
      R"(<shape type="sphere"><bsdf type="mask"><texture type="bitmap" name="opacity"><string name="filename" value="ghost.png"/></texture><bsdf type="diffuse"/></bsdf></shape>)";
  EXPECT_EQ(scene_of(content).materials.at(0).opacity.value, 1);
  EXPECT_EQ(material_of(R"(<bsdf type="mask"><bsdf type="diffuse"/></bsdf>)").opacity.value, 0.5f);
  expect_told(
      {content, R"(2: <bsdf type="mask">: the texture of 'opacity' is left out; the surface is opaque)"});
}

TEST(MitsubaLeftOut, ParametersOfWhatIsNotUsedAreNotTold) {
  const std::vector<const char*> table{
      R"(<sensor type="perspective"/><sensor type="perspective"><float name="fov" value="3"/></sensor>)",
      R"(<shape type="obj"><string name="filename" value="ghost.obj"/><transform name="to_world"/></shape>)",
      R"(<shape type="linearcurve"><transform name="to_world"/></shape>)",
      R"(<shape type="instance"><transform name="to_world"/></shape>)",
      R"(<sensor type="perspective"><float name="fov" value="35deg"/><string name="fov_axis" value="y"/></sensor>)",
  };
  for (const char* const content : table)
    EXPECT_THAT(warnings_of(scene_of(content)), Not(HasSubstr("is ignored"))) << content;
}

TEST(MitsubaLeftOut, ShapesWithoutAFile) {
  expect_told(
      {R"(<shape type="obj"/>)", R"(2: <shape type="obj">: lacks a 'filename'; the shape is left out)"});
  expect_told({R"(<shape type="linearcurve"/>)", R"(2: <shape type="linearcurve">: lacks a 'filename')"});
}

TEST(MitsubaLeftOut, ASecondBsdfOfAShape) {
  const char* const content =
      R"(<shape type="sphere"><bsdf type="diffuse"/><bsdf type="conductor"><string name="material" value="Au"/></bsdf></shape>)";
  expect_told(
      {content, R"(2: <shape type="sphere">: has several BSDFs, which Mitsuba refuses; the first one)"});
  EXPECT_THAT(warnings_of(scene_of(content)), Not(HasSubstr("is ignored")));
}

TEST(MitsubaLeftOut, MisspeltParameters) {
  expect_told(
      {R"(<emitter type="constant"><rgb name="radience" value="2"/></emitter>)",
       "2: <emitter type=\"constant\">: the parameter 'radience' is ignored; did you mean 'radiance'?"});
  expect_told({R"(<emitter type="constant"><rgb name="color" value="2"/></emitter>)",
               "2: <emitter type=\"constant\">: the parameter 'color' is ignored\n"});
}

// As Cryptomatte calls them.
TEST(MitsubaNames, AreTheIdsOfTheFile) {
  const SceneDescription scene = scene_of(
      R"(<bsdf type="twosided" id="wood"><bsdf type="diffuse"/></bsdf><shape type="sphere" id="ball"><ref id="wood"/></shape>)");
  EXPECT_EQ(scene.materials[0].name, "wood");
  EXPECT_EQ(scene.shape_names[0], "ball");
}

}  // namespace
}  // namespace tessera::core
