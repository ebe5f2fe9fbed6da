// Distributions of directions learnt from examples: quadtrees over the unfolded sphere, finer where there are
// more examples (after Müller, Gross and Novák 2017). Many trees share one array of nodes. Immutable once
// built.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math/vec3.hpp"

namespace tessera::core {

struct WeightedDirection {
  Vec3 direction;  // unit
  float weight;    // above 0
};

class DirectionTrees {
 public:
  using Root = std::uint32_t;

  // The result depends on the order of `examples`, of which there is at least one, in its last bits.
  Root add(std::span<const WeightedDirection> examples);

  // A direction for u in [0, 1) x [0, 1), which keeps neighbours together, and the density per solid angle.
  Vec3 sample(Root root, Vec2 u) const;
  float pdf(Root root, Vec3 direction) const;

 private:
  // Of the square's four quarters, x first. Where there is no child, the density is even.
  struct Node {
    std::array<float, 4> share{};
    std::array<std::uint32_t, 4> child{};
  };
  struct Example {
    Vec2 point;  // within the node's square
    float weight;
  };

  std::uint32_t build(std::span<Example> examples, float prior, int depth);

  std::vector<Node> nodes_{1};  // the first is nobody's, so that child 0 is none
};

}  // namespace tessera::core
