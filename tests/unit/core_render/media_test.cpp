// SPDX-License-Identifier: Apache-2.0
// Participating media: what is known in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/integrators/volume_path.hpp"
#include "core/math/elementary.hpp"
#include "core/media/phase_function.hpp"
#include "core/media/tracking.hpp"
#include "core/sampling/sampler.hpp"
#include "tests/support/mean_radiance.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

using test::mean_radiance;

// A grid whose density varies by a factor of nine along x, and less along the other axes.
VoxelGrid uneven_grid() {
  VoxelGrid grid{.size = {5, 3, 2}};
  for (std::uint32_t i = 0; i < 30; ++i)
    grid.values.push_back(0.2f + 0.4f * static_cast<float>(i % 5) + 0.1f * static_cast<float>(i / 5 % 3));
  return grid;
}

MediumDescription filled_by_grid(MediumDescription medium, const Transform& to_world) {
  medium.absorption_grid = medium.scattering_grid = 0;
  medium.grid_to_world = to_world;
  return medium;
}

Medium medium_of(const MediumDescription& description) {
  return {description, std::make_shared<const std::vector<VoxelGrid>>(1, uneven_grid())};
}

// The transmittance of a ray through a medium by the midpoint rule.
Rgb transmittance_by_steps(const Medium& medium, const Ray& ray, float t_max) {
  constexpr int kSteps = 4000;
  const MediumRay way(medium, ray, t_max);
  Rgb depth;
  for (int i = 0; i < kSteps; ++i) {
    const float t = (static_cast<float>(i) + 0.5f) / kSteps * t_max;
    depth += way.at(t).sigma_t() * (length(ray.direction) * t_max / kSteps);
  }
  return beam_transmittance(depth, 1);
}

// The mean over samples, with a third of them for each hero channel.
template <typename Estimate>
Rgb mean_over_heroes(int samples, const Estimate& estimate) {
  Rgb sum;
  for (int i = 0; i < samples; ++i) {
    sampling::NumberStream numbers =
        sampling::Sampler(1, 0, i % 3, static_cast<std::uint32_t>(i / 3)).stream(7, sampling::medium_pad(3));
    sum += estimate(i % 3, numbers);
  }
  return sum / static_cast<float>(samples);
}

void expect_near(Rgb value, Rgb expected, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], expected[c], tolerance) << "channel " << c;
}

const Ray kOblique{{-0.5f, 0.3f, 0.1f}, {2, 0.5f, 0.4f}};

// Unit-cube grids scaled to [0, 2]^3 and moved.
const Transform kPlace = compose(translation({-0.2f, 0, -0.3f}), scaling({2, 2, 2}));

TEST(Tracking, RatioTrackingHasTheExpectationOfTheTransmittance) {
  const Medium medium =
      medium_of(filled_by_grid({.sigma_a = {0.1f, 0.3f, 0.2f}, .sigma_s = {0.4f, 0.1f, 1.2f}}, kPlace));
  ASSERT_FALSE(medium.is_homogeneous());
  const Rgb mean_estimate = mean_over_heroes(30000, [&](int hero, sampling::NumberStream& numbers) {
    SpectralWeights weights;
    estimate_transmittance(medium, kOblique, 1, hero, numbers, weights);
    return weights.throughput / mean(weights.light);
  });
  const Rgb expected = transmittance_by_steps(medium, kOblique, 1);
  EXPECT_GT(expected.g, 0.3f);
  EXPECT_LT(expected.b, 0.3f);
  expect_near(mean_estimate, expected, 0.01f);
}

TEST(Tracking, OfAGridOfOnesEqualsAHomogeneousMedium) {
  MediumDescription description{.sigma_a = {0.3f, 0.2f, 0.1f}, .sigma_s = {0.2f, 0.7f, 0.4f}};
  const Medium homogeneous(description, nullptr);
  description.absorption_grid = description.scattering_grid = 0;
  const VoxelGrid ones{.size = {2, 2, 2}, .values = std::vector<float>(8, 1)};
  const Medium gridded(description, std::make_shared<const std::vector<VoxelGrid>>(1, ones));
  const Ray ray{{0.5f, 0.5f, 0}, {0, 0, 2}};
  for (const Medium* medium : {&homogeneous, &gridded}) {
    const Rgb passing = mean_over_heroes(30000, [&](int hero, sampling::NumberStream& numbers) {
      SpectralWeights weights;
      const Collision collision = sample_collision(*medium, ray, 0.5f, hero, numbers, weights);
      return collision.t ? Rgb{} : weights.throughput / mean(weights.unidirectional);
    });
    expect_near(passing, beam_transmittance({0.5f, 0.9f, 0.5f}, 1), 0.01f);
  }
}

// The expected weight of scattering is the integral of sigma_s times the transmittance.
TEST(Tracking, ScattersInProportionToSigmaS) {
  const Rgb sigma_a{0.4f, 0.1f, 0}, sigma_s{0.2f, 1, 3};
  const Medium medium(MediumDescription{.sigma_a = sigma_a, .sigma_s = sigma_s}, nullptr);
  const Ray ray{{0, 0, 0}, {0, 0, 1}};
  const Rgb scattered = mean_over_heroes(60000, [&](int hero, sampling::NumberStream& numbers) {
    SpectralWeights weights;
    const Collision collision = sample_collision(medium, ray, 1.5f, hero, numbers, weights);
    return collision.t ? weights.throughput / mean(weights.unidirectional) : Rgb{};
  });
  const Rgb sigma_t = sigma_a + sigma_s, lost = Rgb::gray(1) - beam_transmittance(sigma_t, 1.5);
  expect_near(scattered, {sigma_s.r / sigma_t.r * lost.r, sigma_s.g / sigma_t.g * lost.g, lost.b}, 0.01f);
}

// Otherwise a hostile grid would take forever.
TEST(Tracking, EndsInGridsOfEnormousDifferences) {
  const VoxelGrid spike{
      .size = {2, 2, 2}, .values = {1e30f, 0, 0, 0, 0, 0, 0, 0}, .filter = GridFilter::kNearest};
  const Medium medium({.sigma_s = Rgb::gray(1), .scattering_grid = 0},
                      std::make_shared<const std::vector<VoxelGrid>>(1, spike));
  const Ray ray{{0.75f, 0.75f, 0}, {0, 0, 1}};
  SpectralWeights weights, shadow;
  sampling::NumberStream numbers = sampling::Sampler(0, 0, 0, 0).stream(0, 0);
  EXPECT_FALSE(sample_collision(medium, ray, 1, 0, numbers, weights).t);
  EXPECT_EQ(weights.throughput, Rgb{});
  estimate_transmittance(medium, ray, 1, 0, numbers, shadow);
  EXPECT_EQ(shadow.throughput, Rgb{});
}

TEST(VoxelGrid, InterpolatesAndEndsAtTheCube) {
  VoxelGrid grid{.size = {2, 1, 1}, .values = {1, 3}};
  EXPECT_EQ(value_at(grid, {0.5f, 0.5f, 0.5f}), Rgb::gray(2));
  EXPECT_EQ(value_at(grid, {0.1f, 0.5f, 0.5f}), Rgb::gray(1));  // clamped
  EXPECT_EQ(value_at(grid, {1.01f, 0.5f, 0.5f}), Rgb{});
  grid.border = GridBorder::kZero;
  EXPECT_EQ(value_at(grid, {0, 0.5f, 0.5f}), Rgb::gray(0.5f));
  grid.filter = GridFilter::kNearest;
  EXPECT_EQ(value_at(grid, {0.49f, 0, 0}), Rgb::gray(1));
  EXPECT_EQ(value_at(grid, {1, 1, 1}), Rgb::gray(3));
}

TEST(PhaseFunction, SamplesItsDensity) {
  for (const float g : {-0.7f, 0.0f, 0.001f, 0.9f}) {
    double mean_cosine = 0, total = 0;
    constexpr int kSamples = 20000;
    for (int i = 0; i < kSamples; ++i) {
      const float u = (static_cast<float>(i) + 0.5f) / kSamples;
      mean_cosine += static_cast<double>(sample_henyey_greenstein(g, {0, 0, 1}, {u, 0.3f}).z) / kSamples;
      total +=
          2 * static_cast<double>(henyey_greenstein(g, 2 * u - 1)) * static_cast<double>(2 * kPi) / kSamples;
    }
    EXPECT_NEAR(mean_cosine, g, 1e-3) << g;
    EXPECT_NEAR(total, 1, 1e-3) << g;
  }
}

// A boundary without surface.
std::uint32_t null_boundary(test::SceneMaker& maker, int medium) {
  const std::uint32_t material = maker.material(Null{});
  maker.description().materials[material].media.interior = medium;
  return material;
}

constexpr CameraDescription kTowardCenter{
    .position = {0, 0, 5}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 20};

// A sphere of `medium` in an environment of even radiance.
Scene sphere_of(const MediumDescription& medium, float surroundings,
                const std::function<std::uint32_t(test::SceneMaker&)>& boundary) {
  test::SceneMaker maker(kTowardCenter);
  maker.description().media = {medium};
  maker.description().grids = {uneven_grid()};
  maker.add(SphereDescription{{0, 0, 0}, 1, boundary(maker)});
  maker.description().environment = {{Rgb::gray(surroundings)}};
  return maker.build();
}

const Transform kAroundSphere = compose(translation({-1, -1, -1}), scaling({2, 2, 2}));

std::uint32_t null_around(test::SceneMaker& maker) {
  return null_boundary(maker, 0);
}

std::uint32_t glass_around(test::SceneMaker& maker) {
  const std::uint32_t material = maker.material(Glass{});
  maker.description().materials[material].media.interior = 0;
  return material;
}

// Every strategy finds the radiance `expected`.
void expect_even(const Scene& scene, double expected) {
  for (const test::Strategy& strategy : test::kStrategies) {
    const test::Mean mean =
        mean_radiance(scene, {.integrator = strategy.integrator, .heuristic = strategy.heuristic}, 150);
    EXPECT_NEAR(mean.value, expected, 5 * mean.standard_error + 1e-4 * expected) << strategy.name;
    EXPECT_LT(mean.standard_error, 0.04 * expected) << strategy.name << " is too noisy to tell";
  }
}

// A medium that absorbs nothing is invisible in a white furnace.
TEST(MediaFurnace, MediaThatOnlyScatterAreInvisible) {
  const MediumDescription colored{.sigma_s = {0.4f, 0.8f, 1.6f}, .g = 0.4f};
  expect_even(sphere_of(colored, 1, null_around), 1);
  expect_even(sphere_of(filled_by_grid(colored, kAroundSphere), 1, null_around), 1);
  expect_even(sphere_of(colored, 1, glass_around), 1);
}

// In thermal equilibrium with its surroundings a medium is invisible, too (Kirchhoff's law). Inside glass,
// radiance in equilibrium is the square of the index times as large.
TEST(MediaFurnace, MediaThatEmitWhatTheyAbsorbAreInvisible) {
  const MediumDescription glowing{
      .sigma_a = {0.6f, 0.2f, 1}, .sigma_s = {0.5f, 1, 0.3f}, .g = -0.3f, .emission = Rgb::gray(0.5f)};
  MediumDescription fire = glowing;
  fire.sigma_s = {};
  for (MediumDescription medium : {glowing, fire}) {
    expect_even(sphere_of(medium, 0.5f, null_around), 0.5);
    expect_even(sphere_of(filled_by_grid(medium, kAroundSphere), 0.5f, null_around), 0.5);
    medium.emission *= 1.5f * 1.5f;
    expect_even(sphere_of(medium, 0.5f, glass_around), 0.5);
  }
}

// A box of a medium from -1 to 1 along each axis.
void add_box(test::SceneMaker& maker, std::uint32_t material) {
  const Vec3 axes[] = {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}};
  for (int a = 0; a < 3; ++a) {
    const Vec3 u = axes[(a + 1) % 3], v = axes[(a + 2) % 3];
    maker.add(QuadDescription{Vec3{-1, -1, -1} + axes[a], u, v, material});
    maker.add(QuadDescription{{-1, -1, -1}, v, u, material});
  }
}

CameraDescription narrow(Vec3 position, Vec3 look_at) {
  return {.position = position, .look_at = look_at, .vertical_fov_degrees = 0.01f};
}

TEST(Media, ASlabTransmitsByBeersLaw) {
  test::SceneMaker maker(narrow({0, 0.2f, 5}, {0, 0.2f, 0}));
  maker.description().media = {{.sigma_a = {0.2f, 0.7f, 3}, .scale = 0.5f}};
  add_box(maker, null_boundary(maker, 0));
  maker.description().environment = {{Rgb::gray(1)}};
  const Scene scene = maker.build();
  EXPECT_TRUE(scene.has_media());
  RenderCounters counters;
  const Ray ray{{0, 0, 5}, {0, 0, -1}};
  expect_near(trace_volume_path(prepare(scene, {}, 1), sampling::Sampler(0, 0, 0, 0), ray, counters),
              beam_transmittance({0.1f, 0.35f, 1.5f}, 2), 1e-5f);
}

// Light from above, once scattered: sigma_s / sigma_t (1 - exp(-sigma_t D)) exp(-sigma_t h) p E.
TEST(Media, ScatterLightOnceAsInClosedForm) {
  const float g = 0.3f, sigma_s = 0.6f, sigma_t = 0.8f, depth = 0.75f;
  test::SceneMaker maker(narrow({0, 1 - depth, 5}, {0, 1 - depth, 0}));
  maker.description().media = {
      {.sigma_a = Rgb::gray(sigma_t - sigma_s), .sigma_s = Rgb::gray(sigma_s), .g = g}};
  add_box(maker, null_boundary(maker, 0));
  maker.description().lights = {DirectionalLightDescription{{0, -1, 0}, Rgb::gray(10)}};
  maker.description().settings.max_depth = 1;
  const double expected =
      static_cast<double>(sigma_s / sigma_t * (1 - static_cast<float>(exp(-2.0 * 0.8))) *
                          static_cast<float>(exp(-0.75 * 0.8)) * henyey_greenstein(g, 0) * 10);
  const Scene scene = maker.build();
  for (const test::Strategy& strategy : test::kStrategies) {
    const test::Mean mean = mean_radiance(
        scene, {.integrator = strategy.integrator, .heuristic = strategy.heuristic, .max_depth = 1}, 500);
    EXPECT_NEAR(mean.value, expected, 5 * mean.standard_error + 1e-4 * expected) << strategy.name;
  }
}

// A lamp seen and lit through fog around the camera, and a scatterer between: all strategies agree.
TEST(Media, LightAroundTheCameraIsFoundByAllStrategies) {
  test::SceneMaker maker({.position = {0, 0, 3}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 60});
  maker.description().media = {{.sigma_a = {0.05f, 0.1f, 0.02f}, .sigma_s = {0.3f, 0.1f, 0.5f}, .g = 0.5f},
                               filled_by_grid({.sigma_s = {2, 3, 1}}, kAroundSphere)};
  maker.description().grids = {uneven_grid()};
  maker.description().camera_medium = 0;
  const std::uint32_t smoke = null_boundary(maker, 1);
  maker.description().materials[smoke].media.exterior = 0;
  maker.add(SphereDescription{{0, 0, 0}, 0.8f, smoke});
  maker.add(QuadDescription{{-2, -1, -2}, {0, 0, 5}, {4, 0, 0}, maker.material(test::lambert(0.6f))});
  maker.add(SphereDescription{{0, 2, 0}, 0.7f, maker.material(test::lambert(0), Rgb::gray(5))});
  const Scene scene = maker.build();
  const test::Mean reference =
      mean_radiance(scene, {.seed = 1, .integrator = Integrator::kMis, .max_depth = 4}, 1000);
  for (const test::Strategy& strategy : test::kStrategies) {
    const test::Mean mean = mean_radiance(
        scene, {.integrator = strategy.integrator, .heuristic = strategy.heuristic, .max_depth = 4},
        strategy.integrator == Integrator::kNaive ? 2000 : 600);
    const double tolerance = strategy.integrator == Integrator::kNaive ? 0.08 : 0.03;
    EXPECT_NEAR(mean.value, reference.value, tolerance * reference.value) << strategy.name;
  }
}

TEST(Media, HaveTheSameBytesHoweverAnImageIsDivided) {
  test::SceneMaker maker({.position = {0, 0, 3}, .look_at = {0, 0, 0}});
  maker.description().media = {
      filled_by_grid({.sigma_a = {0, 0.5f, 1}, .sigma_s = {2, 3, 1}}, kAroundSphere)};
  maker.description().grids = {uneven_grid()};
  maker.add(SphereDescription{{0, 0, 0}, 0.9f, null_around(maker)});
  maker.description().environment = {{Rgb::gray(1)}};
  const Scene scene = maker.build();
  const RenderSettings settings{.width_px = 20, .height_px = 12, .spp = 4};
  const RenderPlan plan = prepare(scene, settings, 2);
  const FilmTile whole = render(plan, {0, 0, 20, 12}, {0, 4}, 2);
  std::vector<std::uint64_t> sums(whole.sums.size());
  for (const PixelRect part : {PixelRect{0, 0, 7, 12}, PixelRect{7, 0, 20, 12}})
    for (std::uint32_t s = 0; s < 4; ++s) {
      const FilmTile tile = render(plan, part, {s, s + 1}, 1);
      for (int y = part.y0; y < part.y1; ++y)
        for (int x = part.x0; x < part.x1; ++x)
          for (int c = 0; c < 3; ++c)
            sums[static_cast<std::size_t>(3 * (y * 20 + x) + c)] +=
                tile.sums[static_cast<std::size_t>(3 * ((y - part.y0) * part.width() + x - part.x0) + c)];
    }
  EXPECT_EQ(sums, whole.sums);
}

// A scene that describes media and uses none is rendered as without.
TEST(Media, UnusedChangeNothing) {
  SceneDescription room = test::room();
  room.settings.integrator = Integrator::kNaive;
  const PixelRect all{0, 0, room.settings.width_px, room.settings.height_px};
  const auto sums_of = [&](const SceneDescription& description) {
    const Scene scene = Scene::build(description, 1).value();
    EXPECT_FALSE(scene.has_media());
    return render(prepare(scene, description.settings, 1), all, {0, 2}, 1).sums;
  };
  const auto before = sums_of(room);
  room.media = {{.sigma_a = Rgb::gray(1)}};
  room.materials[0].media = {0, 0};
  EXPECT_EQ(sums_of(room), before);
}

TEST(Media, RefuseWhatCannotBeComputed) {
  const auto mistake_of = [](const std::function<void(SceneDescription&)>& spoil) {
    SceneDescription scene = test::room();
    scene.grids = {uneven_grid()};
    scene.media = {{.name = "fog", .sigma_s = Rgb::gray(1)}};
    spoil(scene);
    const auto built = Scene::build(scene, 1);
    return built ? std::string("no mistake") : built.error().message;
  };
  const auto expect_mistake = [&](const std::string& part,
                                  const std::function<void(SceneDescription&)>& spoil) {
    const std::string message = mistake_of(spoil);
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  EXPECT_EQ(mistake_of([](SceneDescription&) {}), "no mistake");
  expect_mistake("g must be", [](SceneDescription& s) { s.media[0].g = 1; });
  expect_mistake("sigma_s", [](SceneDescription& s) { s.media[0].sigma_s.g = -1; });
  expect_mistake("no such grid", [](SceneDescription& s) { s.media[0].emission_grid = 1; });
  expect_mistake("grid 0", [](SceneDescription& s) { s.grids[0].values.pop_back(); });
  expect_mistake("flattens", [](SceneDescription& s) {
    s.media[0].absorption_grid = 0;
    s.media[0].grid_to_world.x_axis = {};
  });
  expect_mistake("no such medium", [](SceneDescription& s) { s.camera_medium = 1; });
  expect_mistake("no such medium", [](SceneDescription& s) { s.materials[1].media.exterior = 1; });
}

}  // namespace
}  // namespace tessera::core::integrators
