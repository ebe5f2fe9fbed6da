// SPDX-License-Identifier: Apache-2.0
#include "core/materials/directional_albedo.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/materials/fresnel.hpp"
#include "core/materials/microfacet.hpp"
#include "core/math/lane_array.hpp"
#include "core/math/simd_double.hpp"
#include "core/math/table_interpolation.hpp"

namespace tessera::core {
namespace {

// (eta - 1) / (eta + 1) for the largest index, 10.
constexpr float kMaxContrast = 9.0f / 11;

// The place of a node on its axis, from 0 to 1.
float place_of(std::size_t node, std::size_t nodes) {
  return static_cast<float>(node) / static_cast<float>(nodes - 1);
}

template <typename T>
T place_of_index(T eta) {
  using std::sqrt;
  const T thicker = select(eta < 1, 1 / eta, eta);
  return sqrt((thicker - 1) / (thicker + 1) / kMaxContrast);
}

float index_at(std::size_t node, std::size_t nodes) {
  const float place = place_of(node, nodes), contrast = kMaxContrast * place * place;
  return (1 + contrast) / (1 - contrast);
}

// The cosine at a node; never 0, which no surface is seen at.
float cosine_at(std::size_t node, std::size_t nodes) {
  const float root = place_of(node, nodes);
  return std::max(1e-4f, root * root);
}

// A point of the unit square with its share of the integral.
struct Node {
  Vec2 u;
  float share;
};

// Nodes for sample_visible(), which maps the square to a disk by rings (sample_disk). The rings narrow
// towards the edge, whose steep facets throw light into each other. Half of the disk is enough: wo lies in
// the plane of x and z.
std::vector<Node> disk_nodes() {
  constexpr int kRings = 28, kSteps = 5;  // steps along a quarter of a ring
  std::vector<Node> nodes;
  const auto add = [&](float a, float b, float share) {
    nodes.push_back({{(a + 1) / 2, (b + 1) / 2}, share});
  };
  for (int ring = 0; ring < kRings; ++ring) {
    const float z = 1 - (static_cast<float>(ring) + 0.5f) / kRings, radius = std::sqrt(1 - z * z);
    const float share = 2 * z / (kRings * 2 * kSteps);  // its sum over all rings is 1
    for (int step = 0; step < kSteps; ++step) {
      const float along = (static_cast<float>(step) + 0.5f) / kSteps;
      add(radius, radius * (2 * along - 1), share);
      add(radius * along, radius, share / 2);
      add(radius * along, -radius, share / 2);
    }
  }
  return nodes;
}

// Nodes for Microfacets::sample_visible(), whose slopes along and across the plane of wo are independent.
// Half of those across are enough. Their steps narrow towards the steepest slopes.
std::vector<Node> slope_nodes() {
  constexpr int kAlong = 32, kAcross = 12;
  std::vector<Node> nodes;
  for (int along = 0; along < kAlong; ++along) {
    const float t = (static_cast<float>(along) + 0.5f) / kAlong;
    const float share = 6 * t * (1 - t) / kAlong;  // the derivative of the place
    for (int across = 0; across < kAcross; ++across)
      nodes.push_back({{t * t * (3 - 2 * t), 0.5f + (static_cast<float>(across) + 0.5f) / (2 * kAcross)},
                       share / kAcross});
  }
  return nodes;
}

// A node in each lane. Those that fill up the last lanes have no share.
struct NodeLanes {
  Vec2Of<FloatN> u;
  FloatLanes shares;
};
std::vector<NodeLanes> in_lanes(const std::vector<Node>& nodes) {
  std::vector<NodeLanes> all;
  for (std::size_t first = 0; first < nodes.size(); first += kLaneCount) {
    FloatLanes x, y, shares;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      const bool fills_up = first + lane >= nodes.size();
      const Node& node = nodes[fills_up ? first : first + lane];
      x.set(lane, node.u.x), y.set(lane, node.u.y), shares.set(lane, fills_up ? 0 : node.share);
    }
    all.push_back({{x.all(), y.all()}, shares});
  }
  return all;
}

using GgxLanes = GgxOf<FloatN>;
using MicrofacetsLanes = MicrofacetsOf<FloatN>;

const std::vector<NodeLanes>& nodes_for(const GgxLanes&) {
  static const std::vector<NodeLanes> nodes = in_lanes(disk_nodes());
  return nodes;
}
const std::vector<NodeLanes>& nodes_for(const MicrofacetsLanes& facets) {
  static const std::vector<NodeLanes> slopes = in_lanes(slope_nodes());
  return facets.kind().distribution == MicrofacetDistribution::kGgx ? nodes_for(GgxLanes()) : slopes;
}

// G2 / G1, by the cosines to the normal.
FloatN unmasked_share(const GgxLanes& facets, FloatN cos_o, FloatN cos_i) {
  return 4 * cos_i * cos_o * facets.smith_visibility(cos_o, cos_i) / facets.visible(cos_o);
}
FloatN unmasked_share(const MicrofacetsLanes& facets, FloatN cos_o, FloatN cos_i) {
  const Vec3Of<FloatN> wo = at_cosine(cos_o), wi = at_cosine(cos_i);
  return 4 * cos_i * cos_o * facets.smith_visibility(wo, wi) / facets.visible(wo);
}

// The light that microfacet normals add, one in each lane, of those visible.
template <typename Facets>
class FacetLanes {
 public:
  FacetLanes(const Facets& facets, Vec3Of<FloatN> wo, Vec2Of<FloatN> u)
      : facets_(facets),
        wo_(wo),
        h_(facets.sample_visible(wo, u)),
        cos_oh_(larger(FloatN(0.0f), dot(wo, h_))) {
    const Vec3Of<FloatN> wi = reflect<FloatN>(wo_, h_);
    reflection_ = select(wi.z > 0, unmasked(wi.z), FloatN(0.0f));
  }

  FloatN reflection() const { return reflection_; }
  FloatN reflected(FloatN eta) const { return fresnel_dielectric<FloatN>(cos_oh_, eta) * reflection_; }
  FloatN transmitted(FloatN eta) const {
    const auto [found, wi] = refracted(wo_, h_, eta);
    return select(found & (wi.z < 0), (1 - fresnel_dielectric<FloatN>(cos_oh_, eta)) * unmasked(-wi.z),
                  FloatN(0.0f));
  }

 private:
  FloatN unmasked(FloatN cos_i) const { return unmasked_share(facets_, wo_.z, cos_i); }

  const Facets& facets_;
  Vec3Of<FloatN> wo_, h_;
  FloatN cos_oh_, reflection_;
};

// The lanes in order, as if there were one.
void add_shares(float& sum, FloatN values, const FloatLanes& shares) {
  const FloatLanes each(values);
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) sum += each[lane] * shares[lane];
}

}  // namespace

float single_reflection(MicrofacetKind kind, float alpha, float cos_o, float eta) {
  const MicrofacetsLanes facets(kind, alpha);
  const Vec3Of<FloatN> wo = at_cosine<FloatN>(cos_o);
  float sum = 0;
  for (const auto& [u, shares] : nodes_for(facets))
    add_shares(sum, FacetLanes(facets, wo, u).reflected(eta), shares);
  return sum;
}

const DirectionalAlbedo& DirectionalAlbedo::tables(MicrofacetKind kind) {
  using enum MicrofacetDistribution;
  using enum SmithMasking;
  if (kind.is_correlated_ggx()) {
    static const DirectionalAlbedo correlated_ggx{MicrofacetKind{}};
    return correlated_ggx;
  }
  if (kind.distribution == kGgx) {
    static const DirectionalAlbedo separable_ggx{MicrofacetKind{kGgx, kSeparable}};
    return separable_ggx;
  }
  if (kind.masking == kCorrelated) {
    static const DirectionalAlbedo correlated_beckmann{MicrofacetKind{kBeckmann, kCorrelated}};
    return correlated_beckmann;
  }
  static const DirectionalAlbedo separable_beckmann{MicrofacetKind{kBeckmann, kSeparable}};
  return separable_beckmann;
}

DirectionalAlbedo::DirectionalAlbedo(MicrofacetKind kind) {
  for (std::size_t cosine = 0; cosine < kCosines; ++cosine) {
    fill_smooth(cosine);
    for (std::size_t roughness = 1; roughness < kRoughnesses; ++roughness) {
      const float root_alpha = place_of(roughness, kRoughnesses), alpha = root_alpha * root_alpha;
      if (kind.is_correlated_ggx())
        integrate(GgxLanes(alpha), roughness, cosine);
      else
        integrate(MicrofacetsLanes(kind, alpha), roughness, cosine);
    }
  }
  for (std::size_t roughness = 0; roughness < kRoughnesses; ++roughness)
    for (std::size_t index = 0; index < kIndices; ++index) integrate_means(roughness, index);
}

void DirectionalAlbedo::fill_smooth(std::size_t cosine) {
  reflecting_[0][cosine] = 1;
  for (std::size_t index = 0; index < kIndices; ++index) {
    reflected_[index][0][cosine] = fresnel_dielectric(cosine_at(cosine, kCosines), index_at(index, kIndices));
    scattered_[0][index][0][cosine] = scattered_[1][index][0][cosine] = 1;
  }
}

template <typename Facets>
void DirectionalAlbedo::integrate(const Facets& facets, std::size_t roughness, std::size_t cosine) {
  const FloatN cos_o = cosine_at(cosine, kCosines);
  const Vec3Of<FloatN> wo = at_cosine(cos_o);
  for (const auto& [u, shares] : nodes_for(facets)) {
    const FacetLanes<Facets> facet(facets, wo, u);
    add_shares(reflecting_[roughness][cosine], facet.reflection(), shares);
    for (std::size_t index = 0; index < kIndices; ++index) {
      const FloatN eta = index_at(index, kIndices);
      const FloatN reflected = facet.reflected(eta);
      add_shares(reflected_[index][roughness][cosine], reflected, shares);
      add_shares(scattered_[0][index][roughness][cosine], reflected + facet.transmitted(eta), shares);
      add_shares(scattered_[1][index][roughness][cosine],
                 facet.reflected(1 / eta) + facet.transmitted(1 / eta), shares);
    }
  }
}

void DirectionalAlbedo::integrate_means(std::size_t roughness, std::size_t index) {
  constexpr int kSteps = 256;
  const float row = place_of(roughness, kRoughnesses);
  double sum = 0, inside = 0;
  for (int i = 0; i < kSteps; ++i) {
    const float cos_o = std::sqrt((static_cast<float>(i) + 0.5f) / kSteps);  // uniform in its square
    const auto at = [&](const Plane& plane) {
      return interpolated<kRoughnesses, kCosines>(plane[0].data(), row, std::sqrt(cos_o));
    };
    sum += static_cast<double>(at(scattered_[0][index]) - at(reflected_[index]));
    inside += static_cast<double>(at(scattered_[1][index]));
  }
  mean_transmitted_[roughness][index] = static_cast<float>(sum / kSteps);
  mean_scattered_inside_[roughness][index] = static_cast<float>(inside / kSteps);
}

template <typename T>
T DirectionalAlbedo::between_planes(const float* planes, WordOf<T> first, T cos_o, T alpha, T eta) {
  using std::sqrt;
  constexpr std::uint32_t kPlane = kRoughnesses * kCosines;
  const TablePlace<T> index(place_of_index(eta), kIndices);
  const T row = sqrt(alpha), column = sqrt(cos_o);
  const WordOf<T> lower = first + index.low * WordOf<T>(kPlane);
  const auto in_plane = [&](WordOf<T> plane) {
    return interpolated<kRoughnesses, kCosines>(planes, row, column, plane);
  };
  return index.mix(in_plane(lower), in_plane(lower + WordOf<T>(kPlane)));
}

template <typename T>
T DirectionalAlbedo::reflecting(std::type_identity_t<T> cos_o, std::type_identity_t<T> alpha) const {
  using std::sqrt;
  return interpolated<kRoughnesses, kCosines>(reflecting_[0].data(), T(sqrt(alpha)), T(sqrt(cos_o)));
}

template <typename T>
T DirectionalAlbedo::reflected(std::type_identity_t<T> cos_o, std::type_identity_t<T> alpha,
                               std::type_identity_t<T> eta) const {
  return between_planes<T>(reflected_[0][0].data(), WordOf<T>(0), cos_o, alpha, eta);
}

template <typename T>
T DirectionalAlbedo::scattered(std::type_identity_t<T> cos_o, std::type_identity_t<T> alpha,
                               std::type_identity_t<T> eta) const {
  const WordOf<T> first = select(eta < 1, WordOf<T>(kIndices * kRoughnesses * kCosines), WordOf<T>(0));
  return between_planes<T>(scattered_[0][0][0].data(), first, cos_o, alpha, eta);
}

template <typename T>
T DirectionalAlbedo::mean_transmitted(std::type_identity_t<T> alpha, std::type_identity_t<T> eta) const {
  using std::sqrt;
  return interpolated<kRoughnesses, kIndices>(mean_transmitted_[0].data(), T(sqrt(alpha)),
                                              place_of_index<T>(eta));
}

template <typename T>
T DirectionalAlbedo::mean_scattered_inside(std::type_identity_t<T> alpha, std::type_identity_t<T> eta) const {
  using std::sqrt;
  return interpolated<kRoughnesses, kIndices>(mean_scattered_inside_[0].data(), T(sqrt(alpha)),
                                              place_of_index<T>(eta));
}

template float DirectionalAlbedo::reflecting<float>(float, float) const;
template FloatN DirectionalAlbedo::reflecting<FloatN>(FloatN, FloatN) const;
template float DirectionalAlbedo::reflected<float>(float, float, float) const;
template FloatN DirectionalAlbedo::reflected<FloatN>(FloatN, FloatN, FloatN) const;
template float DirectionalAlbedo::scattered<float>(float, float, float) const;
template FloatN DirectionalAlbedo::scattered<FloatN>(FloatN, FloatN, FloatN) const;
template float DirectionalAlbedo::mean_transmitted<float>(float, float) const;
template FloatN DirectionalAlbedo::mean_transmitted<FloatN>(FloatN, FloatN) const;
template float DirectionalAlbedo::mean_scattered_inside<float>(float, float) const;
template FloatN DirectionalAlbedo::mean_scattered_inside<FloatN>(FloatN, FloatN) const;

}  // namespace tessera::core
