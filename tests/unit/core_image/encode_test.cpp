// SPDX-License-Identifier: Apache-2.0
#include "core/image/encode.hpp"

#include <ImathBox.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStdIO.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "core/image/decode.hpp"
#include "core/image/file_io.hpp"
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

TEST_P(EveryFormat, SameImageSameBytes) {
  EXPECT_EQ(encode_or_die(random_image(50, 50, 6), GetParam()),
            encode_or_die(random_image(50, 50, 6), GetParam()));
}

class Buffer final : public ByteSink {
 public:
  Status write_at(std::uint64_t offset, std::string_view more) override {
    if (bytes.size() + more.size() > limit) return fail(ErrorCode::kResourceExhausted, "the disk is full");
    if (offset + more.size() > bytes.size()) bytes.resize(offset + more.size());
    bytes.replace(offset, more.size(), more);
    return {};
  }

  std::string bytes;
  std::size_t limit = 1'000'000;
};

// The source has one row at a time.
TEST_P(EveryFormat, WritesTheSameFileRowByRow) {
  const Image image = random_image(50, 40, 6);
  std::vector<int> order;
  std::vector<Rgb> row(50);
  const RowSource source{50, 40, [&](int y) -> Result<const Rgb*> {
                           order.push_back(y);
                           std::copy_n(&image.at(0, y), 50, row.begin());
                           return row.data();
                         }};
  Buffer file;
  const auto size = write_image(source, GetParam(), {}, file);
  ASSERT_TRUE(size) << size.error().message;
  EXPECT_EQ(*size, file.bytes.size());
  EXPECT_TRUE(file.bytes == encode_or_die(image, GetParam()));
  ASSERT_EQ(order.size(), 40u);
  const bool is_ascending = std::is_sorted(order.begin(), order.end());
  EXPECT_EQ(is_ascending, GetParam() != ImageFormat::kPfm);
}

TEST_P(EveryFormat, TellsTheErrorsOfItsSourceAndItsSink) {
  const Image image = random_image(50, 40, 6);
  RowSource source{50, 40, [&](int y) -> Result<const Rgb*> { return &image.at(0, y); }};
  Buffer full;
  full.limit = 2000;
  EXPECT_EQ(write_image(source, GetParam(), {}, full).error().message, "the disk is full");
  source.row = [&](int y) -> Result<const Rgb*> {
    if (y == 20) return fail(ErrorCode::kDataLoss, "the row is lost");
    return &image.at(0, y);
  };
  Buffer file;
  EXPECT_EQ(write_image(source, GetParam(), {}, file).error().message, "the row is lost");
}

// The first bytes are written long before the last rows are read.
TEST_P(EveryFormat, IsWrittenWhileItsRowsAreRead) {
  constexpr int kSide = 512;
  const Image image = random_image(kSide, kSide, 7);
  Buffer file;
  file.limit = 20'000'000;
  std::size_t least = file.limit, last_row = 0;
  const RowSource source{kSide, kSide, [&](int y) -> Result<const Rgb*> {
                           if (++last_row == kSide) least = file.bytes.size();
                           return &image.at(0, y);
                         }};
  ASSERT_TRUE(write_image(source, GetParam(), {}, file));
  EXPECT_GT(least, file.bytes.size() * 3 / 4);
}

// Written by an earlier release.
TEST(EncodeExr, WritesTheBytesOfGoldenImages) {
  const Result<std::string> golden = read_file(TESSERA_GOLDEN_EXR);
  ASSERT_TRUE(golden) << golden.error().message;
  const Result<Image> image = decode_image(*golden);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_TRUE(encode_or_die(*image, ImageFormat::kExr) == *golden);
}

TEST(EncodeExr, SaysWhereTheRegionOfAnImageIs) {
  const Image image = random_image(20, 10, 6);
  const RowSource source{20, 10, [&](int y) -> Result<const Rgb*> { return &image.at(0, y); },
                         RowSource::Position{30, 40, 100, 80}};
  Buffer file;
  ASSERT_TRUE(write_image(source, ImageFormat::kExr, {}, file));
  Imf::StdISStream stream;
  stream.str(file.bytes);
  const Imf::InputFile read(stream);
  EXPECT_EQ(read.header().dataWindow(), Imath::Box2i({30, 40}, {49, 49}));
  EXPECT_EQ(read.header().displayWindow(), Imath::Box2i({0, 0}, {99, 79}));
  const Result<Image> decoded = decode_image(file.bytes);
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(bits_of(*decoded), bits_of(image));
}

TEST_P(EveryFormat, RefusesAnEmptyImage) {
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
  EXPECT_TRUE(check_encodable(ImageFormat::kPng, 32768, 32768));
  EXPECT_FALSE(check_encodable(ImageFormat::kPng, 65536, 16385));
  EXPECT_FALSE(check_encodable(ImageFormat::kHdr, 23170, 23170));
  EXPECT_THAT(check_encodable(ImageFormat::kHdr, 23170, 23170).error().message, HasSubstr("use .exr"));
}

}  // namespace
}  // namespace tessera::core
