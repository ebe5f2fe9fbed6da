// SPDX-License-Identifier: Apache-2.0
// An area light on an instance that moves while the shutter is open. Immutable; copies share their data.
#pragma once

#include <memory>

#include "core/geometry/moving_placement.hpp"
#include "core/lights/area_light.hpp"

namespace tessera::core::lights {

class MovingAreaLight {
 public:
  // `shape` and `front` (see AreaLight) are in the space of the instance's object.
  MovingAreaLight(const LightShape& shape, Vec3 front, const SurfaceEmission& emission,
                  std::shared_ptr<const MovingPlacement> motion);

  // The light at a time from 0, when the shutter opens, to 1, when it closes.
  AreaLight at(float time) const;

  // The greatest at the beginning, half-way and at the end, in watts, averaged over the channels.
  double power() const;
  // Those of that power. The box bounds the light at all times, and its normals are any.
  LightBounds bounds() const;

 private:
  struct Parts {
    LightShape shape;
    Vec3 front;
    SurfaceEmission emission;
    std::shared_ptr<const MovingPlacement> motion;
  };
  std::shared_ptr<const Parts> parts_;
};

// A light of an object as its instance has it.
LightShape placed(const LightShape& shape, const Placement& placement);

}  // namespace tessera::core::lights
