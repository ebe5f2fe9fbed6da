// SPDX-License-Identifier: Apache-2.0
// Which way to look for light that comes from all around: in proportion to the radiance times the cosine that
// it arrives under, which depends on the way that the lit surface faces. Immutable.
//
// The sphere of directions is cut into cells along the rows and columns of an equirectangular picture. For
// each way to face there is a table of what each cell sends, and all tables together fit into a near cache.
// Within a cell directions are even, and the picture's texels need not be looked at; but for cells that are
// uneven, such as the sun's, which have a distribution of their own, interpolated between texels as light is
// within the cell.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/lights/equirectangular.hpp"
#include "core/math/simd_integer.hpp"
#include "core/sampling/bilinear_distribution.hpp"

namespace tessera::core {

class EnvironmentDistribution {
 public:
  // The mean of the channels at (u, v) of the picture; finite and not negative.
  using RadianceAt = std::function<double(Vec2 uv)>;
  // `means`: of that over each texel, row by row from the upper edge. Of an environment that is black there is
  // nothing but radiance_over_sphere().
  static EnvironmentDistribution build(int width, int height, const std::vector<double>& means,
                                       const RadianceAt& radiance_at, const EquirectangularMap& map);

  // A direction, by its place in the picture (EquirectangularMap::direction).
  template <typename T>
  struct PlaceOf {
    T along_row, depth, side;
    T pdf;  // per solid angle
  };
  // By normal_bin() of the surface; u in [0, 1). Nine times in ten in proportion to the radiance, else to
  // anything that shines alike, and both times the cosine; but one time in twenty without it. So wherever
  // there is light there is a density.
  PlaceOf<float> sample(std::uint32_t facing, Vec2 u) const;
  PlaceOf<Float8> sample(U32x8 facings, Vec2Of<Float8> u) const;

  // Of the direction that falls on (u, v) of the picture.
  float pdf(std::uint32_t facing, Vec2 uv) const;
  Float8 pdf(U32x8 facings, Vec2Of<Float8> uv) const;

  // All radiance, integrated over solid angle.
  double radiance_over_sphere() const { return radiance_over_sphere_; }
  // kFacings numbers: the irradiance that lights are sampled for, shadows apart: what is uneven, and a
  // quarter of the rest, which rays that are scattered find as well. For all sides at once: of a surface that
  // half of a uniform environment sends.
  const std::vector<double>& importance_by_normal() const { return sought_; }

 private:
  friend class EnvironmentDistributionBuilder;

  static constexpr int kBands = 16, kSectors = 32;
  static constexpr std::size_t kCells = std::size_t{kBands} * kSectors;

  // Of a whole: where each share begins, and where the last one ends.
  template <std::size_t kCount>
  using Shares = std::array<std::int16_t, kCount + 1>;
  struct Choice {
    Shares<kBands> bands;
    std::array<Shares<kSectors>, kBands> sectors;  // of each band
  };
  static constexpr std::int16_t kWhole = 1 << 14;

  // What lies between two rows and two columns, as in PlaceOf; or several of these.
  template <typename T>
  struct PatchOf {
    T along_row, row_size, depth, depth_size, side;
    T per_solid_angle;  // one over that of the patch

    PlaceOf<T> at(Vec2Of<T> within, T chance) const {
      return {along_row + row_size * within.x, depth + depth_size * within.y, side, chance * per_solid_angle};
    }
  };
  static constexpr std::int32_t kEven = -1;
  struct Cell {
    PatchOf<float> patch;
    std::int32_t uneven = kEven;  // else the number of its Texels
  };
  struct Texels {
    int first_column, first_row;
    BilinearDistribution distribution;
  };
  template <typename T>
  struct SharesOf;
  struct Chosen;
  class ChosenLanes;
  class PlaceLanes;

  EnvironmentDistribution() = default;
  Chosen chosen(std::uint32_t facing, std::size_t band, std::size_t sector) const;
  Chosen choose(std::uint32_t facing, std::uint32_t x, std::uint32_t y) const;
  PlaceOf<float> sample_texels(const Chosen& chosen, Vec2 u) const;
  float texels_per_solid_angle(float row) const;
  float pdf_at(std::uint32_t facing, Vec2 place) const;

  // Of the grid: the picture's columns and rows, or parts of them where they are fewer than sectors or bands.
  int width_ = 0, height_ = 0;
  std::vector<std::uint8_t> sector_of_column_, band_of_row_;
  std::vector<Cell> cells_;  // by band and sector
  std::vector<Texels> texels_;
  std::vector<Choice> choices_;  // by facing
  std::vector<double> sought_;   // by facing
  double radiance_over_sphere_ = 0;
};

}  // namespace tessera::core
