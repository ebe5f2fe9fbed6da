// SPDX-License-Identifier: Apache-2.0
#include "core/image/color_profile.hpp"

#include <fmt/format.h>
#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>

#include "core/base/printable.hpp"

namespace tessera::core {
namespace {

using namespace std::string_view_literals;
using Text = std::optional<std::string>;

constexpr std::size_t kMaxProfileBytes = std::size_t{1} << 22, kMaxNameLength = 80;

// Part of the bytes; empty if it is not all there.
std::string_view part(std::string_view bytes, std::size_t at, std::size_t length) {
  if (at > bytes.size() || length > bytes.size() - at) return {};
  return bytes.substr(at, length);
}

// An integer of up to four bytes; 0 if it is not all there.
std::uint32_t integer(std::string_view bytes, std::size_t at, std::size_t length,
                      bool little_endian = false) {
  std::uint32_t value = 0;
  const std::string_view digits = part(bytes, at, length);
  for (std::size_t i = 0; i < digits.size(); ++i) {
    const char byte = digits[little_endian ? digits.size() - 1 - i : i];
    value = value << 8 | static_cast<unsigned char>(byte);
  }
  return value;
}

Text shown(std::string_view name) {
  name = name.substr(0, std::min(name.find('\0'), kMaxNameLength));
  return name.empty() ? Text("unnamed") : Text(printable(name));
}

// ASCII of big-endian UTF-16.
std::string narrowed(std::string_view wide) {
  std::string text;
  for (std::size_t i = 0; i + 1 < wide.size() && text.size() < kMaxNameLength; i += 2)
    text.push_back(wide[i] == 0 ? wide[i + 1] : '?');
  return text;
}

// The text of a tag of the type "desc" (ICC.1:2001) or "mluc" (ICC.1:2010).
Text description_text(std::string_view tag) {
  if (tag.starts_with("desc")) return shown(part(tag, 12, integer(tag, 8, 4)));
  if (!tag.starts_with("mluc") || integer(tag, 8, 4) == 0) return std::nullopt;
  return shown(narrowed(part(tag, integer(tag, 24, 4), integer(tag, 20, 4))));
}

// The description of an ICC profile.
Text description_of(std::string_view icc) {
  constexpr std::size_t kSignature = 36, kTagCount = 128, kTagBytes = 12;
  constexpr std::uint32_t kMaxTags = 1000;
  if (part(icc, kSignature, 4) != "acsp") return std::nullopt;
  const std::uint32_t tags = std::min(integer(icc, kTagCount, 4), kMaxTags);
  for (std::size_t i = 0; i < tags; ++i) {
    const std::size_t at = kTagCount + 4 + i * kTagBytes;
    if (part(icc, at, 4) == "desc")
      return description_text(part(icc, integer(icc, at + 4, 4), integer(icc, at + 8, 4)));
  }
  return std::nullopt;
}

bool contains(std::string_view text, std::string_view word) {
  return text.find(word) != std::string_view::npos;
}

// "c2" is the small sRGB of many web services.
Text unless_srgb(Text name) {
  if (!name) return name;
  const bool is_srgb = (contains(*name, "sRGB") || contains(*name, "srgb")) && !contains(*name, "inear");
  return is_srgb || *name == "c2" ? std::nullopt : name;
}

Text of_profile(std::string_view icc) {
  return icc.empty() ? std::nullopt : unless_srgb(description_of(icc));
}

std::string inflated(std::string_view zlib) {
  const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> decompressor(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  if (!decompressor) return {};
  std::string plain(std::min(kMaxProfileBytes, 1024 * (zlib.size() + 1)), '\0');
  std::size_t size = 0;
  const auto result = libdeflate_zlib_decompress(decompressor.get(), zlib.data(), zlib.size(), plain.data(),
                                                 plain.size(), &size);
  plain.resize(result == LIBDEFLATE_SUCCESS ? size : 0);
  return plain;
}

// A keyword, a null, a method and the compressed profile. A profile without a description has the keyword.
Text of_iccp(std::string_view chunk) {
  const std::size_t end = chunk.find('\0');
  if (end == chunk.npos || end + 2 > chunk.size()) return std::nullopt;
  const Text described = description_of(inflated(chunk.substr(end + 2)));
  return unless_srgb(described ? described : shown(chunk.substr(0, end)));
}

// As they are stored: 100,000 times the gamma of the encoding, and the white point, red, green and blue.
Text of_gamma(std::uint32_t gamma) {
  constexpr std::uint32_t kSrgb = 45455, kTolerance = 1000;
  if (gamma == 0 || (gamma + kTolerance > kSrgb && gamma < kSrgb + kTolerance)) return std::nullopt;
  return fmt::format("gamma {:.3g}", 1e5 / gamma);
}
Text of_chromaticities(std::string_view chunk) {
  constexpr std::array kSrgb{31270, 32900, 64000, 33000, 30000, 60000, 15000, 6000};
  constexpr std::int64_t kTolerance = 1000;
  for (std::size_t i = 0; i < kSrgb.size(); ++i)
    if (std::abs(std::int64_t{integer(chunk, 4 * i, 4)} - kSrgb[i]) > kTolerance)
      return "primaries other than those of sRGB";
  return std::nullopt;
}

// sRGB goes before a profile, and a profile before gamma and primaries (PNG, third edition, section 4.3).
Text of_png(std::string_view bytes) {
  Text gamma, primaries;
  std::size_t at = 8;
  while (true) {
    const std::size_t length = integer(bytes, at, 4);
    const std::string_view type = part(bytes, at + 4, 4), chunk = part(bytes, at + 8, length);
    if (type.empty() || type == "IDAT" || type == "sRGB" || length > bytes.size()) break;
    if (type == "iCCP") return of_iccp(chunk);
    if (type == "gAMA") gamma = of_gamma(integer(chunk, 0, 4));
    if (type == "cHRM" && chunk.size() >= 32) primaries = of_chromaticities(chunk);
    at += length + 12;
    if (type == "IEND") break;
  }
  if (part(bytes, at + 4, 4) == "sRGB") return std::nullopt;
  return primaries ? primaries : gamma;
}

// Profiles longer than a segment go on in others; their tags with text come first.
Text of_jpeg(std::string_view bytes) {
  constexpr std::string_view kProfile = "ICC_PROFILE\0"sv;
  constexpr std::size_t kHeader = kProfile.size() + 2;
  std::string icc;
  std::size_t at = 2;
  while (part(bytes, at, 1) == "\xff"sv) {
    while (part(bytes, at + 1, 1) == "\xff"sv) ++at;  // fill bytes
    const std::uint32_t marker = integer(bytes, at + 1, 1), length = integer(bytes, at + 2, 2);
    if (marker == 0xda || length < 2) break;  // the scan
    const std::string_view segment = part(bytes, at + 4, length - 2);
    if (marker == 0xe2 && segment.starts_with(kProfile) && icc.size() < kMaxProfileBytes)
      icc += segment.substr(std::min(kHeader, segment.size()));
    at += 2 + length;
  }
  return of_profile(icc);
}

// The tag 34675 of the first image.
Text of_tiff(std::string_view bytes) {
  constexpr std::uint32_t kTag = 34675;
  constexpr std::size_t kEntryBytes = 12;
  const bool little = bytes.starts_with("II");
  const std::size_t directory = integer(bytes, 4, 4, little);
  const std::uint32_t entries = integer(bytes, directory, 2, little);
  for (std::size_t i = 0; i < entries; ++i) {
    const std::size_t at = directory + 2 + i * kEntryBytes;
    if (integer(bytes, at, 2, little) != kTag) continue;
    return of_profile(part(bytes, integer(bytes, at + 8, 4, little), integer(bytes, at + 4, 4, little)));
  }
  return std::nullopt;
}

Text of_webp(std::string_view bytes) {
  std::size_t at = 12;
  for (std::string_view type = part(bytes, at, 4); !type.empty(); type = part(bytes, at, 4)) {
    const std::size_t length = integer(bytes, at + 4, 4, true);
    if (type == "ICCP") return of_profile(part(bytes, at + 8, length));
    at += 8 + length + length % 2;
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> foreign_color_profile(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return of_png(bytes);
  if (bytes.starts_with("\xff\xd8\xff")) return of_jpeg(bytes);
  if (bytes.starts_with("II*\0"sv) || bytes.starts_with("MM\0*"sv)) return of_tiff(bytes);
  if (bytes.starts_with("RIFF") && part(bytes, 8, 4) == "WEBP") return of_webp(bytes);
  return std::nullopt;
}

}  // namespace tessera::core
