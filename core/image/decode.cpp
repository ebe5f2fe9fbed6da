#include "core/image/decode.hpp"

#include <fmt/format.h>
#include <stb_image.h>

#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <system_error>

#include "core/image/exr.hpp"
#include "core/image/file_io.hpp"
#include "core/image/hdr_check.hpp"
#include "core/image/limits.hpp"
#include "core/image/srgb.hpp"
#include "core/image/stb_memory.hpp"
#include "core/image/stb_reason.hpp"

namespace tessera::core {
namespace {

constexpr std::string_view kExrMagic = "\x76\x2f\x31\x01";
constexpr std::string_view kPngMagic = "\x89PNG\r\n\x1a\n";

struct StbFree {
  void operator()(void* texels) const { stbi_image_free(texels); }
};
template <typename T>
using StbTexels = std::unique_ptr<T[], StbFree>;

float linear_value(std::uint8_t code) {
  return srgb_decode(code);
}
float linear_value(std::uint16_t code) {
  return srgb_decode(code / 65535.0);
}
float linear_value(float value) {
  return value;
}

tl::unexpected<Error> unreadable(std::string_view why) {
  return fail(ErrorCode::kInvalidArgument, fmt::format("not a readable picture: {}", why));
}

tl::unexpected<Error> out_of_bounds(int width, int height) {
  return fail(
      ErrorCode::kInvalidArgument,
      fmt::format("its size of {}x{} pixels is not plausible for a file of its length", width, height));
}

// `load` is one of stb's stbi_load*_from_memory.
template <typename T>
Result<Image> decode_with_stb(std::string_view bytes, int width, int height,
                              T* (*load)(const stbi_uc*, int, int*, int*, int*, int)) {
  int channels = 0;
  const StbMemory memory(width, height, bytes.size());
  const StbTexels<T> texels(load(reinterpret_cast<const stbi_uc*>(bytes.data()),
                                 static_cast<int>(bytes.size()), &width, &height, &channels, 3));
  if (memory.was_exceeded()) return unreadable("its data unpack to more than its pixels");
  if (memory.ran_out()) throw std::bad_alloc();
  if (!texels) return unreadable(stb_reason());
  Image image(width, height);
  const T* next = texels.get();
  for (Rgb& pixel : image.pixels) {
    pixel = {linear_value(next[0]), linear_value(next[1]), linear_value(next[2])};
    next += 3;
  }
  return image;
}

Result<Image> decode_png_or_hdr(std::string_view bytes) {
  if (bytes.size() > INT32_MAX)
    return fail(ErrorCode::kInvalidArgument, "the file is too large for a picture");
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const auto size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (!stbi_info_from_memory(data, size, &width, &height, &channels)) return unreadable(stb_reason());
  if (!is_plausible_size(width, height, bytes.size())) return out_of_bounds(width, height);
  if (!bytes.starts_with(kPngMagic)) {
    if (!is_complete_hdr(bytes, width, height)) return unreadable("the file ends too early");
    return decode_with_stb<float>(bytes, width, height, stbi_loadf_from_memory);
  }
  if (stbi_is_16_bit_from_memory(data, size))
    return decode_with_stb<stbi_us>(bytes, width, height, stbi_load_16_from_memory);
  return decode_with_stb<stbi_uc>(bytes, width, height, stbi_load_from_memory);
}

// Takes the next word of a PFM header and the one white space after it; empty where there is none.
std::string_view take_word(std::string_view& text) {
  const std::size_t end = text.find_first_of(" \t\r\n");
  if (end == std::string_view::npos) return {};
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(end + 1);
  return word;
}

template <typename T>
bool parse_number(std::string_view word, T& value) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size();
}

float load_float(const char* bytes, bool little_endian) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, bytes, sizeof bits);
  return std::bit_cast<float>(little_endian ? bits : __builtin_bswap32(bits));
}

Result<Image> decode_pfm(std::string_view bytes) {
  const int channels = take_word(bytes) == "PF" ? 3 : 1;
  int width = 0, height = 0;
  double scale = 0;
  if (!parse_number(take_word(bytes), width) || !parse_number(take_word(bytes), height) ||
      !parse_number(take_word(bytes), scale) || scale == 0) {
    return fail(ErrorCode::kInvalidArgument, "not a readable PFM picture: its header is broken");
  }
  if (!is_plausible_size(width, height, bytes.size())) return out_of_bounds(width, height);
  const std::size_t pixel_bytes = static_cast<std::size_t>(channels) * sizeof(float);
  const std::size_t expected =
      static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * pixel_bytes;
  if (bytes.size() != expected) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("not a readable PFM picture: {}x{} pixels take {} bytes, got {}", width, height,
                            expected, bytes.size()));
  }
  Image image(width, height);
  const char* next = bytes.data();
  for (int y = height - 1; y >= 0; --y) {
    for (int x = 0; x < width; ++x, next += pixel_bytes) {
      const auto channel = [&](int i) { return load_float(next + (channels == 3 ? 4 * i : 0), scale < 0); };
      image.at(x, y) = {channel(0), channel(1), channel(2)};
    }
  }
  return image;
}

}  // namespace

Result<Image> decode_image(std::string_view bytes) {
  if (bytes.size() > static_cast<std::size_t>(kMaxPicturePixels) * sizeof(Rgb) + 4096) {
    return fail(ErrorCode::kInvalidArgument, "the file is too large for a picture");
  }
  try {
    if (bytes.starts_with(kExrMagic)) return decode_exr(bytes);
    if (bytes.starts_with("PF\n") || bytes.starts_with("Pf\n")) return decode_pfm(bytes);
    if (bytes.starts_with(kPngMagic) || is_hdr_picture(bytes)) return decode_png_or_hdr(bytes);
    return fail(ErrorCode::kInvalidArgument, "not a PNG, EXR, HDR or PFM picture");
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kResourceExhausted, "not enough memory for the picture");
  }
}

Result<Image> read_image(const std::string& path) {
  Result<std::string> bytes = read_file(path);
  if (!bytes) return fail(bytes.error());
  Result<Image> image = decode_image(*bytes);
  if (!image) return fail(image.error().within(path));
  return image;
}

}  // namespace tessera::core
