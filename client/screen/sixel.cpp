// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <sixel/sixel.h>

#include <memory>

#include "client/screen/graphics.hpp"

namespace tessera::client {
namespace {

constexpr int kColors = 256;

struct FreeOutput {
  void operator()(sixel_output_t* output) const { ::sixel_output_unref(output); }
};
struct FreeDither {
  void operator()(sixel_dither_t* dither) const { ::sixel_dither_unref(dither); }
};

int append(char* data, int size, void* text) {
  static_cast<std::string*>(text)->append(data, static_cast<std::size_t>(size));
  return size;
}

core::Error failure(SIXELSTATUS status) {
  return {core::ErrorCode::kInternal,
          fmt::format("the image cannot be encoded as sixels ({}): choose --protocol blocks",
                      ::sixel_helper_format_error(status))};
}

}  // namespace

core::Result<std::string> draw_sixel(const ScreenImage& image) {
  std::string text;
  std::vector<std::uint8_t> pixels = image.rgb;  // the library wants to write to them
  sixel_output_t* output = nullptr;
  if (const auto status = ::sixel_output_new(&output, append, &text, nullptr); SIXEL_FAILED(status))
    return core::fail(failure(status));
  const std::unique_ptr<sixel_output_t, FreeOutput> output_owner(output);
  sixel_dither_t* dither = nullptr;
  if (const auto status = ::sixel_dither_new(&dither, kColors, nullptr); SIXEL_FAILED(status))
    return core::fail(failure(status));
  const std::unique_ptr<sixel_dither_t, FreeDither> dither_owner(dither);
  if (const auto status = ::sixel_dither_initialize(dither, pixels.data(), image.width, image.height,
                                                    SIXEL_PIXELFORMAT_RGB888, SIXEL_LARGE_AUTO,
                                                    SIXEL_REP_AUTO, SIXEL_QUALITY_AUTO);
      SIXEL_FAILED(status))
    return core::fail(failure(status));
  if (const auto status = ::sixel_encode(pixels.data(), image.width, image.height, 3, dither, output);
      SIXEL_FAILED(status))
    return core::fail(failure(status));
  return text;
}

}  // namespace tessera::client
