// SPDX-License-Identifier: Apache-2.0
// The kinds of primitives. geometry_traits.hpp says what is done with each.
#pragma once

#include <cstdint>

namespace tessera::core {

// In the order of ids, except that moving triangles, those that deform while the shutter is open, are the
// last of the triangles.
enum class GeometryKind : std::uint32_t {
  kTriangle,
  kMovingTriangle,
  kSphere,
  kDisk,
  kCylinder,
  kCurve,  // a part of one
  kInstance
};

}  // namespace tessera::core
