// SPDX-License-Identifier: Apache-2.0
// JPEG files of other programs, whole, odd and hostile.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "core/image/codecs.hpp"
#include "tests/unit/core_image/image_files.hpp"

namespace tessera::core::jpeg_codec_test {
namespace {

using namespace std::string_literals;
using test::jpeg_file;
using testing::HasSubstr;

constexpr DecodeOptions kOptions{.max_pixels = 1 << 28};

DecodedImage decode_or_die(const std::string& file) {
  auto image = decode_pixels(file, kOptions);
  EXPECT_TRUE(image.has_value()) << image.error().message;
  return image ? std::move(*image) : DecodedImage{};
}

const DecodedImage::Bytes& codes(const DecodedImage& image) {
  return std::get<DecodedImage::Bytes>(image.values);
}

std::string error_of(const std::string& file) {
  const auto image = decode_pixels(file, kOptions);
  return image ? "no error" : image.error().message;
}

constexpr std::string_view kEnd = "\xff\xd9";

TEST(JpegCodec, ReadsAllCodings) {
  const std::vector<std::uint8_t> expected = test::smooth_codes(40, 24, 3);
  for (const test::JpegOptions& options :
       {test::JpegOptions{}, {.progressive = true}, {.arithmetic = true}, {.restart_rows = 1}}) {
    const DecodedImage image = decode_or_die(jpeg_file(options));
    EXPECT_EQ(image.size.width, 40);
    EXPECT_EQ(image.size.height, 24);
    EXPECT_THAT(image.warnings, testing::IsEmpty());
    ASSERT_EQ(codes(image).size(), expected.size());
    double difference = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) difference += std::abs(codes(image)[i] - expected[i]);
    EXPECT_LT(difference / static_cast<double>(expected.size()), 12);
  }
}

TEST(JpegCodec, NeedsNoEndMarker) {
  for (const bool progressive : {false, true}) {
    const std::string file = jpeg_file({.progressive = progressive});
    ASSERT_TRUE(file.ends_with(kEnd));
    const DecodedImage whole = decode_or_die(file);
    for (std::size_t missing : {1, 2}) {
      const DecodedImage image = decode_or_die(file.substr(0, file.size() - missing));
      EXPECT_EQ(codes(image), codes(whole));
      ASSERT_EQ(image.warnings.size(), 1u);
      EXPECT_EQ(image.warnings[0],
                "is a JPEG image with faults, which were passed over (1: Premature end of JPEG file)");
    }
  }
}

TEST(JpegCodec, PassesOverStrayBytesAndMarkers) {
  const std::string file = jpeg_file(), progressive = jpeg_file({.progressive = true});
  const DecodedImage whole = decode_or_die(file), whole_progressive = decode_or_die(progressive);
  for (const std::string& stray : {"\0\0\0\0"s, "\xff\0\xff\0"s, "\xff\xff\xff"s, "\xff\xd0"s, "abc"s}) {
    std::string before_end = file;
    before_end.insert(file.size() - 2, stray);
    EXPECT_EQ(codes(decode_or_die(before_end)), codes(whole));
    EXPECT_EQ(codes(decode_or_die(file + stray)), codes(whole));
    std::string between = progressive;
    between.insert(progressive.rfind("\xff\xc4"), stray);  // before the last scan's tables
    EXPECT_EQ(codes(decode_or_die(between)), codes(whole_progressive));
  }
}

TEST(JpegCodec, RefusesFilesThatLackData) {
  for (const test::JpegOptions& options : {test::JpegOptions{}, {.progressive = true}, {.restart_rows = 1}}) {
    const std::string file = jpeg_file(options);
    for (std::size_t size = 3; size + 8 < file.size(); size += 5)
      EXPECT_NE(error_of(file.substr(0, size)), "no error") << size << " of " << file.size();
    EXPECT_EQ(error_of(file.substr(0, file.size() - 40)), "is a broken JPEG image (the file ends too early)");
  }
}

// Adobe's programs store 255 minus the ink.
TEST(JpegCodec, ConvertsCmykWithAndWithoutAdobesMarker) {
  const std::vector<std::uint8_t> stored = test::smooth_codes(40, 24, 4);
  for (const bool adobe : {false, true}) {
    const DecodedImage image = decode_or_die(jpeg_file({.cmyk = true, .adobe_marker = adobe}));
    ASSERT_EQ(codes(image).size(), 3u * 40 * 24);
    double difference = 0;
    for (std::size_t i = 0; i < 40 * 24; ++i)
      for (std::size_t c = 0; c < 3; ++c) {
        const int ink = stored[4 * i + c], black = stored[4 * i + 3];
        const int expected = adobe ? ink * black / 255 : (255 - ink) * (255 - black) / 255;
        difference += std::abs(codes(image)[3 * i + c] - expected);
      }
    EXPECT_LT(difference / (3.0 * 40 * 24), 8) << adobe;
  }
}

// A segment that begins a progressive scan of nothing new, again and again.
TEST(JpegCodec, RefusesEndlessScans) {
  const std::string file = jpeg_file({.progressive = true});
  const std::size_t scan = file.rfind("\xff\xda");
  const std::string last = file.substr(scan, file.size() - 2 - scan);
  std::string bomb = file.substr(0, file.size() - 2);
  for (int i = 0; i < 600; ++i) bomb += last;
  EXPECT_EQ(error_of(bomb + "\xff\xd9"), "is a broken JPEG image (it has too many scans)");
}

TEST(JpegCodec, RefusesSizesThatTheFileCannotHold) {
  std::string file = jpeg_file();
  const std::size_t frame = file.find("\xff\xc0");
  file.replace(frame + 5, 4, "\x7f\xff\x7f\xff");
  EXPECT_THAT(error_of(file), HasSubstr("1073676289 pixels, more than the 268435456"));
  file.replace(frame + 5, 4, "\x0f\xff\x0f\xff");
  EXPECT_EQ(error_of(file), "is a broken JPEG image (the file ends too early)");
}

TEST(JpegCodec, SaysWhatIsNotSupported) {
  std::string file = jpeg_file();
  file[file.find("\xff\xc0") + 4] = 12;
  EXPECT_EQ(error_of(file),
            "is a JPEG image of 12 bits, which is not supported; save it with 8 bits, or as PNG with 16");
}

// Run once more with JSIMD_FORCENONE=1, which switches libjpeg-turbo's SIMD code off (CMakeLists.txt): the
// hash is what both give, with chroma of half the size each way and odd edges.
TEST(JpegCodec, GivesTheSameBytesWithAndWithoutSimd) {
  std::uint64_t hash = 14695981039346656037u;  // FNV-1a
  for (const test::JpegOptions& options :
       {test::JpegOptions{.width = 251, .height = 127}, {.width = 251, .height = 127, .progressive = true}}) {
    const auto decoded = decode_or_die(jpeg_file(options));
    for (const std::uint8_t code : codes(decoded)) hash = (hash ^ code) * 1099511628211u;
  }
  EXPECT_EQ(hash, 11566677749284188851u);
}

}  // namespace
}  // namespace tessera::core::jpeg_codec_test
