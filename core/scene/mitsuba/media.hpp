// SPDX-License-Identifier: Apache-2.0
// Converts Mitsuba's participating media. Not thread-safe.
#pragma once

#include <map>
#include <optional>
#include <utility>

#include "core/media/medium_description.hpp"
#include "core/media/voxel_grid.hpp"
#include "core/scene/mitsuba/plugin.hpp"

namespace tessera::core::mitsuba {

class MediumConverter {
 public:
  explicit MediumConverter(Conversion& conversion) : conversion_(conversion) {}

  // The media that a shape names as its interior and exterior. The interior emits what the shape's
  // <emitter type="volumelight"> says.
  MediumInterface interface_of(const Plugin& shape);
  // The medium inside of a sensor, where the paths of its camera begin; kNoMedium if there is none.
  int medium_around(const Plugin& sensor);

 private:
  // A coefficient: a constant, or a grid with its place.
  struct Coefficient {
    Rgb value{};
    std::optional<VoxelGrid> grid{};
    Transform to_world{};
  };

  // The index of the medium, the same for the same plugins; kNoMedium after a warning.
  int medium(const Plugin& plugin, const std::optional<Plugin>& light);
  std::optional<MediumDescription> convert(const Plugin& plugin);
  // Lets the medium emit the light's radiance per unit of length.
  void add_emission(const Plugin& light, MediumDescription& medium);
  void add_emission_grid(const Plugin& light, const Coefficient& radiance, MediumDescription& medium);
  Coefficient coefficient(const Plugin& owner, std::string_view name, float otherwise);
  // Sets the coefficients of absorption and scattering, by the albedo.
  void set_coefficients(const Plugin& plugin, const Coefficient& extinction, const Coefficient& albedo,
                        MediumDescription& medium);
  // The same for an albedo that is a grid.
  void set_grids(const Plugin& plugin, const Coefficient& extinction, const Coefficient& albedo,
                 MediumDescription& medium);
  int add_grid(VoxelGrid grid);
  float mean_cosine(const Plugin& plugin);

  Conversion& conversion_;
  std::map<std::pair<NodeId, NodeId>, int> media_;  // by medium and light, or the medium twice
};

}  // namespace tessera::core::mitsuba
