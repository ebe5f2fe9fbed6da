// SPDX-License-Identifier: Apache-2.0
// The XML of Mitsuba scenes: parameters, includes, references, old versions and hostile files.
#include <gmock/gmock.h>

#include "tests/unit/core_scene_mitsuba/mitsuba_scene.hpp"

namespace tessera::core::test {
namespace {

using testing::HasSubstr;

// The x of the only point light, which `value` is written for.
float point_x(const std::string& before, const std::string& value) {
  const SceneDescription scene = scene_of(before + "\n<emitter type=\"point\"><point name=\"position\" x=\"" +
                                          value + "\" y=\"0\" z=\"0\"/></emitter>");
  if (scene.lights.size() != 1) return -1;
  return std::get<PointLightDescription>(scene.lights.front()).position.x;
}

TEST(MitsubaXml, ParametersAreSubstituted) {
  EXPECT_EQ(point_x("<default name=\"a\" value=\"3\"/>", "$a"), 3);
  EXPECT_EQ(point_x("<default name=\"a\" value=\"3\"/><default name=\"ab\" value=\"4\"/>", "$ab"), 4);
  EXPECT_EQ(point_x("<default name=\"a\" value=\"3\"/><default name=\"a\" value=\"4\"/>", "1$a"), 13);
}

TEST(MitsubaXml, UndefinedParametersAreErrors) {
  EXPECT_THAT(error_of("\n<integrator type=\"$kind\"/>"),
              HasSubstr("scene.xml:3: the parameter $kind is not defined"));
  for (const std::string text : {"a ${r}", "a $", "a $-r"})
    EXPECT_THAT(
        error_of("\n<integrator type=\"" + text + "\"/>"),
        HasSubstr("scene.xml:3: '" + text + "' has a '$' without the name of a parameter; write '$name'"));
}

TEST(MitsubaXml, ParametersDoNotGrowWithoutBound) {
  std::string text = "<default name=\"p0\" value=\"0123456789\"/>\n";
  for (int i = 1; i <= 40; ++i) {
    const std::string last = "$p" + std::to_string(i - 1);
    text += "<default name=\"p" + std::to_string(i) + "\" value=\"" + last + last + "\"/>\n";
  }
  EXPECT_THAT(error_of(text), HasSubstr("too long"));
}

TEST(MitsubaXml, EntitiesAreNotExpanded) {
  const std::string text =
      "<?xml version=\"1.0\"?>\n<!DOCTYPE scene [<!ENTITY x SYSTEM \"secret.txt\">]>\n"
      "<scene version=\"3.0.0\"><shape type=\"sphere\" id=\"&x;\"/></scene>";
  const auto scene = load_xml(text, {{"secret.txt", "secret"}});
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(scene->shape_names.front(), HasSubstr("&x;"));
}

TEST(MitsubaXml, MalformedFilesAreErrorsWithALine) {
  const auto scene = load_xml("<scene version=\"3.0.0\">\n<shape type=\"sphere\"\n</scene>");
  ASSERT_FALSE(scene);
  EXPECT_THAT(scene.error().message, HasSubstr("scene.xml:"));
  EXPECT_THAT(scene.error().message, HasSubstr("well-formed"));
  EXPECT_FALSE(load_xml(""));
  EXPECT_FALSE(load_xml("<svg/>"));
}

TEST(MitsubaXml, DeepNestingIsAnError) {
  std::string text;
  for (int i = 0; i < 5000; ++i) text += "<bsdf type=\"twosided\">";
  for (int i = 0; i < 5000; ++i) text += "</bsdf>";
  EXPECT_THAT(error_of(text), HasSubstr("nested more than"));
}

TEST(MitsubaXml, IncludesAreSearchedInPaths) {
  const std::string light = "<scene version=\"3.0.0\"><emitter type=\"constant\"/></scene>";
  EXPECT_TRUE(scene_of("<include filename=\"parts/light.xml\"/>", {{"parts/light.xml", light}}).environment);
  EXPECT_TRUE(
      scene_of("<path value=\"parts\"/><include filename=\"light.xml\"/>", {{"parts/light.xml", light}})
          .environment);
  // The root of an included file may be an object.
  const std::string bsdf = "<bsdf version=\"3.0.0\" type=\"null\" id=\"nothing\"/>";
  const auto scene = load_xml(
      xml_scene("<include filename=\"b.xml\"/><shape type=\"sphere\"><ref id=\"nothing\"/></shape>", false),
      {{"b.xml", bsdf}});
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_TRUE(std::holds_alternative<Null>(scene->materials.at(0).model));
}

TEST(MitsubaXml, MissingAndCircularIncludesAreErrors) {
  EXPECT_THAT(error_of("<include filename=\"gone.xml\"/>"),
              HasSubstr("scene.xml:2: the included file 'gone.xml'"));
  EXPECT_THAT(error_of("<include filename=\"a.xml\"/>",
                       {{"a.xml", "<scene version=\"3.0.0\"><include filename=\"a.xml\"/></scene>"}}),
              HasSubstr("a.xml:1: files are included more than"));
}

TEST(MitsubaXml, ReferencesMayComeBeforeTheirObjects) {
  const auto scene =
      load_xml(xml_scene("<shape type=\"sphere\"><ref id=\"b\"/></shape>\n"
                         "<bsdf type=\"null\" id=\"a\"/><alias id=\"a\" as=\"b\"/>",
                         false));
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_TRUE(std::holds_alternative<Null>(scene->materials.at(0).model));
}

TEST(MitsubaXml, ReferencesToNothingAreLeftOut) {
  const SceneDescription scene = scene_of("<shape type=\"sphere\"><ref id=\"gone\"/></shape>");
  EXPECT_THAT(warnings_of(scene), HasSubstr("scene.xml:2: there is no object with the id 'gone'"));
}

TEST(MitsubaXml, EachObjectThatIsNotThereIsNamed) {
  const std::string told = warnings_of(
      scene_of("<shape type='sphere'><ref id='a'/></shape><shape type='sphere'><ref id='b'/></shape>"
               "<alias id='c' as='d'/><alias id='e' as='f'/>"));
  for (const char* each : {"id 'a';", "id 'b';", "no object 'c';", "no object 'e';"})
    EXPECT_THAT(told, HasSubstr(each));
}

TEST(MitsubaXml, CirclesOfReferencesAreErrors) {
  EXPECT_THAT(error_of("<bsdf type=\"twosided\" id=\"a\"><ref id=\"b\"/></bsdf>\n"
                       "<bsdf type=\"twosided\" id=\"b\"><ref id=\"a\"/></bsdf>"),
              HasSubstr("circle"));
}

TEST(MitsubaXml, TypesHaveSmallLetters) {
  const SceneDescription scene = scene_of("<shape type=\"Sphere\"/>");
  EXPECT_EQ(scene.shapes.size(), 2u);
  EXPECT_THAT(warnings_of(scene), HasSubstr("scene.xml:2: there is no type 'Sphere'; 'sphere' is used"));
}

TEST(MitsubaXml, OldNamesAreUpgraded) {
  const auto seen = load_xml(
      "<scene version=\"0.5.0\"><shape type=\"sphere\"/><sensor type=\"perspective\">"
      "<string name=\"fovAxis\" value=\"y\"/><float name=\"fov\" value=\"30\"/><transform name=\"toWorld\">"
      "<lookAt origin=\"0, 0, 9\" target=\"0, 0, 0\" up=\"0, 1, 0\"/></transform></sensor></scene>");
  ASSERT_TRUE(seen) << seen.error().message;
  EXPECT_EQ(seen->camera.position, (Vec3{0, 0, 9}));
  EXPECT_NEAR(seen->camera.vertical_fov_degrees, 30, 1e-4f);
  const auto scene = load_xml(
      "<scene version=\"0.6.0\"><shape type=\"sphere\"><transform name=\"toWorld\">"
      "<translate x=\"1\" y=\"2\" z=\"3\"/></transform></shape></scene>");
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(std::get<SphereDescription>(scene->shapes.at(0)).center, (Vec3{1, 2, 3}));
  EXPECT_THAT(warnings_of(*scene), testing::Not(HasSubstr("to_world")));
}

TEST(MitsubaXml, TransformsApplyInOrder) {
  const SceneDescription scene = scene_of(
      "<shape type=\"sphere\"><transform name=\"to_world\"><scale value=\"2\"/><rotate z=\"1\" angle=\"90\"/>"
      "<translate value=\"1,0,0\"/><matrix value=\"1 0 0 0  0 1 0 0  0 0 1 5  0 0 0 1\"/></transform>"
      "<point name=\"center\" x=\"1\" y=\"0\" z=\"0\"/></shape>");
  const auto& sphere = std::get<SphereDescription>(scene.shapes.at(0));
  EXPECT_NEAR(sphere.center.x, 1, 1e-5);
  EXPECT_NEAR(sphere.center.y, 2, 1e-5);
  EXPECT_NEAR(sphere.center.z, 5, 1e-5);
  EXPECT_NEAR(sphere.radius, 2, 1e-5);
}

TEST(MitsubaXml, WhatIsUnknownIsToldOnceWithItsCount) {
  const SceneDescription scene = scene_of(
      "<shape type=\"sdfgrid\"/>\n<shape type=\"sdfgrid\"/>\n<medal name=\"x\"/>\n"
      "<bsdf type=\"diffuse\" id=\"d\"><float name=\"shine\" value=\"2\"/><float name=\"x\" "
      "value=\"two\"/></bsdf>\n"
      "<shape type=\"sphere\"><ref id=\"d\"/></shape>");
  const std::string told = warnings_of(scene);
  EXPECT_THAT(
      told,
      HasSubstr("scene.xml:2: <shape type=\"sdfgrid\">: this shape is not supported; it is left out (2"));
  EXPECT_THAT(told, HasSubstr("scene.xml:4: the element <medal> is not known"));
  EXPECT_THAT(told, HasSubstr("scene.xml:5: <bsdf type=\"diffuse\">: the parameter 'shine' is ignored"));
  EXPECT_THAT(told, HasSubstr("'two' is no value of <float>"));
}

}  // namespace
}  // namespace tessera::core::test
