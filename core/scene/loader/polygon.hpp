// SPDX-License-Identifier: Apache-2.0
// Triangulates polygons. Stateless; thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math/vec3.hpp"

namespace tessera::core {

// Of non-convex polygons of more corners, the number of corners times that of reflex corners may be its
// square, which bounds the time that most take.
inline constexpr std::size_t kMaxConcaveCorners = 4096;

// Appends corners.size() - 2 triangles, as indices into `corners`, with the polygon's winding. Convex
// polygons become a fan around the first corner; others are triangulated by ear clipping (Meisters 1975),
// projected along the dominant axis of their normal. Non-planar and self-intersecting polygons get some
// triangulation. Returns false and appends nothing beyond the limit above, or if it takes unusually long.
bool triangulate(std::span<const Vec3> corners, std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace tessera::core
