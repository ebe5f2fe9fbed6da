// SPDX-License-Identifier: Apache-2.0
// What pixel filters and the lens make of images that are known in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "core/integrators/render.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

// A camera before the plane z = 0, one unit of which is one pixel; (0, 0) is the middle of the image.
CameraDescription frontal_camera(int height_px, float distance) {
  return {.position = {0, 0, distance},
          .look_at = {0, 0, 0},
          .vertical_fov_degrees =
              static_cast<float>(2 * std::atan(height_px / 2.0 / double{distance}) * 180 / M_PI)};
}

FilmTile render_all(const Scene& scene, const RenderSettings& settings) {
  return render(prepare(scene, settings, 2), {0, 0, settings.width_px, settings.height_px}, {0, settings.spp},
                2);
}

double value_at(const FilmTile& tile, int x, int y) {
  const auto pixel = static_cast<std::size_t>(y * tile.rect.width() + x);
  return static_cast<double>(tile.sums[3 * pixel]) * kFilmUnit / tile.range.end;
}

double box(double x) {
  return std::clamp(x + 0.5, 0.0, 1.0);
}
double tent(double x) {
  const double c = std::clamp(x, -1.0, 1.0);
  return c < 0 ? (1 + c) * (1 + c) / 2 : 1 - (1 - c) * (1 - c) / 2;
}
double gaussian(double x) {
  const auto below = [](double sigmas) { return std::erfc(-sigmas / std::sqrt(2.0)) / 2; };
  return (below(std::clamp(2 * x, -3.0, 3.0)) - below(-3)) / (below(3) - below(-3));
}

struct FilterCase {
  FilterKind kind;
  double (*integral)(double x);  // of the filter at its default radius, up to x
};

class FilteredCorner : public testing::TestWithParam<FilterCase> {};
INSTANTIATE_TEST_SUITE_P(All, FilteredCorner,
                         testing::Values(FilterCase{FilterKind::kBox, box},
                                         FilterCase{FilterKind::kTent, tent},
                                         FilterCase{FilterKind::kGaussian, gaussian}),
                         [](const auto& filter) { return std::string(filter_name(filter.param.kind)); });

// The corner of a bright square, off the pixel grid: each pixel is the filter's integral over the square.
TEST_P(FilteredCorner, IsTheFiltersIntegral) {
  constexpr int kSide = 8;
  constexpr float kEdgeX = 0.3f, kEdgeY = -0.45f;  // bright to the right of, and below
  test::SceneMaker maker(frontal_camera(kSide, 100));
  const auto bright = maker.material(test::lambert(0), Rgb::gray(1));
  maker.add(QuadDescription{{kEdgeX, -50, 0}, {50, 0, 0}, {0, 50 + kEdgeY, 0}, bright});
  const FilmTile tile = render_all(
      maker.build(),
      {.width_px = kSide, .height_px = kSide, .spp = 16384, .filter = default_filter(GetParam().kind)});
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const double right = x + 0.5 - kSide / 2.0 - double{kEdgeX};
      const double below = y + 0.5 - kSide / 2.0 + double{kEdgeY};
      EXPECT_NEAR(value_at(tile, x, y), GetParam().integral(right) * GetParam().integral(below), 1e-3)
          << x << ", " << y;
    }
  }
}

TEST(Filter, NoSampleIsWeighed) {
  test::SceneMaker maker(frontal_camera(4, 10));
  const auto bright = maker.material(test::lambert(0), Rgb::gray(0.75f));
  maker.add(QuadDescription{{-50, -50, 0}, {100, 0, 0}, {0, 100, 0}, bright});
  const Scene scene = maker.build();
  for (const FilterKind kind : {FilterKind::kBox, FilterKind::kTent, FilterKind::kGaussian}) {
    const FilmTile tile =
        render_all(scene, {.width_px = 4, .height_px = 4, .spp = 8, .filter = {kind, 2.5f}});
    for (int i = 0; i < 16; ++i) EXPECT_EQ(value_at(tile, i % 4, i / 4), 0.75) << filter_name(kind);
  }
}

// How a point's light is spread over the film: the standard deviation of its place along x and along y, in
// pixels.
std::pair<double, double> spread_on_film(const FilmTile& tile) {
  double sum = 0, sum_x = 0, sum_y = 0, sum_xx = 0, sum_yy = 0;
  for (int y = 0; y < tile.rect.height(); ++y) {
    for (int x = 0; x < tile.rect.width(); ++x) {
      const double v = value_at(tile, x, y);
      sum += v;
      sum_x += v * x;
      sum_y += v * y;
      sum_xx += v * x * x;
      sum_yy += v * y * y;
    }
  }
  const double mean_x = sum_x / sum, mean_y = sum_y / sum;
  return {std::sqrt(sum_xx / sum - mean_x * mean_x), std::sqrt(sum_yy / sum - mean_y * mean_y)};
}

struct ConfusionCase {
  float distance;  // of the point; the lens is focused at 4
  int blades;
};

class CircleOfConfusion : public testing::TestWithParam<ConfusionCase> {};
INSTANTIATE_TEST_SUITE_P(ThinLens, CircleOfConfusion,
                         testing::Values(ConfusionCase{2, 0}, ConfusionCase{3, 0}, ConfusionCase{5, 0},
                                         ConfusionCase{8, 0}, ConfusionCase{16, 0}, ConfusionCase{2.5f, 3},
                                         ConfusionCase{8, 3}, ConfusionCase{8, 4}, ConfusionCase{8, 6}));

// A small bright ball stands for the point: with the film's pixel it adds a little to the spread.
TEST_P(CircleOfConfusion, HasItsDiameterOnTheFilm) {
  constexpr int kSide = 96;
  constexpr double kAperture = 0.4, kFocus = 4;
  const double distance = double{GetParam().distance};
  test::SceneMaker maker({.position = {0, 0, 0},
                          .look_at = {0, 0, -1},
                          .vertical_fov_degrees = 20,
                          .aperture_radius = static_cast<float>(kAperture),
                          .focus_distance = static_cast<float>(kFocus),
                          .aperture_blades = GetParam().blades});
  const auto bright = maker.material(test::lambert(0), Rgb::gray(1));
  const double ball = 0.02 * distance;
  maker.add(SphereDescription{{0, 0, -GetParam().distance}, static_cast<float>(ball), bright});
  const FilmTile tile = render_all(maker.build(), {.width_px = kSide, .height_px = kSide, .spp = 256});

  const double pixels_per_slope = kSide / (2 * std::tan(10 * M_PI / 180));
  const double diameter =
      2 * kAperture * std::fabs(distance - kFocus) / (distance * kFocus) * pixels_per_slope;
  const double ball_px = ball / distance * pixels_per_slope;
  // A regular polygon of circumradius 1 has this variance along every axis; a disk 1/4.
  const int blades = GetParam().blades;
  const double shape = blades == 0 ? 0.25 : (2 + std::cos(2 * M_PI / blades)) / 12;
  const auto [x, y] = spread_on_film(tile);
  for (const double spread : {x, y}) {
    const double lens_variance = spread * spread - ball_px * ball_px / 4 - 1.0 / 12;
    EXPECT_NEAR(2 * std::sqrt(lens_variance / shape), diameter, 0.02 * diameter);
  }
}

}  // namespace
}  // namespace tessera::core::integrators
