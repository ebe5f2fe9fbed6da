// SPDX-License-Identifier: Apache-2.0
// Converts Mitsuba's textures. Not thread-safe.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "core/scene/mitsuba/plugin.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core::mitsuba {

// What a shape stores as texture coordinates, in terms of Mitsuba's, where the first row of an image is at
// v = 0.
enum class UvLayout {
  kSame,
  kReversedV,  // (u, 1 - v): OBJ files, whose v Mitsuba reverses; spheres
  kDisk,       // (v, 1 - u)
};

// What a mesh has for <texture type="mesh_attribute">, as an image over its texture coordinates. Some texels
// may be larger than the largest value.
struct AttributeTexture {
  Texture texture;
  Rgb largest;
};
using AttributeTextures = std::map<std::string, AttributeTexture, std::less<>>;

// The shape that a texture is looked up on.
struct TextureSite {
  UvLayout layout = UvLayout::kSame;
  // Null: the shape has no attributes.
  const AttributeTextures* attributes = nullptr;
};

// What becomes of the texels of an image that is looked up for a single number.
enum class TexelMap {
  kLuminance,   // the luminance of its colours, as in Mitsuba
  kSquareRoot,  // of the luminance: the roughness of a microfacet alpha
};

class TextureConverter {
 public:
  explicit TextureConverter(Conversion& conversion) : conversion_(conversion) {}

  // The colour of a parameter: a number, <rgb>, <spectrum> or texture. `largest` bounds it: 1 for
  // reflectances.
  ColorParameter color(const Plugin& owner, std::string_view name, Rgb otherwise, const TextureSite& site,
                       float largest = 1);
  // As a number, which becomes map(number).
  ScalarParameter scalar(const Plugin& owner, std::string_view name, float otherwise, const TextureSite& site,
                         TexelMap map = TexelMap::kLuminance);
  // The opacity of a mask; 1 without the texture that it should have.
  ScalarParameter opacity(const Plugin& mask, const TextureSite& site);
  // The texture of a normal map whose green tilts normals along the normal x the tangent of u, as in Mitsuba.
  // -1 if it is no image.
  int normal_map(const Plugin& texture, const TextureSite& site);
  // A bump map of the texture's heights; none if they are constant.
  BumpMap bump_map(const Plugin& texture, const TextureSite& site);
  // The image of an environment, with rows between the poles instead of from pole to pole.
  std::optional<Texture> environment_image(const Plugin& emitter);

 private:
  using Image = SceneBuilder::Image;
  // A constant, or a texture times a constant.
  struct Value {
    Rgb factor = Rgb::gray(1);
    std::optional<Texture> texture{};
    bool is_substitute = false;    // for a texture that cannot be had
    std::optional<Rgb> largest{};  // of an attribute
  };

  // The value of a property; nullopt if it has none that can be used.
  std::optional<Value> value(const Plugin& owner, std::string_view name, const TextureSite& site);
  // Each texture is converted once for a site: textures can be parts of others.
  Value texture(const Plugin& plugin, const TextureSite& site);
  Value convert(const Plugin& plugin, const TextureSite& site);
  Value scaled(const Plugin& plugin, const TextureSite& site);
  Value volume(const Plugin& plugin, const TextureSite& site);
  // Each grid is read once, for any site; nullopt after a warning.
  std::optional<Texture> grid(const Plugin& plugin);
  Value bitmap(const Plugin& plugin, const TextureSite& site);
  Value checkerboard(const Plugin& plugin, const TextureSite& site);
  Value attribute(const Plugin& plugin, const TextureSite& site);
  // Sets what maps the shape's texture coordinates to the image.
  void place(const Plugin& plugin, UvLayout layout, Texture& texture);
  // Null after a warning.
  Image load(const Plugin& plugin, ColorSpace color_space);
  Image mapped(const Image& image, TexelMap map);
  Texture mapped(Texture texture, TexelMap map);
  // Clamps a texture whose values exceed `largest`; returns whether they do.
  bool limit(Value& value, float largest);
  Image with_signs(const Image& image, bool flip_red, bool flip_green);
  // `make` returns the texels of an image derived from `image`, counted against the limits, once for each
  // name.
  template <typename Make>
  Image derived(const Image& image, const std::string& name, const Make& make);

  Conversion& conversion_;
  std::map<std::pair<const TextureImage*, std::string>, std::pair<Image, Image>>
      derived_;  // of which, and itself
  std::map<std::tuple<NodeId, UvLayout, const AttributeTextures*>, Value> known_;
  std::map<NodeId, std::optional<Texture>> grids_;
  std::map<std::array<float, 6>, Image> boards_;  // by their two colours
};

}  // namespace tessera::core::mitsuba
