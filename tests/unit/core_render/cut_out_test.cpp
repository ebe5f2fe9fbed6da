// SPDX-License-Identifier: Apache-2.0
// What image textures cut out of surfaces: traversal passes it.
#include <gtest/gtest.h>

#include <cstdint>
#include <utility>

#include "core/integrators/render.hpp"
#include "tests/unit/core_render/cards.hpp"

namespace tessera::core::integrators::opacity_test {
namespace {

using test::SceneMaker;

// The left half of a card is cut out by a mask, in front of one that is whole.
SceneMaker half_a_card(float middle = 0) {
  SceneMaker maker(kTowardsOrigin);
  maker.description().textures = {texture_of(3, 1, {0, middle, 1})};
  maker.description().textures[0].filter = TextureFilter::kNearest;
  maker.add(card(-1, maker.material(test::lambert(0.5f))));
  maker.description().materials[translucent(maker, test::lambert(0.5f), 1)].opacity.texture = 0;
  return maker;
}
constexpr std::uint32_t kWhole = 0, kHalf = 1;

// Down onto the cards.
Ray ray_at(float x) {
  return {{x, 0.1f, 4}, {0, 0, -1}};
}

TEST(CutOut, IsNoSurfaceWhereItIsTransparent) {
  SceneMaker maker = half_a_card(0.5f);
  maker.add(card(0, kHalf));
  const Scene scene = maker.build();
  for (const auto& [x, t] : {std::pair{-0.5f, 5.0f}, {0.0f, 4.0f}, {0.5f, 4.0f}})
    EXPECT_EQ(scene.closest_hit(ray_at(x)).t, t) << x;
  EXPECT_EQ(scene.bvh().closest_hit(scene.primitives(), ray_at(-0.5f)).t, 4);
  const auto until = [&](float x, float t) {
    Ray ray = ray_at(x);
    ray.t_max = t;
    return scene.occlusion(ray);
  };
  EXPECT_EQ(until(-0.5f, 4.5f), accel::Occlusion::kNone);
  EXPECT_EQ(until(-0.5f, 6), accel::Occlusion::kFull);
  EXPECT_EQ(until(0, 4.5f), accel::Occlusion::kPartial);
  EXPECT_EQ(until(0, 6), accel::Occlusion::kFull);
  EXPECT_EQ(until(0.5f, 4.5f), accel::Occlusion::kFull);
  EXPECT_EQ(scene.opacity_of(scene.closest_hit(ray_at(0))), accel::Opacity::kPartial);
}

// Of an opaque object, too, and by the second texture coordinates.
TEST(CutOut, IsWhatInstancesAreMadeOf) {
  SceneMaker maker = half_a_card();
  MeshDescription mesh{.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}},
                       .normals = {},
                       .uvs = {{1, 0}, {0, 0}, {0, 1}, {1, 1}},
                       .triangles = {{0, 1, 2}, {0, 2, 3}},
                       .triangle_materials = {kWhole}};
  mesh.second_uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  maker.description().objects = {{"card", {mesh}, {}}};
  maker.add(InstanceDescription{0, translation({0, 0, 1}), kHalf});
  for (const UvSet set : {UvSet::kFirst, UvSet::kSecond}) {
    maker.description().textures[0].uv_set = set;
    const Scene scene = maker.build();
    const float cut = set == UvSet::kFirst ? 0.5f : -0.5f;
    EXPECT_EQ(scene.closest_hit(ray_at(cut)).t, 5);
    EXPECT_EQ(scene.closest_hit(ray_at(-cut)).t, 3);
    EXPECT_EQ(scene.closest_hit(ray_at(-cut)).instance, 0u);
  }
}

TEST(CutOut, IsMetWhereItMustBe) {
  const auto t_through = [](auto&& change) {
    SceneMaker maker = half_a_card();
    maker.add(card(0, kHalf));
    change(maker.description());
    return maker.build().closest_hit(ray_at(-0.5f)).t;
  };
  EXPECT_EQ(t_through([](SceneDescription&) {}), 5);
  EXPECT_EQ(t_through([](SceneDescription& scene) {
              scene.media = {{.name = "smoke", .sigma_a = Rgb::gray(1)}};
              scene.materials[kHalf].media = {0, kNoMedium};
            }),
            4);
  EXPECT_EQ(t_through([](SceneDescription& scene) { scene.materials[kHalf].model = Glass{.priority = 1}; }),
            4);
  EXPECT_EQ(t_through([](SceneDescription& scene) { scene.materials[kHalf].model = Null{}; }), 5);
  EXPECT_EQ(t_through([](SceneDescription& scene) { scene.materials[kHalf].opacity = 1e-9f; }), 4);
}

TEST(CutOut, FollowsKeyframes) {
  SceneMaker maker = half_a_card();
  maker.add(card(0, kWhole));
  maker.description().animation.materials = {{kWhole, {{{"opacity", {{0, 10}, {1, 0}}}}, {}}}};
  Scene scene = maker.build();
  EXPECT_EQ(scene.closest_hit(ray_at(0.5f)).t, 4);
  EXPECT_EQ(scene.occlusion(ray_at(0.5f)), accel::Occlusion::kFull);
  ASSERT_TRUE(scene.set_frame(5, 1));
  EXPECT_EQ(scene.closest_hit(ray_at(0.5f)).t, 4);
  EXPECT_EQ(scene.occlusion(ray_at(0.5f)), accel::Occlusion::kPartial);
  ASSERT_TRUE(scene.set_frame(10, 1));
  EXPECT_FALSE(scene.closest_hit(ray_at(0.5f)).found());
  ASSERT_TRUE(scene.set_frame(0, 1));
  EXPECT_EQ(scene.occlusion(ray_at(0.5f)), accel::Occlusion::kFull);
  EXPECT_EQ(scene.bvh(), maker.build().bvh());
}

// However many holes a ray passes, it is traced once.
TEST(CutOut, TakesNoMoreRays) {
  const auto counters = [](int cards) {
    SceneMaker maker = half_a_card();
    maker.description().lights = {DirectionalLightDescription{{0.01f, 0.01f, -1}, Rgb::gray(2)}};
    for (int i = 0; i < cards; ++i)
      maker.add(QuadDescription{{-2, -3, 0.1f * static_cast<float>(i)}, {9, 0, 0}, {0, 9, 0}, kHalf});
    const Scene scene = maker.build();
    return render(prepare(scene, {.width_px = 8, .height_px = 8, .spp = 4, .max_depth = 1}, 1), {0, 0, 8, 8},
                  {0, 4}, 1)
        .counters;
  };
  const RenderCounters free = counters(0), cut = counters(20);
  EXPECT_EQ(cut.closest_hit_rays, free.closest_hit_rays);
  EXPECT_EQ(cut.shadow_rays, free.shadow_rays);
}

}  // namespace
}  // namespace tessera::core::integrators::opacity_test
