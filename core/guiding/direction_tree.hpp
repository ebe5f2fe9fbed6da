// SPDX-License-Identifier: Apache-2.0
// Distributions of directions learnt from the light that comes from them: quadtrees over the unfolded sphere,
// finer where there are more examples (after Müller, Gross and Novák 2017). Many trees share one array.
// Immutable once built.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math/row_lookup.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

// An example of light.
struct DirectedLight {
  Vec3 direction;  // unit
  float power;     // above 0
  // Where the light comes from few of the directions around: its power times the value of a sample that meets
  // it. 0 where it comes from all of them.
  float concentration;
};

class DirectionTrees {
 public:
  using Root = std::uint32_t;

  DirectionTrees();

  struct Added {
    Root root;
    float root_mean_square;  // to expect of one sample's value, in units of power
  };
  // The result depends on the order of `lights`, of which there is at least one, in its last bits.
  Added add(std::span<const DirectedLight> lights);

  template <typename T>
  struct DirectionOf {
    Vec3Of<T> direction;  // unit
    T pdf;                // per solid angle
  };
  // Where `sampled`, a direction for u in [0, 1) x [0, 1); elsewhere `other`. T is float or Float8. Root 0 is
  // that of no tree and has an even density over the unfolded sphere.
  template <typename T>
  DirectionOf<T> sample_or(WordOf<T> root, MaskOf<T> sampled, Vec2Of<T> u, Vec3Of<T> other) const;

 private:
  // Only a tree's leaves are kept, in their order along the Z-order curve (Morton 1966), fifteen to a block:
  // where on the curve each begins, and the chance of all before it. So the leaf at a place is found as the
  // leaf of a random number is, by counting. A tree's first block has the first leaf of each that follows.
  // Rows are filled up with what the last leaf ends at, and blocks with the next one's first leaf.
  struct alignas(64) Block {
    std::array<SixteenShorts, 2> begins;  // by place, by chance
  };
  struct Leaf {
    std::uint32_t place;
    float value;  // its chance, times the same factor for all
  };
  Root store(std::span<const Leaf> leaves, float total);

  // Of a leaf, or of eight: where it begins, in the lower half of the word, and where it ends.
  template <typename Word>
  struct Extent {
    Word place, chance;
  };
  Extent<std::uint32_t> find(std::uint32_t root, bool by_chance, std::uint32_t key) const;
  Extent<U32x8> find(U32x8 root, Mask8 by_chance, U32x8 key) const;

  class Divider;

  std::vector<Block> blocks_;
};

}  // namespace tessera::core
