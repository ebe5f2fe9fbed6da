// SPDX-License-Identifier: Apache-2.0
#include "core/textures/image_decoder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <type_traits>
#include <utility>
#include <variant>

#include "core/image/srgb.hpp"
#include "core/spectra/color_space.hpp"

namespace tessera::core {
namespace {

constexpr float kLargestHalf = 65504;

// The valid texture value that replaces `value`.
float usable(float value) {
  if (!(value > 0)) return 0;  // includes NaN
  return std::isfinite(value) ? value : kLargestHalf;
}

// Returns the number of replaced values.
std::size_t make_usable(std::vector<float>& values) {
  std::size_t replaced = 0;
  for (float& value : values) {
    const float kept = usable(value);
    if (!(kept == value)) ++replaced;
    value = kept;
  }
  return replaced;
}

// Converts colours with other primaries to those of Rec. 709, in place.
void convert(std::vector<float>& values, std::size_t channels, const spectra::ColorMatrix& to_rec709) {
  for (std::size_t i = 0; i + 3 <= values.size(); i += channels) {
    const Rgb color = to_rec709({values[i], values[i + 1], values[i + 2]});
    values[i] = usable(color.r), values[i + 1] = usable(color.g), values[i + 2] = usable(color.b);
  }
}

// Of an image of linear values.
void settle_primaries(DecodedImage& image, ColorSpace color_space) {
  const auto& [rx, ry, gx, gy, bx, by, wx, wy] = *image.primaries;
  const auto of = [](float x, float y) { return spectra::Chromaticity{double{x}, double{y}}; };
  const auto matrix = to_rec709(spectra::Primaries{of(rx, ry), of(gx, gy), of(bx, by), of(wx, wy)});
  if (!matrix)
    image.warnings.emplace_back("has primaries that span no colours; they count as those of sRGB");
  else if (color_space == ColorSpace::kSrgb)
    convert(std::get<DecodedImage::Floats>(image.values), image.channels, *matrix);
  else
    image.warnings.emplace_back("has other primaries than sRGB, which are not used: it is read as data");
}

std::vector<float> linear_values(const std::vector<std::uint16_t>& codes, ColorSpace color_space) {
  std::vector<float> values(codes.size());
  std::ranges::transform(codes, values.begin(), [&](std::uint16_t code) {
    return color_space == ColorSpace::kSrgb ? srgb_decode(code / 65535.0)
                                            : static_cast<float>(code) / 65535.0f;
  });
  return values;
}

// An image of a decoded file's values, three for each texel.
TextureImage make_image(ImageSize size, const DecodedImage::Bytes& bytes, ColorSpace color_space) {
  return TextureImage(size.width, size.height, bytes, color_space);
}
TextureImage make_image(ImageSize size, const DecodedImage::Words& codes, ColorSpace color_space) {
  return TextureImage(size.width, size.height, linear_values(codes, color_space));
}
TextureImage make_image(ImageSize size, DecodedImage::Floats& values, ColorSpace) {
  return TextureImage(size.width, size.height, std::move(values));
}

template <typename T>
T opaque_value() {
  if constexpr (std::is_floating_point_v<T>)
    return 1;
  else
    return std::numeric_limits<T>::max();
}

// Keeps three values of each pixel, all of them that of one of its `channels`.
template <typename T>
void keep_channel(std::vector<T>& values, std::size_t channels, std::size_t channel) {
  const std::size_t pixels = values.size() / channels;
  for (std::size_t i = 0; i < pixels; ++i) {
    const T kept = values[channels * i + channel];
    std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, kept);
  }
  values.resize(3 * pixels);
}

// Extracts alpha from a file with 4 channels.
template <typename T>
TextureImage alpha_image(ImageSize size, std::vector<T>& rgba) {
  keep_channel(rgba, 4, 3);
  if (std::ranges::all_of(rgba, [](T alpha) { return alpha == opaque_value<T>(); })) {
    size = {1, 1};
    rgba.resize(3);
  }
  return make_image(size, rgba, ColorSpace::kLinear);
}

// From values with 4 channels for alpha, else with 3.
template <typename T>
TextureImage image_of_channel(ImageSize size, std::vector<T>& values, ColorSpace color_space,
                              TextureChannel channel) {
  switch (channel) {
    case TextureChannel::kColor:
      break;
    case TextureChannel::kAlpha:
      return alpha_image(size, values);
    case TextureChannel::kRed:
      keep_channel(values, 3, 0);
      break;
    case TextureChannel::kGreen:
      keep_channel(values, 3, 1);
      break;
    case TextureChannel::kBlue:
      keep_channel(values, 3, 2);
      break;
  }
  return make_image(size, values, color_space);
}

Result<TextureImage> decode(std::string_view bytes, ColorSpace color_space, TextureChannel channel,
                            std::vector<std::string>* warnings, std::string_view layer) {
  const bool wants_alpha = channel == TextureChannel::kAlpha;
  auto decoded =
      decode_pixels(bytes, {.max_pixels = kMaxTexturePixels, .keep_alpha = wants_alpha, .layer = layer});
  if (!decoded) return fail(decoded.error());
  if (wants_alpha && decoded->channels == 3) return TextureImage(1, 1, std::vector<std::uint8_t>(3, 255));
  if (auto* floats = std::get_if<DecodedImage::Floats>(&decoded->values))
    if (const std::size_t replaced = make_usable(*floats); replaced > 0)
      decoded->warnings.push_back(fmt::format(
          "has values that are negative, infinite or not numbers ({} of them); 0 or {} is used instead",
          replaced, kLargestHalf));
  if (decoded->primaries && !wants_alpha) settle_primaries(*decoded, color_space);
  if (warnings != nullptr) *warnings = std::move(decoded->warnings);
  return std::visit(
      [&](auto& values) { return image_of_channel(decoded->size, values, color_space, channel); },
      decoded->values);
}

}  // namespace

Result<TextureSize> texture_size(std::string_view bytes) {
  return image_size(bytes);
}

Result<TextureImage> decode_texture_image(std::string_view bytes, ColorSpace color_space,
                                          TextureChannel channel, std::vector<std::string>* warnings,
                                          std::string_view layer) {
  try {
    return decode(bytes, color_space, channel, warnings, layer);
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kResourceExhausted, "does not fit into memory");
  }
}

}  // namespace tessera::core
