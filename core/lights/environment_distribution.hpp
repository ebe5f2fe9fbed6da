// SPDX-License-Identifier: Apache-2.0
// Importance sampling of environment light, in proportion to radiance times cosine, which depends on the
// surface normal. Immutable.
//
// There are two sets of tables, with and without MIS compensation. Compensated tables subtract a level from
// the radiance (Karlík et al. 2019). With one BSDF sample of density cosine / pi beside each light sample,
// the sum of both densities is best in proportion to radiance times cosine. The light samples' part of it is
// proportional to (radiance - level) * cosine where that is positive, and its integral is pi * level. An
// even sky is thus sampled as without compensation, and of a sky with a sun only the sun.
//
// The sphere of directions is divided into cells along the rows and columns of an equirectangular image.
// Each normal bin has a table of cell probabilities, and all tables together fit into a near cache. Within
// a cell the density is uniform and the image's texels are not read. Cells with high contrast, such as the
// sun's, have their own distribution, interpolated between texels as the radiance is.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/lights/equirectangular.hpp"
#include "core/lights/mis_compensation.hpp"
#include "core/lights/normal_bins.hpp"
#include "core/math/simd_integer.hpp"
#include "core/sampling/bilinear_distribution.hpp"

namespace tessera::core::lights {

class EnvironmentDistribution {
 public:
  // The mean of the channels at (u, v) of the image; finite and non-negative.
  using RadianceAt = std::function<double(Vec2 uv)>;
  // `means` holds the mean over each texel, row by row from the upper edge. For a black environment only
  // radiance_over_sphere() may be called.
  static EnvironmentDistribution build(int width, int height, const std::vector<double>& means,
                                       const RadianceAt& radiance_at, const EquirectangularMap& map);

  // A direction, as an image position (EquirectangularMap::direction).
  template <typename T>
  struct PlaceOf {
    T along_row, depth, side;
    T pdf;  // per solid angle
  };
  // The table for a surface's normal_bin().
  template <typename Word>
  static Word table_of(Word facing, MisCompensation compensation) {
    return compensation == MisCompensation::kOn ? facing + Word(kFacings) : facing;
  }
  // u is in [0, 1). Without compensation, nine tenths of the samples are in proportion to radiance, the
  // others uniform over the sphere, both times the cosine; the density is positive wherever there is light.
  // With it, there are none where the radiance is below the level. One sample in twenty ignores the cosine.
  PlaceOf<float> sample(std::uint32_t table, Vec2 u) const;
  PlaceOf<FloatN> sample(U32xN tables, Vec2Of<FloatN> u) const;

  // The density of the direction at (u, v) of the image.
  float pdf(std::uint32_t table, Vec2 uv) const;
  FloatN pdf(U32xN tables, Vec2Of<FloatN> uv) const;

  // Radiance integrated over the sphere.
  double radiance_over_sphere() const { return radiance_over_sphere_; }
  // Unoccluded irradiance that counts when choosing a light. For the bin of all sides, it is that of a
  // surface that receives half of a uniform environment.
  struct Importance {
    double uncompensated = 0;  // of high-contrast cells, and a quarter of the rest, which has little noise
    double total = 0;
    double excess = 0;  // of what is brighter than the mean radiance that the surface receives
  };
  // For each of kFacings bins.
  const std::vector<Importance>& importance_by_normal() const { return importance_; }

 private:
  friend class EnvironmentDistributionBuilder;

  static constexpr int kBands = 16, kSectors = 32;
  static constexpr std::size_t kCells = std::size_t{kBands} * kSectors;

  // The intervals of a discrete distribution: where each begins, and where the last one ends.
  template <std::size_t kCount>
  using Shares = std::array<std::int16_t, kCount + 1>;
  struct Choice {
    Shares<kBands> bands;
    std::array<Shares<kSectors>, kBands> sectors;  // for each band
  };
  static constexpr std::int16_t kWhole = 1 << 14;

  // The patch between two rows and two columns, as in PlaceOf; or several.
  template <typename T>
  struct PatchOf {
    T along_row, row_size, depth, depth_size, side;
    T per_solid_angle;  // 1 / solid angle of the patch

    PlaceOf<T> at(Vec2Of<T> within, T chance) const {
      return {along_row + row_size * within.x, depth + depth_size * within.y, side, chance * per_solid_angle};
    }
  };
  static constexpr std::int32_t kEven = -1;
  struct Cell {
    PatchOf<float> patch;
    std::int32_t uneven = kEven;  // kEven, or the index of its Texels
  };
  struct Texels {
    int first_column, first_row;
    sampling::BilinearDistribution distribution;
  };
  template <typename T>
  struct SharesOf;
  struct Chosen;
  class ChosenLanes;
  class PlaceLanes;

  EnvironmentDistribution() = default;
  Chosen chosen(std::uint32_t table, std::size_t band, std::size_t sector) const;
  Chosen choose(std::uint32_t table, std::uint32_t x, std::uint32_t y) const;
  PlaceOf<float> sample_texels(const Chosen& chosen, Vec2 u) const;
  float texels_per_solid_angle(float row) const;
  float pdf_at(std::uint32_t table, Vec2 place) const;

  // The grid's size: the image's columns and rows, subdivided if there are fewer than sectors or bands.
  int width_ = 0, height_ = 0;
  std::vector<std::uint8_t> sector_of_column_, band_of_row_;
  std::vector<Cell> cells_;  // by band and sector
  std::vector<Texels> texels_;
  std::vector<Choice> choices_;         // by table_of()
  std::vector<Importance> importance_;  // by facing
  double radiance_over_sphere_ = 0;
};

}  // namespace tessera::core::lights
