// SPDX-License-Identifier: Apache-2.0
// The named textures of a scene, and the parameters that are textures. Not thread-safe.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/scene/pbrt/colors.hpp"
#include "core/scene/pbrt/matrix.hpp"
#include "core/scene/pbrt/report.hpp"
#include "core/scene/pbrt/texture_node.hpp"

namespace tessera::core::pbrt {

class Textures {
 public:
  // The arguments must outlive this object.
  Textures(SceneBuilder& builder, const Report& report, Colors& colors)
      : builder_(builder), report_(report), colors_(colors) {}

  // The directive Texture "name" "type" "kind" where this transformation is current. A kind that is not
  // supported becomes a constant, with a warning. Fails for images beyond the limits.
  Status define(const std::string& name, const std::string& type, const std::string& kind,
                const Parameters& p, const Matrix& to_world);

  // The parameter as a texture of colours; null if it is not given.
  TexturePtr color(const Parameters& p, std::string_view name, SpectrumRole role);
  TexturePtr color(const Parameters& p, std::string_view name, SpectrumRole role, Rgb otherwise);
  // The parameter as a texture of numbers, in all channels; null if it is not given.
  TexturePtr number(const Parameters& p, std::string_view name);
  TexturePtr number(const Parameters& p, std::string_view name, float otherwise);

  // The parameter "alpha"; null, with a warning, if its texture cannot be read.
  TexturePtr alpha(const Parameters& p);

  // An image file, its alpha for a number if it has one; gray of 0.5 if it cannot be read, with a warning.
  // `default_wrap` is that of the parameter "wrap".
  Result<TexturePtr> image(const Parameters& p, const std::string& file, bool is_number,
                           const std::string& default_wrap = "repeat");

 private:
  enum class Kind { kNumber, kColor };

  Result<TexturePtr> make(const std::string& kind, const Parameters& p, Kind type, const Matrix& to_world);
  // By texture coordinates; null for other kinds.
  Result<TexturePtr> make_flat(const std::string& kind, const Parameters& p, Kind type);
  // By coordinates in space, if the mapping is none of texture coordinates.
  TexturePtr projected(const TexturePtr& flat, const Parameters& p, const Matrix& to_world);
  // Null for other kinds.
  TexturePtr make_pattern(const std::string& kind, const Parameters& p, Kind type, const Matrix& to_world);
  Result<TexturePtr> make_image(const Parameters& p, Kind type);
  TexturePtr make_direction_mix(const Parameters& p, Kind type, const Matrix& to_world);
  TexturePtr make_unknown(const std::string& kind, const Parameters& p);
  // A parameter of a texture, which is of the texture's type.
  TexturePtr input(const Parameters& p, std::string_view name, float otherwise, Kind type);
  Rgb value(const Parameters& p, std::string_view name, float otherwise, Kind type);
  TexturePtr named(const Parameters& p, const Parameter& parameter, Kind type);
  TexturePtr find(const Parameter& parameter, Kind type) const;  // null if there is none
  UvMapping mapping(const Parameters& p);
  Status surround_with_black(const std::string& file, ImageNode& node);

  SceneBuilder& builder_;
  const Report& report_;
  Colors& colors_;
  const TexturePtr unknown_ = unknown_texture();
  std::map<std::string, TexturePtr> numbers_, spectra_;
};

}  // namespace tessera::core::pbrt
