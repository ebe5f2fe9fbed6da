// SPDX-License-Identifier: Apache-2.0
// The keys of procedural textures. A new pattern adds its table here, and its word to kPatternTypes.
#pragma once

#include "core/scene/tables/domains.hpp"
#include "core/textures/procedural.hpp"

namespace tessera::core {

namespace domains {
inline constexpr Range kPatternRange{.min = -double{kMaxPatternValue}, .max = double{kMaxPatternValue}};
inline constexpr Domain kPatternColor{
    .range = kPatternRange, .definition = "pattern_color", .values = "colour"};
inline constexpr Domain kPatternNumber{
    .range = kPatternRange, .definition = "pattern_number", .values = "a number"};
inline constexpr Domain kPatternFactor{.range = kPatternRange};
inline constexpr Domain kPatternExponent{.range = {.min = 0, .max = 100}};
inline constexpr Domain kOctaves{.range = {.min = 1, .max = double{kMaxNoiseOctaves}}, .values = "1 to 32"};
inline constexpr Domain kOctaveHeight{.range = {.min = 0, .max = 10}};
inline constexpr Domain kProjection = words(scene_keys::kProjections);
inline constexpr Domain kPatternSpace = words(scene_keys::kPatternSpaces);
inline constexpr Domain kGridLayers{.range = {.min = 1, .max = double{kMaxGridLayers}},
                                    .values = "1 to 16384"};
inline constexpr Domain kGridWrap = words(scene_keys::kWraps);
inline constexpr Domain kGridTexelFilter = words(scene_keys::kTextureFilters);
inline constexpr Domain kUvSet = words(scene_keys::kUvSets);
}  // namespace domains

// The numbers of noise: the names of all members are the same.
template <typename Owner>
constexpr auto noise_keys() {
  return Table{Key{"octaves", &Owner::octaves, domains::kOctaves,
                   "the number of octaves of noise, each 1.99 times as fine as the one before"},
               Key{"roughness", &Owner::roughness, domains::kOctaveHeight,
                   "the height of an octave relative to the one before"}};
}

template <>
inline constexpr auto kKeys<CheckerboardPattern> =
    Table{Key{"even", &CheckerboardPattern::even, domains::kPatternColor,
              "the colour of the cell from the origin to (1, 1, 1), and of every second one"},
          Key{"odd", &CheckerboardPattern::odd, domains::kPatternColor, "the colour of the others"}};

template <>
inline constexpr auto kKeys<DotsPattern> =
    Table{Key{"inside", &DotsPattern::inside, domains::kPatternColor, "the colour of the dots"},
          Key{"outside", &DotsPattern::outside, domains::kPatternColor, "the colour between them"}};

template <>
inline constexpr auto kKeys<FbmPattern> = noise_keys<FbmPattern>();

template <>
inline constexpr auto kKeys<WrinkledPattern> = noise_keys<WrinkledPattern>();

template <>
inline constexpr auto kKeys<WindyPattern> = Table{};

template <>
inline constexpr auto kKeys<MarblePattern> =
    join(noise_keys<MarblePattern>(),
         Table{Key{"scale", &MarblePattern::scale, domains::kPatternFactor, "multiplies the coordinates"},
               Key{"variation", &MarblePattern::variation, domains::kPatternFactor,
                   "how much noise disturbs the layers"}});

template <>
inline constexpr auto kKeys<MixPattern> =
    Table{Key{"first", &MixPattern::first, domains::kPatternColor, "the colour where `amount` is 0"},
          Key{"second", &MixPattern::second, domains::kPatternColor, "the colour where it is 1"},
          Key{"amount", &MixPattern::amount, domains::kPatternNumber, "the share of the second"}};

template <>
inline constexpr auto kKeys<ProductPattern> =
    Table{Key{"first", &ProductPattern::first, domains::kPatternColor, "a factor"},
          Key{"second", &ProductPattern::second, domains::kPatternColor, "the other one"}};

template <>
inline constexpr auto kKeys<PowerPattern> =
    Table{Key{"base", &PowerPattern::base, domains::kPatternColor, "the base; what is negative counts as 0"},
          Key{"exponent", &PowerPattern::exponent, domains::kPatternExponent, "the exponent"}};

template <>
inline constexpr auto kKeys<StepPattern> =
    Table{Key{"base", &StepPattern::base, domains::kPatternColor, "what is compared, after interpolation"},
          Key{"threshold", &StepPattern::threshold, domains::kPatternFactor, "the least value that gives 1"}};

template <>
inline constexpr auto kKeys<FacingPattern> = Table{};

template <>
inline constexpr auto kKeys<GridPattern> =
    Table{Key{"layers", &GridPattern::layers, domains::kPatternColor,
              "an image of the layers of equal z, side by side from the top left, row by row"},
          Key{"depth", &GridPattern::depth, domains::kGridLayers, "the number of layers"},
          Key{"columns", &GridPattern::columns, domains::kGridLayers,
              "how many layers stand side by side; the image has as many rows of them as are needed"},
          Key{"wrap", &GridPattern::wrap, domains::kGridWrap,
              "beyond the cube: the grid again, its faces, or the grid mirrored at each face"},
          Key{"filter", &GridPattern::filter, domains::kGridTexelFilter,
              "between the centres of voxels: interpolation, or the value of the nearest one"}};

template <>
inline constexpr auto kKeys<ProjectedPattern> =
    Table{Key{"base", &ProjectedPattern::base, domains::kPatternColor, "the texture that is projected"},
          Key{"projection", &ProjectedPattern::projection, domains::kProjection,
              "what becomes u and v: x and y; the angle from +z over 180 degrees, and that about +z from +x "
              "over 360 degrees; or the angle about +z from -x over 360 degrees, and z"}};

// What all of them have.
template <>
inline constexpr auto kKeys<ProceduralTexture> = Table{
    Key{"coordinates", &ProceduralTexture::space, domains::kPatternSpace,
        "what the pattern is a function of: the point in the world, the texture coordinates (u, v, 0), or "
        "the unit normal of the surface, as it is without interpolation and maps"},
    OtherKey{
        "transform",
        domains::kTransform,
        "maps these coordinates to those of the pattern: `{ \"scale\": 4 }` makes it four times as fine. "
        "It cannot be animated",
        {.otherwise = "none"}},
    OtherKey{"uv_set",
             domains::kUvSet,
             "which texture coordinates of meshes are used, as for images",
             {.otherwise = "`\"first\"`"}},
    Key{"max", &ProceduralTexture::max, domains::kPositive,
        "where a material uses the texture, its values are clamped from 0 to this. Other textures use them "
        "as they are"},
    Unkeyed{&ProceduralTexture::pattern},
    Unkeyed{&ProceduralTexture::transform}};

}  // namespace tessera::core
