// SPDX-License-Identifier: Apache-2.0
// The acceleration structure: finds what a ray hits first, and whether it hits anything.
// Callers see only this interface; any structure behind it returns the same hits (ties are settled as Hit
// says), so that replacing it cannot change a picture. Each object that instances show has a structure of its
// own, into which a ray goes on from their leaves. Immutable once built; thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/accel/bvh_layout.hpp"
#include "core/accel/huge_pages.hpp"
#include "core/geometry/primitives.hpp"
#include "core/geometry/ray.hpp"

namespace tessera::core {

// What it takes to trace rays, whatever the machine.
struct VisitCounts {
  std::uint64_t nodes = 0, packets = 0;
};

class Bvh {
 public:
  // All that it consists of, for those who keep trees and make them again.
  struct Arrays {
    HugePageArray<BvhNode> nodes;  // the root first
    HugePageArray<BvhPacket> packets;
    std::vector<Arrays> objects;  // of the trees of objects

    bool operator==(const Arrays&) const = default;
  };

  Bvh() = default;  // of nothing: every ray misses
  // `arrays` are those of a tree that was built of the same primitives.
  explicit Bvh(Arrays arrays) : arrays_(std::move(arrays)) {}
  const Arrays& arrays() const { return arrays_; }

  // Keeps a reference to nothing: `primitives` is passed again to the queries. The result does not depend on
  // `threads`, of which there is at least one. What cannot be hit (triangles without area, anything not
  // finite) is left out.
  static Bvh build(const Primitives& primitives, int threads);

  // The nearest hit with 0 < t < ray.t_max; not found() where there is none.
  Hit closest_hit(const Primitives& primitives, const Ray& ray) const;

  // Whether anything is hit with 0 < t < ray.t_max.
  bool any_hit(const Primitives& primitives, const Ray& ray) const;

  // Many rays at once, in any order and of any kind: answer i is that of rays[i], to the bit what the query
  // of one ray gives. The spans are of the same size. Rays that go nearly the same way should be neighbours.
  void closest_hits(const Primitives& primitives, std::span<const Ray> rays, std::span<Hit> hits) const;
  // occluded[i] becomes 1 where rays[i] hits anything, 0 elsewhere.
  void any_hits(const Primitives& primitives, std::span<const Ray> rays,
                std::span<std::uint8_t> occluded) const;

  // The trees of objects included.
  std::size_t memory_bytes() const;

  // What closest_hit visits for all these rays together, for tests and for choosing between trees.
  VisitCounts count_visits(const Primitives& primitives, std::span<const Ray> rays) const;

  // Whether the trees are the same, node for node.
  bool operator==(const Bvh&) const = default;

 private:
  Arrays arrays_;
};

}  // namespace tessera::core
