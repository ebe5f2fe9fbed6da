#include "core/textures/image_decoder.hpp"

#include <fmt/format.h>
#include <stb_image.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

#include "core/image/hdr_check.hpp"
#include "core/image/srgb.hpp"
#include "core/image/stb_memory.hpp"
#include "core/image/stb_reason.hpp"
#include "core/textures/jpeg_check.hpp"
#include "core/textures/size_check.hpp"

namespace tessera::core {
namespace {

constexpr std::string_view kPngStart = "\x89PNG\r\n\x1a\n";
constexpr std::string_view kJpegStart = "\xff\xd8\xff";

struct StbFree {
  void operator()(void* texels) const { stbi_image_free(texels); }
};
template <typename T>
using StbTexels = std::unique_ptr<T[], StbFree>;

struct Encoded {
  const stbi_uc* data;
  int size;
};

// Whether the file has as many bytes as its pixels need.
bool is_long_enough(std::string_view bytes, TextureSize size) {
  if (is_hdr_picture(bytes)) return is_complete_hdr(bytes, size.width, size.height);
  return bytes.starts_with(kJpegStart) ? can_hold_jpeg(bytes, size.width, size.height)
                                       : can_hold_png(bytes, size.width, size.height);
}

tl::unexpected<Error> broken_picture(std::string_view why) {
  return fail(ErrorCode::kInvalidArgument, fmt::format("is a broken picture ({})", why));
}

Result<Encoded> encoded_picture(std::string_view bytes) {
  if (!bytes.starts_with(kPngStart) && !bytes.starts_with(kJpegStart) && !is_hdr_picture(bytes))
    return fail(ErrorCode::kInvalidArgument, "is not a PNG, JPEG or HDR picture");
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    return fail(ErrorCode::kInvalidArgument, "is too large for a picture (2 GB)");
  return Encoded{reinterpret_cast<const stbi_uc*>(bytes.data()), static_cast<int>(bytes.size())};
}

Result<TextureSize> size_of(Encoded encoded) {
  TextureSize size;
  int channels = 0;
  if (!stbi_info_from_memory(encoded.data, encoded.size, &size.width, &size.height, &channels))
    return broken_picture(stb_reason());
  if (size.width < 1 || size.height < 1) return broken_picture("it has no pixels");
  return size;
}

Result<TextureSize> checked_size(std::string_view bytes, Encoded encoded) {
  if (bytes.starts_with(kJpegStart))
    if (const auto fault = jpeg_fault(bytes)) return broken_picture(*fault);
  const auto checked = size_of(encoded);
  if (!checked) return fail(checked.error());
  const TextureSize size = *checked;
  if (std::int64_t{size.width} * size.height > kMaxTexturePixels)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("has {} x {} pixels, more than the {} a texture may have", size.width,
                            size.height, kMaxTexturePixels));
  if (!is_long_enough(bytes, size)) return broken_picture("the file ends too early");
  return size;
}

// `load` is one of stb's stbi_load*_from_memory; it makes 3 values of each pixel, or 4 with alpha.
template <typename T>
Result<StbTexels<T>> load_texels(Encoded encoded, TextureSize size,
                                 T* (*load)(const stbi_uc*, int, int*, int*, int*, int), int values = 3) {
  int width = 0, height = 0, channels = 0;
  const StbMemory memory(size.width, size.height, static_cast<std::size_t>(encoded.size));
  StbTexels<T> texels(load(encoded.data, encoded.size, &width, &height, &channels, values));
  if (memory.was_exceeded()) return broken_picture("its data unpack to more than its pixels");
  if (memory.ran_out()) throw std::bad_alloc();
  if (!texels) return broken_picture(stb_reason());
  if (width != size.width || height != size.height) return broken_picture("it has two sizes");
  return texels;
}

// Linear floats of a 16-bit file.
std::vector<float> linear_values(const stbi_us* codes, std::size_t count, ColorSpace color_space) {
  std::vector<float> values(count);
  std::transform(codes, codes + count, values.begin(), [&](stbi_us code) {
    return color_space == ColorSpace::kSrgb ? srgb_decode(code / 65535.0)
                                            : static_cast<float>(code) / 65535.0f;
  });
  return values;
}

// Alpha of `texels`, which have it as the last of 4 values, in all channels.
template <typename T, typename Value>
TextureImage alpha_image(const T* texels, TextureSize size, const Value& value) {
  constexpr T kOpaque = std::numeric_limits<T>::max();
  std::vector<decltype(value(kOpaque))> alphas;
  bool opaque = true;
  for (std::uint64_t i = 0; i < size.pixels() && opaque; ++i) opaque = texels[4 * i + 3] == kOpaque;
  if (opaque) size = {1, 1};
  alphas.reserve(3 * size.pixels());
  for (std::uint64_t i = 0; i < size.pixels(); ++i)
    alphas.insert(alphas.end(), 3, value(opaque ? kOpaque : texels[4 * i + 3]));
  if constexpr (std::is_same_v<T, stbi_uc>)
    return TextureImage(size.width, size.height, alphas, ColorSpace::kLinear);
  else
    return TextureImage(size.width, size.height, std::move(alphas));
}

// JPEG and HDR files have no alpha.
Result<TextureImage> decode_alpha(std::string_view bytes, Encoded encoded) {
  const auto size = checked_size(bytes, encoded);
  if (!size) return fail(size.error());
  if (!bytes.starts_with(kPngStart)) return TextureImage(1, 1, std::vector<std::uint8_t>(3, 255));
  if (stbi_is_16_bit_from_memory(encoded.data, encoded.size)) {
    const auto texels = load_texels<stbi_us>(encoded, *size, stbi_load_16_from_memory, 4);
    if (!texels) return fail(texels.error());
    return alpha_image(texels->get(), *size,
                       [](stbi_us code) { return static_cast<float>(code) / 65535.0f; });
  }
  const auto texels = load_texels<stbi_uc>(encoded, *size, stbi_load_from_memory, 4);
  if (!texels) return fail(texels.error());
  return alpha_image(texels->get(), *size, [](stbi_uc code) { return code; });
}

Result<TextureImage> decode(std::string_view bytes, Encoded encoded, ColorSpace color_space) {
  const auto size = checked_size(bytes, encoded);
  if (!size) return fail(size.error());
  const std::size_t count = 3 * size->pixels();
  if (is_hdr_picture(bytes)) {
    const auto texels = load_texels<float>(encoded, *size, stbi_loadf_from_memory);
    if (!texels) return fail(texels.error());
    return TextureImage(size->width, size->height, std::vector<float>(texels->get(), texels->get() + count));
  }
  if (stbi_is_16_bit_from_memory(encoded.data, encoded.size)) {
    const auto texels = load_texels<stbi_us>(encoded, *size, stbi_load_16_from_memory);
    if (!texels) return fail(texels.error());
    return TextureImage(size->width, size->height, linear_values(texels->get(), count, color_space));
  }
  const auto texels = load_texels<stbi_uc>(encoded, *size, stbi_load_from_memory);
  if (!texels) return fail(texels.error());
  return TextureImage(size->width, size->height,
                      std::vector<std::uint8_t>(texels->get(), texels->get() + count), color_space);
}

}  // namespace

Result<TextureSize> texture_size(std::string_view bytes) {
  const auto encoded = encoded_picture(bytes);
  if (!encoded) return fail(encoded.error());
  return size_of(*encoded);
}

Result<TextureImage> decode_texture_image(std::string_view bytes, ColorSpace color_space,
                                          TextureChannel channel) {
  const auto encoded = encoded_picture(bytes);
  if (!encoded) return fail(encoded.error());
  try {
    return channel == TextureChannel::kAlpha ? decode_alpha(bytes, *encoded)
                                             : decode(bytes, *encoded, color_space);
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kResourceExhausted, "does not fit into memory");
  }
}

}  // namespace tessera::core
