// SPDX-License-Identifier: Apache-2.0
#include "core/textures/texture.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
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

// A coordinate inside of the image with the texel of kMirror at `coordinate`.
template <typename T>
T mirrored(T coordinate) {
  using std::floor;
  const T half = coordinate * 0.5f;
  const T within = (half - floor(half)) * 2.0f;
  return select(within > 1.0f, T(2.0f) - within, within);
}

// The centre of the texel of a coordinate, where the others have no weight but rounding; inside of the image
// if it repeats, since large coordinates are coarse.
template <typename T>
T centre_of_texel(T coordinate, T size, MaskOf<T> repeat) {
  using std::floor;
  const T within = select(repeat, coordinate - floor(coordinate), coordinate);
  return (floor(within * size) + 0.5f) / size;
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

template <typename T>
RgbOf<T> mix(RgbOf<T> a, RgbOf<T> b, T weight) {
  return a * (1 - weight) + b * weight;
}

// Decodes a texel's bytes.
template <typename T>
RgbOf<T> decode(WordOf<T> texel, WordOf<T> values, WordOf<T> unit) {
  const auto value = [&](int shift) { return look_up(kByteValues.data(), values + (texel >> shift & 255u)); };
  return RgbOf<T>{value(0), value(8), value(16)} * look_up(kUnits.data(), unit + (texel >> 24));
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
  return decode<float>(texel_of(texels_.tiles, place_of(x, y)), values, unit);
}

Rgb TextureImage::texel(int x, int y) const {
  return fetch(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
}

Rgb TextureImage::bilinear(Vec2 uv, Wrap wrap_u, Wrap wrap_v) const {
  const auto column = footprint(uv.x, static_cast<float>(width()), wrap_u == Wrap::kRepeat);
  const auto row = footprint(1 - uv.y, static_cast<float>(height()), wrap_v == Wrap::kRepeat);
  const Rgb upper = mix(fetch(column.first, row.first), fetch(column.second, row.first), column.weight);
  const Rgb lower = mix(fetch(column.first, row.second), fetch(column.second, row.second), column.weight);
  return mix(upper, lower, row.weight);
}

// The images of all lanes, stored as bytes; images stored as floats are replaced by a black texel.
class TextureImage::InLanes {
 public:
  explicit InLanes(const std::array<const TextureImage*, kLaneCount>& images) {
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

  // Prefetches all texels first, so that their cache misses overlap.
  RgbOf<FloatN> bilinear(Vec2Of<FloatN> uv, MaskN repeat_u, MaskN repeat_v) const {
    const auto column = footprint(uv.x, widths_.all(), repeat_u);
    const auto row = footprint(1 - uv.y, heights_.all(), repeat_v);
    const U32xN upper_left = fetch(column.first, row.first), upper_right = fetch(column.second, row.first);
    const U32xN lower_left = fetch(column.first, row.second), lower_right = fetch(column.second, row.second);
    const auto upper = mix(color(upper_left), color(upper_right), column.weight);
    const auto lower = mix(color(lower_left), color(lower_right), column.weight);
    return mix(upper, lower, row.weight);
  }

 private:
  U32xN fetch(U32xN x, U32xN y) const {
    const WordLanes places(place_in_tiles(x, y, tiles_along_.all()));
    WordLanes fetched;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) fetched.set(lane, texels_[lane][places[lane]]);
    return fetched.all();
  }
  RgbOf<FloatN> color(U32xN texel) const { return decode<FloatN>(texel, values_.all(), units_.all()); }

  FloatLanes widths_, heights_;
  WordLanes tiles_along_, values_, units_;
  std::array<const std::uint32_t*, kLaneCount> texels_;
};

RgbOf<FloatN> TextureImage::bilinear(const std::array<const TextureImage*, kLaneCount>& images,
                                     Vec2Of<FloatN> uv, MaskN repeat_u, MaskN repeat_v) {
  const RgbOf<FloatN> of_bytes = InLanes(images).bilinear(uv, repeat_u, repeat_v);
  const auto in_floats = [](const TextureImage* image) { return image->texels_.format == Format::kFloats; };
  if (std::none_of(images.begin(), images.end(), in_floats)) return of_bytes;
  RgbLanes all(of_bytes);
  const FloatLanes u(uv.x), v(uv.y);
  const auto wrap = [](MaskN repeat, std::size_t lane) {
    return (repeat.bits() >> lane & 1) != 0 ? Wrap::kRepeat : Wrap::kClamp;
  };
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    if (in_floats(images[lane]))
      all.set(lane, images[lane]->bilinear({u[lane], v[lane]}, wrap(repeat_u, lane), wrap(repeat_v, lane)));
  return all.all();
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
  const Wrap along_v = wrap_v.value_or(wrap);
  Vec2 at{uv.x * scale.x + offset.x, uv.y * scale.y + offset.y};
  if (shear != Vec2{}) at = at + Vec2{uv.y * shear.x, uv.x * shear.y};
  if (wrap == Wrap::kMirror) at.x = mirrored(at.x);
  if (along_v == Wrap::kMirror) at.y = mirrored(at.y);
  if (filter == TextureFilter::kNearest)
    at = {centre_of_texel(at.x, static_cast<float>(image->width()), wrap == Wrap::kRepeat),
          centre_of_texel(at.y, static_cast<float>(image->height()), along_v == Wrap::kRepeat)};
  return image->bilinear(at, wrap, along_v);
}

namespace {

// The lanes whose textures have the filter kNearest.
class NearestLanes {
 public:
  void set(std::size_t lane, const Texture& texture) {
    if (texture.filter != TextureFilter::kNearest) return;
    nearest_ |= 1u << lane;
    widths_.set(lane, static_cast<float>(texture.image->width()));
    heights_.set(lane, static_cast<float>(texture.image->height()));
  }
  Vec2Of<FloatN> moved_to_centres(Vec2Of<FloatN> at, MaskN repeat_u, MaskN repeat_v) const {
    if (nearest_ == 0) return at;
    const MaskN lanes = MaskN::from_bits(nearest_);
    return {select(lanes, centre_of_texel(at.x, widths_.all(), repeat_u), at.x),
            select(lanes, centre_of_texel(at.y, heights_.all(), repeat_v), at.y)};
  }

 private:
  unsigned nearest_ = 0;                                     // bit i for lane i
  FloatLanes widths_{FloatN(1.0f)}, heights_{FloatN(1.0f)};  // of these lanes
};

// The lanes whose textures wrap in each way.
struct WrapLanes {
  void set(std::size_t lane, Wrap wrap) {
    repeat |= (wrap == Wrap::kRepeat ? 1u : 0u) << lane;
    mirror |= (wrap == Wrap::kMirror ? 1u : 0u) << lane;
  }
  FloatN mirrored_where_due(FloatN coordinate) const {
    return mirror == 0 ? coordinate : select(MaskN::from_bits(mirror), mirrored(coordinate), coordinate);
  }

  unsigned repeat = 0, mirror = 0;  // bit i for lane i
};

// The second set where bit i is set for lane i, else the first.
Vec2Of<FloatN> in_lanes(unsigned by_second, const UvSetsOf<FloatN>& uv) {
  if (by_second == 0) return uv.first;
  const MaskN second = MaskN::from_bits(by_second);
  return {select(second, uv.second.x, uv.first.x), select(second, uv.second.y, uv.first.y)};
}

}  // namespace

RgbOf<FloatN> Texture::evaluate(const std::array<const Texture*, kLaneCount>& textures,
                                const UvSetsOf<FloatN>& uv_sets) {
  std::array<const TextureImage*, kLaneCount> images;
  FloatLanes scale_u, scale_v, offset_u, offset_v, shear_u, shear_v;
  WrapLanes wrap_u, wrap_v;
  NearestLanes nearest;
  unsigned sheared = 0, by_second = 0;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const Texture& texture = *textures[lane];
    images[lane] = texture.image.get();
    scale_u.set(lane, texture.scale.x), scale_v.set(lane, texture.scale.y);
    offset_u.set(lane, texture.offset.x), offset_v.set(lane, texture.offset.y);
    shear_u.set(lane, texture.shear.x), shear_v.set(lane, texture.shear.y);
    sheared |= (texture.shear != Vec2{} ? 1u : 0u) << lane;
    by_second |= (texture.uv_set == UvSet::kSecond ? 1u : 0u) << lane;
    nearest.set(lane, texture);
    wrap_u.set(lane, texture.wrap);
    wrap_v.set(lane, texture.wrap_v.value_or(texture.wrap));
  }
  const Vec2Of<FloatN> uv = in_lanes(by_second, uv_sets);
  Vec2Of<FloatN> at{uv.x * scale_u.all() + offset_u.all(), uv.y * scale_v.all() + offset_v.all()};
  if (sheared != 0) {
    const MaskN lanes = MaskN::from_bits(sheared);
    at = {select(lanes, at.x + uv.y * shear_u.all(), at.x), select(lanes, at.y + uv.x * shear_v.all(), at.y)};
  }
  const MaskN repeat_u = MaskN::from_bits(wrap_u.repeat), repeat_v = MaskN::from_bits(wrap_v.repeat);
  at = nearest.moved_to_centres({wrap_u.mirrored_where_due(at.x), wrap_v.mirrored_where_due(at.y)}, repeat_u,
                                repeat_v);
  return TextureImage::bilinear(images, at, repeat_u, repeat_v);
}

namespace {

// The textures of the parameters in all lanes. Lanes without an image get another lane's.
template <typename Parameter>
struct TexturesOf {
  TexturesOf(const std::array<const Parameter*, kLaneCount>& parameters, const std::vector<Texture>& all) {
    const Texture* some_image = nullptr;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      if (parameters[lane]->texture < 0) continue;
      const Texture& texture = all[static_cast<std::size_t>(parameters[lane]->texture)];
      textured |= 1u << lane;
      if (texture.procedural) {
        procedural[lane] = &texture;
        with_procedural |= 1u << lane;
      } else {
        some_image = images[lane] = &texture;
      }
    }
    has_images = some_image != nullptr;
    std::replace(images.begin(), images.end(), static_cast<const Texture*>(nullptr), some_image);
  }

  RgbOf<FloatN> evaluate(const std::vector<Texture>& all, const TexturePointOf<FloatN>& at) const {
    const auto values = has_images ? Texture::evaluate(images, at.uv) : RgbOf<FloatN>::gray(0.0f);
    return with_procedural == 0 ? values : with_patterns(values, all, at);
  }

  unsigned textured = 0;  // bit i for lane i

 private:
  // Evaluates each procedural texture once, for all of its lanes.
  RgbOf<FloatN> with_patterns(RgbOf<FloatN> values, const std::vector<Texture>& all,
                              const TexturePointOf<FloatN>& at) const {
    for (unsigned left = with_procedural; left != 0;) {
      const Texture* texture = procedural[static_cast<std::size_t>(std::countr_zero(left))];
      unsigned its_lanes = 0;
      for (std::size_t lane = 0; lane < kLaneCount; ++lane)
        its_lanes |= (procedural[lane] == texture ? 1u : 0u) << lane;
      values = select(MaskN::from_bits(its_lanes), texture->evaluate_procedural(all, at), values);
      left &= ~its_lanes;
    }
    return values;
  }

  unsigned with_procedural = 0;
  bool has_images = false;
  std::array<const Texture*, kLaneCount> images{}, procedural{};
};

}  // namespace

RgbOf<FloatN> evaluate(const std::array<const ColorParameter*, kLaneCount>& parameters,
                       const std::vector<Texture>& textures, const TexturePointOf<FloatN>& at) {
  RgbLanes constants;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) constants.set(lane, parameters[lane]->value);
  const RgbOf<FloatN> value = constants.all();
  const TexturesOf of(parameters, textures);
  if (of.textured == 0) return value;
  return select(MaskN::from_bits(of.textured), value * of.evaluate(textures, at), value);
}

FloatN evaluate(const std::array<const ScalarParameter*, kLaneCount>& parameters,
                const std::vector<Texture>& textures, const TexturePointOf<FloatN>& at) {
  FloatLanes constants;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) constants.set(lane, parameters[lane]->value);
  const FloatN value = constants.all();
  const TexturesOf of(parameters, textures);
  if (of.textured == 0) return value;
  return select(MaskN::from_bits(of.textured), value * of.evaluate(textures, at).r, value);
}

}  // namespace tessera::core
