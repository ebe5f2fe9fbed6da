#include "core/lights/light_tree.hpp"

#include <algorithm>

#include "core/math/simd.hpp"

namespace tessera::core {
namespace {

constexpr double kBelowOne = 1 - 0x1p-53;

// Cosine and sine of an angle up to pi.
struct Angle {
  Float8 cosine, sine;

  static Angle of_cosine(Float8 cosine) { return {cosine, sqrt(max(0.0f, 1.0f - cosine * cosine))}; }
};

// The difference of two angles, or 0 where the second is larger.
Angle excess(const Angle& a, const Angle& b) {
  const Mask8 none = a.cosine >= b.cosine;
  return {select(none, 1.0f, a.cosine * b.cosine + a.sine * b.sine),
          select(none, 0.0f, a.sine * b.cosine - a.cosine * b.sine)};
}

Float8 load(const std::array<float, LightTree::kWidth>& lanes) {
  return Float8::load(lanes.data());
}

// Eight vectors.
struct Vec3x8 {
  Float8 x, y, z;
};
Vec3x8 load(const std::array<float, LightTree::kWidth> (&lanes)[3]) {
  return {load(lanes[0]), load(lanes[1]), load(lanes[2])};
}
Float8 dot(const Vec3x8& a, const Vec3x8& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Whether the tree is of a single light, which needs no weighing: lanes without a child hold 0.
bool leaf_alone(const auto& nodes) {
  return nodes.size() == 1 && nodes[0].children[1] == 0;
}

}  // namespace

// How much light each child may send to the point: of all places in its sphere and all normals in its cone,
// those that suit best (Conty Estevez and Kulla 2018, section 3.2). From within the sphere, nothing is ruled
// out.
LightTree::Weights LightTree::weigh(const Node& node, const LitPoint& point) {
  constexpr float kLeastDistance2 = 1e-30f;
  const Vec3x8 center = load(node.center);
  const Vec3x8 to_center{center.x - point.position.x, center.y - point.position.y,
                         center.z - point.position.z};
  const Vec3x8 normal{point.normal.x, point.normal.y, point.normal.z};
  const Float8 distance2 = max(dot(to_center, to_center), kLeastDistance2), radius2 = load(node.radius2);
  const Float8 per_distance = 1.0f / sqrt(distance2);
  const Mask8 inside = radius2 >= distance2;

  const Float8 sin2_of_sphere = min(radius2 * (per_distance * per_distance), 1.0f);
  const Angle sphere{sqrt(1.0f - sin2_of_sphere), sqrt(sin2_of_sphere)};
  const Angle cone{load(node.cos_o), load(node.sin_o)};

  const Float8 to_axis = -dot(to_center, load(node.axis)) * per_distance;
  const Angle from_axis = Angle::of_cosine(max(to_axis, to_axis * load(node.back)));
  const Float8 leaving = excess(excess(from_axis, cone), sphere).cosine;
  const Float8 sent = select(leaving >= load(node.cos_e), leaving, 0.0f);

  const Angle from_normal = Angle::of_cosine(dot(to_center, normal) * per_distance);
  const Float8 arriving = max(excess(from_normal, sphere).cosine, 0.0f);
  const Float8 received = select(Mask8(point.normal == Vec3{}), 1.0f, arriving);

  const Float8 facing = select(inside, 1.0f, sent * received);
  Weights weights;
  (load(node.intensity) / max(distance2, load(node.nearest2)) * facing).store(weights.lanes.data());
  double sum = 0;
  for (std::size_t lane = 0; lane < kWidth; ++lane)
    weights.sums[lane] = sum += static_cast<double>(weights.lanes[lane]);
  return weights;
}

LightTree::Choice LightTree::sample(const LitPoint& point, double u) const {
  if (leaf_alone(nodes_)) return {static_cast<std::uint32_t>(~nodes_[0].children[0]), 1};
  float pmf = 1;
  for (std::size_t at = 0;;) {
    const Weights weights = weigh(nodes_[at], point);
    if (!(weights.sum() > 0)) return {kNoLight, 0};
    const double sought = std::min(u, kBelowOne) * weights.sum();
    std::size_t lane = 0;  // the first whose sum exceeds what is sought: never one of weight 0
    for (const double sum : weights.sums) lane += sum <= sought ? 1 : 0;
    const double before = lane > 0 ? weights.sums[lane - 1] : 0;
    u = (sought - before) / (weights.sums[lane] - before);
    pmf *= weights.share(lane);
    const std::int32_t child = nodes_[at].children[lane];
    if (child < 0) return {static_cast<std::uint32_t>(~child), pmf};
    at = static_cast<std::size_t>(child);
  }
}

float LightTree::pmf(const LitPoint& point, std::uint32_t light) const {
  if (!contains(light)) return 0;
  if (leaf_alone(nodes_)) return 1;
  float pmf = 1;
  for (std::uint32_t at = leaves_[light];;) {
    const Node& node = nodes_[at / kWidth];
    const Weights weights = weigh(node, point);
    if (!(weights.sum() > 0)) return 0;
    pmf *= weights.share(at % kWidth);
    if (at < kWidth) return pmf;
    at = node.parent;
  }
}

double LightTree::irradiance(const LitPoint& point) const {
  return empty() ? 0 : weigh(nodes_[0], point).sum() * power_;
}

}  // namespace tessera::core
