// SPDX-License-Identifier: Apache-2.0
// One of many places where an object is shown. Objects are stored once, however many instances they have.
#pragma once

#include <cstdint>

#include "core/geometry/placement.hpp"

namespace tessera::core {

// Stands for the object's own materials.
inline constexpr std::uint32_t kOwnMaterials = 0xffffffffu;

struct Instance {
  Placement placement;
  std::uint32_t object;                    // its number in Primitives
  std::uint32_t material = kOwnMaterials;  // of all of it
};

}  // namespace tessera::core
