// SPDX-License-Identifier: Apache-2.0
// Eight rays as a structure of arrays, with access to single rays.
#pragma once

#include "core/geometry/ray.hpp"
#include "core/math/lane_array.hpp"

namespace tessera::core {

class RayLanes {
 public:
  explicit RayLanes(const RayOf<Float8>& rays)
      : origin_(rays.origin), direction_(rays.direction), t_max_(rays.t_max) {}
  Ray operator[](std::size_t lane) const { return {origin_[lane], direction_[lane], t_max_[lane]}; }

 private:
  Vec3Lanes origin_, direction_;
  FloatLanes t_max_;
};

}  // namespace tessera::core
