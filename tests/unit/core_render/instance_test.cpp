// SPDX-License-Identifier: Apache-2.0
// Scenes of two levels: the lights in instances, what Scene::build refuses, and the bytes of their images.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/integrators/render.hpp"
#include "core/scene/validation.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

using testing::HasSubstr;

// The room's shapes as an object, which the transform places.
SceneDescription room_as_instance(const Transform& transform) {
  SceneDescription room = test::room();
  room.objects = {{"room", std::move(room.shapes), {}}};
  room.shapes = {InstanceDescription{0, transform, std::nullopt}};
  return room;
}

std::vector<std::uint64_t> integrated_sums(const SceneDescription& description, Integrator integrator) {
  const Scene scene = Scene::build(description, 2).value();
  RenderSettings settings = scene.settings();
  settings.integrator = integrator;
  return render(prepare(scene, settings, 2), {0, 0, settings.width_px, settings.height_px}, {0, 4}, 2).sums;
}

// Without mirrors and clear glass, which photons leave by other roundings in an instance.
SceneDescription without_casters(SceneDescription room) {
  room.materials[4].model = test::lambert(0.5f);
  room.materials[5].model = Glass{.roughness = 0.5f};
  return room;
}

TEST(InstanceRender, OfWhatStandsWhereItWasModelledHasTheSameBytes) {
  for (const Integrator integrator : {Integrator::kMis, Integrator::kWhitted})
    EXPECT_EQ(integrated_sums(without_casters(room_as_instance({})), integrator),
              integrated_sums(without_casters(test::room()), integrator));
}

TEST(InstanceRender, FindsTheLightsOfEveryInstance) {
  SceneDescription description = room_as_instance({});
  description.shapes.push_back(InstanceDescription{0, translation({10, 0, 0}), std::nullopt});
  description.shapes.push_back(InstanceDescription{0, translation({20, 0, 0}), 0u});  // nothing of it emits
  description.shapes.push_back(InstanceDescription{0, scaling({1, -1, 1}), 3u});      // all of it emits
  description.shapes.push_back(SphereDescription{{0, 50, 0}, 1, 2});
  const Scene scene = Scene::build(description, 1).value();
  constexpr std::uint32_t kLights = 2, kShapes = 9;
  ASSERT_EQ(scene.lights().size(), 1 + 2 * kLights + kShapes);
  const auto light_of = [&](std::uint32_t primitive, std::uint32_t instance) {
    return scene.light_of({.primitive = primitive, .instance = instance});
  };
  EXPECT_EQ(scene.light_of({.primitive = 0}), 0u) << "the scene's own come first";
  for (const std::uint32_t instance : {0u, 1u}) {
    const std::uint32_t first = 1 + kLights * instance;
    EXPECT_EQ(light_of(0, instance), lights::kNoLight);
    EXPECT_EQ(light_of(10, instance), first);
    EXPECT_EQ(light_of(11, instance), first);
    EXPECT_EQ(light_of(14, instance), first + 1);
    EXPECT_EQ(light_of(12, instance), lights::kNoLight);
  }
  EXPECT_EQ(light_of(10, 2), lights::kNoLight);
  EXPECT_EQ(light_of(0, 3), 1 + 2 * kLights);
  EXPECT_EQ(light_of(14, 3), scene.lights().size() - 1);
}

TEST(InstanceRender, CountsTheLightOfObjectsOnlyWhereTheyAreShown) {
  SceneDescription description = room_as_instance({});
  EXPECT_TRUE(gives_light(description));
  description.shapes = {InstanceDescription{0, {}, 0u}};
  EXPECT_FALSE(gives_light(description));
  description.shapes = {SphereDescription{}};
  EXPECT_FALSE(gives_light(description));
}

TEST(InstanceRender, RefusesWhatCannotBeShown) {
  const auto error_of = [](const SceneDescription& description) {
    const auto scene = Scene::build(description, 1);
    return scene ? "" : scene.error().message;
  };
  const auto with = [](const InstanceDescription& instance) {
    SceneDescription description = room_as_instance({});
    description.shapes = {instance};
    return description;
  };
  EXPECT_EQ(error_of(with({0, {}, 1u})), "");
  EXPECT_EQ(error_of(with({1, {}, 1u})), "shapes[0]: there is no object 1");
  EXPECT_EQ(error_of(with({0, {}, 9u})), "shapes[0]: there is no material 9");
  EXPECT_THAT(error_of(with({0, scaling({1, 0, 1}), 1u})), HasSubstr("flattens the object"));
  EXPECT_EQ(error_of(with({0, translation({2e15f, 0, 0}), 1u})),
            "shapes[0]: the object reaches farther than 1e+15 there");
  EXPECT_THAT(error_of(with({0, scaling({1, 2, 1}), std::nullopt})), HasSubstr("must stay round"));
  EXPECT_EQ(error_of(with({0, scaling({1, 2, 1}), 1u})), "");
  SceneDescription nested = room_as_instance({});
  nested.objects[0].shapes.push_back(InstanceDescription{});
  EXPECT_THAT(error_of(nested), HasSubstr("cannot hold instances"));
  nested.objects[0].shapes.clear();
  EXPECT_EQ(error_of(nested), "object 'room': needs at least one shape");
}

}  // namespace
}  // namespace tessera::core::integrators
