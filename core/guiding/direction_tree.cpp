// SPDX-License-Identifier: Apache-2.0
#include "core/guiding/direction_tree.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/math/elementary.hpp"
#include "core/math/octahedral_map.hpp"
#include "core/math/simd_double.hpp"

namespace tessera::core::guiding {
namespace {

constexpr int kFinestSquares = 128;  // along a side; about two degrees each
constexpr float kMinSide = 1.0f / kFinestSquares;
// A prior of this many examples, spread uniformly over the sphere, gives every direction some density even
// without an example.
constexpr float kPriorExamples = 1;

// The length of the curve, and the total probability of all leaves: the maximum that sixteen bits hold.
constexpr std::uint32_t kCurve = kFinestSquares * kFinestSquares, kCertain = 32767;
constexpr std::size_t kBlockLeaves = 15, kMaxLeaves = 16 * kBlockLeaves;

constexpr float kBelowOne = 1 - 0x1p-24f;

// Spreads the bits of seven-bit numbers to every second place, and back.
template <typename Word>
Word spread_bits(Word x) {
  x = (x | x << 4) & 0x070f;
  x = (x | x << 2) & 0x1333;
  return (x | x << 1) & 0x1555;
}
template <typename Word>
Word gather_bits(Word x) {
  x = x & 0x1555;
  x = (x | x >> 1) & 0x1333;
  x = (x | x >> 2) & 0x070f;
  return (x | x >> 4) & 0x007f;
}

// The index along the curve of the finest square that contains the direction.
template <typename T>
WordOf<T> place_of(Vec3Of<T> direction) {
  const Vec2Of<T> point = to_octahedral_square(direction);
  const auto number = [](T x) {
    return to_word(smaller(x, T(kBelowOne)) * static_cast<float>(kFinestSquares));
  };
  return spread_bits(number(point.x)) | spread_bits(number(point.y)) << 1;
}

}  // namespace

// Computes the leaves.
class DirectionTrees::Divider {
 public:
  struct Example {
    Vec2 point;  // within the square
    float power, concentration;
  };
  struct Square {
    Vec2 corner;
    float side;
    std::uint32_t place;
  };

  Divider(float prior_power, std::size_t least_to_divide)
      : prior_power_(prior_power), least_to_divide_(least_to_divide) {}

  // The importance of a square where sample values vary: proportional to the root mean square (Rath et al.
  // 2020). For light from all of a square this is its power; for light from only a part of it, it grows as
  // the part shrinks.
  void divide(std::span<const Example> examples, const Square& square) {
    std::array<std::vector<Example>, 4> quarters;
    for (const auto& [point, power, concentration] : examples) {
      const Vec2 scaled = point * 2;
      const bool right = scaled.x >= 1, upper = scaled.y >= 1;
      const Vec2 rest{scaled.x - static_cast<float>(right), scaled.y - static_cast<float>(upper)};
      quarters[(right ? 1 : 0) + (upper ? 2 : 0)].push_back({rest, power, concentration});
    }
    const float side = square.side / 2;
    const auto area = static_cast<std::uint32_t>(side * side * static_cast<float>(kCurve));
    for (std::uint32_t q = 0; q < 4; ++q) {
      const Vec2 corner = square.corner + Vec2{static_cast<float>(q & 1), static_cast<float>(q / 2)} * side;
      const Square quarter{corner, side, square.place + q * area};
      if (quarters[q].size() >= least_to_divide_ && side > kMinSide)
        divide(quarters[q], quarter);
      else
        leaves_.push_back({quarter.place, root_mean_square(quarters[q], quarter)});
    }
  }
  std::span<const Leaf> leaves() const { return leaves_; }

 private:
  float root_mean_square(std::span<const Example> examples, const Square& square) const {
    const Vec3 middle = from_octahedral_square(square.corner + Vec2{0.5f, 0.5f} * square.side);
    const float solid_angle = octahedral_area(middle) * square.side * square.side;
    float power = prior_power_ * solid_angle / (4 * kPi), concentration = 0;
    for (const Example& example : examples) {
      power += example.power;
      concentration += example.concentration;
    }
    return std::sqrt(power * power + concentration * solid_angle);
  }

  float prior_power_;
  std::size_t least_to_divide_;
  std::vector<Leaf> leaves_;
};

DirectionTrees::DirectionTrees() {
  store(std::array{Leaf{0, 1}}, 1);
}

DirectionTrees::Added DirectionTrees::add(std::span<const DirectedLight> lights, std::size_t min_to_divide) {
  std::vector<Divider::Example> examples;
  examples.reserve(lights.size());
  float power = 0;
  for (const DirectedLight& light : lights) {
    const Vec2 point = to_octahedral_square(light.direction);
    examples.push_back(
        {{std::min(point.x, kBelowOne), std::min(point.y, kBelowOne)}, light.power, light.concentration});
    power += light.power;
  }
  const float prior_power = kPriorExamples * power / static_cast<float>(lights.size());
  // Doubles the minimum number of examples while there are too many leaves for a tree.
  for (std::size_t least = min_to_divide;; least *= 2) {
    Divider divider(prior_power, least);
    divider.divide(examples, {{0, 0}, 1, 0});
    if (divider.leaves().size() > kMaxLeaves) continue;
    float total = 0;
    for (const Leaf& leaf : divider.leaves()) total += leaf.value;
    return {store(divider.leaves(), total), total};
  }
}

// Probabilities are rounded, but never to 0.
DirectionTrees::Root DirectionTrees::store(std::span<const Leaf> leaves, float total) {
  SixteenShorts ends_by_place, ends_by_chance;
  ends_by_place.fill(kCurve);
  ends_by_chance.fill(kCertain);
  const auto root = static_cast<Root>(blocks_.size());
  blocks_.resize(root + 1 + (leaves.size() + kBlockLeaves - 1) / kBlockLeaves,
                 {{ends_by_place, ends_by_chance}});
  const float spare = static_cast<float>(kCertain - leaves.size());
  float before = 0;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    const std::size_t number = i / kBlockLeaves, within = i % kBlockLeaves;
    const auto set = [&](std::size_t block, std::size_t slot) {
      auto& [by_place, by_chance] = blocks_[root + block].begins;
      by_place[slot] = static_cast<std::int16_t>(leaves[i].place);
      by_chance[slot] = static_cast<std::int16_t>(i + static_cast<std::size_t>(before / total * spare));
    };
    set(1 + number, within);
    if (within == 0) set(0, number);
    if (within == 0 && number > 0) set(number, kBlockLeaves);
    before += leaves[i].value;
  }
  return root;
}

DirectionTrees::Extent<std::uint32_t> DirectionTrees::find(std::uint32_t root, bool by_chance,
                                                           std::uint32_t key) const {
  const std::size_t order = by_chance ? 1 : 0;
  const auto searched = static_cast<std::int16_t>(key);
  const std::uint32_t number = count_up_to(searched, blocks_[root].begins[order]);
  const Block& block = blocks_[root + number];
  const std::uint32_t leaf = count_up_to(searched, block.begins[order]) - 1;
  Extent<std::uint32_t> extent;
  std::memcpy(&extent.place, &block.begins[0][leaf], sizeof(std::uint32_t));
  std::memcpy(&extent.chance, &block.begins[1][leaf], sizeof(std::uint32_t));
  return extent;
}

DirectionTrees::Extent<U32xN> DirectionTrees::find(U32xN root, MaskN by_chance, U32xN key) const {
  const WordLanes roots(root), keys(key);
  const unsigned chances = by_chance.bits();
  WordLanes place, chance;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const auto extent = find(roots[lane], (chances >> lane & 1) != 0, keys[lane]);
    place.set(lane, extent.place);
    chance.set(lane, extent.chance);
  }
  return {place.all(), chance.all()};
}

template <typename T>
DirectionTrees::DirectionOf<T> DirectionTrees::sample_or(WordOf<T> root, MaskOf<T> sampled, Vec2Of<T> u,
                                                         Vec3Of<T> other) const {
  using std::sqrt;
  const T u_chance = u.x * static_cast<float>(kCertain);
  const auto leaf = find(root, sampled, select(sampled, to_word(u_chance), place_of(other)));
  const WordOf<T> place = leaf.place & 0xffff, before = leaf.chance & 0xffff;
  const T area = to_float((leaf.place >> 16) - place), chance = to_float((leaf.chance >> 16) - before);
  Vec3Of<T> direction = other;
  if (any(sampled)) {
    // The remainder of the random number is uniform again.
    const Vec2Of<T> within{smaller((u_chance - to_float(before)) / chance, T(kBelowOne)), u.y};
    const Vec2Of<T> corner{to_float(gather_bits(place)), to_float(gather_bits(place >> 1))};
    const Vec2Of<T> point = (corner + within * sqrt(area)) * T(kMinSide);
    direction = select(sampled, from_octahedral_square(point), other);
  }
  constexpr float kEven = static_cast<float>(kCurve) / kCertain;
  return {direction, chance * kEven / (area * octahedral_area(direction))};
}

template DirectionTrees::DirectionOf<float> DirectionTrees::sample_or(std::uint32_t, bool, Vec2, Vec3) const;
template DirectionTrees::DirectionOf<FloatN> DirectionTrees::sample_or(U32xN, MaskN, Vec2Of<FloatN>,
                                                                       Vec3Of<FloatN>) const;

}  // namespace tessera::core::guiding
