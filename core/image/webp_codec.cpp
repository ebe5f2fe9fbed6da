// SPDX-License-Identifier: Apache-2.0
// WebP by libwebp. Images are at most 16,383 pixels wide and high.
#include <webp/decode.h>

#include <new>

#include "core/image/codec.hpp"
#include "core/image/limits.hpp"

namespace tessera::core {
namespace webp {
namespace {

const std::uint8_t* data_of(std::string_view bytes) {
  return reinterpret_cast<const std::uint8_t*>(bytes.data());
}

bool matches(std::string_view bytes) {
  return bytes.size() >= 12 && bytes.starts_with("RIFF") && bytes.substr(8, 4) == "WEBP";
}

Result<WebPBitstreamFeatures> read_features(std::string_view bytes) {
  WebPBitstreamFeatures features;
  switch (WebPGetFeatures(data_of(bytes), bytes.size(), &features)) {
    case VP8_STATUS_OK:
      break;
    case VP8_STATUS_OUT_OF_MEMORY:
      throw std::bad_alloc();
    case VP8_STATUS_NOT_ENOUGH_DATA:
      return broken_image("WebP", kEndsTooEarly);
    default:
      return broken_image("WebP", "its header is damaged");
  }
  if (features.has_animation) return unsupported_image("an animated WebP image", "save one frame of it");
  return features;
}

Result<ImageSize> read_size(std::string_view bytes) {
  const auto features = read_features(bytes);
  if (!features) return fail(features.error());
  return ImageSize{features->width, features->height};
}

Result<DecodedImage> decode(std::string_view bytes, ImageSize size, const DecodeOptions& options) {
  const auto features = read_features(bytes);
  if (!features) return fail(features.error());
  if (!is_plausible_size(size.width, size.height, bytes.size()))
    return broken_image("WebP", implausible_size(size.width, size.height));
  const bool keep_alpha = features->has_alpha && options.keep_alpha;
  const std::size_t channels = keep_alpha ? 4 : 3;
  DecodedImage::Bytes values(size.pixels() * channels);
  const auto decode_into = keep_alpha ? WebPDecodeRGBAInto : WebPDecodeRGBInto;
  const int stride = size.width * static_cast<int>(channels);
  if (decode_into(data_of(bytes), bytes.size(), values.data(), values.size(), stride) == nullptr)
    return broken_image("WebP", "its pixels are damaged or cut short");
  return DecodedImage{.size = size, .channels = channels, .values = std::move(values), .warnings = {}};
}

}  // namespace
}  // namespace webp

const Codec kWebpCodec{"WebP", false, webp::matches, webp::read_size, webp::decode};

}  // namespace tessera::core
