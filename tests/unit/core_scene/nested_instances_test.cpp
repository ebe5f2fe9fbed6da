// SPDX-License-Identifier: Apache-2.0
// Objects that hold instances of others become products of transforms.
#include "core/scene/import/nested_instances.hpp"

#include <gtest/gtest.h>

#include "core/scene/validation.hpp"
#include "tests/support/near.hpp"

namespace tessera::core {
namespace {

InstanceDescription instance(std::uint32_t object, Transform to_world,
                             std::optional<std::uint32_t> material = {}) {
  return {object, to_world, material};
}

// A leaf (0), a branch of two leaves (1), a tree of a trunk and two branches (2), and an empty object (3).
SceneDescription forest() {
  SceneDescription scene;
  scene.materials = {{"a", Lambert{}}, {"b", Lambert{}}};
  scene.objects = {
      {"leaf", {SphereDescription{}}, {"ball"}},
      {"branch",
       {instance(0, translation({1, 0, 0})), instance(0, translation({2, 0, 0}), 1)},
       {"first", "second"}},
      {"tree",
       {instance(1, scaling({2, 2, 2})), QuadDescription{{}, {1, 0, 0}, {0, 1, 0}}, instance(1, {})},
       {"big branch", "trunk", "branch"}},
      {"nothing", {}, {}}};
  scene.shapes = {SphereDescription{}, instance(2, translation({0, 10, 0})), instance(0, {}),
                  instance(1, scaling({3, 3, 3}), 0)};
  scene.shape_names = {"sphere", "tree", "leaf", "branch"};
  return scene;
}

const InstanceDescription& instance_at(const SceneDescription& scene, std::size_t shape) {
  return std::get<InstanceDescription>(scene.shapes.at(shape));
}

TEST(NestedInstances, BecomeProductsOfTheirTransforms) {
  SceneDescription scene = forest();
  ASSERT_TRUE(flatten_instances(scene).has_value());
  ASSERT_TRUE(validate_scene(scene).has_value());
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_EQ(scene.objects[0].name, "leaf");
  EXPECT_EQ(scene.objects[1].name, "tree");
  EXPECT_EQ(scene.objects[1].shape_names, (std::vector<std::string>{"trunk"}));
  const std::vector<std::string> names{"sphere", "tree", "tree",   "tree",  "tree",
                                       "tree",   "leaf", "branch", "branch"};
  EXPECT_EQ(scene.shape_names, names);
  ASSERT_EQ(scene.shapes.size(), names.size());
  EXPECT_EQ(instance_at(scene, 1).object, 1u) << "the trunk comes first";
  expect_near(instance_at(scene, 2).to_world.point({}), {2, 10, 0}, 1e-6f);
  expect_near(instance_at(scene, 3).to_world.point({}), {4, 10, 0}, 1e-6f);
  expect_near(instance_at(scene, 4).to_world.point({}), {1, 10, 0}, 1e-6f);
  expect_near(instance_at(scene, 5).to_world.point({}), {2, 10, 0}, 1e-6f);
  expect_near(instance_at(scene, 8).to_world.point({}), {6, 0, 0}, 1e-6f);
  EXPECT_EQ(instance_at(scene, 2).material, std::nullopt);
  EXPECT_EQ(instance_at(scene, 3).material, 1u);
  EXPECT_EQ(instance_at(scene, 8).material, 0u) << "the outermost counts";
}

TEST(NestedInstances, KeepTheMotionOfTheOutermost) {
  SceneDescription scene = forest();
  TranslationMotion rise{{{0, 10}, {{0, 0, 0}, {0, 0, 5}}}};
  scene.animation.instances = {{3, {scaling({3, 3, 3}), rise}}};
  ASSERT_TRUE(flatten_instances(scene).has_value());
  ASSERT_EQ(scene.animation.instances.size(), 2u);
  for (const InstanceMotion& motion : scene.animation.instances)
    expect_near(transform_at(motion.steps, 0).point({}), instance_at(scene, motion.shape).to_world.point({}),
                1e-6f);
  EXPECT_EQ(scene.animation.instances[1].shape, 8u);
  expect_near(transform_at(scene.animation.instances[1].steps, 10).point({}), {6, 0, 5}, 1e-6f);
}

TEST(NestedInstances, LeaveOtherScenesAsTheyAre) {
  SceneDescription scene;
  scene.objects = {{"leaf", {SphereDescription{}}, {"ball"}}};
  scene.shapes = {instance(0, {})};
  ASSERT_TRUE(flatten_instances(scene).has_value());
  EXPECT_EQ(scene.shapes.size(), 1u);
  EXPECT_EQ(scene.objects.size(), 1u);
}

TEST(NestedInstances, OfThemselvesAreRefused) {
  SceneDescription scene = forest();
  scene.objects[0].shapes.emplace_back(instance(2, {}));
  const Status refused = flatten_instances(scene);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(refused.error().message, "object 'leaf' holds an instance of itself, directly or through others");
}

// 2 to the power of 80 leaves.
TEST(NestedInstances, BeyondTheLimitAreRefusedAtOnce) {
  SceneDescription scene;
  scene.objects = {{"0", {SphereDescription{}}, {""}}};
  for (std::uint32_t i = 0; i < 80; ++i)
    scene.objects.push_back({std::to_string(i + 1), {instance(i, {}), instance(i, {})}, {"", ""}});
  scene.shapes = {instance(80, {})};
  const Status refused = flatten_instances(scene);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::kResourceExhausted);
}

TEST(NestedInstances, OfNoObjectAreRefused) {
  SceneDescription scene = forest();
  scene.objects[1].shapes.emplace_back(instance(9, {}));
  EXPECT_FALSE(flatten_instances(scene).has_value());
}

}  // namespace
}  // namespace tessera::core
