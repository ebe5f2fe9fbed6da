// SPDX-License-Identifier: Apache-2.0
// The named participating media of a scene. Not thread-safe.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "core/media/medium_description.hpp"
#include "core/scene/loader/nanovdb_grid.hpp"
#include "core/scene/pbrt/colors.hpp"
#include "core/scene/pbrt/exposure.hpp"
#include "core/scene/pbrt/matrix.hpp"
#include "core/scene/pbrt/report.hpp"

namespace tessera::core::pbrt {

class Media {
 public:
  // The arguments must outlive this object.
  Media(SceneBuilder& builder, const Report& report, Colors& colors)
      : builder_(builder), report_(report), colors_(colors) {}

  void set_exposure(const Exposure& exposure) { exposure_ = exposure; }

  // The directive MakeNamedMedium. A type that is not supported becomes vacuum, with a warning. False if
  // there was a medium of this name.
  bool define(const std::string& name, const Parameters& p, const Matrix& to_world);
  // The index of the medium in the scene; kNoMedium for "", or with a warning for an unknown name.
  int find(const std::string& name, const Place& place) const;

 private:
  void read_common(const Parameters& p, MediumDescription& medium);
  void read_scale(const Parameters& p, MediumDescription& medium) const;
  float emission_scale(const Parameters& p) const;
  bool read_uniform_grid(const Parameters& p, const Matrix& to_world, MediumDescription& medium);
  bool read_rgb_grid(const Parameters& p, const Matrix& to_world, MediumDescription& medium);
  bool read_cloud(const Parameters& p, const Matrix& to_world, MediumDescription& medium);
  bool read_nanovdb(const Parameters& p, const Matrix& to_world, MediumDescription& medium);
  // Light by the temperatures of the file of a grid of this shape, if there are some.
  void add_temperatures(const Parameters& p, std::string_view file, const GridShape& shape,
                        MediumDescription& medium);
  // Light by temperatures, times `shares` at each voxel if they are given.
  void set_temperatures(const Parameters& p, const VoxelGrid& temperatures,
                        const std::optional<VoxelGrid>& shares, MediumDescription& medium);
  // nullopt if there is no parameter of the name, or not one value for each voxel.
  std::optional<VoxelGrid> grid_of(const Parameters& p, std::string_view name, std::uint32_t channels);
  // The index of the grid in the scene; -1 for none.
  int add_grid(std::optional<VoxelGrid> grid);
  // Counts the values of a grid that takes little of a file. False, with a warning, beyond the limit.
  bool reserve_values(std::uint64_t count, const Place& place);
  void place_grid(const Parameters& p, const Matrix& to_world, MediumDescription& medium) const;

  SceneBuilder& builder_;
  const Report& report_;
  Colors& colors_;
  Exposure exposure_;
  std::map<std::string, int> names_;
  std::uint64_t reserved_values_ = 0;
};

}  // namespace tessera::core::pbrt
