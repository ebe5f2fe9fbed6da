// SPDX-License-Identifier: Apache-2.0
#include "core/image/encode.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/image/decode.hpp"
#include "core/image/srgb.hpp"
#include "tests/unit/core_image/test_image.hpp"

namespace tessera::core {
namespace {

using namespace std::string_literals;
using testing::HasSubstr;
using testing::Not;

std::string encode_or_die(const Image& image, ImageFormat format) {
  const Result<std::string> bytes = encode_image(image, format);
  EXPECT_TRUE(bytes) << bytes.error().message;
  return bytes.value_or("");
}

Image round_trip(const Image& image, ImageFormat format) {
  const Result<Image> decoded = decode_image(encode_or_die(image, format));
  EXPECT_TRUE(decoded) << decoded.error().message;
  return decoded.value_or(Image(image.width, image.height));
}

class LosslessFormat : public testing::TestWithParam<ImageFormat> {};
INSTANTIATE_TEST_SUITE_P(All, LosslessFormat, testing::Values(ImageFormat::kExr, ImageFormat::kPfm),
                         [](const auto& format) { return std::string(image_format_name(format.param)); });

TEST_P(LosslessFormat, KeepsEveryBit) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 40}, {40, 1}, {67, 35}}) {
    const Image image = random_image(width, height, 2);
    EXPECT_EQ(bits_of(round_trip(image, GetParam())), bits_of(image)) << width << "x" << height;
  }
}

TEST_P(LosslessFormat, KeepsTheOrientation) {
  Image image(3, 2);
  image.at(2, 0) = {1, 2, 3};
  const Image decoded = round_trip(image, GetParam());
  EXPECT_EQ(decoded.width, 3);
  EXPECT_EQ(decoded.height, 2);
  EXPECT_EQ(decoded.at(2, 0), (Rgb{1, 2, 3}));
}

TEST(EncodePng, StoresTheRoundedSrgbCodes) {
  const Image image = random_image(33, 21, 3);
  const Image decoded = round_trip(image, ImageFormat::kPng);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    for (int channel = 0; channel < 3; ++channel) {
      ASSERT_EQ(decoded.pixels[i][channel], srgb_decode(srgb_encode(image.pixels[i][channel])));
    }
  }
}

TEST(EncodeHdr, KeepsEightBitsOfTheLargestChannel) {
  for (const int width : {5, 64}) {  // below 8 pixels rows are stored without run-length encoding
    const Image image = random_image(width, 9, 4);
    const Image decoded = round_trip(image, ImageFormat::kHdr);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      const float unit = std::fmax(max_component(image.pixels[i]) / 128, 1e-30f);
      for (int channel = 0; channel < 3; ++channel) {
        ASSERT_NEAR(decoded.pixels[i][channel], image.pixels[i][channel], unit);
      }
    }
  }
}

TEST(EncodePfm, WritesRowsFromTheBottomInLittleEndian) {
  Image image(1, 2);
  image.at(0, 0) = {1, 0, 0};
  image.at(0, 1) = {0, 2, -0.5f};
  const std::string expected =
      "PF\n1 2\n-1.0\n"
      "\0\0\0\0"
      "\0\0\0\x40"
      "\0\0\0\xbf"
      "\0\0\x80\x3f"
      "\0\0\0\0"
      "\0\0\0\0"s;
  EXPECT_EQ(encode_or_die(image, ImageFormat::kPfm), expected);
}

TEST(EncodeExr, SaysNothingAboutWhenOrWhere) {
  const std::string bytes = encode_or_die(random_image(20, 20, 5), ImageFormat::kExr);
  for (const char* attribute : {"capDate", "utcOffset", "owner", "comments"}) {
    EXPECT_THAT(bytes, Not(HasSubstr(attribute)));
  }
}

class EveryFormat : public testing::TestWithParam<ImageFormat> {};
INSTANTIATE_TEST_SUITE_P(All, EveryFormat,
                         testing::Values(ImageFormat::kPng, ImageFormat::kExr, ImageFormat::kHdr,
                                         ImageFormat::kPfm),
                         [](const auto& format) { return std::string(image_format_name(format.param)); });

TEST_P(EveryFormat, SamePictureSameBytes) {
  EXPECT_EQ(encode_or_die(random_image(50, 50, 6), GetParam()),
            encode_or_die(random_image(50, 50, 6), GetParam()));
}

TEST_P(EveryFormat, RefusesAnEmptyPicture) {
  const Result<std::string> bytes = encode_image(Image(0, 0), GetParam());
  ASSERT_FALSE(bytes);
  EXPECT_THAT(bytes.error().message, HasSubstr("0x0"));
}

TEST_P(EveryFormat, IsFoundByTheEndingOfAName) {
  const std::string ending(image_format_name(GetParam()));
  EXPECT_EQ(image_format_from_path("a." + ending), GetParam());
  EXPECT_EQ(image_format_from_path("some.folder/a.b." + ending), GetParam());
}

TEST(ImageFormatFromPath, TakesUpperCase) {
  EXPECT_EQ(image_format_from_path("OUT.PNG"), ImageFormat::kPng);
}

TEST(ImageFormatFromPath, ListsTheEndingsItKnows) {
  for (const char* path :
       {"", "png", "out", "out.", "out.jpeg", "out.png/", "folder.png/out", "out.png.tmp"}) {
    const Result<ImageFormat> format = image_format_from_path(path);
    ASSERT_FALSE(format) << path;
    EXPECT_THAT(format.error().message, HasSubstr(".png, .exr, .hdr or .pfm"));
  }
}

TEST(CheckEncodable, KnowsTheLimitsOfTheFormats) {
  EXPECT_TRUE(check_encodable(ImageFormat::kExr, 65536, 16384));
  EXPECT_FALSE(check_encodable(ImageFormat::kPng, 65536, 16384));
  EXPECT_TRUE(check_encodable(ImageFormat::kPng, 23170, 23170));
  EXPECT_FALSE(check_encodable(ImageFormat::kHdr, 23170, 23170));
  EXPECT_THAT(check_encodable(ImageFormat::kHdr, 23170, 23170).error().message, HasSubstr("use .exr"));
}

}  // namespace
}  // namespace tessera::core
