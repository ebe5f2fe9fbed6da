// SPDX-License-Identifier: Apache-2.0
// Directional distributions learnt from incident light: quadtrees over the unfolded sphere, finer where
// there are more examples (after Müller, Gross and Novák 2017). Many trees share one array. Immutable once
// built.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math/row_lookup.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core::guiding {

// An example of incident light.
struct DirectedLight {
  Vec3 direction;  // unit
  float power;     // positive
  // If the light comes from few of the surrounding directions: its power times the value of a sample that
  // meets it. 0 if it comes from all of them.
  float concentration;
};

class DirectionTrees {
 public:
  using Root = std::uint32_t;

  DirectionTrees();

  struct Added {
    Root root;
    float root_mean_square;  // expected root mean square of a sample's value, in units of power
  };
  // Squares of directions with fewer examples than this are not divided. Few of them resolve the image of a
  // lamp in a glass ball; many leave no gaps in the view through a window.
  static constexpr std::size_t kFine = 4, kCoarse = 12;
  // The last bits of the result depend on the order of `lights`, which must not be empty.
  Added add(std::span<const DirectedLight> lights, std::size_t min_to_divide = kFine);

  template <typename T>
  struct DirectionOf {
    Vec3Of<T> direction;  // unit
    T pdf;                // per solid angle
  };
  // Samples a direction with u in [0, 1) x [0, 1) in lanes where `sampled`, and otherwise takes `other`. T
  // is float or FloatN. Root 0 is the empty tree, which is uniform over the unfolded sphere.
  template <typename T>
  DirectionOf<T> sample_or(WordOf<T> root, MaskOf<T> sampled, Vec2Of<T> u, Vec3Of<T> other) const;

 private:
  // Only leaves are stored, in order along the Z-order curve (Morton 1966), fifteen to a block: where each
  // begins along the curve, and the cumulative probability before it. Both a location and a random number
  // thus select a leaf by counting smaller entries. A tree's first block holds the first leaf of each
  // following block. Rows are padded with the end of the last leaf, and blocks with the first leaf of the
  // next.
  struct alignas(64) Block {
    std::array<SixteenShorts, 2> begins;  // by location, by probability
  };
  struct Leaf {
    std::uint32_t place;
    float value;  // its probability, times a factor common to all
  };
  Root store(std::span<const Leaf> leaves, float total);

  // For one leaf or one in each lane: the begin in the lower half of the word, the end in the upper half.
  template <typename Word>
  struct Extent {
    Word place, chance;
  };
  Extent<std::uint32_t> find(std::uint32_t root, bool by_chance, std::uint32_t key) const;
  Extent<U32xN> find(U32xN root, MaskN by_chance, U32xN key) const;

  class Divider;

  std::vector<Block> blocks_;
};

}  // namespace tessera::core::guiding
