// SPDX-License-Identifier: Apache-2.0
// Textures of a glTF file: images in files, buffers and data URIs, with their samplers and
// KHR_texture_transform. Not thread-safe; functions throw Refusals.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/gltf/buffers.hpp"
#include "core/scene/gltf/document.hpp"
#include "core/scene/import/scene_builder.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core::gltf {

class Textures {
 public:
  // Converts a channel's value, from 0 to 1, to another in that range.
  using Curve = std::function<float(float)>;
  struct Input {
    Value info;
    ImageUse use;
  };
  // The texels of all inputs at a point, linear and from 0 to 1; single channels are gray. Returns a linear
  // colour in that range.
  using Combine = std::function<Rgb(const std::vector<Rgb>&)>;

  Textures(const Document& document, Buffers& buffers) : document_(document), buffers_(buffers) {}

  // The texture coordinates of a material: numbers n of TEXCOORD_n.
  struct Coordinates {
    std::vector<std::uint32_t> sets{};  // at most two, the scene's UvSets
    std::vector<Value> others{};        // textureInfos with a third set, which are looked up by the first
  };
  // Begins a material, whose textures follow. The first set is that of its base colour's texture, if it has
  // one, or else of the first texture.
  void begin_material(const Value& base_texture);
  const Coordinates& coordinates() const { return coordinates_; }
  // More textures of a material follow, which has these.
  void continue_material(const Coordinates& coordinates) { coordinates_ = coordinates; }

  // The scene's texture of a textureInfo; -1 if it is absent, or its image cannot be read, with a warning.
  int color(const Value& info) { return add(info, {ColorSpace::kSrgb, TextureChannel::kColor}); }
  int data(const Value& info, TextureChannel channel) { return add(info, {ColorSpace::kLinear, channel}); }
  // A texture of the converted values of one channel. `name` distinguishes curves.
  int converted(const Value& info, TextureChannel channel, const std::string& name, const Curve& curve);
  // A texture that depends on several, at the size of the largest. Inputs that are absent or cannot be read
  // are white, as are, after a warning, those that are mapped otherwise than the first; -1 if all are. `name`
  // distinguishes functions.
  int combined(const std::vector<Input>& inputs, ColorSpace space, const std::string& name,
               const Combine& combine);

  // The set of texture coordinates that a textureInfo uses.
  std::uint32_t set_of(const Value& info) const;

 private:
  UvSet uv_set(const Value& info);
  int add(const Value& info, const ImageUse& use);
  std::optional<SceneBuilder::Image> image(const Value& info, const ImageUse& use);
  Value image_of(const Value& texture) const;
  Result<SceneBuilder::Image> decode(const Value& image, const ImageUse& use);
  Texture with_sampler(const Value& info, SceneBuilder::Image image);
  void apply_sampler(const Value& sampler, Texture& texture) const;
  std::vector<SceneBuilder::Image> images_of(const std::vector<Input>& inputs);
  bool are_mapped_alike(const Value& first, const Value& second);

  const Document& document_;
  Buffers& buffers_;
  Coordinates coordinates_;                              // of the material
  std::map<std::string, SceneBuilder::Image> combined_;  // by the images and what is made of them
};

}  // namespace tessera::core::gltf
