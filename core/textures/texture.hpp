// SPDX-License-Identifier: Apache-2.0
// Textures: images, looked up by surface coordinates, and procedural ones. Immutable once built, shared by
// all threads.
//
// u runs to the right and v upwards, as in OBJ files: (0, 0) is the lower left corner of the image. Texel
// centres lie at ((i + 0.5) / width, (j + 0.5) / height).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/math/lane_array.hpp"
#include "core/math/rgb.hpp"
#include "core/math/simd_double.hpp"
#include "core/math/uv_sets.hpp"
#include "core/math/vec3.hpp"
#include "core/textures/procedural.hpp"
#include "core/textures/texture_parameter.hpp"

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
  // Looks up an image in each lane; each lane equals bilinear().
  static RgbOf<FloatN> bilinear(const std::array<const TextureImage*, kLaneCount>& images, Vec2Of<FloatN> uv,
                                MaskN repeat_u, MaskN repeat_v);
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

// An image that is mapped to surfaces, or a procedural texture.
struct Texture {
  // Null for a procedural texture; several textures may share an image.
  std::shared_ptr<const TextureImage> image;
  Wrap wrap = Wrap::kRepeat;  // along u, and along v unless wrap_v is given
  // The image is looked up at (scale.x u + shear.x v, scale.y v + shear.y u) + offset.
  Vec2 scale{1, 1};
  Vec2 offset{0, 0};
  std::optional<Wrap> wrap_v{};
  Vec2 shear{0, 0};
  UvSet uv_set = UvSet::kFirst;  // the texture coordinates u and v
  TextureFilter filter = TextureFilter::kLinear;
  // Has a uv_set; all other members above are those of images.
  std::optional<ProceduralTexture> procedural{};

  bool operator==(const Texture&) const = default;

  // Whether u of the image depends on v of the surface, or the reverse, as in rotated images.
  bool is_sheared() const { return shear != Vec2{}; }

  // Of images.
  Rgb evaluate(Vec2 uv) const;  // filtered, linear colour; at coordinates of its set
  Rgb evaluate(const UvSets& uv) const { return evaluate(uv[uv_set]); }
  // Evaluates a texture in each lane; each lane equals evaluate().
  static RgbOf<FloatN> evaluate(const std::array<const Texture*, kLaneCount>& textures,
                                const UvSetsOf<FloatN>& uv);

  // Of procedural textures: what materials see, in [0, max]; and what other textures use, of any sign. Inputs
  // are among `all`.
  Rgb evaluate_procedural(const std::vector<Texture>& all, const TexturePoint& at) const;
  RgbOf<FloatN> evaluate_procedural(const std::vector<Texture>& all, const TexturePointOf<FloatN>& at) const;
  Rgb evaluate_unclamped(const std::vector<Texture>& all, const TexturePoint& at) const;

  // For each channel; of a procedural texture an estimate.
  Rgb mean(const std::vector<Texture>& all) const;
  // A bound for each channel.
  Rgb largest() const { return procedural ? Rgb::gray(procedural->max) : image->largest(); }
};

// The value of a texture where a material uses it.
inline Rgb value_at(const Texture& texture, const std::vector<Texture>& all, const TexturePoint& at) {
  return texture.procedural ? texture.evaluate_procedural(all, at) : texture.evaluate(at.uv);
}

inline Rgb ColorParameter::evaluate(const std::vector<Texture>& textures, const TexturePoint& at) const {
  return texture < 0 ? value : value * value_at(textures[static_cast<std::size_t>(texture)], textures, at);
}

inline float ScalarParameter::evaluate(const std::vector<Texture>& textures, const TexturePoint& at) const {
  return texture < 0 ? value : value * value_at(textures[static_cast<std::size_t>(texture)], textures, at).r;
}

// Evaluates a parameter in each lane; each lane equals evaluate().
RgbOf<FloatN> evaluate(const std::array<const ColorParameter*, kLaneCount>& parameters,
                       const std::vector<Texture>& textures, const TexturePointOf<FloatN>& at);
FloatN evaluate(const std::array<const ScalarParameter*, kLaneCount>& parameters,
                const std::vector<Texture>& textures, const TexturePointOf<FloatN>& at);

}  // namespace tessera::core
