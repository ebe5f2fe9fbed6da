// SPDX-License-Identifier: Apache-2.0
// Surfaces that let light pass: what rays and shadow rays see of them, in closed form, and that a sample
// stays a pure function.
#include "core/integrators/opacity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/mean_radiance.hpp"
#include "tests/unit/core_render/cards.hpp"

namespace tessera::core::integrators::opacity_test {
namespace {

using test::expect_radiance;
using test::mean_radiance;
using test::SceneMaker;

// Cards one behind another that emit 2, 3 (seen through) and 4 (hidden).
SceneMaker see_through_and_hidden() {
  SceneMaker maker(kTowardsOrigin);
  maker.add(card(-1, maker.material(test::lambert(0), Rgb::gray(2))));
  maker.add(card(0, maker.material(Null{}, Rgb::gray(3))));
  const std::uint32_t hidden = maker.material(test::lambert(0), Rgb::gray(4));
  maker.description().materials[hidden].visible_to_camera = false;
  maker.add(card(1, hidden));
  return maker;
}

TEST(EmissionInPassing, AddsToWhatIsBehindAndHiddenSurfacesAreNotSeen) {
  for (const test::Strategy& strategy : test::kStrategies)
    EXPECT_NEAR(mean_radiance(see_through_and_hidden().build(), {.integrator = strategy.integrator}, 4).value,
                5, 1e-5)
        << strategy.name;
  EXPECT_NEAR(mean_radiance(see_through_and_hidden().build(), {.integrator = Integrator::kWhitted}, 4).value,
              5, 1e-5);
}

// The ball emits on both sides of its surface, which a ray meets twice, and absorbs.
TEST(EmissionInPassing, IsDimmedByMedia) {
  SceneMaker maker(kTowardsOrigin);
  maker.add(card(-1, maker.material(test::lambert(0), Rgb::gray(2))));
  maker.description().media = {{.name = "smoke", .sigma_a = Rgb::gray(0.9f)}};
  const std::uint32_t ball = maker.material(Null{}, Rgb::gray(3));
  maker.description().materials[ball].media = {0, kNoMedium};
  maker.add(SphereDescription{{0, 0, 0}, 0.5f, ball});
  const double left = std::exp(-0.9);
  EXPECT_NEAR(mean_radiance(maker.build(), {}, 4).value, 3 + left * (3 + 2), 0.03);
}

// A floor below a lamp, in a room that reflects, seen from the side. Light samples and what paths find of a
// lamp that they pass are weighed against each other.
double floor_below(const MaterialModel& lamp, bool visible, Integrator integrator, double& error) {
  SceneMaker maker({.position = {0, -3, 0.5f}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 2});
  maker.add(card(0, maker.material(test::lambert(0.5f)), 4));
  maker.add(SphereDescription{{0, 0, 0}, 20, maker.material(test::lambert(0.5f))});
  const std::uint32_t material = maker.material(lamp, Rgb::gray(3));
  maker.description().materials[material].visible_to_camera = visible;
  maker.add(SphereDescription{{0, 0, 1.5f}, 0.7f, material});
  const auto mean = mean_radiance(maker.build(), {.integrator = integrator, .max_depth = 3}, 4000);
  error = mean.standard_error;
  return mean.value;
}

TEST(EmissionInPassing, LightsTheSameByAllStrategies) {
  double naive_error = 0, error = 0;
  const double expected = floor_below(Null{}, true, Integrator::kNaive, naive_error);
  EXPECT_GT(expected, 0.05);
  for (const Integrator integrator : {Integrator::kNee, Integrator::kMis}) {
    const double value = floor_below(Null{}, true, integrator, error);
    EXPECT_NEAR(value, expected, 5 * (error + naive_error));
  }
}

TEST(HiddenFromTheCamera, LightsAndReflectsAsIfItWereVisible) {
  double error = 0;
  for (const Integrator integrator : {Integrator::kNaive, Integrator::kMis})
    EXPECT_NEAR(floor_below(test::lambert(0.5f), false, integrator, error),
                floor_below(test::lambert(0.5f), true, integrator, error), 1e-6);
}

// In front of what emits 2, a black card hides its opacity's share.
TEST(Opacity, HidesItsShareOfWhatIsBehind) {
  for (const float opacity : {0.0f, 0.25f, 0.5f, 1.0f}) {
    SceneMaker maker(kTowardsOrigin);
    maker.add(card(-1, maker.material(test::lambert(0), Rgb::gray(2))));
    maker.add(card(0, translucent(maker, test::lambert(0), opacity)));
    const double expected = 2 * (1 - static_cast<double>(opacity));
    for (const test::Strategy& strategy : test::kStrategies) {
      const auto mean = mean_radiance(maker.build(), {.integrator = strategy.integrator}, 1000);
      EXPECT_NEAR(mean.value, expected, 1e-6 + 5 * mean.standard_error) << strategy.name << opacity;
    }
    const auto whitted = mean_radiance(maker.build(), {.integrator = Integrator::kWhitted}, 1000);
    EXPECT_NEAR(whitted.value, expected, 1e-6 + 5 * whitted.standard_error) << opacity;
  }
}

// What a floor reflects of a light that two cards are in front of, against the floor without them. The camera
// looks from below the cards.
TEST(Opacity, DimsShadows) {
  const auto floor_brightness = [](bool cards, const LightDescription& light, Integrator integrator) {
    SceneMaker maker({.position = {0, -3, 0.5f}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 2});
    maker.add(card(0, maker.material(test::lambert(0.5f))));
    if (cards) {
      maker.add(card(1, translucent(maker, test::lambert(0), 0.5f), 50));
      maker.add(SphereDescription{{0, 0, 3}, 1.5f, translucent(maker, Mirror{}, 0.25f)});
    }
    maker.description().lights = {light};
    return mean_radiance(maker.build(), {.integrator = integrator, .max_depth = 1}, 64).value;
  };
  constexpr double kShare = 0.5 * 0.75 * 0.75;  // the sphere is crossed twice
  for (const LightDescription& light :
       {LightDescription{PointLightDescription{{0, 0, 6}, Rgb::gray(9)}},
        LightDescription{DirectionalLightDescription{{0, 0, -1}, Rgb::gray(2)}}})
    for (const Integrator integrator :
         {Integrator::kNaive, Integrator::kNee, Integrator::kMis, Integrator::kWhitted}) {
      const double free = floor_brightness(false, light, integrator);
      EXPECT_GT(free, 0.01);
      EXPECT_NEAR(floor_brightness(true, light, integrator), kShare * free, 1e-4 * free);
    }
}

// Under a lamp with extent, where what scattered rays and shadow rays find is weighed against each other.
TEST(Opacity, DimsTheLightOfLamps) {
  SceneMaker maker({.position = {0, -3, 0.5f}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 2});
  maker.add(card(0, maker.material(test::lambert(1))));
  maker.add(SphereDescription{{0, 0, 0}, 20, maker.material(test::lambert(0), Rgb::gray(3))});
  maker.add(SphereDescription{{0, 0, 0}, 10, translucent(maker, test::lambert(0), 0.25f)});
  // The camera is inside as well.
  expect_radiance(maker.build(), 3 * 0.75, 500);
}

// Inside a shell that emits Le, reflects rho and has the opacity o, radiance is o (Le + rho L), since what is
// outside is black.
TEST(Opacity, IsThatOfAFurnaceOfItself) {
  constexpr float kOpacity = 0.6f, kAlbedo = 0.7f;
  SceneMaker maker({.position = {0.2f, 0.1f, 0.3f}, .look_at = {1, 0.4f, 0}, .vertical_fov_degrees = 90});
  maker.add(
      SphereDescription{{0, 0, 0}, 1, translucent(maker, test::lambert(kAlbedo), kOpacity, Rgb::gray(2))});
  expect_radiance(maker.build(), static_cast<double>(kOpacity * 2 / (1 - kOpacity * kAlbedo)), 1000);
}

TEST(Opacity, LosesNothingInAWhiteFurnace) {
  for (const MaterialModel& model : {MaterialModel{test::lambert(1)}, MaterialModel{Mirror{}}}) {
    SceneMaker maker({.position = {0, 0, 4}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 30});
    maker.description().environment = {{Rgb::gray(2)}};
    maker.add(SphereDescription{{0, 0, 0}, 1, translucent(maker, model, 0.4f)});
    expect_radiance(maker.build(), 2, 1000);
  }
}

// A translucent lamp in the shape of a sphere shows its far side, which lights the floor as well.
TEST(Opacity, ShowsTheFarSideOfLamps) {
  SceneMaker maker(kTowardsOrigin);
  maker.add(SphereDescription{{0, 0, 0}, 1, translucent(maker, test::lambert(0), 0.25f, Rgb::gray(4))});
  const double seen = 4 * (0.25 + 0.75 * 0.25);
  expect_radiance(maker.build(), seen, 1000);

  // Inside out: a floor in the middle of a lamp shaped as a sphere in another.
  SceneMaker nested({.position = {0, -0.3f, 0.1f}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 2});
  nested.add(card(0, nested.material(test::lambert(1)), 0.3f));
  nested.add(SphereDescription{{0, 0, 0}, 2, translucent(nested, test::lambert(0), 0.25f, Rgb::gray(4))});
  nested.add(SphereDescription{{0, 0, 0}, 3, translucent(nested, test::lambert(0), 0.5f, Rgb::gray(4))});
  expect_radiance(nested.build(), 4 * (0.25 + 0.75 * 0.5), 4000);
}

// A lamp far away lights a floor by the mean of its emission times its opacity, whose textures run across
// each other.
TEST(Opacity, MultipliesTheEmissionOfTexturedLamps) {
  const auto brightness = [](ColorParameter emission, ScalarParameter opacity, Integrator integrator) {
    SceneMaker maker({.position = {0, -3, 0.5f}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 2});
    maker.description().textures = {texture_of(1, 2, {1, 0.5f}), texture_of(2, 1, {0.5f, 1})};
    for (Texture& texture : maker.description().textures) texture.wrap = Wrap::kRepeat;
    const auto lamp = maker.material(test::lambert(0));
    maker.description().materials[lamp].emission = emission;
    maker.description().materials[lamp].opacity = opacity;
    maker.add(card(0, maker.material(test::lambert(1))));
    maker.add(card(50, lamp));
    return mean_radiance(maker.build(), {.integrator = integrator, .max_depth = 1}, 4000).value;
  };
  for (const Integrator integrator : {Integrator::kNee, Integrator::kMis}) {
    const double even = brightness({Rgb::gray(8 * 0.75f)}, 0.5f * 0.75f, integrator);
    EXPECT_GT(even, 1e-3);
    EXPECT_NEAR(brightness({Rgb::gray(8), 0}, {0.5f, 1}, integrator), even, 0.02 * even);
  }
}

// A disk that is cut out by a mask, sharp or a threshold between its texels, and one that is cut of geometry.
TEST(Opacity, CutsOutWhatGeometryCuts) {
  enum class Cut { kGeometry, kMask, kThreshold };
  const auto brightness = [](Cut kind, Integrator integrator) {
    SceneMaker maker({.position = {0, 0, 4}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 40});
    const auto white = maker.material(test::lambert(0.8f));
    maker.description().lights = {PointLightDescription{{2, 1, 3}, Rgb::gray(20)}};
    maker.add(card(-1, white, 3));
    if (kind != Cut::kGeometry) {
      const int side = kind == Cut::kMask ? 512 : 64;
      std::vector<float> values;
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
          const float half = static_cast<float>(side) / 2;
          const float radius = std::hypot(x + 0.5f - half, y + 0.5f - half) / half;
          values.push_back(kind == Cut::kThreshold ? 1 - radius / 2 : (radius < 1 ? 1.0f : 0.0f));
        }
      maker.description().textures = {texture_of(side, side, values)};
      const auto cut = maker.material(test::lambert(0.3f));
      maker.description().materials[cut].opacity = {1, 0};
      if (kind == Cut::kThreshold) {
        const StepPattern step{{Rgb::gray(1), 0}, 0.5f};
        maker.description().textures.push_back(
            {.image = nullptr, .procedural = ProceduralTexture{.pattern = step}});
        maker.description().materials[cut].opacity = {1, 1};
      }
      maker.add(card(0, cut));
    } else {
      MeshDescription disk{.positions = {{0, 0, 0}},
                           .normals = {},
                           .uvs = {},
                           .triangles = {},
                           .triangle_materials = {maker.material(test::lambert(0.3f))}};
      constexpr std::uint32_t kCorners = 720;
      for (std::uint32_t i = 0; i < kCorners; ++i) {
        const double angle = 2 * M_PI * i / kCorners;
        disk.positions.push_back(
            {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0});
        disk.triangles.push_back({0, i + 1, (i + 1) % kCorners + 1});
      }
      maker.add(disk);
    }
    return mean_radiance(maker.build(), {.integrator = integrator}, 400, 8).value;
  };
  for (const Integrator integrator : {Integrator::kMis, Integrator::kWhitted}) {
    const double geometry = brightness(Cut::kGeometry, integrator);
    EXPECT_NEAR(brightness(Cut::kMask, integrator), geometry, 0.003 * geometry);
    EXPECT_NEAR(brightness(Cut::kThreshold, integrator), geometry, 0.003 * geometry);
  }
}

// Through instances, one of them mirrored, as well.
TEST(Opacity, IsThatOfInstances) {
  SceneMaker maker(kTowardsOrigin);
  maker.add(card(-9, maker.material(test::lambert(0), Rgb::gray(2)), 9));
  const auto veil = translucent(maker, test::lambert(0), 0.25f);
  const auto hidden = maker.material(test::lambert(0));
  maker.description().objects = {{"lantern", {SphereDescription{{0, 0, 0}, 1, veil}, card(0, hidden)}, {}},
                                 {"cards", {card(0, hidden)}, {}}};
  const Transform squeezed{{-1, 0, 0}, {0, 2, 0}, {0, 0, 0.5f}, {0, 0, -4}};
  maker.add(InstanceDescription{0, squeezed, veil});
  maker.add(InstanceDescription{1, translation({0, 0, 1}), veil});
  expect_radiance(maker.build(), 2 * std::pow(0.75, 4), 4000);
}

TEST(Opacity, IsReadFromTheRedChannelAndHeldToOne) {
  SceneMaker maker(kTowardsOrigin);
  maker.description().textures = {texture_of(2, 1, {7, -3})};
  maker.add(card(-1, maker.material(test::lambert(0), Rgb::gray(2)), 9));
  const auto cut = maker.material(test::lambert(0));
  maker.description().materials[cut].opacity = {1, 0};
  for (const float u : {0.1f, 0.9f}) {
    SceneDescription description = maker.description();
    description.shapes.push_back(QuadDescription{{-2 * u, -1, 0}, {2, 0, 0}, {0, 2, 0}, cut});
    const double expected = u < 0.5f ? 0 : 2;
    EXPECT_NEAR(mean_radiance(Scene::build(description, 1).value(), {}, 16).value, expected, 1e-6);
  }
}

TEST(Opacity, OfASingleTexelIsANumber) {
  SceneMaker maker(kTowardsOrigin);
  maker.description().textures = {texture_of(1, 1, {1})};
  const auto white = maker.material(test::lambert(0.5f));
  maker.description().materials[white].opacity = {1, 0};
  EXPECT_TRUE(maker.build().is_opaque());
  maker.description().textures.push_back(
      {.image = nullptr, .procedural = ProceduralTexture{.pattern = StepPattern{{Rgb::gray(1), 0}, 1}}});
  maker.description().materials[white].opacity = {1, 1};
  EXPECT_TRUE(maker.build().is_opaque());
  maker.description().materials[white].opacity = {0.5f, 0};
  EXPECT_FALSE(maker.build().is_opaque());
}

// A wall of opacity 0 changes nothing but the roundings of what is behind. Without a guide, which would be
// built of other photons.
TEST(Opacity, OfZeroIsNoSurface) {
  const auto brightness = [](bool wall, Integrator integrator) {
    SceneMaker maker({});
    maker.description() = test::room();
    const auto nothing = translucent(maker, test::lambert(0.5f), 0);
    for (Material& material : maker.description().materials)
      if (std::holds_alternative<Mirror>(material.model) || std::holds_alternative<Glass>(material.model))
        material.model = Glass{.roughness = 0.5f};
    if (wall) {
      maker.add(QuadDescription{{-1, 0, 0.9f}, {2, 0, 0}, {0, 2, 0}, nothing});
      maker.add(SphereDescription{{0, 1, 0}, 0.9f, nothing});
    }
    return mean_radiance(maker.build(), {.integrator = integrator}, 64, 16).value;
  };
  for (const Integrator integrator :
       {Integrator::kNaive, Integrator::kNee, Integrator::kMis, Integrator::kWhitted}) {
    const double free = brightness(false, integrator);
    EXPECT_NEAR(brightness(true, integrator), free, 1e-4 * free) << integrator_name(integrator);
  }
}

// Stacks of cards: rays and shadow rays cross them all, or end.
TEST(Opacity, CrossesManySurfacesAndEnds) {
  const auto brightness = [](int cards, float opacity, Integrator integrator) {
    SceneMaker maker({.position = {0, 0, 4}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 2});
    maker.add(card(-1, maker.material(test::lambert(1))));
    maker.description().lights = {DirectionalLightDescription{{0.01f, 0.01f, -1}, Rgb::gray(2)}};
    const auto veil = translucent(maker, test::lambert(0), opacity);
    MeshDescription stack{
        .positions = {}, .normals = {}, .uvs = {}, .triangles = {}, .triangle_materials = {veil}};
    for (int i = 0; i < cards; ++i) {
      const auto first = static_cast<std::uint32_t>(stack.positions.size());
      const float z = 2.0f * static_cast<float>(i) / static_cast<float>(cards);
      for (const Vec3 corner : {Vec3{-9, -9, z}, Vec3{9, -9, z}, Vec3{0, 9, z}})
        stack.positions.push_back(corner);
      stack.triangles.push_back({first, first + 1, first + 2});
    }
    maker.add(stack);
    return mean_radiance(maker.build(), {.integrator = integrator, .max_depth = 1}, 16, 2).value;
  };
  const double free = 2 / M_PI;
  for (const Integrator integrator : {Integrator::kMis, Integrator::kWhitted}) {
    EXPECT_NEAR(brightness(5000, 1e-12f, integrator), free, 1e-3);
    EXPECT_EQ(brightness(kMaxCrossings + 100, 1e-12f, integrator), 0);
    EXPECT_NEAR(brightness(kMaxCrossings + 100, 0, integrator), free, 1e-3);
  }
  EXPECT_NEAR(brightness(50, 1e-3f, Integrator::kWhitted), free * std::pow(0.999, 100), 0.1);
}

TEST(Transmittance, IsTheProductOfWhatEachSurfaceLetsThrough) {
  SceneMaker maker(kTowardsOrigin);
  maker.add(card(1, translucent(maker, Glass{}, 0.5f)));
  maker.add(card(2, translucent(maker, Mirror{}, 0.25f)));
  maker.add(card(4, maker.material(test::lambert(0.5f))));
  const Scene scene = maker.build();
  const auto share = [&](float length) {
    std::uint64_t traced = 0;
    return transmittance(scene, {{0, 0, 0}, {0, 0, length}, 1}, {}, traced);
  };
  EXPECT_EQ(share(0.9f), Rgb::gray(1));
  EXPECT_EQ(share(1.5f), Rgb::gray(0.5f));
  EXPECT_EQ(share(3), Rgb::gray(0.375f));
  EXPECT_EQ(share(5), Rgb{});
  std::uint64_t traced = 0;
  EXPECT_EQ(transmittance(scene, {{0.1f, 0, 3}, {0, 0, -2}}, {}, traced), Rgb::gray(0.375f));
}

// A floor under a pane sees the lamps through it: at once, so that no depth is needed, and with every
// strategy.
TEST(Pane, LetsLightPassStraight) {
  const auto brightness = [](bool pane, const LightDescription& light, Integrator integrator) {
    SceneMaker maker({.position = {0, -3, 0.5f}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 2});
    maker.add(card(0, maker.material(test::lambert(0.5f))));
    if (pane) maker.add(card(1, maker.material(ThinDielectric{.transmittance = {{0.5f, 1, 1}}}), 50));
    maker.description().lights = {light};
    return mean_radiance(maker.build(), {.integrator = integrator, .max_depth = 1}, 64).value;
  };
  const LightDescription lamp = DirectionalLightDescription{{0, 0, -1}, Rgb::gray(2)};
  for (const Integrator integrator :
       {Integrator::kNaive, Integrator::kNee, Integrator::kMis, Integrator::kWhitted}) {
    const double free = brightness(false, lamp, integrator);
    EXPECT_GT(free, 0.01);
    EXPECT_NEAR(brightness(true, lamp, integrator), 0.5 * (1 - 0.08 / 1.04) * free, 1e-4 * free);
  }
}

// In a lamp around everything a pane neither takes nor adds light, whatever the strategy.
TEST(Pane, LosesNothingInAWhiteFurnace) {
  SceneMaker maker({.position = {0, -3, 0.5f}, .look_at = {0, 0, 0.2f}, .vertical_fov_degrees = 40});
  maker.add(card(0, maker.material(test::lambert(1))));
  maker.add(SphereDescription{{0, 0, 0}, 20, maker.material(test::lambert(0), Rgb::gray(3))});
  maker.add(card(0.7f, maker.material(ThinDielectric{}), 2));
  expect_radiance(maker.build(), 3, 500);
}

// The room with translucent materials of every kind.
SceneDescription translucent_room() {
  SceneDescription room = test::room();
  room.textures = {texture_of(2, 2, {0, 1, 0.5f, 1})};
  room.textures[0].scale = {3, 3};
  room.textures[0].wrap = Wrap::kRepeat;
  for (Material& material : room.materials) material.opacity = {0.9f, 0};
  room.materials[0].opacity = 0.7f;
  room.environment = {{Rgb::gray(0.2f)}};
  return room;
}

TEST(Opacity, LeavesSamplesPureFunctions) {
  const Scene scene = Scene::build(translucent_room(), 2).value();
  for (const Integrator integrator :
       {Integrator::kNaive, Integrator::kNee, Integrator::kMis, Integrator::kWhitted}) {
    RenderSettings settings = scene.settings();
    settings.integrator = integrator;
    const TileGrid grid(settings.width_px, settings.height_px, 16);
    const PixelRect whole{0, 0, settings.width_px, settings.height_px};
    const RenderPlan plan = prepare(scene, settings, 2);
    const FilmTile one = render(plan, whole, {0, settings.spp}, 1);
    const FilmTile many = render(plan, whole, {0, settings.spp}, 3);
    ASSERT_EQ(one.sums, many.sums) << integrator_name(integrator);
    ASSERT_EQ(one.counters, many.counters) << integrator_name(integrator);
    Film expected(grid), film(grid);
    expected.add(one);
    for (int tile = grid.tile_count() - 1; tile >= 0; --tile)
      for (const SampleRange range : {SampleRange{3, settings.spp}, SampleRange{0, 3}})
        film.add(render(plan, grid.rect(tile), range, 2));
    ASSERT_TRUE(film == expected) << integrator_name(integrator);
  }
}

}  // namespace
}  // namespace tessera::core::integrators::opacity_test
