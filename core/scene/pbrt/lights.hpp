// SPDX-License-Identifier: Apache-2.0
// The light sources of a scene. Radiance and intensity are scaled as pbrt-v4 defines it: light whose spectrum
// is not RGB has luminance 1, times "scale". Not thread-safe.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/base/error.hpp"
#include "core/scene/pbrt/colors.hpp"
#include "core/scene/pbrt/environment_map.hpp"
#include "core/scene/pbrt/exposure.hpp"
#include "core/scene/pbrt/matrix.hpp"
#include "core/scene/pbrt/report.hpp"
#include "core/scene/pbrt/texture_baker.hpp"
#include "core/scene/pbrt/textures.hpp"

namespace tessera::core::pbrt {

// The emission of the shapes that follow an AreaLightSource.
struct AreaLight {
  ColorParameter radiance{Rgb{}};
  bool two_sided = false;
  std::optional<float> power{};  // of each shape, instead of its own

  bool is_textured() const { return radiance.texture >= 0; }
  // The radiance of a shape with this area.
  ColorParameter radiance_of(double area) const;
};

class Lights {
 public:
  // The arguments must outlive this object.
  Lights(SceneBuilder& builder, const Report& report, Colors& colors, Textures& textures, TextureBaker& baker)
      : builder_(builder), report_(report), colors_(colors), textures_(textures), baker_(baker) {}

  // Of the lights that follow.
  void set_exposure(const Exposure& exposure) { exposure_ = exposure; }

  // The directive LightSource; `to_world` is the current transformation.
  Status add(const std::string& kind, const Parameters& p, const Matrix& to_world);
  // The directive AreaLightSource.
  Result<std::shared_ptr<const AreaLight>> area_light(const std::string& kind, const Parameters& p);
  // Adds the environment. Call once, at the end.
  Status finish() const { return environment_.finish(builder_); }

 private:
  void add_point(const Parameters& p, const Matrix& to_world);
  void add_spot(const Parameters& p, const Matrix& to_world);
  void add_distant(const Parameters& p, const Matrix& to_world);
  Status add_goniometric(const Parameters& p, const Matrix& to_world);
  Status add_projection(const Parameters& p, const Matrix& to_world);
  Status add_infinite(const Parameters& p, const Matrix& to_world);
  Status add_infinite_image(const Parameters& p, const std::string& file, const Matrix& to_world);
  Result<std::optional<SceneBuilder::Image>> image(const Parameters& p, const std::string& file);
  void tell_dark(const Parameters& p, std::string_view what) const;
  Rgb emitted(const Parameters& p, std::string_view name);

  SceneBuilder& builder_;
  const Report& report_;
  Colors& colors_;
  Textures& textures_;
  TextureBaker& baker_;
  Exposure exposure_;
  EnvironmentMap environment_;
};

}  // namespace tessera::core::pbrt
