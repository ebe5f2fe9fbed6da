// SPDX-License-Identifier: Apache-2.0
// The acceleration structure: finds the closest hit of a ray, or whether a ray hits anything. Callers see
// only this interface. Every implementation returns the same hits (Hit defines how ties are resolved), so
// replacing it cannot change an image. Each instanced object has its own tree, which rays enter from leaves
// of the scene's tree. Queries are thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/accel/bvh_layout.hpp"
#include "core/accel/hit_opacity.hpp"
#include "core/accel/huge_pages.hpp"
#include "core/geometry/primitives.hpp"
#include "core/geometry/ray.hpp"
#include "core/math/columns.hpp"

namespace tessera::core::accel {

// What is on a ray.
enum class Occlusion : std::uint8_t {
  kNone,
  kFull,    // what stops every ray
  kPartial  // only surfaces of Opacity::kPartial
};

// The work of tracing rays, independent of the machine.
struct VisitCounts {
  std::uint64_t nodes = 0, packets = 0;
};

class Bvh {
 public:
  // All data of a tree, for callers that store trees and restore them.
  struct Arrays {
    HugePageArray<BvhNode> nodes;  // the root first
    HugePageArray<BvhPacket> packets;
    std::vector<Arrays> objects;  // the trees of instanced objects

    bool operator==(const Arrays&) const = default;
  };

  Bvh() = default;  // an empty tree: every ray misses
  // `arrays` must come from a tree built over the same primitives.
  explicit Bvh(Arrays arrays) : arrays_(std::move(arrays)) {}
  const Arrays& arrays() const { return arrays_; }

  // Keeps no references: `primitives` is passed again to the queries. The result does not depend on
  // `threads`, which must be at least one. Primitives that cannot be hit (triangles without area,
  // non-finite coordinates) are left out.
  static Bvh build(const Primitives& primitives, int threads);

  // Builds the scene's own tree again, after instances have moved or meshes have deformed, and those of
  // objects with meshes that deform. The other trees stay. All that was built is opaque.
  void rebuild(const Primitives& primitives, int threads);

  // Marks the packets by the opacities of materials. Queries ask for the opacity of hits of those that are
  // not opaque, if they are given `opacity`; without, every hit counts.
  void set_opacities(const Primitives& primitives, std::span<const MaterialOpacity> of_materials,
                     int threads);

  // The nearest hit with 0 < t < ray.t_max that is not transparent; Hit::found() is false if there is none.
  Hit closest_hit(const Primitives& primitives, const Ray& ray, const HitOpacity* opacity = nullptr) const;

  // What is hit with 0 < t < ray.t_max.
  Occlusion occlusion(const Primitives& primitives, const Ray& ray,
                      const HitOpacity* opacity = nullptr) const;
  bool any_hit(const Primitives& primitives, const Ray& ray) const {
    return occlusion(primitives, ray) != Occlusion::kNone;
  }

  // Traces many rays in any order and of any kind. hits[i] is bit-identical to closest_hit(primitives,
  // rays[i], opacity). There are as many of either. Coherent rays should be neighbours. Where nothing moves,
  // times are neither read nor written.
  void closest_hits(const Primitives& primitives, ColumnsView<const Ray> rays, ColumnsView<Hit> hits,
                    const HitOpacity* opacity = nullptr) const;
  // occluded[i] becomes occlusion(primitives, rays[i], opacity).
  void occlusions(const Primitives& primitives, ColumnsView<const Ray> rays, std::span<Occlusion> occluded,
                  const HitOpacity* opacity = nullptr) const;

  // Includes the trees of objects.
  std::size_t memory_bytes() const;

  // The visits of closest_hit for all these rays together, for tests and for comparing trees.
  VisitCounts count_visits(const Primitives& primitives, std::span<const Ray> rays) const;

  // Whether the trees are equal, node for node.
  bool operator==(const Bvh&) const = default;

 private:
  void rebuild_own(const Primitives& primitives, int threads);

  Arrays arrays_;
};

}  // namespace tessera::core::accel
