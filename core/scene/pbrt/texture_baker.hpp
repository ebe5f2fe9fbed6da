// SPDX-License-Identifier: Apache-2.0
// Converts textures to the parameters of materials: constants, plain images with a factor, procedural
// textures, or an image into which the texture is evaluated. Not thread-safe.
#pragma once

#include <compare>
#include <map>
#include <string>
#include <utility>

#include "core/base/error.hpp"
#include "core/scene/pbrt/report.hpp"
#include "core/scene/pbrt/texture_node.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core::pbrt {

// What values are clamped to.
struct ValueRange {
  float min, max;

  auto operator<=>(const ValueRange&) const = default;
};

class TextureBaker {
 public:
  // The arguments must outlive this object.
  TextureBaker(SceneBuilder& builder, const Report& report) : builder_(builder), report_(report) {}

  // `limit` bounds the values: 1 for shares of light. Warnings name `place`. RESOURCE_EXHAUSTED if a
  // generated image exceeds the limits on textures.
  Result<ColorParameter> color(const TexturePtr& texture, float limit, const Place& place);
  Result<ScalarParameter> scalar(const TexturePtr& texture, float limit, const Place& place);
  // The height of a bump map, of any sign: it may differ by an additive constant, which tilts nothing.
  Result<ScalarParameter> height(const TexturePtr& texture, const Place& place);

 private:
  // An image that holds values below 0 differs by an additive constant.
  Result<ColorParameter> converted(const TexturePtr& texture, const ValueRange& range, const Place& place);
  Result<ColorParameter> convert(const TexturePtr& texture, const ValueRange& range, const Place& place);
  // Of a texture with patterns; materials see values up to `max`.
  Result<ColorParameter> procedural(const TextureNode& texture, float max, const Place& place);
  Result<ProceduralTexture> pattern_of(const TextureNode& texture, const Place& place);
  Result<ColorParameter> input(const TexturePtr& texture, const Place& place);
  Result<ColorParameter> bake(const TexturePtr& texture, const ValueRange& range, const Place& place);

  SceneBuilder& builder_;
  const Report& report_;
  struct Converted {
    TexturePtr texture;  // keeps the key alive
    ColorParameter parameter;
  };
  std::map<std::pair<const TextureNode*, ValueRange>, Converted> converted_;
};

}  // namespace tessera::core::pbrt
