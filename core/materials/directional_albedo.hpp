// SPDX-License-Identifier: Apache-2.0
// Directional albedos: the share of the light from everywhere that a surface of GGX microfacets scatters to
// a viewer, single scattering with exact Fresnel reflectance. Layers are attenuated by them, and what single
// scattering loses is compensated (Turquin 2019). Tables are computed by quadrature on first use, which takes
// some tens of milliseconds; thread-safe.
#pragma once

#include <array>
#include <cstddef>

namespace tessera::core {

class DirectionalAlbedo {
 public:
  static const DirectionalAlbedo& tables();

  // cos_o is the viewer's cosine, alpha GGX's roughness, both in [0, 1]. `eta` is the index of the far side
  // over the near side, in [1 / 10, 10].
  // Of facets that reflect all light.
  float reflecting(float cos_o, float alpha) const;
  // The reflection of a dielectric boundary, eta >= 1.
  float reflected(float cos_o, float alpha, float eta) const;
  // The reflection and transmission of a dielectric boundary.
  float scattered(float cos_o, float alpha, float eta) const;
  // What a boundary transmits of even light, eta >= 1: the mean of scattered - reflected, weighted by the
  // cosine.
  float mean_transmitted(float alpha, float eta) const;

 private:
  // Nodes: square root of the cosine, square root of alpha, and an index whose spacing narrows towards 1.
  static constexpr std::size_t kCosines = 16, kRoughnesses = 16, kIndices = 16;
  using Plane = std::array<std::array<float, kCosines>, kRoughnesses>;
  using Planes = std::array<Plane, kIndices>;

  DirectionalAlbedo();
  void fill_smooth(std::size_t cosine);
  void integrate(std::size_t roughness, std::size_t cosine);
  float mean_transmitted(std::size_t roughness, std::size_t index) const;

  Plane reflecting_{};
  Planes reflected_{}, scattered_outside_{}, scattered_inside_{};
  std::array<std::array<float, kIndices>, kRoughnesses> mean_transmitted_{};
};

}  // namespace tessera::core
