// SPDX-License-Identifier: Apache-2.0
#include "core/lights/light_tree.hpp"

#include <algorithm>
#include <bit>

#include "core/math/lane_array.hpp"

namespace tessera::core::lights {
namespace {

constexpr double kBelowOne = 1 - 0x1p-53;

// Cosine and sine of an angle up to pi.
struct Angle {
  FloatN cosine, sine;

  static Angle of_cosine(FloatN cosine) { return {cosine, sqrt(max(0.0f, 1.0f - cosine * cosine))}; }
};

// The difference of two angles, or 0 if the second is larger.
Angle excess(const Angle& a, const Angle& b) {
  const MaskN none = a.cosine >= b.cosine;
  return {select(none, 1.0f, a.cosine * b.cosine + a.sine * b.sine),
          select(none, 0.0f, a.sine * b.cosine - a.cosine * b.sine)};
}

// The approximate mean cosine over a sphere whose centre is seen at the cosine `of_middle`, with negative
// cosines clamped to 0. It assumes uniformly distributed cosines. A point at the edge that emits all of the
// light contributes more, but its squared cosine is at most 4 times this, which bounds the noise.
FloatN mean_cosine(FloatN of_middle, FloatN sine_of_sphere) {
  constexpr float kMinSphereSine = 1e-30f;
  const FloatN highest = max(of_middle + sine_of_sphere, 0.0f);
  return select(of_middle >= sine_of_sphere, of_middle,
                highest * highest / (4 * max(sine_of_sphere, kMinSphereSine)));
}

FloatN load(const std::array<float, LightTree::kWidth>& lanes) {
  return FloatN::load(lanes.data());
}

Vec3Of<FloatN> load(const std::array<float, LightTree::kWidth> (&lanes)[3]) {
  return {load(lanes[0]), load(lanes[1]), load(lanes[2])};
}

}  // namespace

// One child of a node in each lane, or the same child in all lanes.
struct LightTree::Children {
  // All children.
  explicit Children(const Node& node)
      : center(load(node.center)),
        axis(load(node.axis)),
        radius2(load(node.radius2)),
        disk2(load(node.disk2)),
        cone{load(node.cos_o), load(node.sin_o)},
        cos_e(load(node.cos_e)),
        back(load(node.back)),
        intensity(load(node.intensity)) {}
  // The child in lane i.
  Children(const Node& node, std::size_t i)
      : center{node.center[0][i], node.center[1][i], node.center[2][i]},
        axis{node.axis[0][i], node.axis[1][i], node.axis[2][i]},
        radius2(node.radius2[i]),
        disk2(node.disk2[i]),
        cone{node.cos_o[i], node.sin_o[i]},
        cos_e(node.cos_e[i]),
        back(node.back[i]),
        intensity(node.intensity[i]) {}

  FloatN weights(const LightSampleContexts& points) const;

  Vec3Of<FloatN> center, axis;
  FloatN radius2, disk2;
  Angle cone;
  FloatN cos_e, back, intensity;
};

// The approximate contribution of each child to the point: emission is uniform over its sphere, and the
// best normal of its cone is taken (after Conty Estevez and Kulla 2018, section 3.2, who take the best
// position as well). Zero only if no light can contribute.
FloatN LightTree::Children::weights(const LightSampleContexts& points) const {
  constexpr float kMinDistance2 = 1e-30f;
  constexpr float kMinInside = 0.1f;  // lower bound on the product of cosines inside the sphere
  constexpr float kNearest2 = 0.1f;   // of radius2: minimum distance for points among the lights
  const Vec3Of<FloatN> to_center = center - points.position, normal = points.normal;
  const FloatN distance2 = max(dot(to_center, to_center), kMinDistance2);
  const FloatN per_distance = 1.0f / sqrt(distance2);
  const MaskN inside = radius2 >= distance2;

  const FloatN sin2_of_sphere = min(radius2 * (per_distance * per_distance), 1.0f);
  const Angle sphere{sqrt(1.0f - sin2_of_sphere), sqrt(sin2_of_sphere)};

  const FloatN to_axis = -dot(to_center, axis) * per_distance;
  const Angle from_cone = excess(Angle::of_cosine(max(to_axis, to_axis * back)), cone);
  const MaskN sends = excess(from_cone, sphere).cosine >= cos_e;
  const FloatN sent = select(sends, mean_cosine(from_cone.cosine, sphere.sine), 0.0f);

  const FloatN arriving = mean_cosine(dot(to_center, normal) * per_distance, sphere.sine);
  const MaskN has_no_normal = (normal.x == 0) & (normal.y == 0) & (normal.z == 0);
  const FloatN received = select(has_no_normal, 1.0f, arriving);

  const FloatN cosines = sent * received;
  // A disk seen from above its centre is equivalent to a point at a distance increased by its radius.
  return intensity / (max(distance2, kNearest2 * radius2) + disk2) *
         select(inside, max(cosines, kMinInside), cosines);
}

void LightTree::Weights::add_up() {
  double sum = 0;
  for (std::size_t lane = 0; lane < kWidth; ++lane) sums[lane] = sum += static_cast<double>(lanes[lane]);
}

LightTree::Weights LightTree::WeightsInLanes::operator[](std::size_t lane) const {
  Weights weights;
  for (std::size_t child = 0; child < kWidth; ++child) weights.lanes[child] = of_children_[child][lane];
  weights.add_up();
  return weights;
}

LightTree::Weights LightTree::weigh(const Node& node, const LightSampleContext& point) {
  const auto [p, n] = point;
  Weights weights;
  Children(node).weights({{p.x, p.y, p.z}, {n.x, n.y, n.z}}).store(weights.lanes.data());
  weights.add_up();
  return weights;
}

LightTree::Weights LightTree::weigh_root(const LightSampleContext& point) const {
  return empty() ? Weights{} : weigh(nodes_[0], point);
}

// Processes one child at a time, since few trees have eight children at their root.
LightTree::WeightsInLanes LightTree::weigh_root(const LightSampleContexts& points) const {
  WeightsInLanes weights;
  if (empty()) return weights;
  for (std::size_t child = 0; child < kWidth && nodes_[0].children[child] != 0; ++child) {
    const FloatN of_child = Children(nodes_[0], child).weights(points);
    of_child.store(weights.of_children_[child].data());
    weights.sum_ = weights.sum_ + widened(of_child);
  }
  return weights;
}

// A tree of a single light needs no weights. Lanes without a child hold 0.
std::optional<std::uint32_t> LightTree::only_light() const {
  if (nodes_.size() != 1 || nodes_[0].children[1] != 0) return std::nullopt;
  return static_cast<std::uint32_t>(~nodes_[0].children[0]);
}

LightTree::Choice LightTree::sample(const Weights& root, const LightSampleContext& point, double u) const {
  if (const auto only = only_light()) return {*only, 1};
  float pmf = 1;
  const std::int32_t child = choose_child(nodes_[0], root, u, pmf);
  return sample_below(child, point, u, pmf);
}

// Chooses a child of a node by u, which becomes uniform again, and multiplies pmf by its probability. 0 if
// none contributes.
std::int32_t LightTree::choose_child(const Node& node, const Weights& weights, double& u, float& pmf) {
  if (!(weights.sum() > 0)) {
    pmf = 0;
    return 0;
  }
  const double target = std::min(u, kBelowOne) * weights.sum();
  std::size_t lane = 0;  // the first whose sum exceeds the target, so its weight is never 0
  for (const double sum : weights.sums) lane += sum <= target ? 1 : 0;
  const double before = lane > 0 ? weights.sums[lane - 1] : 0;
  u = (target - before) / (weights.sums[lane] - before);
  pmf *= weights.share(lane);
  return node.children[lane];
}

// Goes on from a child of the root that was chosen with the probability pmf.
LightTree::Choice LightTree::sample_below(std::int32_t child, const LightSampleContext& point, double u,
                                          float pmf) const {
  while (child > 0) {
    const Node& node = nodes_[static_cast<std::size_t>(child)];
    child = choose_child(node, weigh(node, point), u, pmf);
  }
  return {static_cast<std::uint32_t>(~child), pmf};
}

LightTree::ChoicesInLanes LightTree::sample(const WeightsInLanes& roots, const LightSampleContexts& points,
                                            DoubleN u, unsigned asked) const {
  if (const auto only = only_light()) return {*only, 1.0f};
  const DoubleN target = smaller(u, DoubleN(kBelowOne)) * roots.sum_;
  DoubleN sum = 0.0, before = 0.0, upto = 1.0;
  FloatN weight = 0.0f;
  U32xN child = 0;
  for (std::size_t i = 0; i < kWidth && nodes_[0].children[i] != 0; ++i) {
    const FloatN of_child = load(roots.of_children_[i]);
    const DoubleN sum_before = sum;
    sum = sum + widened(of_child);
    const MaskN chosen = (target >= sum_before) & (target < sum);
    before = select(chosen, sum_before, before);
    upto = select(chosen, sum, upto);
    weight = select(chosen, of_child, weight);
    child = select(chosen, U32xN(static_cast<std::uint32_t>(nodes_[0].children[i])), child);
  }
  const MaskN none = child == U32xN(0);
  ChoicesInLanes choices{child ^ U32xN(~0u), select(none, 0.0f, to_float(widened(weight) / roots.sum_))};
  unsigned below = asked & ~highest_bits(child) & ~none.bits();
  if (below == 0) return choices;
  const WordLanes children(child);
  const DoubleLanes u_below((target - before) / (upto - before));
  const Vec3Lanes positions(points.position), normals(points.normal);
  WordLanes lights(choices.light);
  FloatLanes pmf(choices.pmf);
  for (; below != 0; below &= below - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(below));
    const Choice choice = sample_below(static_cast<std::int32_t>(children[lane]),
                                       {positions[lane], normals[lane]}, u_below[lane], pmf[lane]);
    lights.set(lane, choice.light);
    pmf.set(lane, choice.pmf);
  }
  return {lights.all(), pmf.all()};
}

float LightTree::pmf(const Weights& root, const LightSampleContext& point, std::uint32_t light) const {
  if (!contains(light)) return 0;
  if (only_light()) return 1;
  float pmf = 1;
  std::uint32_t at = leaves_[light];
  for (; at >= kWidth; at = nodes_[at / kWidth].parent) {
    const Weights weights = weigh(nodes_[at / kWidth], point);
    if (!(weights.sum() > 0)) return 0;
    pmf *= weights.share(at % kWidth);
  }
  return root.sum() > 0 ? pmf * root.share(at) : 0;
}

}  // namespace tessera::core::lights
