// SPDX-License-Identifier: Apache-2.0
// A participating medium as plain data, not yet validated. Materials name the media on the two sides of their
// surfaces (MediumInterface).
#pragma once

#include <string>

#include "core/math/rgb.hpp"
#include "core/math/transform.hpp"

namespace tessera::core {

// Of scattering, absorption and emission, also times a grid's values: sums and products of two fit a float.
inline constexpr float kMaxMediumCoefficient = 1e18f;

// Homogeneous, or with coefficients that grids multiply. With a grid, the medium fills the image of the unit
// cube under grid_to_world; without, it has no bounds but its surfaces.
struct MediumDescription {
  std::string name{};
  Rgb sigma_a{}, sigma_s{};  // coefficients of absorption and scattering, per unit of length in the world
  float scale = 1;           // multiplies both
  float g = 0;               // mean cosine of scattering (Henyey and Greenstein 1941), above -1 and below 1
  Rgb emission{};            // radiance; the medium emits sigma_a * emission per unit of length
  // Indices of the scene's grids, which multiply sigma_a, sigma_s and emission; -1 for none.
  int absorption_grid = -1, scattering_grid = -1, emission_grid = -1;
  Transform grid_to_world{};

  bool has_grid() const { return absorption_grid >= 0 || scattering_grid >= 0 || emission_grid >= 0; }
};

inline constexpr int kNoMedium = -1;  // vacuum

// The media on the sides of a surface, as indices of the scene's. `interior` is the side that the geometric
// normal points away from. If both are the same, a ray keeps its medium.
struct MediumInterface {
  int interior = kNoMedium, exterior = kNoMedium;

  bool changes_medium() const { return interior != exterior; }
  bool operator==(const MediumInterface&) const = default;
};

}  // namespace tessera::core
