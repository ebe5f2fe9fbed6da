// SPDX-License-Identifier: Apache-2.0
#include "core/camera/aperture.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/math/elementary.hpp"
#include "core/sampling/hash.hpp"

namespace tessera::core::integrators {
namespace {

constexpr float kRadius = 0.7f, kRotationDegrees = 17;

struct Point {
  double x, y;
};
using Polygon = std::vector<Point>;

// The corners as the description says: the first one up, turned counter-clockwise.
Polygon expected_polygon(int blades) {
  Polygon corners;
  for (int i = 0; i < blades; ++i) {
    const double angle = M_PI / 2 + 2 * M_PI * i / blades + double{kRotationDegrees} * M_PI / 180;
    corners.push_back({double{kRadius} * std::cos(angle), double{kRadius} * std::sin(angle)});
  }
  return corners;
}

// The part of a convex polygon where a*x + b*y <= c (Sutherland and Hodgman 1974).
Polygon clip(const Polygon& polygon, double a, double b, double c) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point p = polygon[i], q = polygon[(i + 1) % polygon.size()];
    const double dp = a * p.x + b * p.y - c, dq = a * q.x + b * q.y - c;
    if (dp <= 0) kept.push_back(p);
    if ((dp < 0 && dq > 0) || (dp > 0 && dq < 0)) {
      const double t = dp / (dp - dq);
      kept.push_back({p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)});
    }
  }
  return kept;
}

double area(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point p = polygon[i], q = polygon[(i + 1) % polygon.size()];
    twice += p.x * q.y - q.x * p.y;
  }
  return twice / 2;
}

constexpr int kCells = 12;
int cell_of(float v) {
  return static_cast<int>(std::floor((v / kRadius + 1) / 2 * kCells));
}
double cell_edge(int cell) {
  return double{kRadius} * (2.0 * cell / kCells - 1);
}

class PolygonalAperture : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Blades, PolygonalAperture, testing::Values(3, 4, 5, 6, 7, 9, 64));

// Cells of a square grid against the areas that the polygon has in them.
TEST_P(PolygonalAperture, IsUniformByTheChiSquareTest) {
  constexpr int kSamples = 1'000'000;
  const Aperture aperture(kRadius, GetParam(), kRotationDegrees);
  std::vector<int> counts(kCells * kCells);
  for (std::uint64_t i = 0; i < kSamples; ++i) {
    const std::uint64_t bits = sampling::hash(i, 1);
    const Vec2 p = aperture.sample({sampling::unit_float(static_cast<std::uint32_t>(bits)),
                                    sampling::unit_float(static_cast<std::uint32_t>(bits >> 32))});
    const int x = cell_of(p.x), y = cell_of(p.y);
    ASSERT_TRUE(x >= 0 && x < kCells && y >= 0 && y < kCells) << p.x << " " << p.y;
    ++counts[static_cast<std::size_t>(y * kCells + x)];
  }
  const Polygon polygon = expected_polygon(GetParam());
  double chi_square = 0, rare_expected = 0, rare_counted = 0;
  int cells = 0;
  for (int y = 0; y < kCells; ++y) {
    for (int x = 0; x < kCells; ++x) {
      const Polygon part =
          clip(clip(clip(clip(polygon, -1, 0, -cell_edge(x)), 1, 0, cell_edge(x + 1)), 0, -1, -cell_edge(y)),
               0, 1, cell_edge(y + 1));
      const double expected = kSamples * area(part) / area(polygon);
      const int counted = counts[static_cast<std::size_t>(y * kCells + x)];
      if (expected < 10) {
        rare_expected += expected;
        rare_counted += counted;
        continue;
      }
      chi_square += (counted - expected) * (counted - expected) / expected;
      ++cells;
    }
  }
  EXPECT_LE(rare_counted, rare_expected + 5 * std::sqrt(rare_expected) + 1);
  // Beyond 4.5 standard deviations once in 300,000 (Wilson and Hilferty 1931).
  const double freedom = cells - 1, spread = 2 / (9 * freedom);
  EXPECT_LT((std::cbrt(chi_square / freedom) - (1 - spread)) / std::sqrt(spread), 4.5) << chi_square;
}

TEST_P(PolygonalAperture, KeepsNeighboursTogether) {
  constexpr int kSide = 400;
  const Aperture aperture(1, GetParam(), 0);
  const auto at = [&](int i, int j) {
    return aperture.sample({(static_cast<float>(i) + 0.5f) / kSide, (static_cast<float>(j) + 0.5f) / kSide});
  };
  for (int i = 1; i < kSide; ++i) {
    for (int j = 1; j < kSide; ++j) {
      for (const Vec2 step : {at(i, j) - at(i - 1, j), at(i, j) - at(i, j - 1)})
        ASSERT_LT(std::hypot(step.x, step.y), 4.0f / kSide) << i << " " << j;
    }
  }
}

TEST_P(PolygonalAperture, ReachesEveryCorner) {
  const Aperture aperture(kRadius, GetParam(), kRotationDegrees);
  for (const Point& corner : expected_polygon(GetParam())) {
    double nearest = 1;
    for (int i = 0; i < 4096; ++i) {  // around the edge of the square
      const float along = static_cast<float>(i % 1024) / 1024, end = 0x1.fffffep-1f;
      const Vec2 u = i < 1024   ? Vec2{along, 0}
                     : i < 2048 ? Vec2{end, along}
                     : i < 3072 ? Vec2{along, end}
                                : Vec2{0, along};
      const Vec2 p = aperture.sample(u);
      nearest = std::min(nearest, std::hypot(double{p.x} - corner.x, double{p.y} - corner.y));
    }
    EXPECT_LT(nearest, 0.01);
  }
}

// What it contains of a grid of points, against its area.
TEST_P(PolygonalAperture, ContainsItsArea) {
  const Aperture aperture(kRadius, GetParam(), kRotationDegrees);
  const double expected = area(expected_polygon(GetParam()));
  EXPECT_NEAR(static_cast<double>(aperture.area()), expected, 1e-5);
  constexpr int kSide = 700;
  int contained = 0;
  for (int y = -kSide; y < kSide; ++y)
    for (int x = -kSide; x < kSide; ++x) {
      const Vec2 point{(static_cast<float>(x) + 0.5f) * (kRadius / kSide),
                       (static_cast<float>(y) + 0.5f) * (kRadius / kSide)};
      contained += aperture.contains(point) ? 1 : 0;
    }
  const double cell = double{kRadius} * double{kRadius} / (kSide * kSide);
  EXPECT_NEAR(contained * cell, expected, 2e-3 * expected);
}

TEST(Aperture, OfADiskContainsIt) {
  const Aperture disk(0.5f, 0, 0);
  EXPECT_FLOAT_EQ(disk.area(), kPi / 4);
  EXPECT_TRUE(disk.contains({0.3f, -0.39f}));
  EXPECT_FALSE(disk.contains({0.3f, -0.41f}));
}

TEST(Aperture, IsAPinholeWithoutARadius) {
  EXPECT_TRUE(Aperture(0, 6, 10).is_pinhole());
  EXPECT_FALSE(Aperture(0.1f, 0, 0).is_pinhole());
}

}  // namespace
}  // namespace tessera::core::integrators
