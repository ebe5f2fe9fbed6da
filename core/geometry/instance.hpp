// SPDX-License-Identifier: Apache-2.0
// An instance of an object. Objects are stored once, however many instances they have.
#pragma once

#include <cstdint>

#include "core/geometry/placement.hpp"

namespace tessera::core {

// The instance uses the object's own materials.
inline constexpr std::uint32_t kOwnMaterials = 0xffffffffu;
// The instance does not move while the shutter is open.
inline constexpr std::uint32_t kStill = 0xffffffffu;

struct Instance {
  Placement placement;                     // at the frame; while the shutter is open, `motion` counts
  std::uint32_t object;                    // index of the object in Primitives
  std::uint32_t material = kOwnMaterials;  // replaces all of the object's materials
  std::uint32_t motion = kStill;           // index of its MovingPlacement in Primitives
};

}  // namespace tessera::core
