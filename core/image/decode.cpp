// SPDX-License-Identifier: Apache-2.0
#include "core/image/decode.hpp"

#include <cstdint>
#include <new>
#include <variant>
#include <vector>

#include "core/image/codecs.hpp"
#include "core/image/file_io.hpp"
#include "core/image/limits.hpp"
#include "core/image/srgb.hpp"

namespace tessera::core {
namespace {

float linear_value(std::uint8_t code) {
  return srgb_decode(code);
}
float linear_value(std::uint16_t code) {
  return srgb_decode(code / 65535.0);
}
float linear_value(float value) {
  return value;
}

template <typename T>
Image linear_image(ImageSize size, const std::vector<T>& values) {
  Image image(size.width, size.height);
  const T* next = values.data();
  for (Rgb& pixel : image.pixels) {
    pixel = {linear_value(next[0]), linear_value(next[1]), linear_value(next[2])};
    next += 3;
  }
  return image;
}

}  // namespace

Result<Image> decode_image(std::string_view bytes, const std::string& layer) {
  try {
    const auto decoded = decode_pixels(bytes, {.max_pixels = kMaxImagePixels, .layer = layer});
    if (!decoded) return fail(decoded.error());
    return std::visit([&](const auto& values) { return linear_image(decoded->size, values); },
                      decoded->values);
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kResourceExhausted, "does not fit into memory");
  }
}

Result<Image> read_image(const std::string& path, const std::string& layer) {
  Result<std::string> bytes = read_file(path);
  if (!bytes) return fail(bytes.error());
  Result<Image> image = decode_image(*bytes, layer);
  if (!image) return fail(image.error().code, "'" + path + "' " + image.error().message);
  return image;
}

}  // namespace tessera::core
