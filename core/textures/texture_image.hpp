// SPDX-License-Identifier: Apache-2.0
// Images that are looked up by coordinates in [0, 1]. Immutable once built, shared by all threads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/math/lane_array.hpp"
#include "core/math/rgb.hpp"
#include "core/math/simd_double.hpp"
#include "core/math/vec3.hpp"
#include "core/textures/wrap.hpp"

namespace tessera::core {

enum class ColorSpace { kSrgb, kLinear };
// The channels of a file that become the image: red, green and blue, or a single one in all three.
enum class TextureChannel { kColor, kAlpha, kRed, kGreen, kBlue };

// A decoded image, stored for fast lookup. 8-bit files and the shared exponents of HDR files take four
// bytes per texel. 4 x 4 texels share a cache line, so four neighbours are mostly in one or two.
class TextureImage {
 public:
  enum class Format { kSrgbBytes, kLinearBytes, kSharedExponent, kFloats };
  struct alignas(64) Tile {
    std::array<std::uint32_t, 16> texels;  // row by row; red in the lowest byte
  };
  struct Texels {
    int width = 0, height = 0;
    Format format = Format::kFloats;
    std::vector<Tile> tiles{};    // row by row; empty for kFloats
    std::vector<float> floats{};  // for kFloats: width * height * 3 values, row-major from the top left
  };

  // From width * height * 3 values, row-major from the top left: bytes as stored in PNG and JPEG files, or
  // linear floats. All values are kept exactly.
  TextureImage(int width, int height, const std::vector<std::uint8_t>& bytes,
               ColorSpace color_space = ColorSpace::kSrgb);
  TextureImage(int width, int height, std::vector<float> linear);
  // Whether an image can be made of these texels: the arrays have the sizes of the image, and floats are
  // finite and not negative.
  static bool is_sound(const Texels& texels);
  // Takes over the texels of another image. They must be sound.
  explicit TextureImage(Texels texels) : texels_(std::move(texels)) {}

  int width() const { return texels_.width; }
  int height() const { return texels_.height; }
  // The colour space of the bytes; images stored otherwise are linear.
  ColorSpace color_space() const {
    return texels_.format == Format::kSrgbBytes ? ColorSpace::kSrgb : ColorSpace::kLinear;
  }
  const Texels& texels() const { return texels_; }

  Rgb texel(int x, int y) const;  // linear; 0 <= x < width, 0 <= y < height
  // Linear, between the nearest four texels. kMirror clamps: Texture::evaluate() has mirrored uv before.
  Rgb bilinear(Vec2 uv, Wrap wrap_u, Wrap wrap_v) const;
  // The red of bilinear(), for scalar parameters.
  float bilinear_red(Vec2 uv, Wrap wrap_u, Wrap wrap_v) const;
  // Looks up an image in each lane; each lane equals bilinear() and bilinear_red().
  using Images = std::array<const TextureImage*, kLaneCount>;
  static RgbOf<FloatN> bilinear(const Images& images, Vec2Of<FloatN> uv, MaskN repeat_u, MaskN repeat_v);
  static FloatN bilinear_red(const Images& images, Vec2Of<FloatN> uv, MaskN repeat_u, MaskN repeat_v);
  Rgb mean() const;     // of all texels, linear
  Rgb largest() const;  // for each channel, linear

 private:
  class InLanes;

  Rgb fetch(std::uint32_t x, std::uint32_t y) const;
  // The table entries that decode the bytes of a texel.
  struct Decoding {
    std::uint32_t values, unit;
  };
  Decoding decoding() const;

  // The index of a texel in tile order.
  std::uint32_t place_of(std::uint32_t x, std::uint32_t y) const;
  static std::uint32_t tiles_along(int texels) { return (static_cast<std::uint32_t>(texels) + 3) / 4; }
  std::vector<Tile> empty_tiles() const {
    return std::vector<Tile>(std::size_t{tiles_along(width())} * tiles_along(height()));
  }
  std::vector<Tile> with_shared_exponents() const;

  Texels texels_;
};

}  // namespace tessera::core
