// SPDX-License-Identifier: Apache-2.0
// Dielectrics that overlap: their surfaces count by priority, in closed form and as exact contact surfaces.
#include "core/scene/nested_dielectrics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/materials/fresnel.hpp"
#include "core/math/elementary.hpp"
#include "core/scene/priorities.hpp"
#include "tests/support/mean_radiance.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators::nested_dielectrics_test {
namespace {

using test::expect_radiance;
using test::mean_radiance;
using test::SceneMaker;

constexpr CameraDescription kAlongZ{
    .position = {0, 0, 6}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 0.5f};

Glass glass(float ior, float priority = 0, float roughness = 0) {
  Glass glass;
  glass.ior = ior;
  glass.priority = priority;
  glass.roughness = roughness;
  return glass;
}

Principled clear_solid(float ior, float priority) {
  Principled solid;
  solid.specular_ior = ior;
  solid.specular_roughness = 0;
  solid.transmission_weight = 1;
  solid.priority = priority;
  return solid;
}

// At this height, wide enough for all rays, with the outside towards growing or falling z.
QuadDescription face(float z, bool up, std::uint32_t material) {
  const float w = 50;
  if (up) return {{-w, -w, z}, {2 * w, 0, 0}, {0, 2 * w, 0}, material};
  return {{-w, -w, z}, {0, 2 * w, 0}, {2 * w, 0, 0}, material};
}

void add_slab(SceneMaker& maker, float bottom, float top, std::uint32_t material) {
  maker.add(face(top, true, material));
  maker.add(face(bottom, false, material));
}

// Two slabs that overlap between -0.5 and 0.5, before what emits 1.
SceneMaker overlapping_slabs(const MaterialModel& upper, const MaterialModel& lower) {
  SceneMaker maker(kAlongZ);
  add_slab(maker, -0.5f, 1, maker.material(upper));
  add_slab(maker, -1, 0.5f, maker.material(lower));
  maker.add(face(-3, true, maker.material(test::lambert(0), Rgb::gray(1))));
  return maker;
}

// What passes three boundaries between four indices at normal incidence, with all reflections in between.
double transmittance_of_stack(double first, double second) {
  const auto reflected = [](double a, double b) { return normal_reflectance(b / a); };
  const double r1 = reflected(1, first), r2 = reflected(first, second), r3 = reflected(second, 1);
  const double both = (1 - r1) * (1 - r2) / (1 - r1 * r2);
  const double from_below = r2 + (1 - r2) * (1 - r2) * r1 / (1 - r1 * r2);
  return both * (1 - r3) / (1 - from_below * r3);
}

void expect_transmitted(const Scene& scene, double expected) {
  expect_radiance(scene, expected, 2000);
  const auto whitted = mean_radiance(scene, {.integrator = Integrator::kWhitted, .max_depth = 40}, 4);
  EXPECT_NEAR(whitted.value, expected, 2e-3 * expected);
}

TEST(NestedDielectrics, FillTheirCommonSpaceByPriority) {
  for (const float of_lower : {1.0f, 3.0f})
    expect_transmitted(overlapping_slabs(glass(1.5f, 2), glass(2.2f, of_lower)).build(),
                       transmittance_of_stack(1.5, 2.2));
}

TEST(NestedDielectrics, HaveNoBoundaryBetweenEqualIndices) {
  expect_transmitted(overlapping_slabs(glass(1.7f, 2), glass(1.7f, 1)).build(),
                     transmittance_of_stack(1.7, 1.7));
}

TEST(NestedDielectrics, AreUnitedWhereTheyHaveTheSameMaterial) {
  SceneMaker maker(kAlongZ);
  const auto material = maker.material(glass(1.7f, 1));
  add_slab(maker, -0.5f, 1, material);
  add_slab(maker, -1, 0.5f, material);
  maker.add(face(-3, true, maker.material(test::lambert(0), Rgb::gray(1))));
  expect_transmitted(maker.build(), transmittance_of_stack(1.7, 1.7));
}

TEST(NestedDielectrics, OfOneMaterialOverlapInAnyNumber) {
  SceneMaker maker(kAlongZ);
  const auto material = maker.material(glass(1.7f, 1)), middle = maker.material(glass(1.2f, 2));
  for (int i = 0; i < 40; ++i)
    add_slab(maker, -1 - 0.01f * static_cast<float>(i), 1 + 0.01f * static_cast<float>(i), material);
  for (int i = 0; i < 3; ++i)
    add_slab(maker, -0.2f - 0.01f * static_cast<float>(i), 0.2f + 0.01f * static_cast<float>(i), middle);
  maker.add(face(-3, true, maker.material(test::lambert(0), Rgb::gray(1))));
  const double r = normal_reflectance(1.7), s = normal_reflectance(1.7 / 1.2);
  const double both = (1 - s) * (1 - s) / (1 - s * s), reflected = s + (1 - s) * (1 - s) * s / (1 - s * s);
  // The boundaries to the air, around what both of the middle transmit and reflect.
  const double top = (1 - r) * both / (1 - r * reflected),
               back = reflected + both * both * r / (1 - r * reflected);
  expect_transmitted(maker.build(), top * (1 - r) / (1 - back * r));
}

TEST(NestedDielectrics, CanBePrincipled) {
  expect_transmitted(overlapping_slabs(clear_solid(1.5f, 1), glass(2.2f, 2)).build(),
                     transmittance_of_stack(1.5, 2.2));
  expect_transmitted(overlapping_slabs(glass(2.2f, 2), clear_solid(1.5f, 1)).build(),
                     transmittance_of_stack(2.2, 1.5));
  expect_transmitted(overlapping_slabs(clear_solid(1.5f, 2), glass(2.2f, 1)).build(),
                     transmittance_of_stack(1.5, 2.2));
}

// The image of a ball in another one, from the side.
FilmTile image_of_balls(const Glass& outer, const Glass& inner, Integrator integrator) {
  SceneMaker maker({.position = {0, 1, 5}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 34});
  maker.add(SphereDescription{{0, 0, 0}, 1, maker.material(outer)});
  maker.add(SphereDescription{{0.2f, 0.1f, 0.1f}, 0.5f, maker.material(inner)});
  maker.add(SphereDescription{{-2, 3, 1}, 0.4f, maker.material(test::lambert(0), Rgb::gray(20))});
  maker.add(QuadDescription{{-9, -1, 9}, {18, 0, 0}, {0, 0, -18}, maker.material(test::lambert(0.6f))});
  maker.description().environment = {{Rgb{0.3f, 0.4f, 0.6f}}};
  const RenderSettings settings{.width_px = 24, .height_px = 24, .spp = 8, .integrator = integrator};
  const Scene scene = maker.build();
  return render(prepare(scene, settings, 1), {0, 0, 24, 24}, {0, 8}, 1);
}

// A liquid in glass is what a boundary with the ratio of both indices is, byte for byte.
TEST(NestedDielectrics, AreSeenAsBoundariesOfTheRatioOfTheIndices) {
  for (const Integrator integrator : {Integrator::kMis, Integrator::kNaive, Integrator::kWhitted})
    for (const float roughness : {0.0f, 0.4f}) {
      const FilmTile nested =
          image_of_balls(glass(1.25f, 1, roughness), glass(1.5625f, 2, roughness), integrator);
      const FilmTile plain =
          image_of_balls(glass(1.25f, 0, roughness), glass(1.25f, 0, roughness), integrator);
      EXPECT_EQ(nested.sums, plain.sums);
    }
}

// A ball of liquid that lies in glass altogether cannot be seen, whatever its size.
TEST(NestedDielectrics, EndInWhatHasAHigherPriority) {
  const auto radiance = [](float radius) {
    SceneMaker maker({.position = {0, 0, 6}, .look_at = {0.5f, 0.3f, 0}, .vertical_fov_degrees = 10});
    maker.add(SphereDescription{{0, 0, 0}, 1.5f, maker.material(glass(1.5f, 2))});
    if (radius > 0) maker.add(SphereDescription{{0, 0, 0}, radius, maker.material(glass(1.33f, 1))});
    maker.add(face(-3, true, maker.material(test::lambert(0), Rgb::gray(1))));
    maker.description().environment = {{Rgb::gray(0.1f)}};
    return mean_radiance(maker.build(), {.integrator = Integrator::kWhitted, .max_depth = 30}, 64).value;
  };
  const double alone = radiance(0);
  EXPECT_GT(alone, 0.05);
  EXPECT_NEAR(radiance(0.8f), alone, 1e-4 * alone);
  EXPECT_NEAR(radiance(1.4f), alone, 1e-4 * alone);
}

// Shadow rays pass surfaces without effect, too. Glass of the index of air hides the dense one in it.
TEST(NestedDielectrics, DoNotHideLampsWhereTheyHaveNoEffect) {
  SceneMaker maker({.position = {0, -12, 0.5f}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 2});
  maker.add(QuadDescription{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(test::lambert(1))});
  maker.add(SphereDescription{{0, 0, 0}, 2, maker.material(glass(1.8f, 1))});
  maker.add(SphereDescription{{0, 0, 0}, 3, maker.material(glass(1, 2))});
  maker.add(SphereDescription{{0, 0, 0}, 20, maker.material(test::lambert(0), Rgb::gray(3))});
  expect_radiance(maker.build(), 3, 500);
}

// Each absorbs where it fills the space.
TEST(NestedDielectrics, HaveTheirMediaInside) {
  constexpr float kUpper = 0.4f, kLower = 0.9f;
  for (const bool upper_wins : {true, false}) {
    SceneMaker maker = overlapping_slabs(glass(1, upper_wins ? 2 : 1), glass(1, upper_wins ? 1 : 2));
    maker.description().media = {{.sigma_a = Rgb::gray(kUpper)}, {.sigma_a = Rgb::gray(kLower)}};
    maker.description().materials[0].media.interior = 0;
    maker.description().materials[1].media.interior = 1;
    const double through_upper = upper_wins ? 1.5 : 0.5, through_lower = 2 - through_upper;
    expect_radiance(maker.build(),
                    std::exp(-(through_upper * double{kUpper} + through_lower * double{kLower})), 500);
  }
}

// Light that is scattered in one solid meets the boundary of the other, as if the first ended there.
TEST(NestedDielectrics, HaveTheirBoundariesForScatteredLight) {
  const auto radiance = [](float top_of_milk, float of_milk, float of_glass) {
    SceneMaker maker(kAlongZ);
    add_slab(maker, -0.5f, 1, maker.material(glass(1, of_glass)));
    add_slab(maker, -1, top_of_milk, maker.material(glass(1, of_milk)));
    maker.description().media = {{.sigma_a = Rgb::gray(0.3f), .sigma_s = Rgb::gray(2)}};
    maker.description().materials[1].media.interior = 0;
    maker.description().environment = {{Rgb::gray(1)}};
    return mean_radiance(maker.build(), {.integrator = Integrator::kMis}, 16000 / test::kSampleDivisor);
  };
  const auto nested = radiance(0.5f, 1, 2), apart = radiance(-0.5001f, 0, 0);
  EXPECT_NEAR(nested.value, apart.value, 4 * std::hypot(nested.standard_error, apart.standard_error));
  EXPECT_LT(nested.standard_error, 0.01 * nested.value);
}

TEST(NestedDielectrics, LoseNothingInAWhiteFurnace) {
  SceneMaker maker({.position = {0, 0, 5}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 30});
  maker.description().environment = {{Rgb::gray(2)}};
  maker.add(SphereDescription{{-0.4f, 0, 0}, 1, maker.material(glass(1.6f, 1))});
  maker.add(SphereDescription{{0.4f, 0, 0}, 1, maker.material(glass(1.2f, 2))});
  maker.add(SphereDescription{{0, 0.5f, 0}, 0.7f, maker.material(glass(1, 3))});  // a bubble
  expect_radiance(maker.build(), 2, 500);
}

TEST(NestedDielectrics, AreEnclosedInAnyOrder) {
  Enclosing some, others;
  for (const std::uint8_t rank : {3, 1, 2, 1}) some.add(rank);
  for (const std::uint8_t rank : {1, 2, 1, 3}) others.add(rank);
  EXPECT_EQ(some, others);
  EXPECT_EQ(some.first(), 1);
  some.remove(1);
  EXPECT_EQ(some.first(), 1);
  some.remove(1);
  some.remove(1);
  EXPECT_EQ(some.first(), 2);
  some.remove(2);
  some.remove(3);
  EXPECT_EQ(some, Enclosing{});
  for (std::uint8_t rank = 20; rank-- > 0;) some.add(rank);
  for (std::uint8_t rank = 0; rank < Enclosing::kMaxCount; ++rank) {
    EXPECT_EQ(some.first(), rank);
    some.remove(rank);
  }
  EXPECT_TRUE(some.empty());
}

std::string mistake_of(SceneMaker& maker) {
  const auto scene = Scene::build(maker.description(), 1);
  return scene ? std::string() : scene.error().message;
}

TEST(NestedDielectrics, RefuseWhatCannotBeComputed) {
  SceneMaker blend = overlapping_slabs(glass(1.5f, 1), glass(1.5f));
  blend.material(Blend{0, 1});
  EXPECT_NE(mistake_of(blend).find("blend cannot have a priority"), std::string::npos) << mistake_of(blend);
  SceneMaker lamp = overlapping_slabs(glass(1.5f, 1), glass(1.5f));
  lamp.description().materials[0].emission = {Rgb::gray(1)};
  EXPECT_NE(mistake_of(lamp).find("emits light"), std::string::npos) << mistake_of(lamp);
  SceneMaker textured = overlapping_slabs(glass(1.5f, 1), glass(1.5f));
  textured.description().textures.push_back({.image = nullptr, .procedural = ProceduralTexture{}});
  std::get<Glass>(textured.description().materials[0].model).ior.texture = 0;
  EXPECT_NE(mistake_of(textured).find("cannot be a texture"), std::string::npos) << mistake_of(textured);
  SceneMaker many = overlapping_slabs(glass(1.5f), glass(1.5f));
  for (std::size_t i = 0; i <= kMaxNestedDielectrics; ++i) many.material(glass(1.5f, 1));
  EXPECT_NE(mistake_of(many).find("at most 64 materials"), std::string::npos) << mistake_of(many);
}

}  // namespace
}  // namespace tessera::core::integrators::nested_dielectrics_test
