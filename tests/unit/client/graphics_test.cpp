// SPDX-License-Identifier: Apache-2.0
#include "client/screen/graphics.hpp"

#include <gtest/gtest.h>
#include <openssl/evp.h>

#include <regex>
#include <string>
#include <vector>

#include "client/screen/screen.hpp"

namespace tessera::client {
namespace {

// Two columns, three rows: red and green above blue and white above black and black.
ScreenImage colors() {
  return {.width = 2, .height = 3, .rgb = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255, 0, 0, 0, 0, 0, 0}};
}

TEST(Graphics, HalfBlocksShowTwoRowsInEachLine) {
  EXPECT_EQ(draw_blocks(colors()),
            "\033[38;2;255;0;0m\033[48;2;0;0;255m▀\033[38;2;0;255;0m\033[48;2;255;255;255m▀\033[0m\r\n"
            "\033[38;2;0;0;0m▀▀\033[0m");
}

TEST(Graphics, KittyGetsThePixelsInChunks) {
  ScreenImage image{.width = 50, .height = 50, .rgb = std::vector<std::uint8_t>(7500)};
  for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] = static_cast<std::uint8_t>(31 * i);
  const std::string text = draw_kitty(image);
  EXPECT_EQ(text.find("\033_Ga=T,f=24,s=50,v=50,"), 0u);
  static const std::regex chunk("\033_G[^;]*m=([01]);([^\033]*)\033\\\\");
  std::string base64, more;
  for (std::sregex_iterator match(text.begin(), text.end(), chunk), end; match != end; ++match) {
    EXPECT_LE((*match)[2].length(), 4096);
    more += (*match)[1];
    base64 += (*match)[2];
  }
  EXPECT_EQ(more, "110");
  std::vector<std::uint8_t> bytes(base64.size());
  ASSERT_EQ(::EVP_DecodeBlock(bytes.data(), reinterpret_cast<const unsigned char*>(base64.data()),
                              static_cast<int>(base64.size())),
            7500);
  bytes.resize(7500);
  EXPECT_EQ(bytes, image.rgb);
}

TEST(Graphics, ImagesAreScaledDownToFitAndNeverUp) {
  core::Image image(400, 100);
  for (auto& pixel : image.pixels) pixel = {1, 1, 0};
  const ScreenImage small = fit_to_screen(image, 80, 80, {});
  EXPECT_EQ(small.width, 80);
  EXPECT_EQ(small.height, 20);
  EXPECT_EQ(std::vector<std::uint8_t>(small.at(79, 19), small.at(79, 19) + 3),
            (std::vector<std::uint8_t>{255, 255, 0}));
  EXPECT_EQ(fit_to_screen(image, 1000, 1000, {}).width, 400);
  EXPECT_EQ(fit_to_screen(core::Image(5000, 1), 80, 48, {}).height, 1);
}

// The mean of black and white light is darker than half of white in the encoding of screens.
TEST(Graphics, LightIsAveragedBeforeItIsEncoded) {
  core::Image image(2, 1);
  image.at(1, 0) = {1, 1, 1};
  EXPECT_EQ(fit_to_screen(image, 1, 1, {}).rgb, (std::vector<std::uint8_t>{188, 188, 188}));
  EXPECT_EQ(fit_to_screen(image, 1, 1, {.exposure_stops = 1}).rgb,
            (std::vector<std::uint8_t>{255, 255, 255}));
}

TEST(Graphics, AreChosenByWhatTheTerminalSays) {
  EXPECT_EQ(graphics_of("xterm-kitty", "", false, ""), Graphics::kKitty);
  EXPECT_EQ(graphics_of("xterm-256color", "WezTerm", false, ""), Graphics::kKitty);
  EXPECT_EQ(graphics_of("xterm-256color", "", false, "\033[?62;4;22c"), Graphics::kSixel);
  EXPECT_EQ(graphics_of("xterm-256color", "", false, "\033[?4c"), Graphics::kSixel);
  EXPECT_EQ(graphics_of("xterm-256color", "", false, "\033[?64;14c"), Graphics::kBlocks);
  EXPECT_EQ(graphics_of("xterm-256color", "", false, ""), Graphics::kBlocks);
  EXPECT_EQ(graphics_of("xterm-kitty", "", true, ""), Graphics::kBlocks) << "tmux passes no graphics on";
}

}  // namespace
}  // namespace tessera::client
