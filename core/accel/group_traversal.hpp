// SPDX-License-Identifier: Apache-2.0
// A group of rays' common way through the tree. A node's boxes are tested against bounds of the whole group,
// then those that may be met against the rays that came here: a vector of rays against one box, or one ray
// against sixteen boxes, whichever is less work. Where few rays go on together, they part: each keeps the
// node, and they take turns once the group is through (diverged_rays.hpp).
//
// Where rays come to an instance together, they become groups again in the space of its object.
//
// Rays from neighbouring pixels, or to one lamp, stay together down to the triangles; scattered ones at least
// share the upper levels of the tree.
#pragma once

#include <cstdint>
#include <span>

#include "core/accel/group_hits.hpp"

namespace tessera::core {

// rays[order[i]] are of one octant (ray_columns.hpp), and there are at most kGroupSize. Answers go to
// hits[order[i]] and occluded[order[i]].
void trace_closest(const GroupScene& scene, std::span<const Ray> rays, std::span<const std::uint16_t> order,
                   std::span<Hit> hits);
void trace_any(const GroupScene& scene, std::span<const Ray> rays, std::span<const std::uint16_t> order,
               std::span<std::uint8_t> occluded);

}  // namespace tessera::core
