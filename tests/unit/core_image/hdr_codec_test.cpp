// SPDX-License-Identifier: Apache-2.0
// Radiance HDR files of other programs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/image/codecs.hpp"

namespace tessera::core::hdr_codec_test {
namespace {

using namespace std::string_literals;
using testing::HasSubstr;

constexpr DecodeOptions kOptions{.max_pixels = 1 << 20};

std::vector<float> values_of(const std::string& file) {
  const auto image = decode_pixels(file, kOptions);
  EXPECT_TRUE(image.has_value()) << image.error().message;
  return image ? std::get<DecodedImage::Floats>(image->values) : std::vector<float>();
}

std::vector<float> reds_of(const std::string& file) {
  std::vector<float> reds;
  const std::vector<float> values = values_of(file);
  for (std::size_t i = 0; i < values.size(); i += 3) reds.push_back(values[i]);
  return reds;
}

std::string error_of(const std::string& file) {
  const auto image = decode_pixels(file, kOptions);
  return image ? "no error" : image.error().message;
}

// A pixel whose red is the mantissa.
std::string pixel(int mantissa) {
  return {static_cast<char>(mantissa), '\x10', '\x20', static_cast<char>(136)};
}

// Six pixels with reds of 128 to 133 in the order of the file.
std::string six_pixels() {
  std::string pixels;
  for (int i = 0; i < 6; ++i) pixels += pixel(128 + i);
  return pixels;
}

const std::string kHeader = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";

TEST(HdrCodec, ReadsAllOrientations) {
  const auto reds = [](const std::string& size) { return reds_of(kHeader + size + "\n" + six_pixels()); };
  using testing::ElementsAre;
  EXPECT_THAT(reds("-Y 2 +X 3"), ElementsAre(128, 129, 130, 131, 132, 133));
  EXPECT_THAT(reds("-Y 2 -X 3"), ElementsAre(130, 129, 128, 133, 132, 131));
  EXPECT_THAT(reds("+Y 2 +X 3"), ElementsAre(131, 132, 133, 128, 129, 130));
  EXPECT_THAT(reds("+Y 2 -X 3"), ElementsAre(133, 132, 131, 130, 129, 128));
  EXPECT_THAT(reds("+X 3 -Y 2"), ElementsAre(128, 130, 132, 129, 131, 133));
  EXPECT_THAT(reds("+X 3 +Y 2"), ElementsAre(129, 131, 133, 128, 130, 132));
  EXPECT_THAT(reds("-X 3 -Y 2"), ElementsAre(132, 130, 128, 133, 131, 129));
  EXPECT_THAT(reds("-X 3 +Y 2"), ElementsAre(133, 131, 129, 132, 130, 128));
}

TEST(HdrCodec, ReadsHeadersInAnyOrderAndWithEitherLineEnd) {
  const std::vector<float> expected = reds_of(kHeader + "-Y 2 +X 3\n" + six_pixels());
  for (const char* header :
       {"#?RGBE\n\n-Y 2 +X 3\n",
        "#?RADIANCE\n# comment\nEXPOSURE=1\nSOFTWARE=x = y\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 3\n",
        "#?RADIANCE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 2 +X 3\r\n", "#?RADIANCE\n-Y 2 +X 3\n",
        "FORMAT=32-bit_rle_rgbe\n#?RADIANCE\n\n-Y 2 +X 3\n",
        "#?RADIANCE\n FORMAT = 32-bit_rle_rgbe \n\n-Y  2 +X 3 \n"})
    EXPECT_EQ(reds_of(header + six_pixels()), expected) << header;
}

TEST(HdrCodec, DividesByAllExposures) {
  const std::string file =
      "#?RADIANCE\nEXPOSURE=4\nFORMAT=32-bit_rle_rgbe\nEXPOSURE= 0.5\n\n-Y 1 +X 1\n" + pixel(128);
  EXPECT_THAT(values_of(file), testing::ElementsAre(64, 8, 16));
  for (const char* exposure : {"0", "-1", "x", "inf", "nan", "1e400"})
    EXPECT_THAT(error_of("#?RADIANCE\nEXPOSURE="s + exposure + "\n\n-Y 1 +X 1\n" + pixel(128)),
                HasSubstr("its EXPOSURE is not a positive number"));
}

TEST(HdrCodec, ConvertsXyz) {
  // The white of D65 (CIE 15:2004) in units of 1/256, nearly.
  const std::string white = "\xf3\xff\xff\x80"s;
  std::string file = "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n"s + white;
  file[file.size() - 2] = '\xff';
  const std::vector<float> values = values_of(file);
  ASSERT_EQ(values.size(), 3u);
  // 243, 255, 255 of 256 are X = 0.949, Y = 0.996, Z = 0.996: bluish by what Z lacks to 1.089.
  EXPECT_NEAR(values[0], 3.2406 * 0.94922 - 1.5372 * 0.99609 - 0.4986 * 0.99609, 1e-3);
  EXPECT_NEAR(values[1], -0.9689 * 0.94922 + 1.8758 * 0.99609 + 0.0415 * 0.99609, 1e-3);
  EXPECT_NEAR(values[2], 0.0557 * 0.94922 - 0.2040 * 0.99609 + 1.0570 * 0.99609, 1e-3);
}

TEST(HdrCodec, ReadsOldRunLengths) {
  const std::string file =
      kHeader + "-Y 2 +X 3\n" + pixel(200) + "\1\1\1\2"s + pixel(130) + pixel(131) + "\1\1\1\1"s;
  EXPECT_THAT(reds_of(file), testing::ElementsAre(200, 200, 200, 130, 131, 131));
  // 0x0102 pixels: the lower byte first.
  const std::string longer = kHeader + "-Y 1 +X 259\n" + pixel(150) + "\1\1\1\2\1\1\1\1"s;
  EXPECT_EQ(reds_of(longer), std::vector<float>(259, 150));
}

TEST(HdrCodec, ReadsPackedRows) {
  const std::string packed = "\2\2\0\x08"s + "\x88\xc8"s + "\3abc\x85\x10"s + "\x88\x20\x88\x88"s;
  const std::vector<float> values = values_of(kHeader + "-Y 1 +X 8\n" + packed);
  ASSERT_EQ(values.size(), 24u);
  EXPECT_EQ(values[0], 200);
  EXPECT_EQ(values[1], 'a');
  EXPECT_EQ(values[22], 16);
}

TEST(HdrCodec, SaysWhatIsWrong) {
  EXPECT_EQ(error_of("#?RADIANCE\n\n"),
            "is a broken HDR image (it has no line that tells its size, such as -Y 512 +X 1024)");
  EXPECT_EQ(error_of(kHeader + "-Y 2 +X 3\n" + pixel(200)),
            "is a broken HDR image (the file ends too early)");
  EXPECT_EQ(error_of(kHeader + "-Y 2 +X 3\n" + pixel(200) + "\1\1\1\3"s + six_pixels()),
            "is a broken HDR image (a run is longer than its row)");
  EXPECT_EQ(error_of(kHeader + "-Y 1 +X 8\n\2\2\0\x09"s + std::string(64, 'x')),
            "is a broken HDR image (a row has another length)");
  EXPECT_THAT(error_of("#?RADIANCE\nFORMAT=16-bit\n\n-Y 1 +X 1\n"),
              HasSubstr("FORMAT is not 32-bit_rle_rgbe"));
  EXPECT_EQ(error_of(kHeader + "-Y 0 +X 3\n"), "is a broken HDR image (it has no pixels)");
  EXPECT_EQ(error_of(kHeader + "-Y 2000 +X 3000\n"),
            "has 3000 x 2000 = 6000000 pixels, more than the 1048576 that an image may have; scale it down");
}

TEST(HdrCodec, WarnsOfWhatIsIgnored) {
  const auto image = decode_pixels(
      "#?RADIANCE\nPRIMARIES=0.64 0.33 0.3 0.6 0.15 0.06 0.33 0.33\nCOLORCORR=1 1 2\n\n-Y 1 +X 1\n" +
          pixel(128),
      kOptions);
  ASSERT_TRUE(image.has_value());
  EXPECT_THAT(image->warnings, testing::ElementsAre("is an HDR image whose PRIMARIES are ignored",
                                                    "is an HDR image whose COLORCORR is ignored"));
}

}  // namespace
}  // namespace tessera::core::hdr_codec_test
