// SPDX-License-Identifier: Apache-2.0
// Converts Mitsuba's emitters that are not part of shapes. Not thread-safe.
#pragma once

#include "core/scene/mitsuba/plugin.hpp"
#include "core/scene/mitsuba/textures.hpp"

namespace tessera::core::mitsuba {

class EmitterConverter {
 public:
  EmitterConverter(Conversion& conversion, TextureConverter& textures)
      : conversion_(conversion), textures_(textures) {}

  void add(const Plugin& emitter);

 private:
  Rgb color(const Plugin& emitter, std::string_view name);
  // A constant, or an image.
  ColorParameter image(const Plugin& emitter, std::string_view name);
  Rgb mean_of(const Plugin& emitter, std::string_view name, const ColorParameter& textured);
  // Where the light is while the shutter is open: equally long in each place.
  std::vector<Transform> placements(const Plugin& emitter);
  // Adds the light, with its share of the intensity, wherever place(light, to_world) puts it.
  template <typename Light, typename Place>
  void add_placed(const Plugin& emitter, const Light& light, const Place& place);
  void add_point(const Plugin& emitter);
  void add_spot(const Plugin& emitter);
  void add_projector(const Plugin& emitter);
  void add_directional(const Plugin& emitter);
  void set_constant(const Plugin& emitter);
  void set_image(const Plugin& emitter);
  void set_environment(const Plugin& emitter, EnvironmentDescription environment);

  Conversion& conversion_;
  TextureConverter& textures_;
};

}  // namespace tessera::core::mitsuba
