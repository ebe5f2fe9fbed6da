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
#include "core/textures/texture_image.hpp"
#include "core/textures/texture_parameter.hpp"

namespace tessera::core {

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
  Wrap wrap_along_v() const { return wrap_v.value_or(wrap); }

  // Of images: filtered, linear colour, and the red of it.
  Rgb evaluate(Vec2 uv) const;  // at coordinates of its set
  Rgb evaluate(const UvSets& uv) const { return evaluate(uv[uv_set]); }
  float evaluate_red(const UvSets& uv) const;
  // Evaluates a texture in each lane; each lane equals evaluate() and evaluate_red().
  static RgbOf<FloatN> evaluate(const std::array<const Texture*, kLaneCount>& textures,
                                const UvSetsOf<FloatN>& uv);
  static FloatN evaluate_red(const std::array<const Texture*, kLaneCount>& textures,
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

 private:
  Vec2 image_point(Vec2 uv) const;  // where the image is looked up
};

// The value of a texture where a material uses it, and its red.
inline Rgb value_at(const Texture& texture, const std::vector<Texture>& all, const TexturePoint& at) {
  return texture.procedural ? texture.evaluate_procedural(all, at) : texture.evaluate(at.uv);
}
inline float red_at(const Texture& texture, const std::vector<Texture>& all, const TexturePoint& at) {
  return texture.procedural ? texture.evaluate_procedural(all, at).r : texture.evaluate_red(at.uv);
}

inline Rgb ColorParameter::evaluate(const std::vector<Texture>& textures, const TexturePoint& at) const {
  return texture < 0 ? value : value * value_at(textures[static_cast<std::size_t>(texture)], textures, at);
}

inline float ScalarParameter::evaluate(const std::vector<Texture>& textures, const TexturePoint& at) const {
  return texture < 0 ? value : value * red_at(textures[static_cast<std::size_t>(texture)], textures, at);
}

// Evaluates a parameter in each lane; each lane equals evaluate().
RgbOf<FloatN> evaluate(const std::array<const ColorParameter*, kLaneCount>& parameters,
                       const std::vector<Texture>& textures, const TexturePointOf<FloatN>& at);
FloatN evaluate(const std::array<const ScalarParameter*, kLaneCount>& parameters,
                const std::vector<Texture>& textures, const TexturePointOf<FloatN>& at);

}  // namespace tessera::core
