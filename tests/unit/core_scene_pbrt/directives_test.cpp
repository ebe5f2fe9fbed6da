// SPDX-License-Identifier: Apache-2.0
// The directives of pbrt files: state, transformations, objects, includes, and what is wrong with files.
#include <gmock/gmock.h>

#include "tests/unit/core_scene_pbrt/pbrt_scene.hpp"

namespace tessera::core::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const SphereDescription& sphere_of(const SceneDescription& scene, std::size_t index = 0) {
  return std::get<SphereDescription>(scene.shapes.at(index));
}

void expect_near(Vec3 a, Vec3 b, float tolerance = 1e-5f) {
  EXPECT_LT(length(a - b), tolerance)
      << a.x << ' ' << a.y << ' ' << a.z << " is not " << b.x << ' ' << b.y << ' ' << b.z;
}

TEST(PbrtDirectives, TransformationsApplyToWhatFollows) {
  const SceneDescription scene = pbrt_world(
      "Translate 1 2 3 Scale 2 2 2 Rotate 90 0 0 1 Translate 1 0 0\n"
      "Shape \"sphere\" \"float radius\" 0.5\n");
  expect_near(sphere_of(scene).center, {1, 4, 3});
  EXPECT_FLOAT_EQ(sphere_of(scene).radius, 1);
  EXPECT_THAT(scene.warnings, IsEmpty());
}

TEST(PbrtDirectives, MatricesAreWrittenByColumns) {
  const SceneDescription scene = pbrt_world(
      "ConcatTransform [1 0 0 0  0 1 0 0  0 0 1 0  5 6 7 1]\nShape \"sphere\"\n"
      "Transform [1 0 0 0  0 1 0 0  0 0 1 0  1 0 0 1]\nShape \"sphere\"\nIdentity Shape \"sphere\"");
  expect_near(sphere_of(scene, 0).center, {5, 6, 7});
  expect_near(sphere_of(scene, 1).center, {1, 0, 0});
  expect_near(sphere_of(scene, 2).center, {0, 0, 0});
}

TEST(PbrtDirectives, AttributesAreSavedAndRestored) {
  const SceneDescription scene = pbrt_world(
      "AttributeBegin Translate 1 0 0 Material \"conductor\" AttributeEnd\nShape \"sphere\"\n"
      "TransformBegin Translate 2 0 0 Material \"conductor\" TransformEnd\nShape \"sphere\"\n");
  expect_near(sphere_of(scene, 0).center, {});
  EXPECT_TRUE(std::holds_alternative<Lambert>(scene.materials.at(sphere_of(scene, 0).material).model));
  expect_near(sphere_of(scene, 1).center, {});
  EXPECT_TRUE(
      std::holds_alternative<ConductorMaterial>(scene.materials.at(sphere_of(scene, 1).material).model));
}

TEST(PbrtDirectives, CoordinateSystemsHaveNames) {
  const SceneDescription scene = pbrt_scene(
      "Translate 0 0 -4 Scale -1 1 1 Camera \"perspective\" WorldBegin\n"
      "Translate 1 0 0 CoordinateSystem \"here\" Translate 1 0 0 CoordSysTransform \"here\" Shape "
      "\"sphere\"\n"
      "CoordSysTransform \"camera\" Shape \"sphere\"\n"
      "CoordSysTransform \"nowhere\" Shape \"sphere\"\n");
  expect_near(sphere_of(scene, 0).center, {1, 0, 0});
  expect_near(sphere_of(scene, 1).center, {0, 0, 4});
  EXPECT_THAT(warnings_of(scene), HasSubstr("scene.pbrt:4: the coordinate system 'nowhere' is not known"));
}

TEST(PbrtDirectives, AttributeGivesDefaults) {
  const SceneDescription scene = pbrt_world(
      "Attribute \"shape\" \"float radius\" 3\n"
      "Attribute \"material\" \"rgb reflectance\" [0.1 0.2 0.3]\n"
      "Material \"diffuse\" Shape \"sphere\"\nShape \"sphere\" \"float radius\" 2\n");
  EXPECT_EQ(sphere_of(scene, 0).radius, 3);
  EXPECT_EQ(sphere_of(scene, 1).radius, 2);
  EXPECT_EQ(std::get<Lambert>(scene.materials.at(sphere_of(scene).material).model).albedo.value,
            (Rgb{0.1f, 0.2f, 0.3f}));
}

TEST(PbrtDirectives, ObjectsArePlacedByInstances) {
  const SceneDescription scene = pbrt_world(
      "Translate 1 0 0 ObjectBegin \"ball\" Translate 0 1 0 Shape \"sphere\" ObjectEnd\n"
      "Scale 2 2 2 ObjectInstance \"ball\" ObjectInstance \"cube\"\n");
  ASSERT_EQ(scene.objects.size(), 1u);
  expect_near(std::get<SphereDescription>(scene.objects[0].shapes.at(0)).center, {1, 1, 0});
  ASSERT_EQ(scene.shapes.size(), 1u);
  const auto& instance = std::get<InstanceDescription>(scene.shapes[0]);
  expect_near(instance.to_world.point({1, 1, 0}), {3, 2, 0});
  EXPECT_THAT(warnings_of(scene), HasSubstr("there is no object 'cube'"));
}

TEST(PbrtDirectives, FilesAreIncluded) {
  const SceneDescription scene = pbrt_world(
      "Include \"parts/a.pbrt\" Shape \"sphere\"\n",
      {{"parts/a.pbrt", "Translate 1 0 0 Include \"parts/b.pbrt\""}, {"parts/b.pbrt", "Translate 1 0 0"}});
  expect_near(sphere_of(scene).center, {2, 0, 0});
}

// As in the smoke plume of pbrt's own scenes, whose density is in a file.
TEST(PbrtDirectives, ADirectiveGoesOnAfterAnIncludedFile) {
  const MemoryAssets::Files files = {{"a.pbrt", "\nShape \"sphere\" \"float height\" 2 \"float radius\""}};
  const SceneDescription scene = pbrt_world("Include \"a.pbrt\" 3\n\"float size\" 1\n", files);
  EXPECT_EQ(sphere_of(scene).radius, 3);
  EXPECT_THAT(warnings_of(scene), HasSubstr("a.pbrt:2: the parameter 'height'"));
  EXPECT_THAT(warnings_of(scene), HasSubstr("scene.pbrt:3: the parameter 'size'"));
  EXPECT_EQ(pbrt_error("WorldBegin\nImport \"a.pbrt\" 3", files),
            "a.pbrt:2: the parameter 'radius' has no value");
}

TEST(PbrtDirectives, CommentsEndWithTheirLine) {
  const SceneDescription scene =
      pbrt_world("# old Macintosh\rTranslate 1 0 0 # Windows\r\nShape \"sphere\"\r");
  expect_near(sphere_of(scene).center, {1, 0, 0});
}

TEST(PbrtDirectives, ImportedFilesLeaveTheStateAlone) {
  const SceneDescription scene =
      pbrt_world("Import \"a.pbrt\" NamedMaterial \"metal\" Shape \"sphere\"\n",
                 {{"a.pbrt", "Translate 1 0 0 MakeNamedMaterial \"metal\" \"string type\" \"conductor\""}});
  expect_near(sphere_of(scene).center, {});
  EXPECT_TRUE(std::holds_alternative<ConductorMaterial>(scene.materials.at(sphere_of(scene).material).model));
}

TEST(PbrtDirectives, IncludesThatDoNotEndAreAnError) {
  EXPECT_THAT(pbrt_error("WorldBegin\nInclude \"scene.pbrt\""),
              HasSubstr("scene.pbrt:1: WorldBegin appears twice"));
  EXPECT_THAT(pbrt_error("WorldBegin\nInclude \"a.pbrt\"", {{"a.pbrt", "\nInclude \"a.pbrt\""}}),
              HasSubstr("a.pbrt:2: files include each other more than 32 deep"));
}

TEST(PbrtDirectives, MistakesNameFileAndLine) {
  const std::string begin = "WorldBegin\n";
  EXPECT_EQ(pbrt_error(begin + "Shape \"sphere\" \"float radius\" [ 1"),
            "scene.pbrt:2: the values of the parameter 'radius' have no closing bracket");
  EXPECT_EQ(pbrt_error(begin + "\nShape \"sphere\" \"float radius\" [ one ]"),
            "scene.pbrt:3: the parameter 'radius' must be a number, got 'one'");
  EXPECT_EQ(pbrt_error(begin + "Shape \"sphere\" \"flout radius\" 1"),
            "scene.pbrt:2: the type 'flout' of the parameter 'radius' is not known; did you mean 'float'?");
  EXPECT_EQ(pbrt_error(begin + "Shape \"sphere\" \"radius\" 1"),
            "scene.pbrt:2: a parameter is declared as \"type name\", got 'radius'");
  EXPECT_EQ(pbrt_error(begin + "Shap \"sphere\""), "scene.pbrt:2: the directive 'Shap' is not known");
  EXPECT_EQ(pbrt_error(begin + "Shape \"sphere"), "scene.pbrt:2: a string has no closing quote");
  EXPECT_EQ(pbrt_error(begin + "Translate 1 2"), "scene.pbrt:2: expected 3 numbers, got ''");
  EXPECT_EQ(pbrt_error(begin + "AttributeEnd"),
            "scene.pbrt:2: an end of attributes, transformations or objects has no begin");
  EXPECT_EQ(pbrt_error(begin + "ObjectBegin \"a\"\nObjectBegin \"b\""),
            "scene.pbrt:3: an object is defined inside of another one");
  EXPECT_EQ(pbrt_error("Shape \"sphere\""), "scene.pbrt:1: a shape comes before WorldBegin");
  EXPECT_EQ(pbrt_error(begin + "Include \"gone.pbrt\""), "scene.pbrt:2: the file 'gone.pbrt' does not exist");
  EXPECT_EQ(
      pbrt_error(begin + "LookAt 0 0 0 0 0 0 0 1 0"),
      "scene.pbrt:2: LookAt needs two different points and a vector that is not parallel to their line");
  EXPECT_THAT(pbrt_error(begin), HasSubstr("scene.pbrt: has no shape that can be rendered"));
  EXPECT_THAT(pbrt_error(begin + "Shape \"spher\""),
              HasSubstr("can be rendered\nscene.pbrt:2: the shape 'spher'"));
}

TEST(PbrtDirectives, CommentsAndStringsAreSkipped) {
  const SceneDescription scene =
      pbrt_world("# Shape \"disk\" [\nShape \"sphere\" # one\n\"float radius\" [ 2 ] #");
  EXPECT_EQ(sphere_of(scene).radius, 2);
}

TEST(PbrtDirectives, WhatIsNotSupportedIsTold) {
  const SceneDescription scene = pbrt_world(
      "Shape \"sphere\" \"float polish\" 3\nShape \"sphere\" \"float polish\" 4\nShape \"voronoi\"\n");
  EXPECT_THAT(
      warnings_of(scene),
      HasSubstr("scene.pbrt:2: the parameter 'polish' of the shape 'sphere' is not supported; it is ignored "
                "(2 times)"));
  EXPECT_THAT(warnings_of(scene),
              HasSubstr("scene.pbrt:4: the shape 'voronoi' is not supported; it is left out"));
}

TEST(PbrtDirectives, TheLastOfRepeatedParametersCounts) {
  const SceneDescription scene = pbrt_world("Shape \"sphere\" \"float radius\" 1\n\"float radius\" 2");
  EXPECT_EQ(sphere_of(scene).radius, 2);
  EXPECT_THAT(warnings_of(scene),
              HasSubstr("the parameter 'radius' of the shape 'sphere' is given again; the "
                        "last one counts"));
}

const InstanceMotion& only_motion(const SceneDescription& scene) {
  static const InstanceMotion kNone;
  EXPECT_EQ(scene.animation.instances.size(), 1u);
  return scene.animation.instances.empty() ? kNone : scene.animation.instances[0];
}

// Frame 0 is the time when the shutter opens, and each second has a frame.
TEST(PbrtDirectives, ActiveTransformMovesAShapeWhileTheShutterIsOpen) {
  const SceneDescription scene = pbrt_scene(
      "Camera \"perspective\" \"float shutteropen\" 1 \"float shutterclose\" 1.5\nTransformTimes 1 2\n"
      "WorldBegin\nTranslate 0 0 7 ActiveTransform EndTime Translate 4 0 0 Rotate 90 0 0 1\n"
      "ActiveTransform All Scale 1 2 1 Shape \"sphere\"\nIdentity Shape \"disk\"\n");
  EXPECT_EQ(warnings_of(scene), "");
  EXPECT_EQ(scene.camera.shutter_open, 0);
  EXPECT_EQ(scene.camera.shutter_close, 0.5f);
  ASSERT_EQ(scene.shapes.size(), 2u);
  const InstanceMotion& motion = only_motion(scene);
  EXPECT_TRUE(std::holds_alternative<InstanceDescription>(scene.shapes[motion.shape]));
  expect_near(transform_at(motion.steps, 0).point({1, 1, 0}), {1, 2, 7}, 1e-5f);
  expect_near(transform_at(motion.steps, 0.5f).point({1, 0, 0}), {2.70710678f, 0.70710678f, 7}, 1e-5f);
  expect_near(transform_at(motion.steps, 1).point({0, 1, 0}), {2, 0, 7}, 1e-5f);
}

TEST(PbrtDirectives, ALongExposureIsLimitedAndTold) {
  const SceneDescription scene = pbrt_scene(
      "Camera \"perspective\" \"float shutterclose\" 5000\nWorldBegin\n"
      "ActiveTransform EndTime Translate 4 0 0 Shape \"sphere\"\n");
  EXPECT_THAT(warnings_of(scene),
              HasSubstr("1: the parameter 'shutterclose' of the camera is limited to 1000"));
  EXPECT_EQ(scene.camera.shutter_close, 1000);
}

// What moves beside a camera that cannot be used is blurred all the same.
TEST(PbrtDirectives, ACameraThatIsReplacedLeavesItsShutter) {
  const SceneDescription scene = pbrt_scene(
      "Translate 1e17 0 0 Camera \"perspective\" \"float shutterclose\" 0.5\nWorldBegin\n"
      "ActiveTransform EndTime Translate 4 0 0 Shape \"sphere\"\n");
  EXPECT_THAT(warnings_of(scene), HasSubstr("a camera that sees the whole scene replaces it"));
  EXPECT_EQ(scene.camera.shutter_close, 0.5f);
}

TEST(PbrtDirectives, ActiveTransformMovesInstancesAndTheCamera) {
  const SceneDescription scene = pbrt_scene(
      "ActiveTransform EndTime Translate 0 0 -3 ActiveTransform All\nCamera \"perspective\"\nWorldBegin\n"
      "ObjectBegin \"o\" Shape \"sphere\" ObjectEnd\nActiveTransform StartTime Scale 2 2 2\n"
      "ObjectInstance \"o\"\n");
  EXPECT_EQ(warnings_of(scene), "");
  expect_near(transform_at(only_motion(scene).steps, 0.5f).point({1, 0, 0}), {1.5f, 0, 0}, 1e-5f);
  const CameraDescription half = camera_at(scene.camera, scene.animation.camera, 0.5f);
  expect_near(half.position, {0, 0, 1.5f}, 1e-5f);
  expect_near(half.look_at - half.position, {0, 0, 1.5f}, 1e-5f);
  EXPECT_EQ(scene.camera.shutter_close, 1);
}

TEST(PbrtDirectives, WhatCannotMoveIsTold) {
  const SceneDescription scene = pbrt_world(
      "AttributeBegin ActiveTransform EndTime Scale -1 1 1 Shape \"sphere\" AttributeEnd\n"
      "AttributeBegin ActiveTransform EndTime Translate 1 0 0\nLightSource \"point\" AttributeEnd\n");
  EXPECT_THAT(warnings_of(scene), HasSubstr("scene.pbrt:2: no motion leads from"));
  EXPECT_THAT(warnings_of(scene), HasSubstr("scene.pbrt:4: the light does not move"));
  EXPECT_TRUE(scene.animation.instances.empty());
  expect_near(sphere_of(scene, 0).center, {});
  EXPECT_EQ(scene.camera.shutter_close, 0);
}

}  // namespace
}  // namespace tessera::core::test
