#include "core/textures/texture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/image/srgb.hpp"

namespace tessera::core {
namespace {

// A copy of srgb_decode's values that needs no call: lookups are in the innermost loop.
const std::array<float, 256> kSrgbByteToLinear = [] {
  std::array<float, 256> values{};
  for (std::size_t code = 0; code < values.size(); ++code)
    values[code] = srgb_decode(static_cast<std::uint8_t>(code));
  return values;
}();

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

Rgb TextureImage::texel(int x, int y) const {
  const std::size_t i =
      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  if (const auto* floats = std::get_if<std::vector<float>>(&texels))
    return {(*floats)[i], (*floats)[i + 1], (*floats)[i + 2]};
  const auto& bytes = *std::get_if<std::vector<std::uint8_t>>(&texels);
  if (color_space == ColorSpace::kSrgb)
    return {kSrgbByteToLinear[bytes[i]], kSrgbByteToLinear[bytes[i + 1]], kSrgbByteToLinear[bytes[i + 2]]};
  return Rgb{static_cast<float>(bytes[i]), static_cast<float>(bytes[i + 1]),
             static_cast<float>(bytes[i + 2])} /
         255;
}

Rgb TextureImage::bilinear(Vec2 uv, Wrap wrap_u, Wrap wrap_v) const {
  const Footprint column = footprint(uv.x, width, wrap_u);
  const Footprint row = footprint(1 - uv.y, height, wrap_v);
  const Rgb upper = mix(texel(column.first, row.first), texel(column.second, row.first), column.weight);
  const Rgb lower = mix(texel(column.first, row.second), texel(column.second, row.second), column.weight);
  return mix(upper, lower, row.weight);
}

Rgb TextureImage::mean() const {
  double r = 0, g = 0, b = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Rgb color = texel(x, y);
      r += static_cast<double>(color.r);
      g += static_cast<double>(color.g);
      b += static_cast<double>(color.b);
    }
  const double count = static_cast<double>(width) * height;
  return {static_cast<float>(r / count), static_cast<float>(g / count), static_cast<float>(b / count)};
}

Rgb TextureImage::largest() const {
  Rgb largest;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Rgb color = texel(x, y);
      largest = {std::max(largest.r, color.r), std::max(largest.g, color.g), std::max(largest.b, color.b)};
    }
  return largest;
}

Rgb Texture::evaluate(Vec2 uv) const {
  return image->bilinear({uv.x * scale.x + offset.x, uv.y * scale.y + offset.y}, wrap, wrap);
}

}  // namespace tessera::core
