// SPDX-License-Identifier: Apache-2.0
#include "scenes/backdrops/backdrops.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "scenes/menagerie/meadow.hpp"
#include "scenes/small_light/planets.hpp"

namespace tessera {
namespace {

using core::Image;
using core::Rgb;

void expect_shares_of_light(const Image& image, const std::string& name) {
  for (const Rgb c : image.pixels) {
    ASSERT_TRUE(is_finite(c)) << name;
    ASSERT_TRUE(c.r >= 0 && c.g >= 0 && c.b >= 0 && max_component(c) < 1.2f) << name;
  }
}

TEST(Backdrops, FloorsAreChequered) {
  for (const Image& image : {backdrops::terracotta_tiles(), backdrops::slate_tiles()}) {
    expect_shares_of_light(image, "floor");
    const int tile = image.width / 8, half = tile / 2;
    for (int i = 0; i < 7; ++i) {
      const float here = image.at(half + i * tile, half).b, next = image.at(half + (i + 1) * tile, half).b;
      const float above = image.at(half + i * tile, half + tile).b;
      EXPECT_EQ(here > next, i % 2 == 0);
      EXPECT_EQ(here > above, i % 2 == 0);
    }
  }
}

TEST(Backdrops, SkyIsBrightAboveAndDarkBelow) {
  const Image sky = backdrops::evening_sky();
  EXPECT_EQ(sky.width, 2 * sky.height);
  for (int x = 0; x < sky.width; ++x) {
    EXPECT_GT(sky.at(x, 0).b, sky.at(x, 0).r);
    EXPECT_GT(luminance(sky.at(x, sky.height / 2 - 8)), 10 * luminance(sky.at(x, sky.height / 2 + 8)));
  }
  EXPECT_GT(sky.at(sky.width / 2, sky.height / 2 - 8).r, 1.5f * sky.at(0, sky.height / 2 - 8).r);
}

TEST(Backdrops, UnknownOnesAreErrorsThatListTheOthers) {
  const auto image = backdrops::backdrop("tiles");
  ASSERT_FALSE(image);
  EXPECT_NE(image.error().message.find("slate_tiles"), std::string::npos);
}

TEST(Planets, ArePaintedInSharesOfLight) {
  for (const auto& [name, paint] : small_light::paintings()) expect_shares_of_light(paint(), name);
}

TEST(Planets, RingIsFlatAndAroundTheGlobe) {
  for (const core::Vec3 p : small_light::ring_mesh().positions) {
    EXPECT_EQ(p.y, 0);
    EXPECT_GT(length(p), 1.2f);
  }
}

TEST(Meadow, GrowsFromTheGroundAndLeavesRoomForTheAnimals) {
  const core::MeshDescription mesh = menagerie::meadow();
  EXPECT_EQ(mesh.uvs.size(), mesh.positions.size());
  float highest_under_cow = 0;
  for (const core::Vec3 p : mesh.positions) {
    ASSERT_GE(p.y, 0);
    ASSERT_LT(p.y, 5);
    if (length(p - core::Vec3{6.5f, p.y, -5}) < 2) highest_under_cow = std::max(highest_under_cow, p.y);
  }
  EXPECT_LT(highest_under_cow, 1);
  expect_shares_of_light(menagerie::meadow_colors(), "meadow");
  expect_shares_of_light(menagerie::ground_colors(), "ground");
}

}  // namespace
}  // namespace tessera
