// SPDX-License-Identifier: Apache-2.0
// The formats that other programs write: pixels, precision, alpha, and what is refused.
#include "core/image/codecs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <string>

#include "core/image/decode.hpp"
#include "core/image/encode.hpp"
#include "tests/support/hostile_images.hpp"
#include "tests/unit/core_image/image_files.hpp"
#include "tests/unit/core_image/test_image.hpp"

namespace tessera::core::codecs_test {
namespace {

using namespace std::string_literals;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr DecodeOptions kColors{.max_pixels = 1 << 28}, kWithAlpha{.max_pixels = 1 << 28, .keep_alpha = true};

template <typename Values>
Values decode_as(const std::string& file, const DecodeOptions& options = kColors, std::size_t channels = 3) {
  auto image = decode_pixels(file, options);
  EXPECT_TRUE(image.has_value()) << image.error().message;
  if (!image) return {};
  EXPECT_EQ(image->channels, channels);
  EXPECT_TRUE(std::holds_alternative<Values>(image->values));
  return std::holds_alternative<Values>(image->values) ? std::get<Values>(image->values) : Values{};
}
using Bytes = DecodedImage::Bytes;
using Words = DecodedImage::Words;
using Floats = DecodedImage::Floats;

std::string error_of(const std::string& file) {
  const auto image = decode_pixels(file, kColors);
  return image ? "no error" : image.error().message;
}

TEST(Codecs, ReadsColorsOfBmpTgaAndWebp) {
  const Bytes rgb = test::smooth_codes(11, 7, 3), rgba = test::smooth_codes(11, 7, 4);
  EXPECT_EQ(decode_as<Bytes>(test::bmp_file(11, 7, rgb)), rgb);
  EXPECT_EQ(decode_as<Bytes>(test::tga_file(11, 7, rgb)), rgb);
  EXPECT_EQ(decode_as<Bytes>(test::webp_file(11, 7, rgba), kWithAlpha, 4), rgba);
}

// ---- TGA ----

// Header of `width` x 1 pixels.
std::string tga_header(int kind, int width, int bits, int descriptor = 0, int palette = 0,
                       int palette_bits = 0) {
  std::string header(18, '\0');
  header[1] = palette > 0 ? 1 : 0;
  header[2] = static_cast<char>(kind);
  header[5] = static_cast<char>(palette);
  header[7] = static_cast<char>(palette_bits);
  header[12] = static_cast<char>(width);
  header[14] = 1;
  header[16] = static_cast<char>(bits);
  header[17] = static_cast<char>(descriptor);
  return header;
}

// A pixel of red, green and blue, one near it, two of a run, one by its index, and one with alpha.
const std::string kQoiPixels =
    "\xfe\x80\x40\x20"
    "\x6b"
    "\xc1"
    "\x15"
    "\xff\x01\x02\x03\x04"s;

std::string qoi(std::uint8_t width, std::uint8_t height, const std::string& pixels) {
  return "qoif\0\0\0"s + static_cast<char>(width) + "\0\0\0"s + static_cast<char>(height) + "\4\0"s + pixels +
         "\0\0\0\0\0\0\0\1"s;
}

TEST(QoiCodec, ReadsAllKindsOfPixels) {
  const std::string file = qoi(3, 2, kQoiPixels);
  EXPECT_THAT(decode_as<Bytes>(file), ElementsAre(0x80, 0x40, 0x20, 0x80, 0x40, 0x21, 0x80, 0x40, 0x21, 0x80,
                                                  0x40, 0x21, 0x80, 0x40, 0x20, 1, 2, 3));
  const auto rgba = decode_as<Bytes>(file, kWithAlpha, 4);
  EXPECT_EQ(rgba.at(3), 255);
  EXPECT_EQ(rgba.at(23), 4);
  EXPECT_TRUE(decode_pixels(file, kWithAlpha)->warnings.empty());
  std::string linear = file;
  linear[13] = 1;
  EXPECT_THAT(decode_pixels(linear, kWithAlpha)->warnings, ElementsAre(HasSubstr("linear")));
}

TEST(QoiCodec, RefusesWhatIsCutOffOrImplausible) {
  const std::string file = qoi(3, 2, kQoiPixels);
  EXPECT_THAT(error_of(file.substr(0, file.size() - 1)), HasSubstr("the file ends too early"));
  EXPECT_THAT(error_of(file.substr(0, 9)), HasSubstr("the file ends too early"));
  EXPECT_THAT(error_of(qoi(255, 255, "")), HasSubstr("not plausible"));
  std::string odd = file;
  odd[12] = 5;
  EXPECT_THAT(error_of(odd), HasSubstr("its channels or its colour space are unknown"));
}

TEST(TgaCodec, ReadsAllKinds) {
  EXPECT_THAT(decode_as<Bytes>(tga_header(3, 2, 8) + "\x10\xf0"), ElementsAre(16, 16, 16, 240, 240, 240));
  EXPECT_THAT(decode_as<Bytes>(tga_header(1, 2, 8, 0, 2, 24) + "\1\2\3\4\5\6\1\0"s),
              ElementsAre(6, 5, 4, 3, 2, 1));
  EXPECT_THAT(decode_as<Bytes>(tga_header(2, 2, 16) + "\x1f\x00\x00\x7c"s),
              ElementsAre(0, 0, 255, 255, 0, 0));
  EXPECT_THAT(decode_as<Bytes>(tga_header(10, 4, 24) + "\x82\1\2\3\0\7\x08\x09"s),
              ElementsAre(3, 2, 1, 3, 2, 1, 3, 2, 1, 9, 8, 7));
  EXPECT_THAT(decode_as<Bytes>(tga_header(11, 3, 8, 0x10) + "\1\1\2\0\3"s),
              ElementsAre(3, 3, 3, 2, 2, 2, 1, 1, 1))
      << "from the right";
  // An index that the palette does not have is black.
  EXPECT_THAT(decode_as<Bytes>(tga_header(1, 1, 8, 0, 1, 24) + "\1\2\3\x05"s), ElementsAre(0, 0, 0));
}

TEST(TgaCodec, KeepsAlphaUnlessItIsZeroEverywhere) {
  EXPECT_THAT(decode_as<Bytes>(tga_header(2, 2, 32, 8) + "\1\2\3\x80\4\5\6\0"s, kWithAlpha, 4),
              ElementsAre(3, 2, 1, 128, 6, 5, 4, 0));
  EXPECT_THAT(decode_as<Bytes>(tga_header(2, 2, 32) + "\1\2\3\0\4\5\6\0"s, kWithAlpha, 3),
              ElementsAre(3, 2, 1, 6, 5, 4));
}

// ---- TIFF ----

TEST(TiffCodec, KeepsThePrecision) {
  EXPECT_EQ(decode_as<Bytes>(test::tiff_file())[3 * 19 + 2], 7 * 19 + 80 + 3);
  EXPECT_EQ(decode_as<Words>(test::tiff_file({.width = 40, .height = 40, .bits = 16}))[3 * 1599 + 1],
            7 * 1599 + 43);
  EXPECT_EQ(decode_as<Floats>(test::tiff_file({.bits = 32, .is_float = true}))[3 * 19], 136.0f);
  // The samples are the bits of halves that are not normalised.
  EXPECT_EQ(decode_as<Floats>(test::tiff_file({.bits = 16, .is_float = true}))[3 * 19], 136 * 0x1p-24f);
}

TEST(TiffCodec, ReadsAllLayouts) {
  const Words expected = decode_as<Words>(test::tiff_file({.width = 37, .height = 21, .bits = 16}));
  for (const bool tiled : {false, true})
    for (const bool planar : {false, true})
      for (const int compression : {1, 5, 8, 32773})
        EXPECT_EQ(decode_as<Words>(test::tiff_file({.width = 37,
                                                    .height = 21,
                                                    .bits = 16,
                                                    .tiled = tiled,
                                                    .planar = planar,
                                                    .compression = compression})),
                  expected)
            << tiled << planar << compression;
}

TEST(TiffCodec, ReadsGrayAlphaAndOrientation) {
  EXPECT_THAT(decode_as<Bytes>(test::tiff_file({.width = 2, .height = 1, .samples = 1, .photometric = 1})),
              ElementsAre(3, 3, 3, 10, 10, 10));
  EXPECT_THAT(decode_as<Bytes>(test::tiff_file({.width = 2, .height = 1, .samples = 1, .photometric = 0})),
              ElementsAre(252, 252, 252, 245, 245, 245));
  EXPECT_THAT(decode_as<Bytes>(test::tiff_file({.width = 1, .height = 1, .samples = 4}), kWithAlpha, 4),
              ElementsAre(3, 43, 83, 123));
  EXPECT_THAT(decode_as<Bytes>(test::tiff_file({.width = 1, .height = 1, .samples = 4})),
              ElementsAre(3, 43, 83));
  EXPECT_THAT(decode_as<Bytes>(test::tiff_file(
                  {.width = 2, .height = 1, .samples = 1, .photometric = 1, .orientation = 2})),
              ElementsAre(10, 10, 10, 3, 3, 3));
}

TEST(TiffCodec, ConvertsWhatIsStoredOtherwise) {
  // CMYK (photometric 5): no ink but what the samples say.
  const Bytes cmyk =
      decode_as<Bytes>(test::tiff_file({.width = 1, .height = 1, .samples = 4, .photometric = 5}));
  EXPECT_THAT(cmyk, ElementsAre((255 - 3) * (255 - 123) / 255, (255 - 43) * (255 - 123) / 255,
                                (255 - 83) * (255 - 123) / 255));
}

// ---- PNG ----

TEST(PngCodec, KeepsAlphaAndSixteenBits) {
  const auto png = [](int color_type, int bits, const std::string& pixels, const std::string& more = "") {
    std::string header = big_endian(1) + big_endian(1) + std::string(5, '\0');
    header[8] = static_cast<char>(bits);
    header[9] = static_cast<char>(color_type);
    const auto length = static_cast<char>(pixels.size());
    const std::string stored =
        "\x78\x01\x01"s + length + '\0' + static_cast<char>(~length) + '\xff' + pixels + std::string(4, '\0');
    return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header) + more + png_chunk("IDAT", stored) +
           png_chunk("IEND", "");
  };
  EXPECT_THAT(decode_as<Bytes>(png(6, 8, "\0\1\2\3\4"s), kWithAlpha, 4), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(decode_as<Bytes>(png(6, 8, "\0\1\2\3\4"s)), ElementsAre(1, 2, 3));
  EXPECT_THAT(decode_as<Words>(png(6, 16, "\0\1\2\3\4\5\6\7\x08"s), kWithAlpha, 4),
              ElementsAre(0x102, 0x304, 0x506, 0x708));
  EXPECT_THAT(decode_as<Words>(png(2, 16, "\0\1\2\3\4\5\6"s)), ElementsAre(0x102, 0x304, 0x506));
  // A colour that is transparent, and a palette with alpha.
  EXPECT_THAT(decode_as<Bytes>(png(2, 8, "\0\1\2\3"s, png_chunk("tRNS", "\0\1\0\2\0\3"s)), kWithAlpha, 4),
              ElementsAre(1, 2, 3, 0));
  const std::string palette = png_chunk("PLTE", "\1\2\3"s);
  EXPECT_THAT(decode_as<Bytes>(png(3, 8, "\0\0"s, palette + png_chunk("tRNS", "\x40")), kWithAlpha, 4),
              ElementsAre(1, 2, 3, 64));
  EXPECT_THAT(decode_as<Bytes>(png(0, 8, "\0\7"s), kWithAlpha), ElementsAre(7, 7, 7))
      << "no alpha in the file";
}

// Whatever memory held before.
TEST(PngCodec, GivesIndicesBeyondThePaletteTheSameColorAlways) {
  std::string header = big_endian(1) + big_endian(1) + "\x08\x03\0\0\0"s;
  const std::string file = "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header) + png_chunk("PLTE", "\1\2\3"s) +
                           png_chunk("IDAT", "\x78\x01\x01\2\0\xfd\xff\0\x99\0\0\0\0"s) +
                           png_chunk("IEND", "");
  EXPECT_THAT(decode_as<Bytes>(file), ElementsAre(0, 0, 0));
}

// ---- OpenEXR and PFM ----

TEST(PfmCodec, ReadsAnyWhiteSpaceInTheHeader) {
  const std::string pixel = "\x3f\x80\0\0"s;
  for (const char* header : {"Pf\n1 1\n1.0\n", "Pf 1 1 1\n", "Pf\r\n1 1\r\n1.0\r\n", "Pf\n1\n1\n  1.0\n"})
    EXPECT_THAT(decode_as<Floats>(header + pixel), ElementsAre(1, 1, 1)) << header;
}

// ---- All ----

TEST(Codecs, TellsFormatsByContent) {
  for (const auto& [name, file] : test::files_of_all_formats()) {
    const auto size = image_size(file);
    ASSERT_TRUE(size.has_value()) << name << ": " << size.error().message;
    EXPECT_GT(size->pixels(), 0u) << name;
    EXPECT_EQ(is_linear_format(file), name == "exr" || name == "hdr" || name == "pfm") << name;
  }
}

TEST(Codecs, NamesFormatsThatAreNotSupported) {
  EXPECT_EQ(error_of("GIF89a\1\0\1\0"s), "is a GIF image, which is not supported; save it as PNG");
  EXPECT_EQ(error_of("DDS |\0\0\0"s), "is a DDS image, which is not supported; save it as PNG");
  EXPECT_EQ(error_of("P6\n1 1\n255\nabc"), "is a Netpbm image, which is not supported; save it as PNG");
  EXPECT_EQ(error_of("\0\0\0\x0cjP  \r\n\x87\n"s),
            "is a JPEG 2000 image, which is not supported; save it as PNG");
  EXPECT_EQ(error_of("8BPS\0\1"s), "is a Photoshop image, which is not supported; save it as PNG");
  EXPECT_EQ(error_of(""), "is an empty file, not an image");
  EXPECT_EQ(error_of("Dear reader,"),
            "is not an image of a known format (PNG, JPEG, HDR, EXR, PFM, TIFF, WebP, BMP, QOI or TGA)");
  std::string rle = test::bmp_file(2, 2, test::smooth_codes(2, 2, 3));
  rle[30] = 1;
  EXPECT_EQ(error_of(rle),
            "is a compressed BMP image, which is not supported; save it uncompressed or as PNG");
}

TEST(Codecs, CutFilesAreErrors) {
  for (const auto& [name, file] : test::files_of_all_formats()) {
    ASSERT_EQ(error_of(file), "no error") << name;
    // What lies behind the pixels: PNG's last chunk and two checksums, JPEG's end marker, BMP's and WebP's
    // padding. TIFF has its header there, whose last entries have defaults.
    const std::size_t tail = name == "png" ? 20 : name == "tga" ? 26 : 4;
    for (std::size_t size = 0; size + tail < file.size(); size += 3)
      EXPECT_NE(error_of(file.substr(0, size)), "no error") << name << ": " << size << " of " << file.size();
  }
}

TEST(Codecs, DamagedFilesAreSurvived) {
  std::mt19937_64 random(9);
  for (const auto& [name, file] : test::files_of_all_formats())
    for (int i = 0; i < 400; ++i) {
      std::string damaged = file;
      for (int k = 0; k < 3; ++k) {
        const std::size_t span = random() % 2 == 0 ? std::min<std::size_t>(200, file.size()) : file.size();
        damaged[random() % span] = static_cast<char>(random());
      }
      const auto once = decode_pixels(damaged, kWithAlpha), again = decode_pixels(damaged, kWithAlpha);
      ASSERT_EQ(once.has_value(), again.has_value()) << name;
      if (!once) {
        EXPECT_EQ(once.error().message, again.error().message) << name;
      } else if (!once->is_linear()) {  // NaN does not equal itself
        EXPECT_EQ(once->values, again->values) << name << ": decoding depends on nothing but the file";
      }
    }
}

}  // namespace
}  // namespace tessera::core::codecs_test
