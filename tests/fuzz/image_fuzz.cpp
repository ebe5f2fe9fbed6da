// SPDX-License-Identifier: Apache-2.0
// An image file: as a texture in both colour spaces, its alpha, and as `tessera compare` reads it and its
// layers; the texts in its header.
#include <algorithm>
#include <string>
#include <vector>

#include "core/image/codecs.hpp"
#include "core/image/decode.hpp"
#include "core/image/exr_header.hpp"
#include "core/textures/image_decoder.hpp"
#include "tests/fuzz/expect.hpp"
#include "tests/fuzz/fuzzer.hpp"

namespace tessera::fuzz::image_fuzz {
namespace {

void decode_as_texture(std::string_view bytes, core::ColorSpace color_space,
                       core::TextureChannel channel = core::TextureChannel::kColor) {
  std::vector<std::string> warnings;
  const auto image = core::decode_texture_image(bytes, color_space, channel, &warnings);
  for (const std::string& warning : warnings) expect_message(warning);
  if (!expect_answer(image)) return;
  expect(image->width() > 0 && image->height() > 0, "an image has pixels");
  for (const core::Vec2 uv : {core::Vec2{0, 0}, core::Vec2{0.5f, 1}, core::Vec2{-7.3f, 1e30f}})
    for (const auto wrap : {core::Wrap::kRepeat, core::Wrap::kClamp})
      expect(core::is_finite(image->bilinear(uv, wrap, wrap)), "light is finite");
  const core::Rgb mean = image->mean(), largest = image->largest();
  expect(mean.r <= largest.r * 1.001f, "no mean is above the largest");
}

void decode_as_image(std::string_view bytes, const std::string& layer = {}) {
  const auto image = core::decode_image(bytes, layer);
  if (!expect_answer(image)) return;
  const auto width = static_cast<std::size_t>(image->width), height = static_cast<std::size_t>(image->height);
  expect(image->pixels.size() == width * height, "as many pixels as the size says");
}

}  // namespace

TESSERA_FUZZER(image, std::string_view bytes) {
  decode_as_texture(bytes, core::ColorSpace::kSrgb);
  decode_as_texture(bytes, core::ColorSpace::kLinear);
  decode_as_texture(bytes, core::ColorSpace::kLinear, core::TextureChannel::kAlpha);
  decode_as_image(bytes);
  for (const char* const layer : {"Normal", "view.combined", "A"}) decode_as_image(bytes, layer);
  expect_answer(core::exr_texts(bytes));
  if (const auto layers = core::image_layers(bytes); expect_answer(layers))
    for (std::size_t i = 0; i < std::min<std::size_t>(layers->size(), 3); ++i)
      decode_as_image(bytes, layers->at(i));
}

}  // namespace tessera::fuzz::image_fuzz
