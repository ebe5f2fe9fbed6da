// SPDX-License-Identifier: Apache-2.0
#include "core/image/exr_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/image/limits.hpp"

namespace tessera::core {
namespace {

constexpr std::size_t kMagicAndVersion = 8;
constexpr std::uint32_t kDeep = 0x800, kOfSeveralParts = 0x1000;

struct Attribute {
  std::string_view name, type;
  std::size_t bytes;  // 0: a channel list of any length
};

// The attributes needed to read an image; all others are skipped.
constexpr std::array<Attribute, 9> kNeeded{{{"channels", "chlist", 0},
                                            {"compression", "compression", 1},
                                            {"dataWindow", "box2i", 16},
                                            {"displayWindow", "box2i", 16},
                                            {"lineOrder", "lineOrder", 1},
                                            {"tiles", "tiledesc", 9},
                                            {"pixelAspectRatio", "float", 4},
                                            {"screenWindowCenter", "v2f", 8},
                                            {"screenWindowWidth", "float", 4}}};
constexpr std::size_t kChannelBytes = 16;  // after its name

std::uint32_t number_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value |= std::uint32_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
  return value;
}

// Whether the channel list is well-formed: entries fill the value, and an empty name terminates it.
bool is_channel_list(std::string_view value) {
  for (;;) {
    const std::size_t name_end = value.find('\0');
    if (name_end == 0) return value.size() == 1;
    if (name_end == std::string_view::npos || value.size() - name_end <= kChannelBytes) return false;
    value.remove_prefix(name_end + 1 + kChannelBytes);
  }
}

// OpenEXR parses some types by their own length rules and continues where these end, not at the end of the
// value.
bool is_as_needed(const Attribute& needed, std::string_view type, std::string_view value) {
  if (type != needed.type) return false;
  return needed.bytes == 0 ? is_channel_list(value) : value.size() == needed.bytes;
}

// Sizes claimed by attributes.
struct Claims {
  std::int64_t width = 0, height = 0, tile_width = 0, tile_height = 0;
  std::int64_t channels = 0;
};

// Of an attribute "chromaticities"; nullopt if they are those of Rec. 709, to three digits, or damaged.
std::optional<PrimaryCoordinates> foreign_primaries(std::string_view type, std::string_view value) {
  constexpr PrimaryCoordinates kRec709{0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
  constexpr float kTolerance = 1e-3f;
  PrimaryCoordinates read{};
  if (type != "chromaticities" || value.size() != sizeof(read)) return std::nullopt;
  bool differ = false;
  for (std::size_t i = 0; i < read.size(); ++i) {
    read[i] = std::bit_cast<float>(number_at(value, 4 * i));
    if (!std::isfinite(read[i])) return std::nullopt;
    differ |= std::fabs(read[i] - kRec709[i]) > kTolerance;
  }
  return differ ? std::optional(read) : std::nullopt;
}

// The attribute must be well-formed (is_as_needed).
void note_claim(std::string_view name, std::string_view value, Claims& claims) {
  const auto number = [&](std::size_t i) {
    return std::int64_t{static_cast<std::int32_t>(number_at(value, 4 * i))};
  };
  if (name == "dataWindow") {
    claims.width = number(2) - number(0) + 1;
    claims.height = number(3) - number(1) + 1;
  } else if (name == "tiles") {
    claims.tile_width = number_at(value, 0);
    claims.tile_height = number_at(value, 4);
  } else if (name == "channels") {
    // Each channel has a name of at least one letter and its terminator. Several lists add up.
    claims.channels += static_cast<std::int64_t>(value.size() / (2 + kChannelBytes) + 1);
  }
}

// OpenEXR decompresses up to 256 lines, or a tile, at once. A genuine file has at least one byte for a
// thousand claimed.
bool is_plausible_block(const Claims& claims, std::size_t file_bytes) {
  constexpr std::int64_t kLines = 256, kAlwaysAllowed = std::int64_t{1} << 28, kMaxBytesOfOne = 1032;
  const std::int64_t most = kAlwaysAllowed + kMaxBytesOfOne * static_cast<std::int64_t>(file_bytes);
  if (std::max(claims.tile_width, claims.tile_height) > kMaxImageSidePx) return false;
  const std::int64_t pixels =
      std::max(claims.width * std::min(claims.height, kLines), claims.tile_width * claims.tile_height);
  return pixels <= most / (4 * std::max<std::int64_t>(claims.channels, 1));
}

}  // namespace

Result<std::map<std::string, std::string>> exr_texts(std::string_view bytes) {
  const auto refuse = [](const char* what) { return fail(ErrorCode::kInvalidArgument, what); };
  if (bytes.size() < kMagicAndVersion || !bytes.starts_with("\x76\x2f\x31\x01"))
    return refuse("it does not begin as one");
  std::map<std::string, std::string> texts;
  for (std::size_t at = kMagicAndVersion;;) {
    const std::size_t name_end = bytes.find('\0', at);
    if (name_end == at) return texts;
    const std::size_t type_end =
        name_end == std::string_view::npos ? name_end : bytes.find('\0', name_end + 1);
    if (type_end == std::string_view::npos || bytes.size() - type_end < 5)
      return refuse("the file ends too early");
    const std::size_t size = number_at(bytes, type_end + 1);
    if (size > bytes.size() - type_end - 5) return refuse("the file ends too early");
    if (bytes.substr(name_end + 1, type_end - name_end - 1) == "string")
      texts.emplace(bytes.substr(at, name_end - at), bytes.substr(type_end + 5, size));
    at = type_end + 5 + size;
  }
}

ExrStructure exr_structure(std::string_view bytes) {
  const std::uint32_t flags = bytes.size() < kMagicAndVersion ? 0 : number_at(bytes, 4);
  if ((flags & kOfSeveralParts) != 0) return ExrStructure::kSeveralParts;
  return (flags & kDeep) != 0 ? ExrStructure::kDeep : ExrStructure::kFlat;
}

Result<ExrHeader> checked_exr_header(std::string_view bytes) {
  const auto refuse = [](std::string what) { return fail(ErrorCode::kInvalidArgument, std::move(what)); };
  const auto too_early = [&] { return refuse("the file ends too early"); };
  if (bytes.size() < kMagicAndVersion) return too_early();
  std::string header(bytes.substr(0, kMagicAndVersion));
  Claims claims;
  std::optional<PrimaryCoordinates> primaries;
  for (;;) {
    const std::size_t name_end = bytes.find('\0', header.size());
    if (name_end == std::string_view::npos) return too_early();
    const std::string_view name = bytes.substr(header.size(), name_end - header.size());
    header.append(name).push_back('\0');
    if (name.empty()) break;
    const std::size_t type_end = bytes.find('\0', header.size());
    if (type_end == std::string_view::npos || bytes.size() - type_end < 5) return too_early();
    const std::string_view type = bytes.substr(header.size(), type_end - header.size());
    const std::size_t size = number_at(bytes, type_end + 1);
    if (size > bytes.size() - type_end - 5) return too_early();
    const std::string_view value = bytes.substr(type_end + 5, size);
    if (name == "chromaticities") primaries = foreign_primaries(type, value);
    const auto needed = std::ranges::find(kNeeded, name, &Attribute::name);
    if (needed != kNeeded.end()) {
      if (!is_as_needed(*needed, type, value))
        return refuse(fmt::format("its attribute {} is damaged", name));
      note_claim(name, value, claims);
    }
    header.append(needed != kNeeded.end() ? std::string(type) : std::string(type.size(), 'x'));
    header.append(bytes.substr(type_end, 5 + size));
  }
  if (!is_plausible_size(claims.width, claims.height, bytes.size()) ||
      !is_plausible_block(claims, bytes.size()))
    return refuse(implausible_size(claims.width, claims.height));
  return ExrHeader{
      std::move(header), {static_cast<int>(claims.width), static_cast<int>(claims.height)}, primaries};
}

}  // namespace tessera::core
