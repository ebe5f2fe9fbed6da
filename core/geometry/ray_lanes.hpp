// SPDX-License-Identifier: Apache-2.0
// Rays in lanes, to read individually.
#pragma once

#include <cstddef>

#include "core/geometry/ray.hpp"
#include "core/math/lane_array.hpp"

namespace tessera::core {

class RayLanes {
 public:
  explicit RayLanes(const RayOf<FloatN>& rays)
      : origin_(rays.origin), direction_(rays.direction), t_max_(rays.t_max), time_(rays.time) {}
  Ray operator[](std::size_t lane) const {
    return {origin_[lane], direction_[lane], t_max_[lane], time_[lane]};
  }

 private:
  Vec3Lanes origin_, direction_;
  FloatLanes t_max_, time_;
};

}  // namespace tessera::core
