// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/stl_colors.hpp"

#include <algorithm>
#include <string>

#include "core/image/srgb.hpp"
#include "core/scene/loader/mtl_material.hpp"

namespace tessera::core {
namespace {

constexpr std::uint16_t kStlFlag = 0x8000;

// One of three numbers of five bits.
float stl_channel(std::uint16_t attributes, int shift) {
  constexpr std::uint16_t kMax = 31;
  return srgb_decode(static_cast<double>(attributes >> shift & kMax) / kMax);
}

// The flag says that the colour is that of the whole.
Rgb magics_color(std::uint16_t attributes, Rgb whole) {
  if ((attributes & kStlFlag) != 0) return whole;
  return {stl_channel(attributes, 0), stl_channel(attributes, 5), stl_channel(attributes, 10)};
}

// The flag says that there is a colour.
Rgb viscam_color(std::uint16_t attributes) {
  if ((attributes & kStlFlag) == 0) return kDefaultDiffuse;
  return {stl_channel(attributes, 10), stl_channel(attributes, 5), stl_channel(attributes, 0)};
}

// Other programs leave any bytes there.
bool are_viscam_colors(std::span<const std::uint16_t> attributes) {
  return std::ranges::any_of(attributes, [](std::uint16_t a) { return a != 0; }) &&
         std::ranges::all_of(attributes, [](std::uint16_t a) { return a == 0 || (a & kStlFlag) != 0; });
}

// "COLOR=", then bytes of red, green, blue and alpha.
std::optional<Rgb> color_of_header(std::string_view header) {
  constexpr std::string_view kKey = "COLOR=";
  const std::size_t at = header.find(kKey);
  if (at == std::string_view::npos || header.size() - at < kKey.size() + 3) return std::nullopt;
  const auto channel = [&](std::size_t i) {
    return srgb_decode(static_cast<std::uint8_t>(header[at + kKey.size() + i]));
  };
  return Rgb{channel(0), channel(1), channel(2)};
}

}  // namespace

Rgb StlColors::of(std::uint16_t attributes) const {
  return whole ? magics_color(attributes, *whole) : viscam_color(attributes);
}

std::optional<StlColors> stl_colors(std::string_view header, std::span<const std::uint16_t> attributes) {
  const auto whole = color_of_header(header);
  if (!whole && !are_viscam_colors(attributes)) return std::nullopt;
  return StlColors{whole};
}

}  // namespace tessera::core
