// SPDX-License-Identifier: Apache-2.0
#include "core/textures/texture_image.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "core/image/limits.hpp"
#include "core/image/srgb.hpp"
#include "core/math/word_lanes.hpp"

namespace tessera::core {
namespace {

// The values of texel bytes: consecutive tables for each byte format, so that texels of several formats are
// decoded at once. The tables duplicate srgb_decode's values to avoid calls in the innermost loop.
constexpr std::uint32_t kOfSrgb = 0, kOfLinear = 256, kOfMantissas = 512;
const std::array<float, 768> kByteValues = [] {
  std::array<float, 768> values{};
  for (std::size_t code = 0; code < 256; ++code) {
    const auto whole = static_cast<float>(code);
    values[kOfSrgb + code] = srgb_decode(static_cast<std::uint8_t>(code));
    values[kOfLinear + code] = whole / 255;
    values[kOfMantissas + code] = whole;
  }
  return values;
}();

// The scales of the mantissas of an HDR texel by its exponent byte (Ward 1991); the last entry is for
// texels without exponents.
constexpr int kExponentBias = 128 + 8;
constexpr std::uint32_t kOfExponents = 0, kOne = 256;
const std::array<float, 257> kUnits = [] {
  std::array<float, 257> units{};
  for (int code = 0; code < 256; ++code)
    units[static_cast<std::size_t>(code)] = std::ldexp(1.0f, code - kExponentBias);
  units[kOne] = 1;
  return units;
}();

std::uint32_t pack(std::uint32_t r, std::uint32_t g, std::uint32_t b, std::uint32_t rest) {
  return r | g << 8 | b << 16 | rest << 24;
}

// The RGBE encoding of the colour; nothing if it does not represent these values exactly.
std::optional<std::uint32_t> shared_exponent(Rgb color) {
  const float greatest = max_component(color);
  if (greatest == 0 && color == Rgb{}) return 0;
  int exponent = 0;
  if (!is_finite(color) || !(std::frexp(greatest, &exponent) > 0)) return std::nullopt;
  const int code = exponent + kExponentBias - 8;
  if (code < 0 || code > 255) return std::nullopt;
  const float unit = kUnits[static_cast<std::size_t>(code)];
  const auto mantissa = [unit](float value) {
    return static_cast<std::uint32_t>(std::max(value, 0.0f) / unit);
  };
  const std::uint32_t r = mantissa(color.r), g = mantissa(color.g), b = mantissa(color.b);
  const Rgb kept{static_cast<float>(r) * unit, static_cast<float>(g) * unit, static_cast<float>(b) * unit};
  if (!(kept == color)) return std::nullopt;
  return pack(r, g, b, static_cast<std::uint32_t>(code));
}

// The position of a coordinate between two rows or columns of texels.
template <typename T>
struct Footprint {
  WordOf<T> first, second;
  T weight;  // of the second
};

template <typename T>
T wrap_index(T i, T size, MaskOf<T> repeat) {
  const T below = select(repeat, i + size, T(0.0f)), above = select(repeat, i - size, size - 1.0f);
  return select(i < 0.0f, below, select(i >= size, above, i));
}

// `coordinate` is in units of the image, from 0 at the first texel's outer edge.
template <typename T>
Footprint<T> footprint(T coordinate, T size, MaskOf<T> repeat) {
  using std::floor;
  const T within = select(repeat, coordinate - floor(coordinate), coordinate);
  // NaN also maps into the image.
  const T clamped = select(within > 0.0f, select(within < 1.0f, within, T(1.0f)), T(0.0f));
  const T position = clamped * size - 0.5f;
  const T first = floor(position);
  return {to_word(wrap_index(first, size, repeat)), to_word(wrap_index(first + 1.0f, size, repeat)),
          position - first};
}

// Of a point of an image of this width or height.
template <typename T>
Footprint<T> columns_at(Vec2Of<T> uv, T width, MaskOf<T> repeat) {
  return footprint(uv.x, width, repeat);
}
template <typename T>
Footprint<T> rows_at(Vec2Of<T> uv, T height, MaskOf<T> repeat) {
  return footprint(1 - uv.y, height, repeat);
}

// Between the texels fetch(column, row) of a footprint along either axis, of what value(texel) says of them.
// Fetches all first, so that their cache misses overlap.
template <typename T, typename Fetch, typename Value>
auto interpolate(const Footprint<T>& column, const Footprint<T>& row, const Fetch& fetch,
                 const Value& value) {
  const auto upper_left = fetch(column.first, row.first), upper_right = fetch(column.second, row.first);
  const auto lower_left = fetch(column.first, row.second), lower_right = fetch(column.second, row.second);
  const auto mix = [](auto a, auto b, T weight) { return a * (1 - weight) + b * weight; };
  const auto upper = mix(value(upper_left), value(upper_right), column.weight);
  const auto lower = mix(value(lower_left), value(lower_right), column.weight);
  return mix(upper, lower, row.weight);
}

// Decodes a texel's bytes.
template <typename T>
T decode_byte(WordOf<T> texel, int shift, WordOf<T> values, WordOf<T> unit) {
  return look_up(kByteValues.data(), values + (texel >> shift & 255u)) *
         look_up(kUnits.data(), unit + (texel >> 24));
}
template <typename T>
T decode_red(WordOf<T> texel, WordOf<T> values, WordOf<T> unit) {
  return decode_byte<T>(texel, 0, values, unit);
}
template <typename T>
RgbOf<T> decode_color(WordOf<T> texel, WordOf<T> values, WordOf<T> unit) {
  return {decode_byte<T>(texel, 0, values, unit), decode_byte<T>(texel, 8, values, unit),
          decode_byte<T>(texel, 16, values, unit)};
}

// The index of a texel in tiles stored in rows of `tiles_along`.
template <typename Word>
Word place_in_tiles(Word x, Word y, Word tiles_along) {
  return ((y >> 2) * tiles_along + (x >> 2)) * 16u + ((y & 3u) * 4u + (x & 3u));
}
auto& texel_of(auto& tiles, std::uint32_t place) {
  return tiles[place / 16].texels[place % 16];
}

}  // namespace

TextureImage::TextureImage(int width, int height, const std::vector<std::uint8_t>& bytes,
                           ColorSpace color_space)
    : texels_{.width = width,
              .height = height,
              .format = color_space == ColorSpace::kSrgb ? Format::kSrgbBytes : Format::kLinearBytes} {
  texels_.tiles = empty_tiles();
  const std::uint8_t* next = bytes.data();
  const auto columns = static_cast<std::uint32_t>(width), rows = static_cast<std::uint32_t>(height);
  for (std::uint32_t y = 0; y < rows; ++y)
    for (std::uint32_t x = 0; x < columns; ++x, next += 3)
      texel_of(texels_.tiles, place_of(x, y)) = pack(next[0], next[1], next[2], 0);
}

TextureImage::TextureImage(int width, int height, std::vector<float> linear)
    : texels_{.width = width, .height = height, .format = Format::kFloats, .floats = std::move(linear)} {
  texels_.tiles = with_shared_exponents();
  if (texels_.tiles.empty()) return;
  texels_.format = Format::kSharedExponent;
  texels_.floats = {};
}

bool TextureImage::is_sound(const Texels& texels) {
  const auto is_side = [](int texel_count) { return texel_count >= 1 && texel_count <= kMaxImageSidePx; };
  if (!is_side(texels.width) || !is_side(texels.height)) return false;
  if (texels.format != Format::kFloats)
    return texels.floats.empty() &&
           texels.tiles.size() == std::size_t{tiles_along(texels.width)} * tiles_along(texels.height);
  const std::size_t pixels = static_cast<std::size_t>(texels.width) * static_cast<std::size_t>(texels.height);
  return texels.tiles.empty() && texels.floats.size() == 3 * pixels &&
         std::ranges::all_of(texels.floats, [](float value) { return value >= 0 && std::isfinite(value); });
}

// Empty if the encoding would not be exact.
std::vector<TextureImage::Tile> TextureImage::with_shared_exponents() const {
  auto tiles = empty_tiles();
  const auto columns = static_cast<std::uint32_t>(width()), rows = static_cast<std::uint32_t>(height());
  for (std::uint32_t y = 0; y < rows; ++y)
    for (std::uint32_t x = 0; x < columns; ++x) {
      const auto texel = shared_exponent(fetch(x, y));
      if (!texel) return {};
      texel_of(tiles, place_of(x, y)) = *texel;
    }
  return tiles;
}

std::uint32_t TextureImage::place_of(std::uint32_t x, std::uint32_t y) const {
  return place_in_tiles(x, y, tiles_along(width()));
}

TextureImage::Decoding TextureImage::decoding() const {
  if (texels_.format == Format::kSharedExponent) return {kOfMantissas, kOfExponents};
  return {texels_.format == Format::kSrgbBytes ? kOfSrgb : kOfLinear, kOne};
}

Rgb TextureImage::fetch(std::uint32_t x, std::uint32_t y) const {
  if (texels_.format == Format::kFloats) {
    const float* rgb = texels_.floats.data() + 3 * (std::size_t{y} * static_cast<std::size_t>(width()) + x);
    return {rgb[0], rgb[1], rgb[2]};
  }
  const auto [values, unit] = decoding();
  return decode_color<float>(texel_of(texels_.tiles, place_of(x, y)), values, unit);
}

Rgb TextureImage::texel(int x, int y) const {
  return fetch(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
}

Rgb TextureImage::bilinear(Vec2 uv, Wrap wrap_u, Wrap wrap_v) const {
  const auto color = [this](std::uint32_t x, std::uint32_t y) { return fetch(x, y); };
  return interpolate(columns_at(uv, static_cast<float>(width()), wrap_u == Wrap::kRepeat),
                     rows_at(uv, static_cast<float>(height()), wrap_v == Wrap::kRepeat), color,
                     std::identity());
}

float TextureImage::bilinear_red(Vec2 uv, Wrap wrap_u, Wrap wrap_v) const {
  if (texels_.format == Format::kFloats) return bilinear(uv, wrap_u, wrap_v).r;
  const auto texel = [this](std::uint32_t x, std::uint32_t y) {
    return texel_of(texels_.tiles, place_of(x, y));
  };
  const auto red = [of = decoding()](std::uint32_t bytes) {
    return decode_red<float>(bytes, of.values, of.unit);
  };
  return interpolate(columns_at(uv, static_cast<float>(width()), wrap_u == Wrap::kRepeat),
                     rows_at(uv, static_cast<float>(height()), wrap_v == Wrap::kRepeat), texel, red);
}

// The images of all lanes, stored as bytes; images stored as floats are replaced by a black texel.
class TextureImage::InLanes {
 public:
  explicit InLanes(const Images& images) {
    static const Tile kBlack{};
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      const TextureImage& image = *images[lane];
      const bool in_bytes = image.texels_.format != Format::kFloats;
      const auto [of_values, of_unit] = image.decoding();
      widths_.set(lane, in_bytes ? static_cast<float>(image.width()) : 1);
      heights_.set(lane, in_bytes ? static_cast<float>(image.height()) : 1);
      tiles_along_.set(lane, tiles_along(image.width()));
      values_.set(lane, of_values);
      units_.set(lane, of_unit);
      texels_[lane] = (in_bytes ? image.texels_.tiles.data() : &kBlack)->texels.data();
    }
  }

  RgbOf<FloatN> bilinear(Vec2Of<FloatN> uv, MaskN repeat_u, MaskN repeat_v) const {
    return interpolated(uv, repeat_u, repeat_v, decode_color<FloatN>);
  }
  FloatN bilinear_red(Vec2Of<FloatN> uv, MaskN repeat_u, MaskN repeat_v) const {
    return interpolated(uv, repeat_u, repeat_v, decode_red<FloatN>);
  }

 private:
  template <typename Value>
  Value interpolated(Vec2Of<FloatN> uv, MaskN repeat_u, MaskN repeat_v,
                     Value (*decode)(U32xN, U32xN, U32xN)) const {
    const auto column = columns_at(uv, widths_.all(), repeat_u), row = rows_at(uv, heights_.all(), repeat_v);
    const U32xN values = values_.all(), units = units_.all();
    return interpolate(
        column, row, [this](U32xN x, U32xN y) { return fetch(x, y); },
        [&](U32xN texels) { return decode(texels, values, units); });
  }
  U32xN fetch(U32xN x, U32xN y) const {
    const WordLanes places(place_in_tiles(x, y, tiles_along_.all()));
    WordLanes fetched;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) fetched.set(lane, texels_[lane][places[lane]]);
    return fetched.all();
  }

  FloatLanes widths_, heights_;
  WordLanes tiles_along_, values_, units_;
  std::array<const std::uint32_t*, kLaneCount> texels_;
};

namespace {

// Calls replace(lane, wrap along u, wrap along v) for each lane whose image is stored as floats.
template <typename Replace>
void for_each_in_floats(const TextureImage::Images& images, MaskN repeat_u, MaskN repeat_v,
                        const Replace& replace) {
  const auto wrap = [](MaskN repeat, std::size_t lane) {
    return (repeat.bits() >> lane & 1) != 0 ? Wrap::kRepeat : Wrap::kClamp;
  };
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    if (images[lane]->texels().format == TextureImage::Format::kFloats)
      replace(lane, wrap(repeat_u, lane), wrap(repeat_v, lane));
}

}  // namespace

RgbOf<FloatN> TextureImage::bilinear(const Images& images, Vec2Of<FloatN> uv, MaskN repeat_u,
                                     MaskN repeat_v) {
  RgbLanes colors(InLanes(images).bilinear(uv, repeat_u, repeat_v));
  const FloatLanes u(uv.x), v(uv.y);
  for_each_in_floats(images, repeat_u, repeat_v, [&](std::size_t lane, Wrap wrap_u, Wrap wrap_v) {
    colors.set(lane, images[lane]->bilinear({u[lane], v[lane]}, wrap_u, wrap_v));
  });
  return colors.all();
}

FloatN TextureImage::bilinear_red(const Images& images, Vec2Of<FloatN> uv, MaskN repeat_u, MaskN repeat_v) {
  FloatLanes reds(InLanes(images).bilinear_red(uv, repeat_u, repeat_v));
  const FloatLanes u(uv.x), v(uv.y);
  for_each_in_floats(images, repeat_u, repeat_v, [&](std::size_t lane, Wrap wrap_u, Wrap wrap_v) {
    reds.set(lane, images[lane]->bilinear_red({u[lane], v[lane]}, wrap_u, wrap_v));
  });
  return reds.all();
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

}  // namespace tessera::core
