// SPDX-License-Identifier: Apache-2.0
// The numbers and Cryptomatte ids of a scene's shapes and materials, for layers.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/film/cryptomatte.hpp"
#include "core/geometry/ray.hpp"
#include "core/scene/description.hpp"

namespace tessera::core {

// A shape whose primitives begin with this id, and end where those of the next shape begin.
struct ShapeStart {
  std::uint32_t first_primitive = 0;
  std::uint32_t shape = 0;  // its index in the description
};

class SceneIds {
 public:
  SceneIds() = default;
  explicit SceneIds(const SceneDescription& description);
  // Those of the scene's shapes besides instances, by growing ids. To be called before shape_of().
  void set_starts(std::vector<ShapeStart> starts) { starts_ = std::move(starts); }

  // Of the scene's shape that was hit; within an instance, that is the instance.
  std::uint32_t shape_of(const Hit& hit) const;

  std::uint32_t crypto_object(std::uint32_t shape) const { return shape_ids_[shape]; }
  std::uint32_t crypto_asset(std::uint32_t shape) const { return asset_ids_[shape]; }
  std::uint32_t crypto_material(std::uint32_t material) const { return material_ids_[material]; }

 private:
  std::vector<ShapeStart> starts_;
  std::vector<std::uint32_t> instance_shapes_;  // by instance
  std::vector<std::uint32_t> shape_ids_, asset_ids_, material_ids_;
};

// What Cryptomatte calls things: shapes by their names in messages ("shapes[2] (bunny.obj)"), materials by
// theirs, and as assets the objects that are instanced and the shapes that are not.
CryptoNames crypto_names(const SceneDescription& description);

}  // namespace tessera::core
