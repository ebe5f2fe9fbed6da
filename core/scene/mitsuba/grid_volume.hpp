// SPDX-License-Identifier: Apache-2.0
// Reads <volume type="gridvolume">, for media and for textures. Not thread-safe.
#pragma once

#include <optional>

#include "core/media/voxel_grid.hpp"
#include "core/scene/mitsuba/plugin.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core::mitsuba {

struct PlacedGrid {
  VoxelGrid grid;
  Transform to_world;  // from the unit cube
  Wrap wrap = Wrap::kClamp;
};

// nullopt after a warning.
std::optional<PlacedGrid> read_grid_volume(Conversion& conversion, const Plugin& volume);

// "wrap_mode"; `otherwise` where it is not given, or after a warning not known.
Wrap wrap_of(const Plugin& plugin, Wrap otherwise);

// The grid as a texture whose layers are an image of the scene; nullopt after a warning, or if limits are
// exceeded.
std::optional<Texture> grid_texture(Conversion& conversion, const Plugin& volume, const PlacedGrid& placed);

}  // namespace tessera::core::mitsuba
