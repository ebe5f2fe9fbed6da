// SPDX-License-Identifier: Apache-2.0
// Converts Mitsuba's participating media. Not thread-safe.
#pragma once

#include <map>
#include <optional>

#include "core/media/medium_description.hpp"
#include "core/media/voxel_grid.hpp"
#include "core/scene/mitsuba/plugin.hpp"

namespace tessera::core::mitsuba {

class MediumConverter {
 public:
  explicit MediumConverter(Conversion& conversion) : conversion_(conversion) {}

  // The media that a shape names as its interior and exterior.
  MediumInterface interface_of(const Plugin& shape);
  // The index of the medium, the same for the same plugin; kNoMedium after a warning.
  int medium(const Plugin& plugin);

 private:
  // A coefficient: a constant, or a grid with its place.
  struct Coefficient {
    Rgb value{};
    std::optional<VoxelGrid> grid{};
    Transform to_world{};
  };

  std::optional<MediumDescription> convert(const Plugin& plugin);
  Coefficient coefficient(const Plugin& owner, std::string_view name, float otherwise);
  std::optional<Coefficient> grid_volume(const Plugin& volume);
  // Sets the coefficients of absorption and scattering, by the albedo.
  void set_coefficients(const Plugin& plugin, const Coefficient& extinction, const Coefficient& albedo,
                        MediumDescription& medium);
  // The same for an albedo that is a grid.
  void set_grids(const Plugin& plugin, const Coefficient& extinction, const Coefficient& albedo,
                 MediumDescription& medium);
  int add_grid(VoxelGrid grid);
  float mean_cosine(const Plugin& plugin);

  Conversion& conversion_;
  std::map<NodeId, int> media_;
};

}  // namespace tessera::core::mitsuba
