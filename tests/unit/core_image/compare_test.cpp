// SPDX-License-Identifier: Apache-2.0
#include "core/image/compare.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/unit/core_image/test_image.hpp"

namespace tessera::core {
namespace {

Comparison compare_or_die(const Image& a, const Image& b) {
  const Result<Comparison> result = compare(a, b);
  EXPECT_TRUE(result) << result.error().message;
  return result.value_or(Comparison{});
}

TEST(Compare, IdenticalImages) {
  const Image image = random_image(7, 5, 1);
  const Comparison result = compare_or_die(image, image);
  EXPECT_TRUE(result.identical);
  EXPECT_EQ(result.largest_difference, 0);
  EXPECT_EQ(result.mse, 0);
  EXPECT_EQ(result.relative_mse, 0);
  EXPECT_EQ(result.psnr_db, std::numeric_limits<double>::infinity());
}

// Worked by hand: 2x2 pixels are 12 values; two of them differ, by 0.5 (b = 1) and by -0.25 (b = 0.5).
TEST(Compare, NumbersOfASmallImage) {
  Image a(2, 2), b(2, 2);
  a.at(1, 0) = {0, 1.5f, 0};
  b.at(1, 0) = {0, 1, 0};
  a.at(0, 1) = {0, 0, 0.25f};
  b.at(0, 1) = {0, 0, 0.5f};
  const Comparison result = compare_or_die(a, b);
  EXPECT_FALSE(result.identical);
  EXPECT_EQ(result.largest_difference, 0.5);
  EXPECT_EQ(result.largest_x, 1);
  EXPECT_EQ(result.largest_y, 0);
  EXPECT_DOUBLE_EQ(result.mse, (0.25 + 0.0625) / 12);
  EXPECT_DOUBLE_EQ(result.relative_mse, (0.25 / 1.01 + 0.0625 / 0.26) / 12);
  EXPECT_DOUBLE_EQ(result.psnr_db, 10 * std::log10(12 / 0.3125));
  EXPECT_DOUBLE_EQ(result.reference_mean_square, (1 + 0.25) / 12);
}

TEST(Compare, RelativeErrorIsRelativeToTheSecondImage) {
  Image dim(1, 1), bright(1, 1);
  dim.at(0, 0) = Rgb::gray(0);
  bright.at(0, 0) = Rgb::gray(1);
  EXPECT_DOUBLE_EQ(compare_or_die(dim, bright).relative_mse, 1 / 1.01);
  EXPECT_DOUBLE_EQ(compare_or_die(bright, dim).relative_mse, 1 / 0.01);
}

TEST(Compare, TheFirstOfEqualDifferencesIsReported) {
  const Image black(3, 2);
  Image spots(3, 2);
  spots.at(2, 0) = spots.at(0, 1) = Rgb::gray(1);
  const Comparison result = compare_or_die(spots, black);
  EXPECT_EQ(result.largest_x, 2);
  EXPECT_EQ(result.largest_y, 0);
}

TEST(Compare, MinusZeroDiffersByNothing) {
  Image a(1, 1), b(1, 1);
  a.at(0, 0).r = -0.0f;
  const Comparison result = compare_or_die(a, b);
  EXPECT_FALSE(result.identical);
  EXPECT_EQ(result.largest_difference, 0);
  EXPECT_EQ(result.mse, 0);
}

TEST(Compare, WhatIsNoNumberEqualsOnlyItself) {
  Image a(1, 2), b(1, 2);
  a.at(0, 1).g = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(compare_or_die(a, a).identical);
  EXPECT_EQ(compare_or_die(a, a).mse, 0);
  const Comparison result = compare_or_die(a, b);
  EXPECT_FALSE(result.identical);
  EXPECT_EQ(result.largest_difference, std::numeric_limits<double>::infinity());
  EXPECT_EQ(result.largest_y, 1);
  EXPECT_EQ(result.relative_mse, std::numeric_limits<double>::infinity());
  EXPECT_EQ(result.psnr_db, -std::numeric_limits<double>::infinity());
}

TEST(Compare, AnInfiniteReferenceDiffersInfinitely) {
  Image a(1, 1), b(1, 1);
  b.at(0, 0).b = std::numeric_limits<float>::infinity();
  EXPECT_EQ(compare_or_die(a, b).relative_mse, std::numeric_limits<double>::infinity());
}

TEST(Compare, DifferentSizesAreAnErrorThatNamesThem) {
  const Result<Comparison> result = compare(Image(4, 3), Image(3, 4));
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().message, "the images have different sizes: 4x3 and 3x4 pixels");
}

TEST(Compare, OfARegionCountsItsPixelsAlone) {
  Image a(5, 4), b(5, 4);
  a.at(0, 0) = {9, 9, 9};  // outside
  a.at(3, 2) = {0, 1.5f, 0};
  b.at(3, 2) = {0, 1, 0};
  const Comparison result = compare(a, b, {2, 1, 3, 2}).value();
  EXPECT_FALSE(result.identical);
  EXPECT_EQ(result.largest_difference, 0.5);
  EXPECT_EQ(result.largest_x, 3) << "in the whole image";
  EXPECT_EQ(result.largest_y, 2);
  EXPECT_DOUBLE_EQ(result.mse, 0.25 / 18);
  EXPECT_DOUBLE_EQ(result.relative_mse, 0.25 / 1.01 / 18);
  EXPECT_TRUE(compare(a, b, {1, 0, 2, 4})->identical);
  EXPECT_EQ(compare(a, b, {0, 0, 5, 4})->mse, compare(a, b)->mse);
}

TEST(Compare, OfARegionTakesAnImageOfNothingElse) {
  Image whole(5, 4), part(3, 2);
  whole.at(3, 2) = part.at(1, 1) = {1, 2, 3};
  EXPECT_TRUE(compare(whole, part, {2, 1, 3, 2})->identical);
  part.at(2, 0) = {0, 0.5f, 0};
  const Comparison result = compare(whole, part, {2, 1, 3, 2}).value();
  EXPECT_FALSE(result.identical);
  EXPECT_EQ(result.largest_x, 4) << "in the whole image";
  EXPECT_EQ(result.largest_y, 1);
  for (const ImageRegion region : {ImageRegion{1, 1, 3, 2}, {2, 2, 3, 2}})
    EXPECT_FALSE(compare(whole, part, region)->identical);
  EXPECT_FALSE(compare(whole, part, {3, 1, 3, 2})) << "does not lie in the first";
  EXPECT_FALSE(compare(whole, part, {2, 1, 2, 2})) << "of another size";
  EXPECT_FALSE(compare(whole, part)) << "of which part is not said";
  EXPECT_FALSE(compare(part, whole, {0, 0, 3, 2})) << "the part is the second";
}

TEST(Compare, RegionsLieWithinTheImages) {
  const Image image(5, 4);
  for (const ImageRegion region : {ImageRegion{0, 0, 0, 1},
                                   {0, 0, 1, 0},
                                   {-1, 0, 2, 2},
                                   {0, -1, 2, 2},
                                   {4, 0, 2, 1},
                                   {0, 3, 1, 2},
                                   {5, 0, 1, 1},
                                   {0, 0, 65536, 65536}}) {
    EXPECT_FALSE(compare(image, image, region).has_value()) << region.x << " " << region.y;
  }
  EXPECT_EQ(compare(image, image, {4, 3, 2, 1}).error().message,
            "the region of 2x1 pixels from (4, 3) does not lie within the images of 5x4");
}

}  // namespace
}  // namespace tessera::core
