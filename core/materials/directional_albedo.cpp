// SPDX-License-Identifier: Apache-2.0
#include "core/materials/directional_albedo.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/materials/fresnel.hpp"
#include "core/materials/microfacet.hpp"

namespace tessera::core {
namespace {

// (eta - 1) / (eta + 1) for the largest index, 10.
constexpr float kMaxContrast = 9.0f / 11;

// The place of a node on its axis, from 0 to 1.
float place_of(std::size_t node, std::size_t nodes) {
  return static_cast<float>(node) / static_cast<float>(nodes - 1);
}

// A place between two nodes of a table's axis.
struct Between {
  // `place` runs from 0 to 1 over all nodes.
  Between(float place, std::size_t nodes) {
    const float scaled = std::clamp(place, 0.0f, 1.0f) * static_cast<float>(nodes - 1);
    low = std::min(static_cast<std::size_t>(scaled), nodes - 2);
    share = scaled - static_cast<float>(low);
  }

  float mix(float at_low, float at_high) const { return at_low + share * (at_high - at_low); }

  std::size_t low;
  float share;
};

template <typename Plane>
float look_up(const Plane& plane, const Between& roughness, const Between& cosine) {
  const auto along_cosine = [&](std::size_t row) {
    return cosine.mix(plane[row][cosine.low], plane[row][cosine.low + 1]);
  };
  return roughness.mix(along_cosine(roughness.low), along_cosine(roughness.low + 1));
}

template <typename Planes>
float look_up(const Planes& planes, const Between& index, const Between& roughness, const Between& cosine) {
  return index.mix(look_up(planes[index.low], roughness, cosine),
                   look_up(planes[index.low + 1], roughness, cosine));
}

float place_of_index(float eta) {
  const float thicker = eta < 1 ? 1 / eta : eta;
  return std::sqrt((thicker - 1) / (thicker + 1) / kMaxContrast);
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

// The light that one microfacet normal adds, of those visible.
class Facet {
 public:
  Facet(const Ggx& ggx, Vec3 wo, Vec2 u)
      : ggx_(ggx), wo_(wo), h_(ggx.sample_visible(wo, u)), cos_oh_(std::max(0.0f, dot(wo, h_))) {
    const Vec3 wi = reflect(wo_, h_);
    reflection_ = wi.z > 0 ? unmasked(wi.z) : 0;
  }

  float reflection() const { return reflection_; }
  float reflected(float eta) const { return fresnel_dielectric(cos_oh_, eta) * reflection_; }
  float transmitted(float eta) const {
    const std::optional<Vec3> wi = refract(wo_, h_, eta);
    return wi && wi->z < 0 ? (1 - fresnel_dielectric(cos_oh_, eta)) * unmasked(-wi->z) : 0;
  }

 private:
  // G2 / G1.
  float unmasked(float cos_i) const {
    return 4 * cos_i * wo_.z * ggx_.smith_visibility(wo_.z, cos_i) / ggx_.visible(wo_.z);
  }

  const Ggx& ggx_;
  Vec3 wo_, h_;
  float cos_oh_, reflection_;
};

}  // namespace

const DirectionalAlbedo& DirectionalAlbedo::tables() {
  static const DirectionalAlbedo all;
  return all;
}

DirectionalAlbedo::DirectionalAlbedo() {
  for (std::size_t cosine = 0; cosine < kCosines; ++cosine) {
    fill_smooth(cosine);
    for (std::size_t roughness = 1; roughness < kRoughnesses; ++roughness) integrate(roughness, cosine);
  }
  for (std::size_t roughness = 0; roughness < kRoughnesses; ++roughness)
    for (std::size_t index = 0; index < kIndices; ++index)
      mean_transmitted_[roughness][index] = mean_transmitted(roughness, index);
}

void DirectionalAlbedo::fill_smooth(std::size_t cosine) {
  reflecting_[0][cosine] = 1;
  for (std::size_t index = 0; index < kIndices; ++index) {
    reflected_[index][0][cosine] = fresnel_dielectric(cosine_at(cosine, kCosines), index_at(index, kIndices));
    scattered_outside_[index][0][cosine] = scattered_inside_[index][0][cosine] = 1;
  }
}

void DirectionalAlbedo::integrate(std::size_t roughness, std::size_t cosine) {
  const float root_alpha = place_of(roughness, kRoughnesses), cos_o = cosine_at(cosine, kCosines);
  const Ggx ggx(root_alpha * root_alpha);
  const Vec3 wo{std::sqrt(1 - cos_o * cos_o), 0, cos_o};
  static const std::vector<Node> kNodes = disk_nodes();
  for (const auto& [u, share] : kNodes) {
    const Facet facet(ggx, wo, u);
    reflecting_[roughness][cosine] += facet.reflection() * share;
    for (std::size_t index = 0; index < kIndices; ++index) {
      const float eta = index_at(index, kIndices);
      const float reflected = facet.reflected(eta);
      reflected_[index][roughness][cosine] += reflected * share;
      scattered_outside_[index][roughness][cosine] += (reflected + facet.transmitted(eta)) * share;
      scattered_inside_[index][roughness][cosine] +=
          (facet.reflected(1 / eta) + facet.transmitted(1 / eta)) * share;
    }
  }
}

float DirectionalAlbedo::mean_transmitted(std::size_t roughness, std::size_t index) const {
  constexpr int kSteps = 256;
  const Between row(place_of(roughness, kRoughnesses), kRoughnesses);
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const float cos_o = std::sqrt((static_cast<float>(i) + 0.5f) / kSteps);  // uniform in its square
    const Between cosine(std::sqrt(cos_o), kCosines);
    sum += static_cast<double>(look_up(scattered_outside_[index], row, cosine) -
                               look_up(reflected_[index], row, cosine));
  }
  return static_cast<float>(sum / kSteps);
}

float DirectionalAlbedo::reflecting(float cos_o, float alpha) const {
  return look_up(reflecting_, Between(std::sqrt(alpha), kRoughnesses), Between(std::sqrt(cos_o), kCosines));
}

float DirectionalAlbedo::reflected(float cos_o, float alpha, float eta) const {
  return look_up(reflected_, Between(place_of_index(eta), kIndices), Between(std::sqrt(alpha), kRoughnesses),
                 Between(std::sqrt(cos_o), kCosines));
}

float DirectionalAlbedo::scattered(float cos_o, float alpha, float eta) const {
  return look_up(eta < 1 ? scattered_inside_ : scattered_outside_, Between(place_of_index(eta), kIndices),
                 Between(std::sqrt(alpha), kRoughnesses), Between(std::sqrt(cos_o), kCosines));
}

float DirectionalAlbedo::mean_transmitted(float alpha, float eta) const {
  return look_up(mean_transmitted_, Between(std::sqrt(alpha), kRoughnesses),
                 Between(place_of_index(eta), kIndices));
}

}  // namespace tessera::core
