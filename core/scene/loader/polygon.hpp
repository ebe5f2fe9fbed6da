// SPDX-License-Identifier: Apache-2.0
// Cuts polygons into triangles. Stateless; thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math/vec3.hpp"

namespace tessera::core {

// Polygons that are not convex may have as many corners; cutting them takes time that grows with the square.
inline constexpr std::size_t kMaxConcaveCorners = 4096;

// Appends corners.size() - 2 triangles, of indices into `corners`, with the polygon's winding. Convex ones
// become a fan around the first corner, the others are cut ear by ear (Meisters 1975), in the plane that fits
// them best. What is not flat or crosses itself is cut somehow. False, and nothing appended, beyond
// kMaxConcaveCorners.
bool triangulate(std::span<const Vec3> corners, std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace tessera::core
