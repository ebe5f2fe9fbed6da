// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/polygon.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iterator>

namespace tessera::core {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Triangles cut(const std::vector<Vec3>& corners) {
  Triangles triangles;
  EXPECT_TRUE(triangulate(corners, triangles));
  EXPECT_EQ(triangles.size(), corners.size() - 2);
  return triangles;
}

// The area normals of the triangles, added up, and their areas: the two agree in length where no triangle is
// turned round.
struct Areas {
  Vec3 sum;
  float total = 0;
};

Areas areas(const std::vector<Vec3>& corners, const Triangles& triangles) {
  Areas result;
  for (const auto& t : triangles) {
    const Vec3 twice = cross(corners[t[1]] - corners[t[0]], corners[t[2]] - corners[t[0]]);
    result.sum += twice * 0.5f;
    result.total += length(twice) * 0.5f;
  }
  return result;
}

TEST(Triangulate, FansConvexPolygons) {
  EXPECT_EQ(cut({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), (Triangles{{0, 1, 2}}));
  EXPECT_EQ(cut({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}), (Triangles{{0, 1, 2}, {0, 2, 3}}));
}

TEST(Triangulate, CutsConcaveQuadsInside) {
  // An arrowhead with its notch at corner 1: the diagonal from corner 0 to 2 would lie outside.
  const std::vector<Vec3> arrow{{0, 0, 0}, {1, 0.5f, 0}, {2, 0, 0}, {1, 2, 0}};
  const auto [sum, total] = areas(arrow, cut(arrow));
  EXPECT_FLOAT_EQ(sum.z, 1.5f);
  EXPECT_FLOAT_EQ(total, 1.5f);
}

// A star with `points` points of radius 1 and notches of radius 0.3, in a plane given by two axes.
std::vector<Vec3> star(int points, Vec3 center, Vec3 u, Vec3 v, bool clockwise) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 2 * points; ++i) {
    const double angle = M_PI * (clockwise ? -i : i) / points, radius = i % 2 == 0 ? 1 : 0.3;
    corners.push_back(center + u * static_cast<float>(radius * std::cos(angle)) +
                      v * static_cast<float>(radius * std::sin(angle)));
  }
  return corners;
}

TEST(Triangulate, KeepsAreaAndWindingOfStarsInAnyPlane) {
  const Vec3 planes[][2] = {{{1, 0, 0}, {0, 1, 0}},
                            {{0, 1, 0}, {0, 0, 1}},
                            {{0, 0, 1}, {1, 0, 0}},
                            {{0.6f, 0.8f, 0}, {0, 0, -1}},
                            {{1e-4f, 0, 0}, {0, 1e-4f, 1e-4f}},
                            {{1e4f, 0, 0}, {0, 0, 1e4f}}};
  for (const auto& [u, v] : planes) {
    for (const bool clockwise : {false, true}) {
      const auto corners = star(7, {3, 2, 1}, u, v, clockwise);
      const auto [sum, total] = areas(corners, cut(corners));
      // Twice as many triangles as points, each between a point and a notch.
      const float expected = 7 * 0.3f * std::sin(static_cast<float>(M_PI) / 7) * length(cross(u, v));
      EXPECT_NEAR(total / expected, 1, 2e-2);
      EXPECT_NEAR(length(sum) / total, 1, 1e-2);
      EXPECT_GT(dot(sum, cross(u, v)) * (clockwise ? -1.0f : 1.0f), 0);
    }
  }
}

TEST(Triangulate, CutsAComb) {
  // Teeth of height 1 on a bar of height 1, twenty of them.
  std::vector<Vec3> comb{{0, 0, 0}, {40, 0, 0}};
  for (int i = 20; i-- > 0;) {
    const auto x = static_cast<float>(2 * i);
    comb.insert(comb.end(), {{x + 2, 1, 0}, {x + 2, 2, 0}, {x + 1, 2, 0}, {x + 1, 1, 0}});
  }
  comb.push_back({0, 1, 0});
  const auto [sum, total] = areas(comb, cut(comb));
  EXPECT_FLOAT_EQ(sum.z, 60);
  EXPECT_FLOAT_EQ(total, 60);
}

TEST(Triangulate, SurvivesWhatIsNoPolygon) {
  cut({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}});                   // a point
  cut({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {1, 1, 1}});        // a line
  cut({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}});                   // crosses itself
  cut({{0, 0, 0}, {1, 0, 5}, {1, 1, -5}, {0, 1, 5}, {-1, 0.5f, -5}});  // far from flat
  cut({{-3e38f, 0, 0}, {3e38f, 0, 0}, {0, 1, 0}, {3e38f, 3e38f, 3e38f}});
}

// The cap of a cylinder, with the digits that OBJ files have.
TEST(Triangulate, CutsLargeCirclesThatAreRounded) {
  for (const double scale : {1e6, 1e4}) {
    std::vector<Vec3> circle;
    for (int i = 0; i < 5000; ++i) {
      const auto rounded = [scale](double x) { return static_cast<float>(std::round(x * scale) / scale); };
      circle.push_back({rounded(std::cos(M_PI * i / 2500)), rounded(std::sin(M_PI * i / 2500)), 3});
    }
    const auto [sum, total] = areas(circle, cut(circle));
    EXPECT_NEAR(sum.z / M_PI, 1, 1e-3) << scale;
    EXPECT_NEAR(total / M_PI, 1, 1e-3) << scale;
  }
}

TEST(Triangulate, LimitsTheCostOfConcavePolygons) {
  Triangles triangles;
  const auto always = static_cast<int>(kMaxConcaveCorners / 2);
  EXPECT_TRUE(triangulate(star(always, {}, {1, 0, 0}, {0, 1, 0}, false), triangles));
  EXPECT_EQ(triangles.size(), kMaxConcaveCorners - 2);
  EXPECT_FALSE(triangulate(star(2 * always, {}, {1, 0, 0}, {0, 1, 0}, false), triangles));
  EXPECT_EQ(triangles.size(), kMaxConcaveCorners - 2);
}

// An L whose sides have many corners.
std::vector<Vec3> finely_divided_l(int corners_of_side) {
  const Vec3 outline[] = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  std::vector<Vec3> corners;
  for (std::size_t side = 0; side < std::size(outline); ++side)
    for (int i = 0; i < corners_of_side; ++i) {
      const Vec3 from = outline[side], to = outline[(side + 1) % std::size(outline)];
      corners.push_back(from + (to - from) * (static_cast<float>(i) / static_cast<float>(corners_of_side)));
    }
  return corners;
}

TEST(Triangulate, CutsSidesWithManyCorners) {
  for (const int corners_of_side : {512, 1 << 18}) {
    const auto corners = finely_divided_l(corners_of_side);
    const auto [sum, total] = areas(corners, cut(corners));
    EXPECT_NEAR(sum.z, 3, 1e-3) << corners_of_side;
    EXPECT_NEAR(total, 3, 1e-3) << corners_of_side;
  }
}

}  // namespace
}  // namespace tessera::core
