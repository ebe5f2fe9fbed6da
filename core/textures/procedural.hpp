// SPDX-License-Identifier: Apache-2.0
// Procedural textures: patterns that are computed where a surface is hit, from the point in space, its
// texture coordinates or its normal. Those of pbrt (Pharr et al. 2023, section 10.5), the combinations of
// textures, and grids. Plain data.
//
// They have no filter: a pattern that is finer than a pixel is averaged by the samples of the pixel.
#pragma once

#include <variant>

#include "core/math/rgb.hpp"
#include "core/math/transform.hpp"
#include "core/textures/texture_parameter.hpp"
#include "core/textures/wrap.hpp"

namespace tessera::core {

// Cells of side 1, alternately of two colours; the cell from the origin to (1, 1, 1) has the first.
struct CheckerboardPattern {
  ColorParameter even{Rgb::gray(1), -1}, odd{Rgb::gray(0), -1};

  bool operator==(const CheckerboardPattern&) const = default;
};

// Disks of radius 0.35 in the plane z = 0, at a random place in about two of five cells of side 1.
struct DotsPattern {
  ColorParameter inside{Rgb::gray(1), -1}, outside{Rgb::gray(0), -1};

  bool operator==(const DotsPattern&) const = default;
};

struct FbmPattern {
  int octaves = 8;
  float roughness = 0.5f;  // the height of an octave relative to the one before

  bool operator==(const FbmPattern&) const = default;
};

// Sums of absolute values of noise, which have creases.
struct WrinkledPattern {
  int octaves = 8;
  float roughness = 0.5f;

  bool operator==(const WrinkledPattern&) const = default;
};

// Waves on water.
struct WindyPattern {
  bool operator==(const WindyPattern&) const = default;
};

// Layers along y, disturbed by noise.
struct MarblePattern {
  int octaves = 8;
  float roughness = 0.5f;
  float scale = 1;
  float variation = 0.2f;  // the amount of noise

  bool operator==(const MarblePattern&) const = default;
};

// The first where `amount` is 0, the second where it is 1.
struct MixPattern {
  ColorParameter first{Rgb::gray(0), -1}, second{Rgb::gray(1), -1};
  ScalarParameter amount = 0.5f;

  bool operator==(const MixPattern&) const = default;
};

struct ProductPattern {
  ColorParameter first{Rgb::gray(1), -1}, second{Rgb::gray(1), -1};

  bool operator==(const ProductPattern&) const = default;
};

// base ^ exponent in each channel; negative values count as 0.
struct PowerPattern {
  ColorParameter base{Rgb::gray(1), -1};
  float exponent = 1;

  bool operator==(const PowerPattern&) const = default;
};

// 1 where the base is at least the threshold, in each channel, and 0 elsewhere.
struct StepPattern {
  ColorParameter base{Rgb::gray(1), -1};
  float threshold = 0.5f;

  bool operator==(const StepPattern&) const = default;
};

// |z|. With coordinates of the normal, how much the surface faces an axis (pbrt's "directionmix").
struct FacingPattern {
  bool operator==(const FacingPattern&) const = default;
};

// A grid of voxels over the unit cube. Its layers of equal z stand side by side in an image, from the top
// left, row by row: voxel (x, y, z) is the texel (x, y) of layer z, counted from the layer's top left.
struct GridPattern {
  ColorParameter layers{Rgb::gray(1), -1};  // the texture is an image
  int depth = 1;                            // the number of layers
  int columns = 1;                          // of layers in the image, which has as many rows as are needed
  Wrap wrap = Wrap::kClamp;
  TextureFilter filter = TextureFilter::kLinear;

  int rows() const { return (depth + columns - 1) / columns; }
  bool operator==(const GridPattern&) const = default;
};

// What gives points of space texture coordinates: (x, y); the angle from +z over pi, and the longitude from
// +x over 2 pi; the longitude from -x over 2 pi, and z (Pharr et al. 2023, section 10.2).
enum class Projection { kPlanar, kSpherical, kCylindrical };

// Another texture by these texture coordinates.
struct ProjectedPattern {
  ColorParameter base{Rgb::gray(1), -1};
  Projection projection = Projection::kPlanar;

  bool operator==(const ProjectedPattern&) const = default;
};

using Pattern = std::variant<CheckerboardPattern, DotsPattern, FbmPattern, WrinkledPattern, WindyPattern,
                             MarblePattern, MixPattern, ProductPattern, PowerPattern, FacingPattern,
                             GridPattern, ProjectedPattern, StepPattern>;

// What a pattern is a function of: the point in world space, (u, v, 0), or the unit geometric normal.
enum class PatternSpace { kPosition, kUv, kNormal };

struct ProceduralTexture {
  Pattern pattern{};
  PatternSpace space = PatternSpace::kPosition;
  Transform transform{};  // from that space to the pattern's
  // Where a material uses the texture, values are clamped to [0, max]. Other textures use them as they are.
  float max = 1;

  bool operator==(const ProceduralTexture&) const = default;
};

inline constexpr int kMaxNoiseOctaves = 32;
inline constexpr float kMaxPatternValue = 1e6f;
inline constexpr int kMaxGridLayers = 1 << 14;
// The number of textures that a look-up evaluates, each as often as it is referred to.
inline constexpr int kMaxTextureWeight = 500;

// Calls visit(parameter) for each colour and number that is an input of the pattern.
template <typename Visit>
void visit_inputs(const Pattern& pattern, const Visit& visit) {
  std::visit(
      [&](const auto& p) {
        if constexpr (requires { p.even; }) visit(p.even), visit(p.odd);
        if constexpr (requires { p.inside; }) visit(p.inside), visit(p.outside);
        if constexpr (requires { p.first; }) visit(p.first), visit(p.second);
        if constexpr (requires { p.amount; }) visit(p.amount);
        if constexpr (requires { p.base; }) visit(p.base);
        if constexpr (requires { p.layers; }) visit(p.layers);
      },
      pattern);
}

}  // namespace tessera::core
