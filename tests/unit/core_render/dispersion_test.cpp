// SPDX-License-Identifier: Apache-2.0
// Dispersion: the wavelengths of paths, and what they see through glass, in closed form.
#include "core/materials/dispersion.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/integrators/path_wavelength.hpp"
#include "core/materials/fresnel.hpp"
#include "core/spectra/color_matching.hpp"
#include "core/spectra/spectrum_color.hpp"
#include "tests/support/mean_radiance.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

using test::SceneMaker;

constexpr std::array kAllIntegrators{Integrator::kNaive, Integrator::kNee, Integrator::kMis,
                                     Integrator::kWhitted};

TEST(Wavelengths, OfWhiteLightHaveTheMeanColorOfWhite) {
  constexpr int kCount = 1 << 20;
  std::array<double, 3> sums{};
  float last = 0;
  for (int i = 0; i < kCount; ++i) {
    const auto [nm, weight] = spectra::sample_wavelength((static_cast<float>(i) + 0.5f) / kCount);
    ASSERT_GE(nm, std::max(last, 360.0f));
    ASSERT_LE(nm, 830);
    last = nm;
    for (int c = 0; c < 3; ++c) {
      ASSERT_GE(weight[c], 0);
      sums[static_cast<std::size_t>(c)] += static_cast<double>(weight[c]);
    }
    ASSERT_NEAR(weight.r + weight.g + weight.b, 3, 1e-5);
  }
  for (const double sum : sums) EXPECT_NEAR(sum / kCount, 1, 1e-5);
}

// Schott's data sheet of N-BK7. Two terms of Cauchy's formula are exact at three lines only.
TEST(Dispersion, OfCrownGlassIsThatOfItsDataSheet) {
  const auto index = [](float nm) { return dispersed_index(1.5168f, 1 / 64.17f, cauchy_abscissa(nm)); };
  EXPECT_NEAR(index(587.56f), 1.5168, 1e-6);
  EXPECT_NEAR(index(486.13f), 1.52238, 2e-4);
  EXPECT_NEAR(index(656.27f), 1.51432, 2e-4);
  EXPECT_NEAR(index(486.13f) - index(656.27f), 0.5168 / 64.17, 1e-6);
  EXPECT_NEAR(index(435.83f), 1.52668, 5e-4);
}

TEST(Dispersion, StaysOnItsSideOfOne) {
  EXPECT_GT(dispersed_index(1.1f, 5.0f, cauchy_abscissa(800.0f)), 1);
  EXPECT_LT(dispersed_index(0.9f, 5.0f, cauchy_abscissa(800.0f)), 1);
  EXPECT_EQ(dispersed_index(1.0f, 5.0f, cauchy_abscissa(400.0f)), 1);
}

// The mean over the spectrum of white light, of what value(nm) gives, in each channel.
template <typename Value>
std::array<double, 3> spectral_mean(const Value& value) {
  std::array<double, 3> sums{}, weights{};
  for (double nm = 360.05; nm < 830; nm += 0.1) {
    const Rgb color = to_linear_rec709(spectra::color_matching(nm));
    const double seen = value(nm);
    for (int c = 0; c < 3; ++c) {
      const double weight = std::max(0.0, static_cast<double>(color[c])) * spectra::d65_power(nm);
      sums[static_cast<std::size_t>(c)] += weight * seen;
      weights[static_cast<std::size_t>(c)] += weight;
    }
  }
  for (std::size_t c = 0; c < 3; ++c) sums[c] /= weights[c];
  return sums;
}

struct Channels {
  std::array<double, 3> mean{}, standard_error{};
};
Channels mean_channels(const Scene& scene, Integrator integrator, std::uint32_t spp) {
  constexpr int kSide = 8, kPixels = kSide * kSide;
  const RenderSettings settings{.width_px = kSide, .height_px = kSide, .spp = spp, .integrator = integrator};
  const FilmTile tile = render(prepare(scene, settings, 2), {0, 0, kSide, kSide}, {0, spp}, 2);
  Channels channels;
  for (std::size_t c = 0; c < 3; ++c) {
    double sum = 0, sum2 = 0;
    for (std::size_t p = 0; p < kPixels; ++p) {
      const double v = static_cast<double>(tile.sums[3 * p + c]) * kFilmUnit / spp;
      sum += v, sum2 += v * v;
    }
    channels.mean[c] = sum / kPixels;
    const double variance = std::max(0.0, sum2 / kPixels - channels.mean[c] * channels.mean[c]);
    channels.standard_error[c] = std::sqrt(variance / (kPixels - 1));
  }
  return channels;
}

void expect_channels(const Scene& scene, const std::array<double, 3>& expected, std::uint32_t spp,
                     double tolerance = 0) {
  for (const Integrator integrator : kAllIntegrators) {
    const Channels seen = mean_channels(scene, integrator, spp);
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(seen.mean[c], expected[c], 5 * seen.standard_error[c] + (1e-4 + tolerance) * expected[c])
          << "channel " << c << ", integrator " << static_cast<int>(integrator);
      EXPECT_LT(seen.standard_error[c], 0.03);
    }
  }
}

Principled clear_solid(float ior, Dispersion dispersion, float roughness = 0) {
  Principled solid;
  solid.specular_ior = ior;
  solid.specular_roughness = roughness;
  solid.transmission_weight = 1;
  solid.transmission_dispersion = dispersion;
  return solid;
}

constexpr float kIndex = 1.6f, kAbbeNumber = 8, kLampDepth = 10;
constexpr Dispersion kStrong{2, 2 * kAbbeNumber};

// A ray meets glass at an angle of sine 0.8; where the lamp in it ends, wavelengths below `last_nm` pass by.
double refracted_offset(double nm) {
  const double n = 1.6 + 0.6 / 8 * static_cast<double>(cauchy_abscissa(static_cast<float>(nm)));
  const double sine = 0.8 / n;
  return double{kLampDepth} * sine / std::sqrt(1 - sine * sine);
}
Scene half_space_with_lamp(const MaterialModel& glass, double last_nm) {
  SceneMaker maker({.position = {-8, 0, 6}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 1e-3f});
  maker.add(QuadDescription{{-50, -50, 0}, {100, 0, 0}, {0, 100, 0}, maker.material(glass)});
  const auto end = static_cast<float>(refracted_offset(last_nm));
  maker.add(QuadDescription{
      {end, -5, -kLampDepth}, {50, 0, 0}, {0, 10, 0}, maker.material(test::lambert(0), Rgb::gray(2))});
  return maker.build();
}

// Each wavelength is deflected by Snell's law, and its radiance is that of the lamp over n².
TEST(Dispersion, DeflectsEachWavelengthBySnellsLaw) {
  const double passed = 1 - static_cast<double>(fresnel_dielectric(0.6f, kIndex));
  for (const double last_nm : {490.0, 590.0}) {
    const auto expected = spectral_mean([&](double nm) {
      const double n = 1.6 + 0.6 / 8 * static_cast<double>(cauchy_abscissa(static_cast<float>(nm)));
      return refracted_offset(nm) > refracted_offset(last_nm) ? 2 * passed / (n * n) : 0;
    });
    const MaterialModel models[] = {Glass{.ior = kIndex, .dispersion = kStrong},
                                    clear_solid(kIndex, kStrong)};
    for (const MaterialModel& model : models)
      expect_channels(half_space_with_lamp(model, last_nm), expected, 1000 / test::kSampleDivisor, 2e-3);
  }
}

Scene ball_in_furnace(const MaterialModel& model, float distance) {
  SceneMaker maker({.position = {0, 0.3f, distance}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 30});
  maker.add(SphereDescription{{0, 0, 0}, 1, maker.material(model)});
  maker.description().environment = {{Rgb::gray(1)}};
  return maker.build();
}

// The mean of white light is white: what is reflected and what is refracted add up, also by total reflection.
TEST(Dispersion, IsInvisibleInAWhiteFurnace) {
  for (const MaterialModel& model :
       {MaterialModel{Glass{.ior = kIndex, .dispersion = kStrong}},
        MaterialModel{Glass{.ior = kIndex, .dispersion = kStrong, .priority = 1}},
        MaterialModel{clear_solid(kIndex, kStrong)}})
    expect_channels(ball_in_furnace(model, 4), {1, 1, 1}, 500 / test::kSampleDivisor, 2e-3);
}

// Inside, each wavelength has n² times its radiance. Light that a path from the inside reflects has lost the
// wavelength that it was reflected by, whose correlation with that of the next vertex is small.
TEST(Dispersion, IsSeenFromTheInside) {
  const auto expected = spectral_mean([](double nm) {
    const double n = 1.6 + 0.6 / 8 * static_cast<double>(cauchy_abscissa(static_cast<float>(nm)));
    return n * n;
  });
  const Glass glass{.ior = kIndex, .dispersion = kStrong};
  expect_channels(ball_in_furnace(glass, 0.2f), expected, 1000 / test::kSampleDivisor, 1e-2);
}

// Rough boundaries as without dispersion, and by every strategy.
TEST(Dispersion, OfRoughGlassIsSeenAlikeByAllStrategies) {
  const MaterialModel models[] = {
      Glass{.ior = kIndex, .dispersion = kStrong, .roughness = 0.4f},
      Glass{.ior = kIndex,
            .dispersion = kStrong,
            .roughness = 0.4f,
            .microfacets = {MicrofacetDistribution::kBeckmann, SmithMasking::kCorrelated}},
      clear_solid(kIndex, kStrong, 0.4f)};
  for (const MaterialModel& model : models) {
    SceneMaker maker({.position = {0, 0, 4}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 20});
    maker.add(QuadDescription{{-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, maker.material(model)});
    maker.add(
        QuadDescription{{0, -1, -2}, {2, 0, 0}, {0, 2, 0}, maker.material(test::lambert(0), Rgb{3, 2, 1})});
    const Scene scene = maker.build();
    const std::uint32_t spp = 2000 / test::kSampleDivisor;
    const Channels naive = mean_channels(scene, Integrator::kNaive, 10 * spp);
    for (const Integrator integrator : {Integrator::kNee, Integrator::kMis}) {
      const Channels seen = mean_channels(scene, integrator, spp);
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(seen.mean[c], naive.mean[c],
                    4 * std::hypot(seen.standard_error[c], naive.standard_error[c]));
    }
  }
}

// Where all indices are equal, wavelengths are chosen, and the mean is that of glass without dispersion.
TEST(Dispersion, OfNearlyNothingChangesNoMean) {
  const auto channels_of = [](float scale) {
    SceneDescription room = test::room();
    for (Material& material : room.materials)
      if (auto* glass = std::get_if<Glass>(&material.model)) glass->dispersion.scale = scale;
    return mean_channels(Scene::build(room, 1).value(), Integrator::kMis, 1000 / test::kSampleDivisor);
  };
  const Channels with = channels_of(1e-6f), without = channels_of(0);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(with.mean[c], without.mean[c], 0.02 * without.mean[c]);
}

// A thin wall does not refract.
TEST(Dispersion, HasNoPlaceInThinWalls) {
  Principled pane = clear_solid(kIndex, kStrong);
  EXPECT_TRUE(disperses(MaterialModel{pane}));
  pane.geometry_thin_walled = true;
  EXPECT_FALSE(disperses(MaterialModel{pane}));
  EXPECT_FALSE(disperses(MaterialModel{Glass{}}));
}

// The boundary of two solids is exact at line d, and in the difference of lines F and C.
TEST(Dispersion, OfNestedDielectricsIsThatOfTheRatioOfTheIndices) {
  SceneMaker maker({});
  const Glass outer{.ior = 1.5f, .dispersion = {1, 60}, .priority = 1},
      inner{.ior = 1.7f, .dispersion = {1, 30}, .priority = 2};
  maker.add(SphereDescription{{0, 0, 0}, 2, maker.material(outer)});
  maker.add(SphereDescription{{0, 0, 0}, 1, maker.material(inner)});
  maker.description().environment = {{Rgb::gray(1)}};
  const Scene scene = maker.build();
  Enclosing around;
  around = scene.nested_dielectrics().inside_of(0, around);
  const auto boundary = scene.nested_dielectrics().boundary(1, around);
  ASSERT_TRUE(boundary);
  const auto& made = std::get<Glass>(scene.materials()[*boundary].model);
  for (const double line : {kLineC, kLineD, kLineF}) {
    const auto index = [&](const Glass& glass) {
      return dispersed_index(glass.ior.value, glass.dispersion.inverse_abbe_number(),
                             cauchy_abscissa(static_cast<float>(line)));
    };
    EXPECT_NEAR(index(made), index(inner) / index(outer), line == kLineD ? 1e-6 : 2e-5);
  }
}

}  // namespace
}  // namespace tessera::core::integrators
