// SPDX-License-Identifier: Apache-2.0
#include "core/scene/writer/texture_writer.hpp"

#include <cmath>
#include <cstdint>
#include <utility>

#include "core/image/encode.hpp"
#include "core/image/image.hpp"
#include "core/image/srgb.hpp"

namespace tessera::core {
namespace {

// The light that a PNG file stores as the code of a linear byte.
float as_srgb_byte(float linear) {
  return srgb_decode(static_cast<std::uint8_t>(std::lround(linear * 255)));
}

bool has_linear_bytes(const TextureImage& image) {
  return image.texels().format == TextureImage::Format::kLinearBytes;
}

bool has_bytes(const TextureImage& image) {
  return has_linear_bytes(image) || image.texels().format == TextureImage::Format::kSrgbBytes;
}

Image pixels_of(const TextureImage& texture) {
  Image image(texture.width(), texture.height());
  for (int y = 0; y < texture.height(); ++y) {
    for (int x = 0; x < texture.width(); ++x) {
      const Rgb texel = texture.texel(x, y);
      image.at(x, y) = has_linear_bytes(texture)
                           ? Rgb{as_srgb_byte(texel.r), as_srgb_byte(texel.g), as_srgb_byte(texel.b)}
                           : texel;
    }
  }
  return image;
}

}  // namespace

Result<TextureFile> write_texture(const TextureImage& texture) {
  const bool is_png = has_bytes(texture);
  auto bytes = encode_image(pixels_of(texture), is_png ? ImageFormat::kPng : ImageFormat::kPfm);
  if (!bytes) return fail(bytes.error());
  TextureFile file;
  file.bytes = std::move(*bytes);
  file.ending = is_png ? "png" : "pfm";
  if (is_png) file.color_space = has_linear_bytes(texture) ? "linear" : "srgb";
  return file;
}

}  // namespace tessera::core
