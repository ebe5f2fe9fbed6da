// SPDX-License-Identifier: Apache-2.0
// The words of scene files for the values of enumerations, in the order of these.
#pragma once

#include <array>
#include <span>
#include <string_view>

namespace tessera::core::scene_keys {

// In the order of Layer, then all of them.
inline constexpr std::array<std::string_view, 20> kLayers{
    "alpha",        "direct",         "indirect",       "emission",      "environment",
    "albedo",       "normal",         "depth",          "position",      "uv",
    "object_index", "material_index", "instance_index", "crypto_object", "crypto_material",
    "crypto_asset", "samples",        "standard_error", "all",           "light_groups"};
inline constexpr std::array<std::string_view, 4> kIntegrators{"naive", "nee", "mis", "whitted"};
inline constexpr std::array<std::string_view, 2> kHeuristics{"balance", "power"};
inline constexpr std::array<std::string_view, 3> kFilters{"box", "tent", "gaussian"};
inline constexpr std::array<std::string_view, 3> kToneCurves{"none", "aces", "agx"};
// In the order of MaterialModel's alternatives.
inline constexpr std::array<std::string_view, 14> kMaterialTypes{"lambert",
                                                                 "mirror",
                                                                 "glass",
                                                                 "phong",
                                                                 "cook_torrance",
                                                                 "principled",
                                                                 "plastic",
                                                                 "conductor",
                                                                 "diffuse_transmission",
                                                                 "thin_dielectric",
                                                                 "blend",
                                                                 "null",
                                                                 "hair",
                                                                 "disney"};
inline constexpr std::array<std::string_view, 3> kCameraTypes{"perspective", "orthographic", "panoramic"};
inline constexpr std::array<std::string_view, 7> kShapeTypes{"mesh", "sphere",   "quad",  "instance",
                                                             "disk", "cylinder", "curves"};
inline constexpr std::array<std::string_view, 4> kCurveBases{"linear", "bezier", "b_spline", "catmull_rom"};
inline constexpr std::array<std::string_view, 3> kCurveShapes{"round", "flat", "ribbon"};
inline constexpr std::array<std::string_view, 3> kSpotFalloffs{"smooth", "linear", "squared"};
inline constexpr std::array<std::string_view, 3> kLightTypes{"point", "spot", "directional"};
inline constexpr std::array<std::string_view, 3> kNormals{"file", "smooth", "flat"};
inline constexpr std::array<std::string_view, 2> kVertexColors{"use", "ignore"};
inline constexpr std::array<std::string_view, 2> kColorSpaces{"srgb", "linear"};
inline constexpr std::array<std::string_view, 3> kWraps{"repeat", "clamp", "mirror"};
inline constexpr std::array<std::string_view, 2> kUvSets{"first", "second"};
// In the order of Pattern's alternatives.
inline constexpr std::array<std::string_view, 13> kPatternTypes{
    "checkerboard", "dots",  "fbm",    "wrinkled", "windy",     "marble", "mix",
    "product",      "power", "facing", "grid",     "projected", "step"};
inline constexpr std::array<std::string_view, 3> kProjections{"planar", "spherical", "cylindrical"};
inline constexpr std::array<std::string_view, 3> kPatternSpaces{"position", "uv", "normal"};
inline constexpr std::array<std::string_view, 5> kChannels{"color", "alpha", "red", "green", "blue"};
inline constexpr std::array<std::string_view, 2> kSides{"both", "front"};
inline constexpr std::array<std::string_view, 2> kShadingNormals{"conserving", "plain"};
inline constexpr std::array<std::string_view, 2> kTextureFilters{"linear", "nearest"};
inline constexpr std::array<std::string_view, 2> kGridFilters{"linear", "nearest"};
inline constexpr std::array<std::string_view, 2> kGridBorders{"clamp", "zero"};
inline constexpr std::array<std::string_view, 3> kDielectricFresnels{"exact", "schlick", "none"};
inline constexpr std::array<std::string_view, 2> kPhongLobes{"n+1", "n+2"};
inline constexpr std::array<std::string_view, 17> kConductors{"copper",
                                                              "gold",
                                                              "silver",
                                                              "aluminium",
                                                              "brass",
                                                              "chromium",
                                                              "nickel",
                                                              "tungsten",
                                                              "mercury",
                                                              "titanium_nitride",
                                                              "magnesium_oxide",
                                                              "titanium_dioxide",
                                                              "titanium_dioxide_extraordinary",
                                                              "diamond",
                                                              "caesium_iodide",
                                                              "silicon_carbide",
                                                              "beryllium"};
inline constexpr std::array<std::string_view, 2> kMaskings{"smith", "schlick"};
inline constexpr std::array<std::string_view, 2> kDistributions{"ggx", "beckmann"};
inline constexpr std::array<std::string_view, 2> kSmithMaskings{"smith", "separable"};
inline constexpr std::array<std::string_view, 3> kMicrofacetSamplings{"bsdf", "uniform", "half_vector"};
inline constexpr std::span<const std::string_view> kSamplings =
    std::span(kMicrofacetSamplings).first(2);  // for the other materials

}  // namespace tessera::core::scene_keys
