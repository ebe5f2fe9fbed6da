#include "core/guiding/direction_tree.hpp"

#include <algorithm>
#include <cmath>

#include "core/guiding/octahedral_map.hpp"
#include "core/math/simd_double8.hpp"

namespace tessera::core {
namespace {

// Squares of fewer examples are not divided, nor those of this depth, whose sides are some two degrees.
constexpr std::size_t kLeastToDivide = 4;
constexpr int kMaxDepth = 7;
// How many examples a square is taken to have had beforehand, spread evenly over its quarters, so that none
// is without any density that merely has had no example yet.
constexpr float kPriorExamples = 1;

constexpr float kBelowOne = 1 - 0x1p-24f;

template <typename T>
Vec2Of<T> place_of(Vec3Of<T> direction) {
  const Vec2Of<T> point = to_octahedral_square(direction);
  return {smaller(point.x, T(kBelowOne)), smaller(point.y, T(kBelowOne))};
}

// Finds the half of [0, 1) in which `x` lies, and moves x to the same place of the whole. True is the upper
// half.
template <typename T>
MaskOf<T> descend(T& x) {
  const MaskOf<T> upper = x >= 0.5f;
  x = 2 * x - select(upper, T(1.0f), T(0.0f));
  return upper;
}

// Chooses the upper half with probability `share` and makes of u the place within the half.
template <typename T>
MaskOf<T> choose(T& u, T share) {
  const T lower = 1 - share;
  const MaskOf<T> upper = u >= lower;
  u = smaller(select(upper, u - lower, u) / select(upper, share, lower), T(kBelowOne));
  return upper;
}

template <typename T>
WordOf<T> quarter(MaskOf<T> right, MaskOf<T> upper) {
  using Word = WordOf<T>;
  return select(right, Word(1), Word(0)) + select(upper, Word(2), Word(0));
}

}  // namespace

DirectionTrees::Root DirectionTrees::add(std::span<const WeightedDirection> directions) {
  std::vector<Example> examples;
  examples.reserve(directions.size());
  float total = 0;
  for (const auto& [direction, weight] : directions) {
    examples.push_back({place_of(direction), weight});
    total += weight;
  }
  return build(examples, kPriorExamples * total / static_cast<float>(directions.size()), 0);
}

std::uint32_t DirectionTrees::build(std::span<Example> examples, float prior, int depth) {
  std::array<std::vector<Example>, 4> quarters;
  std::array<float, 4> weights;
  weights.fill(prior / 4);
  for (const Example& example : examples) {
    Vec2 point = example.point;
    const bool right = descend(point.x), upper = descend(point.y);
    const std::size_t q = quarter<float>(right, upper);
    quarters[q].push_back({point, example.weight});
    weights[q] += example.weight;
  }
  const float total = weights[0] + weights[1] + weights[2] + weights[3];
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  for (std::size_t q = 0; q < 4; ++q) {
    const bool divided = quarters[q].size() >= kLeastToDivide && depth + 1 < kMaxDepth;
    const std::uint32_t child = divided ? build(quarters[q], prior, depth + 1) : 0;
    nodes_[index].share[q] = weights[q] / total;
    nodes_[index].child[q] = child;
  }
  return index;
}

template <typename T>
T DirectionTrees::share(WordOf<T> node, WordOf<T> quarter) const {
  return look_up(nodes_[0].share.data(), node * (sizeof(Node) / sizeof(float)) + quarter);
}
template <typename T>
WordOf<T> DirectionTrees::child(WordOf<T> node, WordOf<T> quarter) const {
  return look_up(nodes_[0].child.data(), node * (sizeof(Node) / sizeof(std::uint32_t)) + quarter);
}

template <typename T>
Vec3Of<T> DirectionTrees::sample(WordOf<T> root, Vec2Of<T> u) const {
  Vec2Of<T> corner{T(0.0f), T(0.0f)};
  T side = 1.0f;
  for (WordOf<T> at = root; any(at != 0);) {
    const MaskOf<T> inside = at != 0;
    const T share1 = share<T>(at, 1), share3 = share<T>(at, 3);
    const T lower = share<T>(at, 0) + share1, upper = share<T>(at, 2) + share3;
    Vec2Of<T> rest = u;
    const MaskOf<T> above = choose(rest.y, upper / (lower + upper));
    const MaskOf<T> right = choose(rest.x, select(above, share3, share1) / select(above, upper, lower));
    side = select(inside, side / 2, side);
    corner.x = corner.x + select(inside & right, side, T(0.0f));
    corner.y = corner.y + select(inside & above, side, T(0.0f));
    u.x = select(inside, rest.x, u.x);
    u.y = select(inside, rest.y, u.y);
    at = child<T>(at, quarter<T>(right, above));
  }
  return from_octahedral_square(corner + u * side);
}

template <typename T>
T DirectionTrees::pdf(WordOf<T> root, Vec3Of<T> direction) const {
  Vec2Of<T> point = place_of(direction);
  T density = 1.0f;
  for (WordOf<T> at = root; any(at != 0);) {
    const MaskOf<T> right = descend(point.x), upper = descend(point.y);
    const WordOf<T> q = quarter<T>(right, upper);
    density = density * (4 * share<T>(at, q));
    at = child<T>(at, q);
  }
  return density / octahedral_area(direction);
}

template Vec3Of<float> DirectionTrees::sample(Root, Vec2Of<float>) const;
template Vec3Of<Float8> DirectionTrees::sample(U32x8, Vec2Of<Float8>) const;
template float DirectionTrees::pdf(Root, Vec3Of<float>) const;
template Float8 DirectionTrees::pdf(U32x8, Vec3Of<Float8>) const;

}  // namespace tessera::core
