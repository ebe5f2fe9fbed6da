// SPDX-License-Identifier: Apache-2.0
#include "core/image/color_profile.hpp"

#include <gtest/gtest.h>
#include <libdeflate.h>

#include <cstdint>
#include <string>

namespace tessera::core {
namespace {

std::string big_endian(std::uint32_t value, int bytes = 4) {
  std::string text;
  for (int i = bytes - 1; i >= 0; --i) text.push_back(static_cast<char>(value >> (8 * i)));
  return text;
}

std::string little_endian(std::uint32_t value, int bytes = 4) {
  const std::string text = big_endian(value, bytes);
  return {text.rbegin(), text.rend()};
}

// An ICC profile whose only tag is its description: of version 2, or of version 4.
std::string profile(const std::string& name, bool version_4 = false) {
  std::string tag = "desc" + big_endian(0) + big_endian(static_cast<std::uint32_t>(name.size()) + 1) + name;
  tag.push_back('\0');
  if (version_4) {
    tag = "mluc" + big_endian(0) + big_endian(1) + big_endian(12) + "enUS" +
          big_endian(static_cast<std::uint32_t>(2 * name.size())) + big_endian(28);
    for (const char c : name) tag += big_endian(static_cast<unsigned char>(c), 2);
  }
  std::string bytes(128, '\0');
  bytes.replace(36, 4, "acsp");
  return bytes + big_endian(1) + "desc" + big_endian(144) +
         big_endian(static_cast<std::uint32_t>(tag.size())) + tag;
}

std::string chunk(const std::string& type, const std::string& data) {
  return big_endian(static_cast<std::uint32_t>(data.size())) + type + data + "crc.";
}

std::string png_with(const std::string& chunks) {
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", std::string(13, '\0')) + chunks + chunk("IDAT", "");
}

std::string compressed(const std::string& plain) {
  libdeflate_compressor* compressor = libdeflate_alloc_compressor(6);
  std::string bytes(libdeflate_zlib_compress_bound(compressor, plain.size()), '\0');
  bytes.resize(libdeflate_zlib_compress(compressor, plain.data(), plain.size(), bytes.data(), bytes.size()));
  libdeflate_free_compressor(compressor);
  return bytes;
}

std::string iccp(const std::string& keyword, const std::string& icc) {
  return chunk("iCCP", keyword + std::string(2, '\0') + compressed(icc));
}

TEST(ColorProfile, OfPngFiles) {
  EXPECT_EQ(foreign_color_profile(png_with("")), std::nullopt);
  EXPECT_EQ(foreign_color_profile(png_with(iccp("ICC Profile", profile("Adobe RGB (1998)")))),
            "Adobe RGB (1998)");
  EXPECT_EQ(foreign_color_profile(png_with(iccp("ICC Profile", profile("Display P3", true)))), "Display P3");
  EXPECT_EQ(foreign_color_profile(png_with(iccp("icc", profile("sRGB IEC61966-2.1")))), std::nullopt);
  EXPECT_EQ(foreign_color_profile(png_with(iccp("icc", profile("Linear sRGB")))), "Linear sRGB");
  EXPECT_EQ(foreign_color_profile(png_with(iccp("ProPhoto", "damaged"))), "ProPhoto");
}

TEST(ColorProfile, OfGammaAndPrimaries) {
  const std::string linear = chunk("gAMA", big_endian(100000)), usual = chunk("gAMA", big_endian(45455));
  EXPECT_EQ(foreign_color_profile(png_with(linear)), "gamma 1");
  EXPECT_EQ(foreign_color_profile(png_with(usual)), std::nullopt);
  EXPECT_EQ(foreign_color_profile(png_with(linear + chunk("sRGB", std::string(1, '\0')))), std::nullopt);
  const auto primaries = [](std::uint32_t red_x) {
    return chunk("cHRM", big_endian(31270) + big_endian(32900) + big_endian(red_x) + big_endian(33000) +
                             big_endian(30000) + big_endian(60000) + big_endian(15000) + big_endian(6000));
  };
  EXPECT_EQ(foreign_color_profile(png_with(primaries(64000))), std::nullopt);
  EXPECT_EQ(foreign_color_profile(png_with(primaries(68000))), "primaries other than those of sRGB");
}

TEST(ColorProfile, OfJpegTiffAndWebp) {
  const std::string icc = profile("ProPhoto RGB");
  const std::string segment = std::string("ICC_PROFILE\0\1\1", 14) + icc;
  EXPECT_EQ(foreign_color_profile("\xff\xd8\xff\xe2" +
                                  big_endian(static_cast<std::uint32_t>(segment.size()) + 2, 2) + segment +
                                  "\xff\xda"),
            "ProPhoto RGB");
  EXPECT_EQ(foreign_color_profile("\xff\xd8\xff\xff\xe2" +  // with a fill byte
                                  big_endian(static_cast<std::uint32_t>(segment.size()) + 2, 2) + segment),
            "ProPhoto RGB");
  const auto size = static_cast<std::uint32_t>(icc.size());
  EXPECT_EQ(foreign_color_profile("II*" + std::string(1, '\0') + little_endian(8) + little_endian(1, 2) +
                                  little_endian(34675, 2) + little_endian(7, 2) + little_endian(size) +
                                  little_endian(26) + little_endian(0) + icc),
            "ProPhoto RGB");
  EXPECT_EQ(foreign_color_profile("RIFF....WEBPVP8X" + little_endian(2) + "xx" + "ICCP" +
                                  little_endian(size) + icc),
            "ProPhoto RGB");
}

TEST(ColorProfile, ThatIsDamagedIsNone) {
  const std::string jpeg = "\xff\xd8\xff\xe2" + big_endian(400, 2) + std::string("ICC_PROFILE\0\1\1", 14);
  EXPECT_EQ(foreign_color_profile(jpeg + profile("Cut off").substr(0, 140)), std::nullopt);
  for (const std::string& start : {std::string("\x89PNG\r\n\x1a\n"), std::string("II*\0\xff\xff\xff\xff", 8),
                                   std::string("RIFF....WEBPICCP\xff\xff\xff\xff"), std::string()})
    EXPECT_EQ(foreign_color_profile(start), std::nullopt);
}

}  // namespace
}  // namespace tessera::core
