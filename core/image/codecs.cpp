// SPDX-License-Identifier: Apache-2.0
#include "core/image/codecs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <new>
#include <string_view>

#include "core/image/color_profile.hpp"
#include "core/image/exr.hpp"
#include "core/image/limits.hpp"

namespace tessera::core {
namespace {

using namespace std::string_view_literals;

// TGA files have no signature, and so come last.
constexpr std::array kCodecs{&kPngCodec,  &kJpegCodec, &kHdrCodec, &kExrCodec, &kPfmCodec,
                             &kTiffCodec, &kWebpCodec, &kBmpCodec, &kQoiCodec, &kTgaCodec};

struct Signature {
  std::size_t offset;
  std::string_view bytes, format;
};

// Formats that are recognised but not supported.
constexpr std::array<Signature, 14> kUnsupported{{{0, "GIF8"sv, "a GIF image"},
                                                  {0, "DDS "sv, "a DDS image"},
                                                  {0, "8BPS"sv, "a Photoshop image"},
                                                  {0, "gimp xcf"sv, "a GIMP image"},
                                                  {0, "\xabKTX"sv, "a KTX image"},
                                                  {0, "\0\0\0\x0cjP  "sv, "a JPEG 2000 image"},
                                                  {0, "\xff\x4f\xff\x51"sv, "a JPEG 2000 image"},
                                                  {0, "\xff\x0a"sv, "a JPEG XL image"},
                                                  {4, "JXL "sv, "a JPEG XL image"},
                                                  {4, "ftypavif"sv, "an AVIF image"},
                                                  {4, "ftypheic"sv, "a HEIF image"},
                                                  {4, "ftypmif1"sv, "a HEIF image"},
                                                  {0, "<svg"sv, "an SVG drawing"},
                                                  {0, "%PDF"sv, "a PDF document"}}};

bool has(std::string_view bytes, const Signature& signature) {
  return bytes.size() >= signature.offset && bytes.substr(signature.offset).starts_with(signature.bytes);
}

tl::unexpected<Error> unknown_format(std::string_view bytes) {
  if (bytes.empty()) return fail(ErrorCode::kInvalidArgument, "is an empty file, not an image");
  const auto known = std::ranges::find_if(kUnsupported, [&](const Signature& s) { return has(bytes, s); });
  if (known != kUnsupported.end()) return unsupported_image(known->format, "save it as PNG");
  const bool is_netpbm = bytes.size() > 2 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '7' &&
                         (bytes[2] == '\n' || bytes[2] == ' ' || bytes[2] == '\r');
  if (is_netpbm) return unsupported_image("a Netpbm image", "save it as PNG");
  return fail(ErrorCode::kInvalidArgument,
              "is not an image of a known format (PNG, JPEG, HDR, EXR, PFM, TIFF, WebP, BMP, QOI or TGA)");
}

const Codec* find_codec(std::string_view bytes) {
  const auto found = std::ranges::find_if(kCodecs, [&](const Codec* codec) { return codec->matches(bytes); });
  return found == kCodecs.end() ? nullptr : *found;
}

Result<ImageSize> size_with(const Codec& codec, std::string_view bytes) {
  const auto size = codec.read_size(bytes);
  if (size && (size->width < 1 || size->height < 1)) return broken_image(codec.name, "it has no pixels");
  return size;
}

Status check_size(ImageSize size, std::int64_t max_pixels) {
  if (std::max(size.width, size.height) > kMaxImageSidePx)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("has {} x {} pixels, more than the {} that a side may have; scale it down",
                            size.width, size.height, kMaxImageSidePx));
  if (size.pixels() > static_cast<std::uint64_t>(max_pixels))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("has {} x {} = {} pixels, more than the {} that an image may have; scale it down",
                            size.width, size.height, size.pixels(), max_pixels));
  return {};
}

template <typename Function>
auto with_memory(const Function& function) -> decltype(function()) {
  try {
    return function();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kResourceExhausted,
                "does not fit into memory; scale the image down or use a machine with more memory");
  }
}

}  // namespace

Result<ImageSize> image_size(std::string_view bytes) {
  const Codec* codec = find_codec(bytes);
  if (codec == nullptr) return unknown_format(bytes);
  return with_memory([&] { return size_with(*codec, bytes); });
}

Result<std::vector<std::string>> image_layers(std::string_view bytes) {
  const Codec* codec = find_codec(bytes);
  if (codec == nullptr) return unknown_format(bytes);
  if (codec != &kExrCodec) return std::vector<std::string>{""};
  return with_memory([&] { return exr_layers(bytes); });
}

Result<DecodedImage> decode_pixels(std::string_view bytes, const DecodeOptions& options) {
  const Codec* codec = find_codec(bytes);
  if (codec == nullptr) return unknown_format(bytes);
  if (!options.layer.empty() && codec != &kExrCodec)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("has the format {}, and only OpenEXR files have layers", codec->name));
  return with_memory([&]() -> Result<DecodedImage> {
    const auto size = size_with(*codec, bytes);
    if (!size) return fail(size.error());
    if (const Status status = check_size(*size, options.max_pixels); !status) return fail(status.error());
    auto decoded = codec->decode(bytes, *size, options);
    if (!decoded) return decoded;
    if (const auto profile = foreign_color_profile(bytes))
      decoded->warnings.push_back(fmt::format(
          "has the colour profile '{}', which is not used: its values count as sRGB or linear", *profile));
    return decoded;
  });
}

bool is_linear_format(std::string_view bytes) {
  const Codec* codec = find_codec(bytes);
  return codec != nullptr && codec->is_linear;
}

}  // namespace tessera::core
