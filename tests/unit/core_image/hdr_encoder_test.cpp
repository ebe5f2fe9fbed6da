// SPDX-License-Identifier: Apache-2.0
// Written HDR files: the rounding, and that another reader understands them.
#include "core/image/hdr_encoder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/image/decode.hpp"
#include "core/image/encode.hpp"
#include "tests/unit/core_image/test_image.hpp"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#pragma GCC diagnostic pop

namespace tessera::core {
namespace {

using Rgbe = std::array<std::uint8_t, 4>;

TEST(EncodeRgbe, RoundsToTheNearest) {
  EXPECT_EQ(encode_rgbe({1, 0.5f, 0.25f}), (Rgbe{128, 64, 32, 129}));
  EXPECT_EQ(encode_rgbe({1, 0.49999f, 0.0119f}), (Rgbe{128, 64, 2, 129}));
  EXPECT_EQ(encode_rgbe({}), (Rgbe{0, 0, 0, 0}));
}

// The largest mantissa would be 256.
TEST(EncodeRgbe, TakesTheExponentAfterRounding) {
  EXPECT_EQ(encode_rgbe({0.999f, 0.5f, 0}), (Rgbe{128, 64, 0, 129}));
  EXPECT_EQ(encode_rgbe({0.997f, 0.5f, 0}), (Rgbe{255, 128, 0, 128}));
}

TEST(EncodeRgbe, KeepsWhatCannotBeStoredWithinBounds) {
  const float infinity = std::numeric_limits<float>::infinity(),
              nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(encode_rgbe({infinity, 0, -1}), (Rgbe{255, 0, 0, 255}));
  EXPECT_EQ(encode_rgbe({std::numeric_limits<float>::max(), 0, 0}), (Rgbe{255, 0, 0, 255}));
  EXPECT_EQ(encode_rgbe({nan, 1, -infinity}), (Rgbe{0, 128, 0, 129}));
  EXPECT_EQ(encode_rgbe({1e-40f, 0, 0}), (Rgbe{0, 0, 0, 0}));
}

// Truncation takes 0.2 to 0.7 % away.
TEST(EncodeHdr, KeepsTheMean) {
  std::mt19937 random(5);
  Image image(512, 256);
  for (Rgb& pixel : image.pixels)
    for (float* channel : {&pixel.r, &pixel.g, &pixel.b})
      *channel = std::ldexp(1 + static_cast<float>(random() % (1 << 20)) / (1 << 20),
                            static_cast<int>(random() % 2) - 1);
  const auto decoded = decode_image(*encode_image(image, ImageFormat::kHdr));
  ASSERT_TRUE(decoded.has_value()) << decoded.error().message;
  double before = 0, after = 0;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    before += static_cast<double>(image.pixels[i].r);
    after += static_cast<double>(decoded->pixels[i].r);
    EXPECT_LE(std::abs(image.pixels[i].r - decoded->pixels[i].r), max_component(image.pixels[i]) / 255);
  }
  EXPECT_NEAR(after / before, 1, 2e-5);
}

TEST(EncodeHdr, IsReadByOtherReadersAsByOurs) {
  for (const auto& [width, height] :
       {std::pair(5, 9), std::pair(8, 3), std::pair(300, 7), std::pair(40000, 1)}) {
    Image image = random_image(width, height, 3);
    for (int x = 0; x < width / 2; ++x) image.at(x, 0) = {0.5f, 0.25f, 2};  // runs
    const std::string file = *encode_image(image, ImageFormat::kHdr);
    const auto ours = decode_image(file);
    ASSERT_TRUE(ours.has_value()) << ours.error().message;
    int stb_width = 0, stb_height = 0, channels = 0;
    float* theirs =
        stbi_loadf_from_memory(reinterpret_cast<const stbi_uc*>(file.data()), static_cast<int>(file.size()),
                               &stb_width, &stb_height, &channels, 3);
    ASSERT_NE(theirs, nullptr) << width;
    ASSERT_EQ(stb_width, width);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
      ASSERT_EQ(ours->pixels[i], (Rgb{theirs[3 * i], theirs[3 * i + 1], theirs[3 * i + 2]}))
          << width << ": " << i;
    stbi_image_free(theirs);
  }
}

}  // namespace
}  // namespace tessera::core
