// SPDX-License-Identifier: Apache-2.0
#include "core/textures/texture.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "core/image/srgb.hpp"

namespace tessera::core {
namespace {

// Linear floats, row by row from the top.
Texture texture_of(int width, int height, std::vector<float> grays, Wrap wrap = Wrap::kRepeat) {
  std::vector<float> texels;
  for (const float gray : grays) texels.insert(texels.end(), {gray, gray * 2, gray * 4});
  return {std::make_shared<const TextureImage>(width, height, std::move(texels)), wrap};
}

TEST(Texture, HitsTexelCentresExactlyWithVUpwards) {
  const Texture t = texture_of(4, 2, {1, 2, 3, 4, 5, 6, 7, 8});
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x) {
      const Vec2 centre{(static_cast<float>(x) + 0.5f) / 4, 1 - (static_cast<float>(y) + 0.5f) / 2};
      EXPECT_EQ(t.evaluate(centre), t.image->texel(x, y)) << x << ' ' << y;
    }
  EXPECT_EQ(t.image->texel(1, 1), (Rgb{6, 12, 24}));
}

TEST(Texture, InterpolatesBetweenCentres) {
  const Texture t = texture_of(2, 2, {0, 1, 2, 3}, Wrap::kClamp);
  EXPECT_EQ(t.evaluate({0.5f, 0.5f}).r, 1.5f);
  EXPECT_EQ(t.evaluate({0.375f, 0.75f}).r, 0.25f);
  EXPECT_EQ(t.evaluate({0.25f, 0.5f}).r, 1.0f);
}

TEST(Texture, WrapsAroundOrClamps) {
  const std::vector<float> grays{0, 1, 2, 3};
  const Texture repeat = texture_of(4, 1, grays), clamp = texture_of(4, 1, grays, Wrap::kClamp);
  EXPECT_EQ(repeat.evaluate({0, 0.5f}).r, 1.5f);  // between the last and the first
  EXPECT_EQ(clamp.evaluate({0, 0.5f}).r, 0);
  EXPECT_EQ(clamp.evaluate({1, 0.5f}).r, 3);
  EXPECT_EQ(clamp.evaluate({7, -3}).r, 3);
  for (const float u : {0.125f, 0.375f, 0.5f}) {
    EXPECT_EQ(repeat.evaluate({u + 3, 0.5f}), repeat.evaluate({u, 0.5f}));
    EXPECT_EQ(repeat.evaluate({u - 2, -4.5f}), repeat.evaluate({u, 0.5f}));
  }
}

TEST(Texture, ScalesAndMovesCoordinates) {
  Texture t = texture_of(4, 1, {0, 1, 2, 3});
  t.scale = {2, 1};
  t.offset = {0.25f, 0};
  EXPECT_EQ(t.evaluate({0.0625f, 0.5f}).r, 1);  // 2 * 0.0625 + 0.25 = 0.375, the centre of texel 1
}

TEST(Texture, MirrorsAtEachEdge) {
  const Texture t = texture_of(4, 1, {0, 1, 2, 3}, Wrap::kMirror);
  for (const float u : {0.125f, 0.25f, 0.375f, 0.625f, 0.875f}) {
    const Rgb inside = t.evaluate({u, 0.5f});
    EXPECT_EQ(inside.r, 4 * u - 0.5f);
    for (const float same : {-u, 2 - u, 2 + u, u - 4}) EXPECT_EQ(t.evaluate({same, 0.5f}), inside) << same;
  }
  EXPECT_EQ(t.evaluate({1, 0.5f}).r, 3);
}

TEST(Texture, HasTheValueOfTheNearestTexel) {
  Texture t = texture_of(3, 1, {1, 5, 2});
  t.filter = TextureFilter::kNearest;
  for (const auto& [u, expected] : {std::pair(0.01f, 1.0f),
                                    {0.32f, 1.0f},
                                    {0.34f, 5.0f},
                                    {0.66f, 5.0f},
                                    {0.67f, 2.0f},
                                    {0.99f, 2.0f},
                                    {1.01f, 1.0f},
                                    {-0.01f, 2.0f}})
    EXPECT_NEAR(t.evaluate({u, 0.1f}).r, expected, 1e-5f) << u;
  // Far from the first repetition, where floats are a sixteenth of a texel apart.
  std::vector<float> grays(1024);
  std::iota(grays.begin(), grays.end(), 0.0f);
  t = texture_of(1024, 1, grays);
  t.filter = TextureFilter::kNearest;
  EXPECT_NEAR(t.evaluate({1000 + 10.4f / 1024, 0.5f}).r, 10, 1e-3f);
}

TEST(Texture, WrapsAlongVByItself) {
  Texture t = texture_of(4, 4, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15}, Wrap::kClamp);
  t.wrap_v = Wrap::kRepeat;
  EXPECT_EQ(t.evaluate({1.875f, 1.875f}).r, 3);   // the last column of the first row
  EXPECT_EQ(t.evaluate({0.125f, -0.125f}).r, 0);  // above the lower edge of the next image
}

// By 90 degrees: what was at the right is at the bottom.
TEST(Texture, IsRotatedByShear) {
  Texture t = texture_of(2, 2, {1, 2, 3, 4}, Wrap::kClamp);
  t.scale = {0, 0};
  t.shear = {-1, 1};
  t.offset = {1, 0};
  EXPECT_EQ(t.evaluate({0.25f, 0.75f}).r, 3);  // u = 1 - 0.75, v = 0.25
  EXPECT_EQ(t.evaluate({0.75f, 0.75f}).r, 1);
  EXPECT_EQ(t.evaluate({0.75f, 0.25f}).r, 2);
  EXPECT_EQ(t.evaluate({0.25f, 0.25f}).r, 4);
}

TEST(Texture, StaysInTheImageForAnyCoordinates) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const float odd[] = {inf, -inf, nan, 1e30f, -1e30f, -1e-30f, 0.99999994f, 1, -0.0f, 16777216.5f};
  for (const Wrap wrap : {Wrap::kRepeat, Wrap::kClamp, Wrap::kMirror}) {
    const Texture t = texture_of(3, 5, std::vector<float>(15, 0.5f), wrap);
    for (const float u : odd)
      for (const float v : odd) EXPECT_NEAR(t.evaluate({u, v}).r, 0.5f, 1e-6f) << u << ' ' << v;
  }
}

TEST(TextureImage, HasTheMeanOfItsTexels) {
  EXPECT_EQ(texture_of(2, 2, {1, 2, 3, 6}).image->mean(), (Rgb{3, 6, 12}));
}

TEST(TextureImage, WrapsEachWayByItself) {
  const Texture t = texture_of(2, 2, {0, 8, 2, 10});
  EXPECT_EQ(t.image->bilinear({0, 1}, Wrap::kRepeat, Wrap::kClamp).r, 4);
  EXPECT_EQ(t.image->bilinear({0, 1}, Wrap::kClamp, Wrap::kRepeat).r, 1);
}

TEST(TextureImage, DecodesBytesByTheStandard) {
  const std::vector<std::uint8_t> bytes{0, 188, 255};
  const TextureImage srgb(1, 1, bytes, ColorSpace::kSrgb), linear(1, 1, bytes, ColorSpace::kLinear);
  EXPECT_EQ(srgb.texel(0, 0), (Rgb{0, srgb_decode(std::uint8_t{188}), 1}));
  EXPECT_NEAR(srgb.texel(0, 0).g, 0.5029f, 1e-4f);
  EXPECT_EQ(linear.texel(0, 0), (Rgb{0, 188.0f / 255, 1}));
}

// Of any size, so that cache lines are filled in part, and whether or not floats fit shared exponents.
TEST(TextureImage, KeepsEveryValue) {
  std::mt19937 random(1);
  for (const auto& [width, height] : std::vector<std::pair<int, int>>{{1, 1}, {7, 5}, {4, 9}, {13, 8}}) {
    const auto count = static_cast<std::size_t>(3 * width * height);
    std::vector<std::uint8_t> bytes(count);
    std::vector<float> shared(count), odd(count);
    for (std::size_t i = 0; i < count; ++i) {
      bytes[i] = static_cast<std::uint8_t>(random());
      shared[i] = std::ldexp(static_cast<float>(bytes[i]), static_cast<int>(i / 3 % 256) - 136);
      odd[i] = i % 5 == 0 ? -1.5f : std::ldexp(static_cast<float>(random()), static_cast<int>(i % 200) - 140);
    }
    const TextureImage of_bytes(width, height, bytes, ColorSpace::kLinear);
    const TextureImage of_shared(width, height, shared), of_odd(width, height, odd);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const auto i = static_cast<std::size_t>(3 * (y * width + x));
        const auto unit = [&](std::size_t k) { return static_cast<float>(bytes[k]) / 255; };
        ASSERT_EQ(of_bytes.texel(x, y), (Rgb{unit(i), unit(i + 1), unit(i + 2)}));
        ASSERT_EQ(of_shared.texel(x, y), (Rgb{shared[i], shared[i + 1], shared[i + 2]}));
        ASSERT_EQ(of_odd.texel(x, y), (Rgb{odd[i], odd[i + 1], odd[i + 2]}));
      }
  }
}

}  // namespace
}  // namespace tessera::core
