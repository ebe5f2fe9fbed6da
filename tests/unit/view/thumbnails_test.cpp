// SPDX-License-Identifier: Apache-2.0
#include "core/view/thumbnails.hpp"

#include <gtest/gtest.h>

#include "core/image/codecs.hpp"
#include "core/image/encode.hpp"
#include "core/image/limits.hpp"
#include "tests/unit/view/view_fixture.hpp"

namespace tessera::view {
namespace {

constexpr auto kNoDeadline = std::chrono::steady_clock::time_point::max();

TEST(Thumbnails, ShowTheImage) {
  GrowingFilm growing;
  growing.add_to_all(0, 2);
  Thumbnails thumbnails;
  const auto whole = thumbnails.get(growing.source, 512, {}, kNoDeadline);
  ASSERT_TRUE(whole);
  const auto expected = core::encode_image(growing.film.develop(), core::ImageFormat::kPng);
  EXPECT_EQ((*whole)->png, *expected) << "it is small enough as it is";
  const auto small = thumbnails.get(growing.source, 50, {}, kNoDeadline);
  ASSERT_TRUE(small);
  const auto size = core::image_size((*small)->png);
  ASSERT_TRUE(size);
  EXPECT_EQ(size->width, 50);
  EXPECT_EQ(size->height, 43);
}

TEST(Thumbnails, FollowChanges) {
  GrowingFilm growing;
  Thumbnails thumbnails;
  growing.add(0, 0, 1);
  const auto first = thumbnails.get(growing.source, 100, {}, kNoDeadline);
  ASSERT_TRUE(first);
  EXPECT_EQ((*thumbnails.get(growing.source, 100, {}, kNoDeadline)).get(), first->get()) << "made once";
  growing.add(4, 0, 1);
  const auto late = thumbnails.get(growing.source, 100, {}, std::chrono::steady_clock::time_point{});
  ASSERT_TRUE(late);
  EXPECT_FALSE((*late)->is_current);
  const auto second = thumbnails.get(growing.source, 100, {}, kNoDeadline);
  ASSERT_TRUE(second);
  EXPECT_TRUE((*second)->is_current);
  EXPECT_NE((*second)->etag, (*first)->etag);
  EXPECT_NE((*second)->png, (*first)->png);
}

}  // namespace
}  // namespace tessera::view
