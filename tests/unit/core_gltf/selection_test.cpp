// SPDX-License-Identifier: Apache-2.0
// What is chosen of a glTF file: cameras, scenes, variants, and the time of an animation.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/scene/loader/parameter_override.hpp"
#include "core/scene/pose.hpp"
#include "core/scene/scene.hpp"
#include "tests/unit/core_gltf/gltf_file.hpp"

namespace tessera::core::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using Overrides = std::vector<ParameterOverride>;

// The scene of the bytes, called `name`, with overrides.
Result<SceneDescription> load_chosen(const std::string& bytes, const Overrides& overrides,
                                     const std::string& name = "model.gltf") {
  MemoryAssets files(MemoryAssets::Files{{name, bytes}});
  OverriddenAssets assets(files, name, overrides);
  return load_scene(assets, name, name);
}

std::string mistake_in_choice(const GltfFile& file, const Overrides& overrides) {
  const auto scene = load_chosen(file.text(), overrides);
  return scene ? "no mistake" : scene.error().message;
}

GltfFile with_two_cameras() {
  GltfFile file;
  file.node({{"mesh", file.triangle()}});
  file.json["cameras"] = {
      {{"type", "perspective"}, {"name", "Front"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}},
      {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}};
  file.node({{"camera", 0}, {"translation", {0, 0, 5}}});
  file.node({{"camera", 1}, {"name", "Side"}, {"translation", {5, 0, 0}}});
  return file;
}

TEST(GltfSelection, OfACameraByNameOrNumber) {
  const GltfFile file = with_two_cameras();
  for (const char* side : {"Side", "1"}) {
    const auto scene = load_chosen(file.text(), {select_by_name("camera", side)});
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(scene->camera.position, (Vec3{5, 0, 0})) << side;
    EXPECT_THAT(scene->warnings, IsEmpty());
    EXPECT_THAT(scene->contents.cameras, ElementsAre("Front", "Side"));
  }
  EXPECT_EQ(mistake_in_choice(file, {select_by_name("camera", "Back")}),
            "model.gltf: there is no camera 'Back'; the file has 0 ('Front'), 1 ('Side')");
}

TEST(GltfSelection, OfACameraIsWrittenIntoBinaryFiles) {
  const auto scene = load_chosen(
      with_two_cameras().binary(),
      {select_by_name("camera", "Side"), *parse_override("nodes[2].translation=[7,0,0]")}, "model.glb");
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->camera.position, (Vec3{7, 0, 0}));
}

TEST(GltfSelection, OfAScene) {
  GltfFile file;
  const int mesh = file.triangle();
  file.node({{"mesh", mesh}});
  file.node({{"mesh", mesh}, {"translation", {9, 0, 0}}});
  file.json["scenes"] = {{{"name", "near"}, {"nodes", {0}}}, {{"name", "far"}, {"nodes", {1}}}};
  const auto first = load_chosen(file.text(), {});
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_EQ(mesh_of(*first).positions[0], (Vec3{0, 0, 0}));
  EXPECT_THAT(warnings_of(*first), HasSubstr("of 2 scenes, only scenes[0] (near) is rendered"));
  const auto far = load_chosen(file.text(), {select_by_name("scene", "far")});
  ASSERT_TRUE(far) << far.error().message;
  EXPECT_EQ(mesh_of(*far).positions[0], (Vec3{9, 0, 0}));
  EXPECT_THAT(far->warnings, IsEmpty());
}

TEST(GltfSelection, OfAVariant) {
  GltfFile file;
  file.json["materials"] = {{{"name", "plain"}}, {{"name", "red"}}, {{"name", "blue"}}};
  file.node({{"mesh", file.triangle(0)}});
  file.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "Red"}}, {{"name", "Blue"}}};
  file.json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"] = {
      {{"material", 1}, {"variants", {0}}}, {{"material", 2}, {"variants", {1}}}};
  const auto material_of = [&](const Overrides& overrides) {
    const auto scene = load_chosen(file.text(), overrides);
    return scene ? scene->materials[mesh_of(*scene).triangle_materials[0]].name : scene.error().message;
  };
  EXPECT_EQ(material_of({}), "plain");
  EXPECT_EQ(material_of({select_by_name("variant", "Blue")}), "blue");
  EXPECT_EQ(material_of({select_by_name("variant", "0")}), "red");
  EXPECT_EQ(material_of({select_by_name("variant", "Green")}),
            "model.gltf: there is no variant 'Green'; the file has 0 ('Red'), 1 ('Blue')");
}

// A triangle whose node has one animated parameter.
GltfFile animated(const char* path, const char* interpolation, const char* type,
                  const std::vector<float>& times, const std::vector<float>& values) {
  GltfFile file;
  file.node({{"mesh", file.triangle()}});
  const int input = file.floats("SCALAR", times), output = file.floats(type, values);
  file.json["accessors"][static_cast<std::size_t>(input)]["max"] = {times.back()};
  file.json["animations"] = {
      {{"name", "Move"},
       {"samplers", {{{"input", input}, {"output", output}, {"interpolation", interpolation}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}}}};
  return file;
}

// The second corner of the triangle, which is (1, 0, 0) at rest.
Vec3 corner_at(const GltfFile& file, double seconds) {
  const auto scene = load_chosen(file.text(), {select_time(seconds)});
  EXPECT_TRUE(scene) << scene.error().message;
  return scene ? mesh_of(*scene).positions[1] : Vec3{};
}

TEST(GltfAnimation, MovesNodesAtATime) {
  const std::vector<float> times{1, 3}, values{0, 0, 0, 4, 0, 8};
  const GltfFile linear = animated("translation", "LINEAR", "VEC3", times, values);
  EXPECT_EQ(corner_at(linear, 0), (Vec3{1, 0, 0}));
  EXPECT_EQ(corner_at(linear, 1.5), (Vec3{2, 0, 2}));
  EXPECT_EQ(corner_at(linear, 3), (Vec3{5, 0, 8}));
  EXPECT_EQ(corner_at(linear, 99), (Vec3{5, 0, 8}));
  const GltfFile step = animated("translation", "STEP", "VEC3", times, values);
  EXPECT_EQ(corner_at(step, 2.9), (Vec3{1, 0, 0}));
  EXPECT_EQ(corner_at(step, 3), (Vec3{5, 0, 8}));
}

// With the slope 1 of x at both keyframes, and their values on that line, the spline is the line. y has the
// slope 2 at the first one alone: 2 s (1 - s / 2)^2 at s seconds.
TEST(GltfAnimation, FollowsCubicSplines) {
  const GltfFile file = animated("translation", "CUBICSPLINE", "VEC3", {0, 2},
                                 {9, 9, 9, 0, 0, 0, 1, 2, 0, 1, 0, 0, 2, 0, 0, 9, 9, 9});
  EXPECT_EQ(corner_at(file, 0), (Vec3{1, 0, 0}));
  EXPECT_EQ(corner_at(file, 0.5), (Vec3{1.5f, 0.5625f, 0}));
  EXPECT_EQ(corner_at(file, 1), (Vec3{2, 0.5f, 0}));
  EXPECT_EQ(corner_at(file, 2), (Vec3{3, 0, 0}));
}

TEST(GltfAnimation, TurnsNodesAtConstantSpeed) {
  const float half = std::sqrt(0.5f);  // a quarter of a turn about +z
  const GltfFile file = animated("rotation", "LINEAR", "VEC4", {0, 1}, {0, 0, 0, 1, 0, 0, half, half});
  const Vec3 corner = corner_at(file, 1.0 / 3);
  EXPECT_NEAR(corner.x, std::sqrt(0.75f), 1e-6f);
  EXPECT_NEAR(corner.y, 0.5f, 1e-6f);
}

TEST(GltfAnimation, MorphsMeshes) {
  GltfFile file = animated("weights", "LINEAR", "SCALAR", {0, 1}, {0, 0, 1, 2});
  const int first = file.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 0, 0}),
            second = file.floats("VEC3", {0, 0, 0, 0, 1, 0, 0, 0, 0});
  file.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", first}}, {{"POSITION", second}}};
  EXPECT_EQ(corner_at(file, 0.5), (Vec3{1.5f, 1, 0}));
  EXPECT_EQ(corner_at(file, 1), (Vec3{2, 2, 0}));
}

TEST(GltfAnimation, MovesTheJointsOfSkins) {
  GltfFile file = animated("translation", "LINEAR", "VEC3", {0, 1}, {0, 0, 0, 0, 6, 0});
  file.json["animations"][0]["channels"][0]["target"]["node"] = 1;
  file.node({{"name", "joint"}});
  file.json["skins"] = {{{"joints", {1}}}};
  file.json["nodes"][0]["skin"] = 0;
  auto& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = file.accessor(file.view(std::string(12, '\0')), 5121, "VEC4", 3);
  attributes["WEIGHTS_0"] = file.floats("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  EXPECT_EQ(corner_at(file, 0.5), (Vec3{1, 3, 0}));
}

TEST(GltfAnimation, IsListedAndChosen) {
  GltfFile file = animated("translation", "LINEAR", "VEC3", {0, 2.5f}, {0, 0, 0, 4, 0, 8});
  auto other = file.json["animations"][0];
  other["name"] = "Stay";
  other["channels"] = nlohmann::json::array();
  file.json["animations"].push_back(other);
  const auto scene = load_chosen(file.text(), {select_by_name("animation", "Stay"), select_time(1)});
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(mesh_of(*scene).positions[1], (Vec3{1, 0, 0}));
  EXPECT_THAT(scene->warnings, IsEmpty());
  ASSERT_EQ(scene->contents.animations.size(), 2u);
  EXPECT_EQ(scene->contents.animations[0].name, "Move");
  EXPECT_EQ(scene->contents.animations[0].seconds, 2.5f);
  GltfFile still;
  still.node({{"mesh", still.triangle()}});
  EXPECT_EQ(mistake_in_choice(still, {select_time(1)}),
            "model.gltf: has no animation of which a time could be chosen");
}

// As Blender writes them, one for each object.
TEST(GltfAnimation, CanBePlayedWithAllOthers) {
  GltfFile file = animated("translation", "LINEAR", "VEC3", {0, 1}, {0, 0, 0, 4, 0, 8});
  const GltfFile scaled = animated("scale", "LINEAR", "VEC3", {0, 1}, {1, 1, 1, 3, 1, 1});
  const int times = file.floats("SCALAR", {0, 1}), scales = file.floats("VEC3", {1, 1, 1, 3, 1, 1});
  auto other = scaled.json["animations"][0];
  other["name"] = "Grow";
  other["samplers"][0]["input"] = times;
  other["samplers"][0]["output"] = scales;
  file.json["animations"].push_back(other);
  const auto played = [&](const Overrides& choice) {
    const auto scene = load_chosen(file.text(), choice);
    EXPECT_TRUE(scene) << scene.error().message;
    return scene ? *scene : SceneDescription();
  };
  const SceneDescription all = played({select_by_name("animation", "all"), select_time(1)});
  EXPECT_EQ(mesh_of(all).positions[1], (Vec3{7, 0, 8}));
  EXPECT_THAT(all.warnings, IsEmpty());
  const SceneDescription first = played({select_time(1)});
  EXPECT_EQ(mesh_of(first).positions[1], (Vec3{5, 0, 8}));
  EXPECT_THAT(warnings_of(first), HasSubstr("only the first of 2 animations is played"));
  EXPECT_THAT(warnings_of(played({select_by_name("animation", "all")})),
              HasSubstr("the beginning of all 2 animations"));
  file.json["animations"].erase(1);
  EXPECT_THAT(warnings_of(played({})), HasSubstr("the beginning of its animation; a time can be chosen"));
}

Overrides open_for(double seconds, double shutter) {
  return {select_time(seconds), select_shutter(shutter)};
}

TEST(GltfAnimation, IsNoneOfFrames) {
  const GltfFile file = animated("translation", "LINEAR", "VEC3", {0, 1}, {0, 0, 0, 4, 0, 8});
  const auto blurred = load_chosen(file.text(), open_for(0, 0.5));
  ASSERT_TRUE(blurred) << blurred.error().message;
  EXPECT_TRUE(is_animated(blurred->animation));
  EXPECT_FALSE(frames_differ(*blurred));
}

// A quarter of a turn about +z in a second.
GltfFile turning() {
  const float half = std::sqrt(0.5f);
  return animated("rotation", "LINEAR", "VEC4", {0, 1}, {0, 0, 0, 1, 0, 0, half, half});
}

TEST(GltfShutter, LetsInstancesMoveWithTheirNodes) {
  const auto scene = load_chosen(turning().text(), open_for(0.25, 0.5));
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(scene->warnings, IsEmpty());
  EXPECT_EQ(scene->camera.shutter_close, 0.5f) << "also of the camera that the file lacks";
  ASSERT_EQ(scene->animation.instances.size(), 1u);
  const InstanceMotion& motion = scene->animation.instances[0];
  const auto& instance = std::get<InstanceDescription>(scene->shapes[motion.shape]);
  EXPECT_EQ(instance.to_world, transform_at(motion.steps, 0));
  for (const float frame : {0.0f, 0.1f, 0.3f, 0.5f}) {
    const Vec3 corner = transform_at(motion.steps, frame).point({1, 0, 0});
    EXPECT_NEAR(corner.x, std::cos((0.25f + frame) * 1.57079633f), 1e-5f) << frame;
    EXPECT_NEAR(corner.y, std::sin((0.25f + frame) * 1.57079633f), 1e-5f) << frame;
  }
  EXPECT_TRUE(Scene::build(*scene, 1).value().has_motion());
}

TEST(GltfShutter, LetsMorphTargetsDeform) {
  GltfFile file = animated("weights", "LINEAR", "SCALAR", {0, 1}, {0, 1});
  const int up = file.floats("VEC3", {0, 0, 0, 0, 0, 8, 0, 0, 0});
  file.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", up}}};
  file.json["nodes"][0]["translation"] = {0, 0, 1};
  const auto scene = load_chosen(file.text(), open_for(0.5, 0.25));
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_TRUE(scene->animation.deforms);
  EXPECT_THAT(scene->animation.instances, IsEmpty());
  const MeshDescription& mesh = mesh_of(*scene);
  ASSERT_GE(mesh.steps.size(), 2u);
  EXPECT_EQ(mesh.steps.front().frame, 0);
  EXPECT_EQ(mesh.steps.back().frame, 0.25f);
  EXPECT_EQ(mesh.positions[1], (Vec3{1, 0, 5}));
  EXPECT_EQ(mesh.steps.front().positions[1], (Vec3{1, 0, 5}));
  EXPECT_EQ(mesh.steps.back().positions[1], (Vec3{1, 0, 7}));
  EXPECT_TRUE(Scene::build(*scene, 1).value().has_motion());
}

TEST(GltfShutter, LetsSkinsDeform) {
  GltfFile file = animated("translation", "LINEAR", "VEC3", {0, 1}, {0, 0, 0, 0, 6, 0});
  file.json["animations"][0]["channels"][0]["target"]["node"] = 1;
  file.node({{"name", "joint"}});
  file.json["skins"] = {{{"joints", {1}}}};
  file.json["nodes"][0]["skin"] = 0;
  auto& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = file.accessor(file.view(std::string(12, '\0')), 5121, "VEC4", 3);
  attributes["WEIGHTS_0"] = file.floats("VEC4", {1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0});
  const auto scene = load_chosen(file.text(), open_for(0, 1));
  ASSERT_TRUE(scene) << scene.error().message;
  const MeshDescription& mesh = mesh_of(*scene);
  ASSERT_GE(mesh.steps.size(), 2u);
  EXPECT_EQ(mesh.steps.back().positions[0], (Vec3{0, 6, 0}));
  EXPECT_EQ(mesh.steps.back().positions[1], (Vec3{1, 0, 0})) << "without a joint";
}

// Weights and a translation of one node: an object that deforms, and an instance that moves.
TEST(GltfShutter, LetsMeshesDeformInNodesThatMove) {
  GltfFile file = animated("weights", "LINEAR", "SCALAR", {0, 1}, {0, 1});
  const int up = file.floats("VEC3", {0, 0, 0, 0, 0, 8, 0, 0, 0});
  file.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", up}}};
  auto& animation = file.json["animations"][0];
  animation["samplers"].push_back(
      {{"input", animation["samplers"][0]["input"]}, {"output", file.floats("VEC3", {0, 0, 0, 4, 0, 0})}});
  animation["channels"].push_back({{"sampler", 1}, {"target", {{"node", 0}, {"path", "translation"}}}});
  const auto scene = load_chosen(file.text(), open_for(0, 1));
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->objects.size(), 1u);
  const auto& mesh = std::get<MeshDescription>(scene->objects[0].shapes[0]);
  EXPECT_EQ(mesh.steps.back().positions[1], (Vec3{1, 0, 8})) << "in the space of the object";
  ASSERT_EQ(scene->animation.instances.size(), 1u);
  EXPECT_EQ(transform_at(scene->animation.instances[0].steps, 1).origin, (Vec3{4, 0, 0}));
  EXPECT_TRUE(Scene::build(*scene, 1).value().has_motion());
}

TEST(GltfShutter, LetsTheCameraMove) {
  GltfFile file = animated("translation", "LINEAR", "VEC3", {0, 1}, {0, 0, 5, 2, 0, 5});
  file.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}}};
  file.node({{"camera", 0}});
  file.json["animations"][0]["channels"][0]["target"]["node"] = 1;
  const auto scene = load_chosen(file.text(), open_for(0, 1));
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->camera.shutter_close, 1);
  const CameraDescription half = camera_at(scene->camera, scene->animation.camera, 0.5f);
  EXPECT_NEAR(half.position.x, 1, 1e-5f);
  EXPECT_NEAR(half.look_at.x, 1, 1e-5f) << "along -z";
  EXPECT_LT(half.look_at.z, half.position.z);
  EXPECT_GT(half.up.y, 0.99f);
}

TEST(GltfShutter, LeavesWhatStandsStillAsItIs) {
  GltfFile file = turning();
  file.json["animations"][0]["channels"][0]["target"]["node"] = 1;
  file.node({{"name", "empty"}});
  const auto scene = load_chosen(file.text(), open_for(0, 1)), without = load_chosen(file.text(), {});
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(mesh_of(*scene).positions, mesh_of(*without).positions);
  EXPECT_TRUE(mesh_of(*scene).steps.empty());
  EXPECT_FALSE(is_animated(scene->animation));
}

TEST(GltfShutter, LeavesWhatEmitsAsItIs) {
  GltfFile file = animated("weights", "LINEAR", "SCALAR", {0, 1}, {0, 1});
  file.json["materials"] = {{{"emissiveFactor", {1, 1, 1}}}};
  auto& primitive = file.json["meshes"][0]["primitives"][0];
  primitive["targets"] = {{{"POSITION", file.floats("VEC3", {0, 0, 0, 0, 0, 8, 0, 0, 0})}}};
  primitive["material"] = 0;
  const auto scene = load_chosen(file.text(), open_for(0.5, 0.5));
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(mesh_of(*scene).positions[1], (Vec3{1, 0, 4}));
  EXPECT_FALSE(scene->animation.deforms);
  EXPECT_THAT(warnings_of(*scene), HasSubstr("a mesh that emits light does not deform"));
}

// Nodes then stand as the file places them at rest.
TEST(GltfAnimation, CanBeLeftOut) {
  GltfFile file = animated("translation", "LINEAR", "VEC3", {0, 1}, {5, 0, 0, 7, 0, 0});
  file.json["nodes"][0]["translation"] = {2, 0, 0};
  const auto moving = load_chosen(file.text(), {});
  ASSERT_TRUE(moving) << moving.error().message;
  EXPECT_EQ(mesh_of(*moving).positions[0], (Vec3{5, 0, 0}));
  EXPECT_THAT(warnings_of(*moving), HasSubstr("or none (--animation none)"));
  const auto at_rest = load_chosen(file.text(), {select_by_name("animation", "none")});
  ASSERT_TRUE(at_rest) << at_rest.error().message;
  EXPECT_EQ(mesh_of(*at_rest).positions[0], (Vec3{2, 0, 0}));
  EXPECT_EQ(warnings_of(*at_rest), "");
  EXPECT_EQ(mistake_in_choice(file, {select_by_name("animation", "none"), select_time(1)}),
            "model.gltf: without an animation, no time can be chosen");
  file.json["animations"][0]["name"] = "none";
  const auto named = load_chosen(file.text(), {select_by_name("animation", "none"), select_time(1)});
  ASSERT_TRUE(named) << named.error().message;
  EXPECT_EQ(mesh_of(*named).positions[0], (Vec3{7, 0, 0}));
}

TEST(GltfShutter, NeedsAnAnimationAndATime) {
  GltfFile still;
  still.node({{"mesh", still.triangle()}});
  EXPECT_EQ(mistake_in_choice(still, {select_shutter(1)}),
            "model.gltf: has no animation of which a time could be chosen");
  EXPECT_THAT(mistake_in_choice(turning(), {select_shutter(2000)}),
              HasSubstr("must be from 0 to 1000 seconds"));
}

// Damaged keyframes give an error or some pose, and no crash.
TEST(GltfAnimation, SurvivesDamage) {
  GltfFile file = animated("weights", "CUBICSPLINE", "SCALAR", {0, std::nanf(""), -1}, {0, 0, 1});
  EXPECT_TRUE(load_chosen(file.text(), {select_time(1)}));
  file = animated("translation", "CUBICSPLINE", "VEC3", {0, 1}, {0, 0, 0});
  const auto scene = load_chosen(file.text(), {select_time(1)});
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(warnings_of(*scene), HasSubstr("has no keyframes; it is ignored"));
  file.json["animations"][0]["samplers"][0]["input"] = 77;
  const auto without_times = load_chosen(file.text(), {select_time(1)});
  ASSERT_TRUE(without_times) << without_times.error().message;
  EXPECT_THAT(warnings_of(*without_times),
              HasSubstr("animations[0].channels[0]: it is ignored: "
                        "animations[0].samplers[0].input: there is no accessors[77]"));
}

TEST(Selection, IsRefusedWhereThereIsNothingToChoose) {
  const auto mistake = [](const char* name, const char* text, const ParameterOverride& wanted) {
    const auto scene = load_chosen(text, {wanted}, name);
    return scene ? "no mistake" : scene.error().message;
  };
  EXPECT_THAT(mistake("a.pbrt", "WorldBegin", select_by_name("camera", "0")),
              HasSubstr("'a.pbrt' has nothing that --camera can choose; glTF and Mitsuba files have"));
  EXPECT_THAT(mistake("a.json", "{}", select_time(1)), HasSubstr("nothing that --animation-time can choose"));
  EXPECT_THAT(mistake("a.xml", "<scene/>", select_by_name("variant", "0")),
              HasSubstr("nothing that --variant can choose; glTF files have"));
}

}  // namespace
}  // namespace tessera::core::test
