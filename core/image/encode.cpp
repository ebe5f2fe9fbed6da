// SPDX-License-Identifier: Apache-2.0
#include "core/image/encode.hpp"

#include <fmt/format.h>
#include <stb_image_write.h>

#include <bit>
#include <cstdint>
#include <new>
#include <vector>

#include "core/image/exr.hpp"
#include "core/image/hdr_encoder.hpp"
#include "core/image/limits.hpp"
#include "core/image/srgb.hpp"

namespace tessera::core {
namespace {

static_assert(sizeof(Rgb) == 3 * sizeof(float), "images are passed on as arrays of floats");

void append_bytes(void* sink, void* data, int size) {
  static_cast<std::string*>(sink)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
}

std::string encode_png(const Image& image, const DisplaySettings& display) {
  const DisplayTransform to_screen(display);
  std::vector<std::uint8_t> codes;
  codes.reserve(image.pixels.size() * 3);
  for (const Rgb& pixel : image.pixels) {
    const Rgb shown = to_screen(pixel);
    codes.insert(codes.end(), {srgb_encode(shown.r), srgb_encode(shown.g), srgb_encode(shown.b)});
  }
  std::string bytes;
  stbi_write_png_to_func(append_bytes, &bytes, image.width, image.height, 3, codes.data(), image.width * 3);
  return bytes;
}

// Rows run from the bottom up; a negative scale marks little-endian numbers (Debevec's PFM).
std::string encode_pfm(const Image& image) {
  static_assert(std::endian::native == std::endian::little);
  std::string bytes = fmt::format("PF\n{} {}\n-1.0\n", image.width, image.height);
  const std::size_t row_bytes = static_cast<std::size_t>(image.width) * sizeof(Rgb);
  bytes.reserve(bytes.size() + row_bytes * static_cast<std::size_t>(image.height));
  for (int y = image.height - 1; y >= 0; --y) {
    bytes.append(reinterpret_cast<const char*>(&image.at(0, y)), row_bytes);
  }
  return bytes;
}

Result<std::string> encode_checked(const Image& image, ImageFormat format, const DisplaySettings& display) {
  switch (format) {
    case ImageFormat::kPng:
      return encode_png(image, display);
    case ImageFormat::kExr:
      return encode_exr(image);
    case ImageFormat::kHdr:
      return encode_hdr(image);
    case ImageFormat::kPfm:
      return encode_pfm(image);
  }
  return fail(ErrorCode::kInternal, "no such image format");
}

}  // namespace

std::string_view image_format_name(ImageFormat format) {
  switch (format) {
    case ImageFormat::kPng:
      return "png";
    case ImageFormat::kExr:
      return "exr";
    case ImageFormat::kHdr:
      return "hdr";
    case ImageFormat::kPfm:
      return "pfm";
  }
  return "";
}

Result<ImageFormat> image_format_from_path(std::string_view path) {
  const std::string_view name = path.substr(path.find_last_of('/') + 1);
  const std::size_t dot = name.find_last_of('.');
  std::string ending(dot == std::string_view::npos ? "" : name.substr(dot + 1));
  for (char& c : ending) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  for (const ImageFormat format :
       {ImageFormat::kPng, ImageFormat::kExr, ImageFormat::kHdr, ImageFormat::kPfm}) {
    if (ending == image_format_name(format)) return format;
  }
  return fail(
      ErrorCode::kInvalidArgument,
      fmt::format("'{}': the extension of an image file selects its format: .png, .exr, .hdr or .pfm", path));
}

Status check_encodable(ImageFormat format, int width, int height) {
  if (width < 1 || height < 1) {
    return fail(ErrorCode::kInvalidArgument, fmt::format("an image of {}x{} pixels is empty", width, height));
  }
  const std::int64_t limit = format == ImageFormat::kPng   ? kMaxPngPixels
                             : format == ImageFormat::kHdr ? kMaxHdrPixels
                                                           : kMaxPicturePixels;
  if (static_cast<std::int64_t>(width) * height > limit) {
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("an image of {}x{} pixels is too large for .{} files, which hold at most {} million "
                    "pixels: use .exr",
                    width, height, image_format_name(format), limit / 1'000'000));
  }
  return {};
}

Result<std::string> encode_image(const Image& image, ImageFormat format, const DisplaySettings& display) {
  if (Status status = check_encodable(format, image.width, image.height); !status)
    return fail(status.error());
  try {
    Result<std::string> bytes = encode_checked(image, format, display);
    if (bytes && bytes->empty()) throw std::bad_alloc();  // stb reports a lack of memory so
    return bytes;
  } catch (const std::bad_alloc&) {
    return fail(
        ErrorCode::kResourceExhausted,
        fmt::format("not enough memory to write an image of {}x{} pixels", image.width, image.height));
  }
}

}  // namespace tessera::core
