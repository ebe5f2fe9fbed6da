// SPDX-License-Identifier: Apache-2.0
// The rays of a group in the object space of an instance, transformed a vector at a time, or one by one if
// the instance moves; bit-identical to Primitives::to_object. Rays of one octant in the world may point into
// several octants there.
#pragma once

#include <cmath>

#include "core/accel/ray_columns.hpp"
#include "core/geometry/primitives.hpp"

namespace tessera::core::accel {

class RaysInObject {
 public:
  RaysInObject(const Primitives& scene, const Instance& instance, const RayColumns<Ray>& rays, RaySet set)
      : time_(rays.time), set_(set) {
    if (instance.motion != kStill) {
      move_each(scene, instance, rays);
      return;
    }
    for (std::size_t v = 0; v < rays.vectors(); ++v)
      if (lanes_of(set, v) != 0) move(instance.placement, rays, v);
  }

  // Returns a ray of the set with the given t_max.
  ObjectRay ray(std::size_t i, float t_max) const {
    return {{origin_[0][i], origin_[1][i], origin_[2][i]},
            {direction_[0][i], direction_[1][i], direction_[2][i]},
            t_max,
            time_[i]};
  }

  // Calls what(rays) for the rays of each octant, if there are any.
  template <typename What>
  void for_each_octant(const What& what) const {
    for (unsigned octant = 0; octant < 8; ++octant) {
      RaySet rays = set_;
      for (unsigned axis = 0; axis < 3; ++axis)
        rays &= (octant >> axis & 1) != 0 ? negative_[axis] : ~negative_[axis];
      if (rays != 0) what(rays);
    }
  }

 private:
  void move_each(const Primitives& scene, const Instance& instance, const RayColumns<Ray>& rays) {
    for_each_ray(set_, [&](std::size_t i) {
      const ObjectRay ray = scene.to_object(instance, rays.ray(i));
      for (int axis = 0; axis < 3; ++axis) {
        origin_[axis][i] = ray.origin[axis];
        direction_[axis][i] = ray.direction[axis];
        negative_[axis] |= RaySet{std::signbit(static_cast<float>(ray.direction[axis]))} << i;
      }
    });
  }

  void move(const Placement& placement, const RayColumns<Ray>& rays, std::size_t v) {
    const std::size_t first = RayColumns<Ray>::kLanes * v;
    const auto wide = [first](const auto& values) {
      return Vec3dOf<DoubleVector>(Vec3Of<FloatVector>{FloatVector::load(values[0] + first),
                                                       FloatVector::load(values[1] + first),
                                                       FloatVector::load(values[2] + first)});
    };
    const Vec3dOf<DoubleVector> origin = placement.object_point(wide(rays.origin));
    const Vec3dOf<DoubleVector> direction = placement.object_vector(wide(rays.direction));
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis].store(origin_[axis] + first);
      direction[axis].store(direction_[axis] + first);
      negative_[axis] |= to_set(signbit(to_float(direction[axis])).bits(), v);
    }
  }

  const float* time_;
  RaySet set_, negative_[3] = {};  // rays whose direction is negative along each axis
  alignas(kVectorAlignment) double origin_[3][kGroupSize];
  alignas(kVectorAlignment) double direction_[3][kGroupSize];
};

}  // namespace tessera::core::accel
