// SPDX-License-Identifier: Apache-2.0
// The values that keys of several types accept. Plain data.
#pragma once

#include "core/film/layers.hpp"
#include "core/materials/material.hpp"
#include "core/scene/tables/table.hpp"
#include "core/scene/tables/words.hpp"

namespace tessera::core::domains {

constexpr Domain words(std::span<const std::string_view> all, std::string_view definition = {}) {
  return {.words = all, .definition = definition};
}

inline constexpr Domain kTruth{};
inline constexpr Domain kTextureName{.names = NamesOf::kTextures, .definition = "texture_name"};
inline constexpr Domain kMediumName{.names = NamesOf::kMedia, .definition = "medium_name"};
inline constexpr Domain kLightGroup{
    .range = {.phrase = kGroupNameRule.substr(std::string_view("must be ").size())},
    .accepts_text = is_group_name,
    .definition = "light_group",
    .values = "a name"};

// Colours: a share of the light, an emitted radiance, a constant of a metal or of a pigment. A metal of real
// index 1 that reflects 0.9999 of the light has an imaginary one of 200.
inline constexpr Domain kShare{.range = ranges::kUnit, .definition = "share"};
inline constexpr Domain kRadiance{.range = ranges::kNotNegative, .definition = "radiance"};
inline constexpr Domain kIndex{.range = {.min = 0, .max = 1000}, .definition = "index"};

inline constexpr Domain kLightColor{.range = ranges::kNotNegative, .definition = "light_color"};

// Points and vectors.
inline constexpr Domain kPoint{
    .range = ranges::kCoordinate, .definition = "coordinates", .values = "a point"};
inline constexpr Domain kEdge{
    .range = ranges::kCoordinate, .definition = "coordinates", .values = "a vector"};
inline constexpr Domain kVector{.definition = "vec3", .values = "a vector"};

// Numbers.
inline constexpr Domain kWeight{.range = ranges::kUnit, .definition = "weight"};
inline constexpr Domain kRoughness{.range = ranges::kUnit, .definition = "roughness"};
inline constexpr Domain kIor{
    .range = {.min = 1,
              .max = double{kMaxIor},
              .unit = "(it is that of the inside; for air in glass, turn the surface inside out)"},
    .definition = "ior"};
inline constexpr Domain kDispersionScale{.range = {.min = 0, .max = double{kMaxDispersionScale}}};
inline constexpr Domain kAbbeNumber{.range = {.min = double{kMinAbbeNumber}, .max = double{kMaxAbbeNumber}}};
inline constexpr Domain kPriority{.range = {.min = 0, .max = 1000}};
inline constexpr Domain kExponent{.range = {.min = 0, .max = double{kMaxExponent}}, .definition = "exponent"};
inline constexpr Domain kLength{
    .range = {.min = 0, .max = 1e15}, .definition = "length", .values = "0 or more"};
inline constexpr Domain kHairTilt{
    .range = {.min = -double{kMaxHairTiltDegrees}, .max = double{kMaxHairTiltDegrees}}};
inline constexpr Domain kTangentTurns{.range = {.min = -1, .max = 1}, .definition = "tangent_turns"};
inline constexpr Domain kNotNegative{.range = ranges::kNotNegative};
inline constexpr Domain kPositive{.range = ranges::kPositive};
inline constexpr Domain kUnit{.range = ranges::kUnit};
inline constexpr Domain kScatterAnisotropy{.range = {.min = -1, .max = 1}};
inline constexpr Domain kStrength{.range = {.min = -100, .max = 100}};
inline constexpr Domain kCoordinate{.range = ranges::kCoordinate, .values = "a number"};

// Enumerations.
inline constexpr Domain kSides = words(scene_keys::kSides);
inline constexpr Domain kShadingNormals = words(scene_keys::kShadingNormals);
inline constexpr Domain kSampling = words(scene_keys::kSamplings);
inline constexpr Domain kMicrofacetSampling = words(scene_keys::kMicrofacetSamplings);
inline constexpr Domain kDielectricFresnel = words(scene_keys::kDielectricFresnels);
inline constexpr Domain kPhongLobe = words(scene_keys::kPhongLobes);
inline constexpr Domain kConductor = words(scene_keys::kConductors);
inline constexpr Domain kMasking = words(scene_keys::kMaskings);
inline constexpr Domain kSmithMasking = words(scene_keys::kSmithMaskings, "smith_masking");
inline constexpr Domain kDistribution = words(scene_keys::kDistributions, "distribution");

// Of keys that are not those of one member.
inline constexpr Domain kMaterialPair{.definition = "material_pair", .values = "two names"};
inline constexpr Domain kTransform{.definition = "transform", .values = "[transform steps](#transforms)"};

// Objects with a table of their own.
inline constexpr std::string_view kTextureObject = "a texture as {\"texture\": \"NAME\"}";
inline constexpr Domain kNormalMap{.definition = "normal_map_texture",
                                   .values = "`{ \"texture\": \"dents\", \"strength\": 1 }`",
                                   .kind = "normal map",
                                   .instead_of_text = kTextureObject};
inline constexpr Domain kTangentMap{.definition = "tangent_map",
                                    .values = "`{ \"texture\": \"brush\" }`",
                                    .kind = "tangent map",
                                    .instead_of_text = kTextureObject};
inline constexpr Domain kBump{.values = "`{ \"texture\": \"grain\", \"height\": 0.01 }`",
                              .kind = "bump map",
                              .instead_of_text = kTextureObject};

}  // namespace tessera::core::domains
