// Distributions of directions learnt from the light that comes from them: quadtrees over the unfolded sphere,
// finer where there are more examples (after Müller, Gross and Novák 2017). Many trees share one array of
// nodes. Immutable once built.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math/vec3.hpp"
#include "core/math/word_lanes.hpp"

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

  struct Added {
    Root root;
    float root_mean_square;  // to expect of one sample's value, in units of power
  };
  // The result depends on the order of `lights`, of which there is at least one, in its last bits.
  Added add(std::span<const DirectedLight> lights);

  // A direction for u in [0, 1) x [0, 1), which keeps neighbours together, and the density per solid angle. T
  // is float or Float8. Root 0 is that of no tree and has an even density over the unfolded sphere.
  template <typename T>
  Vec3Of<T> sample(WordOf<T> root, Vec2Of<T> u) const;
  template <typename T>
  T pdf(WordOf<T> root, Vec3Of<T> direction) const;

 private:
  // Of the square's four quarters, x first. Where there is no child, the density is even.
  struct Node {
    void set_shares(std::array<float, 4> shares);

    std::array<float, 4> share{0.25f, 0.25f, 0.25f, 0.25f};
    std::array<std::uint32_t, 4> child{};
    // What sample() takes of the shares: of the upper half, and of the right quarters in the lower and in the
    // upper half.
    std::array<float, 3> share_of_half{0.5f, 0.5f, 0.5f};
  };
  template <typename T>
  T share(WordOf<T> node, WordOf<T> quarter) const;
  template <typename T>
  T share_of_half(WordOf<T> node, WordOf<T> half) const;
  template <typename T>
  WordOf<T> child(WordOf<T> node, WordOf<T> quarter) const;

  struct Example {
    Vec2 point;  // within the node's square
    float power, concentration;
  };
  struct Square {
    Vec2 corner;
    float side;
  };
  Added build(std::span<const Example> examples, float prior_power, Square square);
  static float root_mean_square(std::span<const Example> examples, float prior_power, Square square);

  std::vector<Node> nodes_{1};  // the first leads to itself, and stands for no child
};

}  // namespace tessera::core
