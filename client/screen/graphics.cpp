// SPDX-License-Identifier: Apache-2.0
#include "client/screen/graphics.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>
#include <unistd.h>

#include <algorithm>

namespace tessera::client {
namespace {

std::string base64(const std::vector<std::uint8_t>& bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  const int length = ::EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), bytes.data(),
                                       static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(length));
  return text;
}

std::string color(int ground, const std::uint8_t* rgb) {
  return fmt::format("\033[{};2;{};{};{}m", ground, rgb[0], rgb[1], rgb[2]);
}

}  // namespace

std::optional<Graphics> graphics_from_name(std::string_view name) {
  if (name == "blocks") return Graphics::kBlocks;
  if (name == "kitty") return Graphics::kKitty;
  if (name == "sixel") return Graphics::kSixel;
  return std::nullopt;
}

core::Result<std::string> draw(const ScreenImage& image, Graphics graphics) {
  if (graphics == Graphics::kKitty) return draw_kitty(image);
  if (graphics == Graphics::kSixel) return draw_sixel(image);
  return draw_blocks(image);
}

std::string draw_blocks(const ScreenImage& image) {
  constexpr int kForeground = 38, kBackground = 48;
  std::string text;
  for (int y = 0; y < image.height; y += 2) {
    if (y > 0) text += "\r\n";
    std::string above, below;  // the colours that are set
    for (int x = 0; x < image.width; ++x) {
      const std::string top = color(kForeground, image.at(x, y));
      const std::string bottom = y + 1 < image.height ? color(kBackground, image.at(x, y + 1)) : "";
      if (top != above) text += top;
      if (bottom != below) text += bottom;
      above = top;
      below = bottom;
      text += "▀";
    }
    text += "\033[0m";
  }
  return text;
}

std::string draw_kitty(const ScreenImage& image) {
  constexpr std::size_t kChunk = 4096;
  const std::string data = base64(image.rgb);
  std::string text;
  for (std::size_t begin = 0; begin < data.size(); begin += kChunk) {
    const bool more = begin + kChunk < data.size();
    // Transmit and show 24-bit pixels; no answers; the cursor stays.
    const std::string first =
        begin > 0 ? ""
                  : fmt::format("a=T,f=24,s={},v={},i={},q=2,C=1,", image.width, image.height, ::getpid());
    text += fmt::format("\033_G{}m={};{}\033\\", first, more ? 1 : 0, data.substr(begin, kChunk));
  }
  return text;
}

}  // namespace tessera::client
