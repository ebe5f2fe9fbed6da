// SPDX-License-Identifier: Apache-2.0
// The layers of an image besides the beauty (R, G and B of the radiance that reaches the camera): what a
// render is asked for, by their names in scene files and on command lines. layout.hpp says which sums a film
// keeps for them, develop.hpp which channels they become. Pure functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::core {

// Light (kDirect to kEnvironment) is divided by the number of times it was scattered on its way to the
// camera; these four layers add up to the beauty. The layers from kAlbedo to kCryptoAsset describe the first
// surface that a camera ray hits: it passes through null interfaces, and stochastically, as paths do, through
// thin panes and surfaces with an opacity below 1, but not through solid glass, mirrors or media.
enum class Layer : std::uint8_t {
  kAlpha,          // the share of camera rays that hit a surface or scatter in a medium
  kDirect,         // light that was scattered once
  kIndirect,       // light that was scattered more than once, clamped as in the beauty
  kEmission,       // of surfaces and media that the camera sees
  kEnvironment,    // the environment that the camera sees
  kAlbedo,         // the surface's base colour
  kNormal,         // unit shading normal in world space, on the camera's side
  kDepth,          // along the line of sight; of panoramic cameras, the distance
  kPosition,       // in world space
  kUv,             // the surface's texture coordinates
  kObjectIndex,    // of the shape, from 1 in the order of the scene file
  kMaterialIndex,  // from 1 in the order of the scene file
  kInstanceIndex,  // from 1; 0 for what is not instanced
  kCryptoObject,   // Cryptomatte (Friedman and Jones 2015) of shapes
  kCryptoMaterial,
  kCryptoAsset,    // of instanced objects; a shape outside them is an asset of its own
  kSamples,        // the number of samples
  kStandardError,  // of the beauty's mean, estimated
};
inline constexpr std::size_t kLayerCount = 18;

// The most light groups of a scene, and what their names are made of: 1 to 64 letters, digits, '_' and '-'.
inline constexpr std::size_t kMaxLightGroups = 32;
inline constexpr std::string_view kGroupNameRule = "must be 1 to 64 letters, digits, '_' and '-'";
bool is_group_name(std::string_view name);

// A set of layers. The beauty is part of every image and of no set.
struct LayerSet {
  std::uint32_t bits = 0;  // bit i for the layer of value i
  // Those of all light groups of the scene, until their names are known (core/scene/light_groups.hpp).
  bool light_groups = false;
  // Light groups by name, each a layer of its own: all light of the lights of this group, without the clamp
  // of indirect light. If all lights have a group, these layers add up to the beauty.
  std::vector<std::string> groups{};

  bool has(Layer layer) const { return (bits >> static_cast<unsigned>(layer) & 1) != 0; }
  bool has_group(std::string_view name) const;
  LayerSet with(Layer layer) const {
    return {bits | 1u << static_cast<unsigned>(layer), light_groups, groups};
  }
  bool empty() const { return bits == 0 && !light_groups && groups.empty(); }
  // Whether they have a layer in common that is no light group.
  bool intersects(const LayerSet& other) const { return (bits & other.bits) != 0; }
  // Whether all members are layers, and groups have names.
  bool valid() const;
  bool operator==(const LayerSet&) const = default;
};

inline const LayerSet kAllLayers{(1u << kLayerCount) - 1, true};

// "alpha", "direct", "indirect", "emission", "environment", "albedo", "normal", "depth", "position", "uv",
// "object_index", "material_index", "instance_index", "crypto_object", "crypto_material", "crypto_asset",
// "samples", "standard_error".
std::string_view layer_name(Layer layer);
// All of them, in the order of the enumerators; then "light_groups" and, for groups, "group.NAME".
std::vector<std::string> layer_names(const LayerSet& layers = kAllLayers);
// "all", "none", or names separated by commas: as `--layers` takes them. The error lists the names.
Result<LayerSet> parse_layers(std::string_view text);
// What parse_layers() takes for this set; "all" also for all layers but light groups.
std::string layers_text(const LayerSet& layers);

}  // namespace tessera::core
