#include "core/textures/texture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/image/srgb.hpp"

namespace tessera::core {
namespace {

// For each value that a byte may have.
template <typename Decode>
std::array<float, 256> table(Decode decode) {
  std::array<float, 256> values{};
  for (std::size_t code = 0; code < values.size(); ++code) values[code] = decode(code);
  return values;
}

// A copy of srgb_decode's values that needs no call: lookups are in the innermost loop.
const std::array<float, 256> kSrgbToLinear =
    table([](std::size_t code) { return srgb_decode(static_cast<std::uint8_t>(code)); });
const std::array<float, 256> kByteToUnit =
    table([](std::size_t code) { return static_cast<float>(code) / 255; });

// What the mantissas of an HDR file's texel count, by its exponent byte (Ward 1991).
constexpr int kExponentBias = 128 + 8;
const std::array<float, 256> kSharedUnit =
    table([](std::size_t code) { return std::ldexp(1.0f, static_cast<int>(code) - kExponentBias); });

std::uint32_t pack(std::uint32_t r, std::uint32_t g, std::uint32_t b, std::uint32_t rest) {
  return r | g << 8 | b << 16 | rest << 24;
}

// Mantissas and exponent as an HDR file has them; nothing if they do not give exactly these values.
std::optional<std::uint32_t> shared_exponent(Rgb color) {
  const float greatest = max_component(color);
  if (greatest == 0 && color == Rgb{}) return 0;
  int exponent = 0;
  if (!is_finite(color) || !(std::frexp(greatest, &exponent) > 0)) return std::nullopt;
  const int code = exponent + kExponentBias - 8;
  if (code < 0 || code > 255) return std::nullopt;
  const float unit = kSharedUnit[static_cast<std::size_t>(code)];
  const auto mantissa = [unit](float value) {
    return static_cast<std::uint32_t>(std::max(value, 0.0f) / unit);
  };
  const std::uint32_t r = mantissa(color.r), g = mantissa(color.g), b = mantissa(color.b);
  const Rgb kept{static_cast<float>(r) * unit, static_cast<float>(g) * unit, static_cast<float>(b) * unit};
  if (!(kept == color)) return std::nullopt;
  return pack(r, g, b, static_cast<std::uint32_t>(code));
}

// Where a coordinate falls between two rows or columns of texels.
struct Footprint {
  int first, second;
  float weight;  // of the second
};

int wrap_index(int i, int size, Wrap wrap) {
  if (wrap == Wrap::kClamp) return i < 0 ? 0 : i >= size ? size - 1 : i;
  return i < 0 ? i + size : i >= size ? i - size : i;
}

// `coordinate` counts pictures, from 0 at the first texel's outer edge.
Footprint footprint(float coordinate, int size, Wrap wrap) {
  const float within = wrap == Wrap::kRepeat ? coordinate - std::floor(coordinate) : coordinate;
  // Written so that NaN, too, ends in the picture.
  const float clamped = within > 0 ? (within < 1 ? within : 1.0f) : 0.0f;
  const float position = clamped * static_cast<float>(size) - 0.5f;
  const float below = std::floor(position);
  const int first = static_cast<int>(below);
  return {wrap_index(first, size, wrap), wrap_index(first + 1, size, wrap), position - below};
}

Rgb mix(Rgb a, Rgb b, float weight) {
  return a * (1 - weight) + b * weight;
}

}  // namespace

TextureImage::TextureImage(int width, int height, const std::vector<std::uint8_t>& bytes,
                           ColorSpace color_space)
    : texels_{.width = width,
              .height = height,
              .format = color_space == ColorSpace::kSrgb ? Format::kSrgbBytes : Format::kLinearBytes} {
  texels_.tiles = empty_tiles();
  const std::uint8_t* next = bytes.data();
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x, next += 3)
      texels_.tiles[tile_of(x, y)].texels[within_tile(x, y)] = pack(next[0], next[1], next[2], 0);
}

TextureImage::TextureImage(int width, int height, std::vector<float> linear)
    : texels_{.width = width, .height = height, .format = Format::kFloats, .floats = std::move(linear)} {
  texels_.tiles = with_shared_exponents();
  if (texels_.tiles.empty()) return;
  texels_.format = Format::kSharedExponent;
  texels_.floats = {};
}

// Empty if that does not keep every value.
std::vector<TextureImage::Tile> TextureImage::with_shared_exponents() const {
  auto tiles = empty_tiles();
  for (int y = 0; y < height(); ++y)
    for (int x = 0; x < width(); ++x) {
      const auto texel = shared_exponent(fetch<Format::kFloats>(x, y));
      if (!texel) return {};
      tiles[tile_of(x, y)].texels[within_tile(x, y)] = *texel;
    }
  return tiles;
}

template <TextureImage::Format kFormat>
Rgb TextureImage::fetch(int x, int y) const {
  if constexpr (kFormat == Format::kFloats) {
    const float* rgb =
        texels_.floats.data() +
        3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width()) + static_cast<std::size_t>(x));
    return {rgb[0], rgb[1], rgb[2]};
  } else {
    const std::uint32_t texel = texels_.tiles[tile_of(x, y)].texels[within_tile(x, y)];
    const std::uint32_t r = texel & 255, g = texel >> 8 & 255, b = texel >> 16 & 255;
    if constexpr (kFormat == Format::kSharedExponent) {
      const auto value = [](std::uint32_t mantissa) {
        return static_cast<float>(static_cast<int>(mantissa));
      };
      return Rgb{value(r), value(g), value(b)} * kSharedUnit[texel >> 24];
    } else {
      const auto& linear = kFormat == Format::kSrgbBytes ? kSrgbToLinear : kByteToUnit;
      return {linear[r], linear[g], linear[b]};
    }
  }
}

// Calls `visit` with a function from x and y to the texel there.
template <typename Visit>
auto TextureImage::visit_format(const Visit& visit) const {
  switch (texels_.format) {
    case Format::kSrgbBytes:
      return visit([this](int x, int y) { return fetch<Format::kSrgbBytes>(x, y); });
    case Format::kLinearBytes:
      return visit([this](int x, int y) { return fetch<Format::kLinearBytes>(x, y); });
    case Format::kSharedExponent:
      return visit([this](int x, int y) { return fetch<Format::kSharedExponent>(x, y); });
    case Format::kFloats:
      break;
  }
  return visit([this](int x, int y) { return fetch<Format::kFloats>(x, y); });
}

Rgb TextureImage::texel(int x, int y) const {
  return visit_format([x, y](const auto& at) { return at(x, y); });
}

Rgb TextureImage::bilinear(Vec2 uv, Wrap wrap_u, Wrap wrap_v) const {
  const Footprint column = footprint(uv.x, width(), wrap_u);
  const Footprint row = footprint(1 - uv.y, height(), wrap_v);
  return visit_format([&](const auto& at) {
    const Rgb upper = mix(at(column.first, row.first), at(column.second, row.first), column.weight);
    const Rgb lower = mix(at(column.first, row.second), at(column.second, row.second), column.weight);
    return mix(upper, lower, row.weight);
  });
}

Rgb TextureImage::mean() const {
  double r = 0, g = 0, b = 0;
  for (int y = 0; y < height(); ++y)
    for (int x = 0; x < width(); ++x) {
      const Rgb color = texel(x, y);
      r += static_cast<double>(color.r);
      g += static_cast<double>(color.g);
      b += static_cast<double>(color.b);
    }
  const double count = static_cast<double>(width()) * height();
  return {static_cast<float>(r / count), static_cast<float>(g / count), static_cast<float>(b / count)};
}

Rgb TextureImage::largest() const {
  Rgb largest;
  for (int y = 0; y < height(); ++y)
    for (int x = 0; x < width(); ++x) {
      const Rgb color = texel(x, y);
      largest = {std::max(largest.r, color.r), std::max(largest.g, color.g), std::max(largest.b, color.b)};
    }
  return largest;
}

Rgb Texture::evaluate(Vec2 uv) const {
  return image->bilinear({uv.x * scale.x + offset.x, uv.y * scale.y + offset.y}, wrap, wrap);
}

}  // namespace tessera::core
