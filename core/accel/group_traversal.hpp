// SPDX-License-Identifier: Apache-2.0
// Traverses the tree with a group of rays. A node's boxes are tested against bounds of the whole group,
// then the boxes that may be met against the rays that reached the node: a vector of rays against one box,
// or one ray against sixteen boxes, whichever is less work. Where few rays remain together they diverge:
// each keeps the node, and they are interleaved after the group has finished (diverged_rays.hpp).
//
// Rays that reach an instance together are regrouped in the space of its object.
//
// Rays from neighbouring pixels, or towards one light, stay together down to the triangles; incoherent rays
// still share the upper levels of the tree.
#pragma once

#include <cstdint>
#include <span>

#include "core/accel/group_hits.hpp"

namespace tessera::core::accel {

// The rays rays[order[i]] point into one octant (octant_groups.hpp), in ascending order, and
// there are at most kGroupSize.
// Results go to hits[order[i]] and occluded[order[i]], as those of Bvh.
void trace_closest(const GroupScene& scene, ColumnsView<const Ray> rays, std::span<const std::uint16_t> order,
                   ColumnsView<Hit> hits);
void trace_any(const GroupScene& scene, ColumnsView<const Ray> rays, std::span<const std::uint16_t> order,
               std::span<Occlusion> occluded);

}  // namespace tessera::core::accel
