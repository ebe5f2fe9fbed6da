// SPDX-License-Identifier: Apache-2.0
#include "core/textures/image_decoder.hpp"

#include <gtest/gtest.h>
#include <stb_image_write.h>

#include <algorithm>
#include <array>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "core/image/encode.hpp"
#include "core/image/srgb.hpp"
#include "core/scene/loader/loader.hpp"
#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core {
namespace {

using namespace std::string_literals;

using test::hdr;
using test::layered_exr;
using test::one_color;
using test::png;

TEST(TextureDecoding, LayersAndChannelsOfOpenExrAreSelectable) {
  const std::string bytes = layered_exr();
  const auto texel = [&](std::string_view layer, TextureChannel channel = TextureChannel::kColor) {
    return decode_texture_image(bytes, ColorSpace::kLinear, channel, nullptr, layer)->texel(0, 0);
  };
  EXPECT_EQ(texel(""), (Rgb{0.125f, 0.25f, 0.375f}));
  EXPECT_EQ(texel("Tint"), (Rgb{0.625f, 0.75f, 0.875f}));
  EXPECT_EQ(texel("Tint", TextureChannel::kGreen), Rgb::gray(0.75f));
  EXPECT_EQ(texel("Depth.Z"), Rgb::gray(0.5f));
  EXPECT_FALSE(decode_texture_image(bytes, ColorSpace::kLinear, TextureChannel::kColor, nullptr, "Mist"));
}

// A pixel of (1, 0, 0), with chromaticities in the place of a text of equal length.
std::string exr_with_primaries(const std::array<float, 8>& primaries) {
  static constexpr std::array kRed{1.0f, 0.0f, 0.0f};
  const std::string name(22, 'n'), text(32, '.'), stand_in = name + "\0string\0 \0\0\0"s + text;
  const std::string attribute =
      "chromaticities\0chromaticities\0 \0\0\0"s +
      std::string(reinterpret_cast<const char*>(primaries.data()), sizeof(primaries));
  ChannelRows source{
      .width = 1, .height = 1, .channels = {"R", "G", "B"}, .row = {}, .attributes = {{name, text}}};
  source.row = [](int) -> Result<const float*> { return kRed.data(); };
  std::string bytes = *encode_channels(source, ImageFormat::kExr, {});
  EXPECT_EQ(stand_in.size(), attribute.size());
  return bytes.replace(bytes.find(stand_in), stand_in.size(), attribute);
}

TEST(TextureDecoding, PrimariesOfOpenExrAreConverted) {
  const std::string rec2020 =
      exr_with_primaries({0.708f, 0.292f, 0.17f, 0.797f, 0.131f, 0.046f, 0.3127f, 0.329f});
  std::vector<std::string> warnings;
  const auto read = [&](const std::string& bytes, ColorSpace color_space) {
    return decode_texture_image(bytes, color_space, TextureChannel::kColor, &warnings)->texel(0, 0);
  };
  const Rgb red = read(rec2020, ColorSpace::kSrgb);
  EXPECT_NEAR(red.r, 1.6604910f, 1e-3f);
  EXPECT_EQ(red.g, 0);
  EXPECT_EQ(warnings, std::vector<std::string>());
  EXPECT_EQ(read(rec2020, ColorSpace::kLinear), (Rgb{1, 0, 0}));
  EXPECT_EQ(
      warnings,
      (std::vector<std::string>{"has other primaries than sRGB, which are not used: it is read as data"}));
  const std::string aces = exr_with_primaries({0.7347f, 0.2653f, 0, 1, 0.0001f, -0.077f, 0.32168f, 0.33767f});
  EXPECT_NEAR(read(aces, ColorSpace::kSrgb).r, 2.5216862f, 3e-3f);
  const std::string same = exr_with_primaries({0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f});
  EXPECT_EQ(read(same, ColorSpace::kSrgb), (Rgb{1, 0, 0}));
  const std::string flat = exr_with_primaries({0.3f, 0.3f, 0.3f, 0.3f, 0.3f, 0.3f, 0.3f, 0.3f});
  EXPECT_EQ(read(flat, ColorSpace::kSrgb), (Rgb{1, 0, 0}));
  EXPECT_EQ(warnings.size(), 1u);
}

// A chunk gAMA of 1.0 behind the header.
TEST(TextureDecoding, ColourProfilesAreTold) {
  std::string bytes = png(one_color(2, 2, Rgb::gray(0.5f)));
  bytes.insert(33, std::string("\0\0\0\4gAMA\0\1\x86\xa0\x31\xe8\x96\x5f", 16));
  std::vector<std::string> warnings;
  ASSERT_TRUE(decode_texture_image(bytes, ColorSpace::kSrgb, TextureChannel::kColor, &warnings));
  EXPECT_EQ(warnings,
            (std::vector<std::string>{
                "has the colour profile 'gamma 1', which is not used: its values count as sRGB or linear"}));
}

// In scene files: "layer".
TEST(TextureDecoding, SceneFilesNameLayers) {
  const auto loaded = [](const std::string& keys) {
    test::MemoryAssets assets(
        {{"a.exr", layered_exr()}, {"scene.json", R"({"camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]},
      "textures": {"t": {"file": "a.exr")" + keys + R"(}},
      "materials": {"m": {"type": "lambert", "albedo": {"texture": "t"}}},
      "shapes": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "m"}]})"}});
    return load_scene(assets, "scene.json", "scene.json");
  };
  const auto scene = loaded(R"(, "layer": "Tint")");
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->textures.at(0).evaluate({0.5f, 0.5f}), (Rgb{0.625f, 0.75f, 0.875f}));
  const auto mistaken = loaded(R"(, "layer": "Tnt")");
  ASSERT_FALSE(mistaken);
  EXPECT_NE(mistaken.error().message.find("did you mean 'Tint'?"), std::string::npos)
      << mistaken.error().message;
}

TEST(DecodeTexture, KeepsThePixelsOfPngAndHdr) {
  Image image(3, 2);
  for (int i = 0; i < 6; ++i)
    image.pixels[static_cast<std::size_t>(i)] = Rgb{0.125f, 0.25f, 0.5f} * static_cast<float>(i);
  const auto from_png = decode_texture_image(png(image), ColorSpace::kSrgb);
  const auto from_hdr = decode_texture_image(hdr(image), ColorSpace::kLinear);
  ASSERT_TRUE(from_png && from_hdr);
  EXPECT_EQ(from_hdr->color_space(), ColorSpace::kLinear);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) {
      EXPECT_NEAR(from_png->texel(x, y).r, std::min(image.at(x, y).r, 1.0f), 0.005f);
      EXPECT_NEAR(from_hdr->texel(x, y).g, image.at(x, y).g, image.at(x, y).b / 128);
    }
}

// One gray pixel in 16 bits: 0x8000.
TEST(DecodeTexture, Keeps16BitsOfPng) {
  const std::string file(
      "\x89PNG\r\n\x1a\n"
      "\0\0\0\x0dIHDR\0\0\0\1\0\0\0\1\x10\0\0\0\0\x6a\xee\x47\x16"
      "\0\0\0\x0eIDAT\x78\x01\x01\x03\0\xfc\xff\0\x80\0\x01\x03\0\x81\xe1\xb3\x15\x63"
      "\0\0\0\0IEND\xae\x42\x60\x82",
      8 + 25 + 26 + 12);
  const auto srgb = decode_texture_image(file, ColorSpace::kSrgb);
  const auto linear = decode_texture_image(file, ColorSpace::kLinear);
  ASSERT_TRUE(srgb.has_value()) << srgb.error().message;
  EXPECT_EQ(srgb->texel(0, 0), Rgb::gray(srgb_decode(0x8000 / 65535.0)));
  EXPECT_EQ(linear->texel(0, 0), Rgb::gray(0x8000 / 65535.0f));
}

// An image whose left half has one colour and the right half another.
std::string jpeg() {
  std::vector<std::uint8_t> texels;
  for (int i = 0; i < 32 * 16; ++i)
    for (const int value : {i % 32 < 16 ? 200 : 40, 100, 60})
      texels.push_back(static_cast<std::uint8_t>(value));
  std::string bytes;
  const auto append = [](void* to, void* data, int size) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
  };
  stbi_write_jpg_to_func(append, &bytes, 32, 16, 3, texels.data(), 95);
  return bytes;
}

TEST(DecodeTexture, ReadsJpeg) {
  const auto image = decode_texture_image(jpeg(), ColorSpace::kLinear);
  ASSERT_TRUE(image.has_value()) << image.error().message;
  EXPECT_EQ(image->width(), 32);
  EXPECT_EQ(image->height(), 16);
  EXPECT_NEAR(image->texel(4, 8).r * 255, 200, 4);
  EXPECT_NEAR(image->texel(28, 8).r * 255, 40, 4);
  EXPECT_NEAR(image->texel(28, 8).b * 255, 60, 4);
}

// Two pixels with these alphas.
std::string png_with_alpha(std::uint8_t left, std::uint8_t right) {
  const std::array<std::uint8_t, 8> texels{255, 0, 0, left, 0, 255, 0, right};
  std::string bytes;
  const auto append = [](void* to, void* data, int size) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
  };
  stbi_write_png_to_func(append, &bytes, 2, 1, 4, texels.data(), 8);
  return bytes;
}

TEST(DecodeTexture, ReadsAlphaAsLinearNumbers) {
  const std::string file = png_with_alpha(51, 255);
  const auto alpha = decode_texture_image(file, ColorSpace::kSrgb, TextureChannel::kAlpha);
  ASSERT_TRUE(alpha.has_value()) << alpha.error().message;
  ASSERT_EQ(alpha->width(), 2);
  EXPECT_EQ(alpha->texel(0, 0), Rgb::gray(0.2f));
  EXPECT_EQ(alpha->texel(1, 0), Rgb::gray(1));
  const auto color = decode_texture_image(file, ColorSpace::kSrgb);
  EXPECT_EQ(color->texel(0, 0), (Rgb{1, 0, 0})) << "alpha does not change colours";
}

TEST(DecodeTexture, KeepsNoAlphaThatIsOneEverywhere) {
  for (const std::string& file : {png_with_alpha(255, 255), png(Image(3, 2)), hdr(Image(3, 2)), jpeg()}) {
    const auto alpha = decode_texture_image(file, ColorSpace::kLinear, TextureChannel::kAlpha);
    ASSERT_TRUE(alpha.has_value()) << alpha.error().message;
    EXPECT_EQ(alpha->width() * alpha->height(), 1);
    EXPECT_EQ(alpha->texel(0, 0), Rgb::gray(1));
  }
}

std::string decoding_error(const std::string& bytes) {
  const auto image = decode_texture_image(bytes, ColorSpace::kSrgb);
  return image ? "no error" : image.error().message;
}

TEST(DecodeTexture, RefusesWhatIsNoImage) {
  EXPECT_NE(decoding_error("Dear reader,").find("is not an image of a known format"), std::string::npos);
  EXPECT_EQ(decoding_error("GIF89a"), "is a GIF image, which is not supported; save it as PNG");
  EXPECT_NE(decoding_error("\x89PNG\r\n\x1a\n").find("is a broken PNG image"), std::string::npos);
  EXPECT_NE(decoding_error("\xff\xd8\xff\xe0").find("is a broken JPEG image"), std::string::npos);
  EXPECT_NE(decoding_error("#?RADIANCE\n\n").find("is a broken HDR image"), std::string::npos);
}

TEST(DecodeTexture, RefusesTooManyPixelsBeforeDecodingThem) {
  EXPECT_EQ(
      decoding_error("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 40000 +X 40000\n"),
      "has 40000 x 40000 = 1600000000 pixels, more than the 268435456 that an image may have; scale it down");
}

// A PFM of one pixel.
std::string pfm(float r, float g, float b) {
  std::string file = "PF\n1 1\n-1\n";
  for (const float value : {r, g, b}) file.append(reinterpret_cast<const char*>(&value), sizeof value);
  return file;
}

TEST(DecodeTexture, ReplacesWhatNoLightHas) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::vector<std::string> warnings;
  const auto image = decode_texture_image(pfm(-1, kInfinity, std::numeric_limits<float>::quiet_NaN()),
                                          ColorSpace::kLinear, TextureChannel::kColor, &warnings);
  ASSERT_TRUE(image.has_value()) << image.error().message;
  EXPECT_EQ(image->texel(0, 0), (Rgb{0, 65504, 0}));
  EXPECT_EQ(warnings, std::vector<std::string>{"has values that are negative, infinite or not numbers (3 of "
                                               "them); 0 or 65504 is used instead"});
  EXPECT_EQ(decode_texture_image(pfm(0.25f, 7, 0), ColorSpace::kSrgb)->texel(0, 0), (Rgb{0.25f, 7, 0}));
}

// Of a file's claim, before memory is taken for it.
TEST(DecodeTexture, RefusesMorePixelsThanTheFileCanHold) {
  std::string small = png(one_color(20, 20, {0.2f, 0.5f, 0.7f}));
  small[18] = small[22] = 0x20;  // 8,212 pixels a side: each takes 3 bytes, and the file has a hundred
  EXPECT_EQ(decoding_error(small), "is a broken PNG image (the file ends too early)");
  std::string photograph = jpeg();
  const std::size_t frame = photograph.find("\xff\xc0");
  photograph[frame + 5] = photograph[frame + 7] = 0x20;
  EXPECT_EQ(decoding_error(photograph), "is a broken JPEG image (the file ends too early)");
}

std::string big_endian(std::size_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<char>(value >> shift & 0xff));
  return bytes;
}

std::string chunk(const std::string& name, const std::string& content) {
  return big_endian(content.size()) + name + content + std::string(4, '\0');  // checksums are not read
}

// So many zeros in a zlib stream: one, and copies of it by the 258 (RFC 1951, fixed codes).
std::string compressed_zeros(std::size_t count) {
  std::string bits = "110";  // the last block, with fixed codes
  bits += "00110000";        // a zero
  for (std::size_t made = 1; made < count; made += 258) bits += "1100010100000";
  bits += "0000000";
  std::string bytes("\x78\x01");
  for (std::size_t i = 0; i < bits.size(); i += 8) {
    unsigned byte = 0;
    for (std::size_t k = 0; k < 8 && i + k < bits.size(); ++k) byte |= (bits[i + k] - '0' + 0u) << k;
    bytes.push_back(static_cast<char>(byte));
  }
  return bytes + std::string(4, '\0');
}

// Black, a bit for each pixel.
std::string black_png(std::size_t side_px) {
  const std::string header = big_endian(side_px) + big_endian(side_px) + std::string("\1\0\0\0\0", 5);
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) +
         chunk("IDAT", compressed_zeros(side_px * (1 + (side_px + 7) / 8))) + chunk("IEND", "");
}

// More than a thousand pixels for each byte of the file.
TEST(DecodeTexture, ReadsWhatIsCompressedWell) {
  constexpr int kSidePx = 2000;
  const std::string file = black_png(kSidePx);
  ASSERT_LT(file.size(), 4000u);
  const auto image = decode_texture_image(file, ColorSpace::kSrgb);
  ASSERT_TRUE(image.has_value()) << image.error().message;
  EXPECT_EQ(image->width(), kSidePx);
  EXPECT_EQ(image->largest(), Rgb::gray(0));
}

// Every beginning of a file that lacks pixels is refused, and none takes for ever.
TEST(DecodeTexture, RefusesCutFiles) {
  std::mt19937 random(1);
  Image noise(24, 9);
  for (Rgb& pixel : noise.pixels) pixel = Rgb::gray(static_cast<float>(random() % 4) / 4);
  for (const std::string& file : {png(noise), hdr(noise), jpeg()}) {
    ASSERT_EQ(decoding_error(file), "no error");
    // PNG's last chunk and checksums, and JPEG's end marker, tell nothing of the pixels.
    const std::size_t tail = file.starts_with("\x89PNG") ? 20 : file.starts_with("\xff\xd8") ? 8 : 0;
    for (std::size_t size = 0; size + tail < file.size(); ++size)
      EXPECT_NE(decoding_error(file.substr(0, size)), "no error") << size;
  }
}

TEST(DecodeTexture, SurvivesDamage) {
  std::mt19937 random(2);
  for (const std::string& file :
       {jpeg(), png(one_color(20, 20, {0.2f, 0.5f, 0.7f})), hdr(one_color(20, 20, {0.2f, 5, 0.7f}))}) {
    for (int i = 0; i < 500; ++i) {
      std::string damaged = file;
      for (int k = 0; k < 3; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
      const auto image = decode_texture_image(damaged, ColorSpace::kSrgb);
      if (image)
        EXPECT_GT(image->width() * image->height(), 0);
      else
        EXPECT_FALSE(image.error().message.empty());
    }
  }
}

TEST(DecodeTexture, TakesASingleChannelOnRequest) {
  const std::string file = test::png(test::one_color(1, 1, Rgb{0.25f, 0.5f, 1}));
  const auto texel = [&](TextureChannel channel, ColorSpace space) {
    return decode_texture_image(file, space, channel)->texel(0, 0);
  };
  const Rgb color = decode_texture_image(file, ColorSpace::kLinear)->texel(0, 0);
  EXPECT_EQ(texel(TextureChannel::kRed, ColorSpace::kLinear), Rgb::gray(color.r));
  EXPECT_EQ(texel(TextureChannel::kGreen, ColorSpace::kLinear), Rgb::gray(color.g));
  EXPECT_EQ(texel(TextureChannel::kBlue, ColorSpace::kSrgb), Rgb::gray(1));
  EXPECT_LT(texel(TextureChannel::kRed, ColorSpace::kSrgb).g, color.r) << "decoded";
}

}  // namespace
}  // namespace tessera::core
