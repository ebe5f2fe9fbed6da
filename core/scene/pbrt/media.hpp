// SPDX-License-Identifier: Apache-2.0
// The named participating media of a scene. Not thread-safe.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "core/media/medium_description.hpp"
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
  // The index of the grid in the scene; -1 if there is no parameter of the name, or not one value for each
  // voxel.
  int add_grid(const Parameters& p, std::string_view name, std::uint32_t channels);
  int add_grid(VoxelGrid grid);
  void place_grid(const Parameters& p, const Matrix& to_world, MediumDescription& medium) const;

  SceneBuilder& builder_;
  const Report& report_;
  Colors& colors_;
  Exposure exposure_;
  std::map<std::string, int> names_;
};

}  // namespace tessera::core::pbrt
