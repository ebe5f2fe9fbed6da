#include "core/guiding/direction_tree.hpp"

#include <algorithm>
#include <cmath>

#include "core/guiding/octahedral_map.hpp"
#include "core/math/elementary.hpp"
#include "core/math/simd_double8.hpp"

namespace tessera::core {
namespace {

// Squares of fewer examples are not divided, nor those of this side, some two degrees.
constexpr std::size_t kLeastToDivide = 4;
constexpr float kLeastSide = 1.0f / 128;
// How many examples there are taken to have been beforehand, spread evenly over the sphere, so that no
// direction is without any density that merely has had no example yet.
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

DirectionTrees::Added DirectionTrees::add(std::span<const DirectedLight> lights) {
  std::vector<Example> examples;
  examples.reserve(lights.size());
  float total = 0;
  for (const auto& [direction, power, concentration] : lights) {
    examples.push_back({place_of(direction), power, concentration});
    total += power;
  }
  return build(examples, kPriorExamples * total / static_cast<float>(lights.size()), {{0, 0}, 1});
}

// Of the density that is best where a sample's value varies: in proportion to its root mean square (Rath et
// al. 2020). Over a square, that of light from everywhere in it is its power; of light from a part of it
// alone it is the larger, the smaller the part.
DirectionTrees::Added DirectionTrees::build(std::span<const Example> examples, float prior_power,
                                            Square square) {
  std::array<std::vector<Example>, 4> quarters;
  for (const Example& example : examples) {
    Vec2 point = example.point;
    const bool right = descend(point.x), upper = descend(point.y);
    quarters[quarter<float>(right, upper)].push_back({point, example.power, example.concentration});
  }
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  const float side = square.side / 2;
  std::array<float, 4> values;
  for (std::uint32_t q = 0; q < 4; ++q) {
    const Vec2 corner = square.corner + Vec2{static_cast<float>(q & 1), static_cast<float>(q / 2)} * side;
    if (quarters[q].size() >= kLeastToDivide && side > kLeastSide) {
      const auto [child, value] = build(quarters[q], prior_power, {corner, side});
      nodes_[index].child[q] = child;
      values[q] = value;
    } else {
      values[q] = root_mean_square(quarters[q], prior_power, {corner, side});
    }
  }
  const float total = values[0] + values[1] + values[2] + values[3];
  for (float& value : values) value /= total;
  nodes_[index].set_shares(values);
  return {index, total};
}

void DirectionTrees::Node::set_shares(std::array<float, 4> shares) {
  share = shares;
  const float lower = share[0] + share[1], upper = share[2] + share[3];
  share_of_half = {upper / (lower + upper), share[1] / lower, share[3] / upper};
}

float DirectionTrees::root_mean_square(std::span<const Example> examples, float prior_power, Square square) {
  const Vec3 middle = from_octahedral_square(square.corner + Vec2{0.5f, 0.5f} * square.side);
  const float solid_angle = octahedral_area(middle) * square.side * square.side;
  float power = prior_power * solid_angle / (4 * kPi), concentration = 0;
  for (const Example& example : examples) {
    power += example.power;
    concentration += example.concentration;
  }
  return std::sqrt(power * power + concentration * solid_angle);
}

template <typename T>
T DirectionTrees::share(WordOf<T> node, WordOf<T> quarter) const {
  return look_up(nodes_[0].share.data(), node * (sizeof(Node) / sizeof(float)) + quarter);
}
template <typename T>
T DirectionTrees::share_of_half(WordOf<T> node, WordOf<T> half) const {
  return look_up(nodes_[0].share_of_half.data(), node * (sizeof(Node) / sizeof(float)) + half);
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
    Vec2Of<T> rest = u;
    const MaskOf<T> above = choose(rest.y, share_of_half<T>(at, 0));
    const MaskOf<T> right = choose(rest.x, share_of_half<T>(at, select(above, WordOf<T>(2), WordOf<T>(1))));
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
