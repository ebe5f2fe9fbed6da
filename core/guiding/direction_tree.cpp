#include "core/guiding/direction_tree.hpp"

#include <algorithm>
#include <cmath>

#include "core/guiding/octahedral_map.hpp"

namespace tessera::core {
namespace {

// Squares of fewer examples are not divided, nor those of this depth, whose sides are some two degrees.
constexpr std::size_t kLeastToDivide = 4;
constexpr int kMaxDepth = 7;
// How many examples a square is taken to have had beforehand, spread evenly over its quarters, so that none
// is without any density that merely has had no example yet.
constexpr float kPriorExamples = 1;

constexpr float kBelowOne = 1 - 0x1p-24f;

// Finds the half of [0, 1) in which `x` lies and moves x to the same place of the whole.
std::size_t descend(float& x) {
  const std::size_t upper = x >= 0.5f ? 1 : 0;
  x = 2 * x - static_cast<float>(upper);
  return upper;
}

// Chooses the upper half with probability `share` and makes of u the place within the half.
std::size_t choose(float& u, float share) {
  const float lower = 1 - share;
  if (u < lower) {
    u = std::min(u / lower, kBelowOne);
    return 0;
  }
  u = std::min((u - lower) / share, kBelowOne);
  return 1;
}

}  // namespace

DirectionTrees::Root DirectionTrees::add(std::span<const WeightedDirection> directions) {
  std::vector<Example> examples;
  examples.reserve(directions.size());
  float total = 0;
  for (const auto& [direction, weight] : directions) {
    const Vec2 point = to_octahedral_square(direction);
    examples.push_back({{std::min(point.x, kBelowOne), std::min(point.y, kBelowOne)}, weight});
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
    const std::size_t right = descend(point.x), q = right + 2 * descend(point.y);
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

Vec3 DirectionTrees::sample(Root root, Vec2 u) const {
  Vec2 corner{0, 0};
  float side = 1;
  for (std::uint32_t at = root; at != 0;) {
    const auto& [share, child] = nodes_[at];
    const float lower = share[0] + share[1], upper = share[2] + share[3];
    const std::size_t row = choose(u.y, upper / (lower + upper));
    const float row_sum = row == 0 ? lower : upper;
    const std::size_t q = 2 * row + choose(u.x, share[2 * row + 1] / row_sum);
    side /= 2;
    corner = corner + Vec2{static_cast<float>(q & 1), static_cast<float>(row)} * side;
    at = child[q];
  }
  return from_octahedral_square(corner + u * side);
}

float DirectionTrees::pdf(Root root, Vec3 direction) const {
  Vec2 point = to_octahedral_square(direction);
  point = {std::min(point.x, kBelowOne), std::min(point.y, kBelowOne)};
  float density = 1;
  for (std::uint32_t at = root; at != 0;) {
    const std::size_t right = descend(point.x), q = right + 2 * descend(point.y);
    density *= 4 * nodes_[at].share[q];
    at = nodes_[at].child[q];
  }
  return density / octahedral_area(direction);
}

}  // namespace tessera::core
