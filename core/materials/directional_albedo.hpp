// SPDX-License-Identifier: Apache-2.0
// Directional albedos: the share of the light from everywhere that a surface of microfacets scatters to a
// viewer, single scattering with exact Fresnel reflectance. Layers are attenuated by them, and what single
// scattering loses is compensated (Turquin 2019). Tables are computed by quadrature on first use, which takes
// some tens of milliseconds, or two hundred for Beckmann's distribution; thread-safe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/materials/microfacets.hpp"
#include "core/math/word_lanes.hpp"

namespace tessera::core {

// What isotropic microfacets reflect of the light from everywhere, by integration without the tables. Below
// the boundary, `eta` is less than 1.
float single_reflection(MicrofacetKind kind, float alpha, float cos_o, float eta);

class DirectionalAlbedo {
 public:
  // Of a kind of microfacets.
  static const DirectionalAlbedo& tables(MicrofacetKind kind = {});

  // cos_o is the viewer's cosine, alpha the microfacets' roughness, both in [0, 1]. `eta` is the index of the
  // far side over the near side, in [1 / 10, 10]. T is float for one point, or FloatN for one in each lane.
  // Of facets that reflect all light.
  template <typename T = float>
  T reflecting(std::type_identity_t<T> cos_o, std::type_identity_t<T> alpha) const;
  // The reflection of a dielectric boundary, eta >= 1.
  template <typename T = float>
  T reflected(std::type_identity_t<T> cos_o, std::type_identity_t<T> alpha,
              std::type_identity_t<T> eta) const;
  // The reflection and transmission of a dielectric boundary.
  template <typename T = float>
  T scattered(std::type_identity_t<T> cos_o, std::type_identity_t<T> alpha,
              std::type_identity_t<T> eta) const;
  // What a boundary transmits of even light, eta >= 1: the mean of scattered - reflected, weighted by the
  // cosine.
  template <typename T = float>
  T mean_transmitted(std::type_identity_t<T> alpha, std::type_identity_t<T> eta) const;
  // The mean of what a boundary scatters of even light from inside, eta >= 1, weighted by the cosine.
  template <typename T = float>
  T mean_scattered_inside(std::type_identity_t<T> alpha, std::type_identity_t<T> eta) const;

 private:
  // Nodes: square root of the cosine, square root of alpha, and an index whose spacing narrows towards 1.
  static constexpr std::uint32_t kCosines = 16, kRoughnesses = 16, kIndices = 16;
  using Plane = std::array<std::array<float, kCosines>, kRoughnesses>;
  using Planes = std::array<Plane, kIndices>;

  using Means = std::array<std::array<float, kIndices>, kRoughnesses>;

  explicit DirectionalAlbedo(MicrofacetKind kind);
  void fill_smooth(std::size_t cosine);
  template <typename Facets>
  void integrate(const Facets& facets, std::size_t roughness, std::size_t cosine);
  void integrate_means(std::size_t roughness, std::size_t index);
  // Between two planes of a table, which begins at planes[first] and has one for each index.
  template <typename T>
  static T between_planes(const float* planes, WordOf<T> first, T cos_o, T alpha, T eta);

  Plane reflecting_{};
  Planes reflected_{};
  std::array<Planes, 2> scattered_{};  // from outside and from inside
  Means mean_transmitted_{}, mean_scattered_inside_{};
};

}  // namespace tessera::core
