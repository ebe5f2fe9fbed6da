// A group of rays' common way through the tree: a node's boxes are tested against bounds of the whole group,
// those that may be met against the rays that came here, and a triangle against eight rays at once. Where few
// rays go on together, each goes its own way (ray_traversal.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/accel/ray_group.hpp"
#include "core/accel/ray_traversal.hpp"
#include "core/geometry/primitives.hpp"

namespace tessera::core {

// What a group is traced against.
struct GroupScene {
  const Primitives& primitives;
  const BvhNode* nodes;
  const BvhPacket* packets;
};

// rays[order[i]] are of one octant, and there are at most RayGroup::kSize.
void trace_closest(const GroupScene& scene, std::span<const Ray> rays, std::span<const std::uint32_t> order,
                   std::span<Hit> hits);
void trace_any(const GroupScene& scene, std::span<const Ray> rays, std::span<const std::uint32_t> order,
               std::span<std::uint8_t> occluded);

}  // namespace tessera::core
