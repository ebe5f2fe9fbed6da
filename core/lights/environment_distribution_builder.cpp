// SPDX-License-Identifier: Apache-2.0
// Builds an EnvironmentDistribution.
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "core/lights/environment_distribution.hpp"
#include "core/lights/normal_bins.hpp"
#include "core/math/elementary.hpp"
#include "core/math/lane_array.hpp"
#include "core/sampling/shares.hpp"

namespace tessera::core::lights {
namespace {

// Fraction of the samples that are uniform, so that a faint sky is sampled beside an arbitrarily bright
// sun.
constexpr double kUniformDirections = 0.1;
// Fraction of the samples that ignore the cosine, because normals within a bin differ.
constexpr double kAnyCosine = 0.05;
// A cell has high contrast if the density of a texel exceeds this multiple of the mean. Smaller variation
// is negligible beside the noise of shadows.
constexpr double kMaxUneven = 1.5;
// The weight of uniform cells when a light is chosen without MIS compensation: their light has little noise,
// so lamps and suns need more samples.
constexpr double kUniformCellWeight = 0.25;

// Sample positions along the sides of a cell and of a normal bin, and their weights (trapezoidal rule).
// Including the corners ensures that every partly visible cell has a positive weight.
constexpr std::array<float, 3> kAlong{0, 0.5f, 1}, kAlongWeights{0.25f, 0.5f, 0.25f};
constexpr std::size_t kPlaces = kAlong.size() * kAlong.size();
constexpr Vec2 place(std::size_t i) {
  return {kAlong[i % kAlong.size()], kAlong[i / kAlong.size()]};
}
constexpr float place_weight(std::size_t i) {
  return kAlongWeights[i % kAlong.size()] * kAlongWeights[i / kAlong.size()];
}

// The number of parts into which each of `count` is divided to give at least `least` in total.
int parts(int count, int least) {
  return (least + count - 1) / count;
}

// The distance of a row's start below the upper pole, on the unit sphere; computed from the sine of half
// the angle, which avoids cancellation near the pole.
double depth_of_row(int row, int rows) {
  const double half_sine =
      static_cast<double>(sin(kPi / 2 * static_cast<float>(row) / static_cast<float>(rows)));
  return 2 * half_sine * half_sine;
}

// The range between two rows, measured from the nearer pole.
struct Heights {
  Heights(int first, int end, int rows)
      : upper(first + end <= rows),
        begin(depth_of_row(upper ? first : rows - first, rows)),
        size(depth_of_row(upper ? end : rows - end, rows) - begin) {}

  bool upper;
  double begin, size;
};

template <std::size_t kCount>
std::array<std::int16_t, kCount + 1> shares_of(const double* weights, std::int16_t whole) {
  std::array<std::int16_t, kCount + 1> begins;
  sampling::cumulate_shares<std::int16_t>({weights, kCount}, whole, begins);
  return begins;
}

}  // namespace

class EnvironmentDistributionBuilder {
 public:
  // The grid consists of texels of the image or parts of them: at least one row for each band, and one
  // column for each sector.
  EnvironmentDistributionBuilder(int width, int height, const std::vector<double>& means,
                                 const EnvironmentDistribution::RadianceAt& radiance_at,
                                 const EquirectangularMap& map)
      : columns_per_texel_(parts(width, kSectors)),
        rows_per_texel_(parts(height, kBands)),
        image_width_(width),
        width_(width * columns_per_texel_),
        height_(height * rows_per_texel_),
        means_(means),
        radiance_at_(radiance_at),
        map_(map) {
    for (int row = 0; row < height_; ++row)
      solid_angles_.push_back(2 * std::numbers::pi / width_ * std::fabs(Heights(row, row + 1, height_).size));
  }

  EnvironmentDistribution build() {
    measure_light();
    if (made_.radiance_over_sphere_ == 0) return std::move(made_);
    add_grid();
    for (std::size_t cell = 0; cell < kCells; ++cell) add_cell(cell);
    for (std::uint32_t facing = 0; facing < kAllSides; ++facing) add_choices(cosines_of(facing));
    OfCells mean_cosine;
    mean_cosine.fill(kMeanCosine);
    add_choices(mean_cosine);
    made_.choices_.insert(made_.choices_.end(), compensated_.begin(), compensated_.end());
    return std::move(made_);
  }

 private:
  static constexpr int kBands = EnvironmentDistribution::kBands, kSectors = EnvironmentDistribution::kSectors;
  static constexpr std::size_t kCells = EnvironmentDistribution::kCells;
  static constexpr double kMeanCosine = 0.25;  // over the sphere; zero behind the surface
  using OfCells = std::array<double, kCells>;  // by band and sector
  using Patch = EnvironmentDistribution::PatchOf<float>;

  // A direction for each cell.
  class Directions {
   public:
    void set(std::size_t cell, Vec3 direction) {
      lanes_[cell / kLaneCount].set(cell % kLaneCount, direction);
    }
    // Those of the cells from `first` on, which begins a vector.
    Vec3Of<FloatN> from(std::size_t first) const { return lanes_[first / kLaneCount].all(); }

   private:
    std::array<Vec3Lanes, kCells / kLaneCount> lanes_{};
  };

  struct Bounds {
    int first_column, first_row, end_column, end_row;
  };
  Bounds bounds(std::size_t cell) const {
    const auto first = [](std::size_t part, int parts, int texels) {
      return static_cast<int>((static_cast<std::int64_t>(part) * texels + parts - 1) / parts);
    };
    const std::size_t band = cell / kSectors, sector = cell % kSectors;
    return {first(sector, kSectors, width_), first(band, kBands, height_),
            first(sector + 1, kSectors, width_), first(band + 1, kBands, height_)};
  }

  Patch patch(const Bounds& b) const {
    const double along_row = static_cast<double>(b.first_column) / width_;
    const double row_size = static_cast<double>(b.end_column - b.first_column) / width_;
    const Heights heights(b.first_row, b.end_row, height_);
    const double solid_angle = 2 * std::numbers::pi * row_size * std::fabs(heights.size);
    return {static_cast<float>(along_row),     static_cast<float>(row_size),
            static_cast<float>(heights.begin), static_cast<float>(heights.size),
            heights.upper ? 1.0f : -1.0f,      static_cast<float>(1 / solid_angle)};
  }
  Vec3 direction(const Patch& p, Vec2 place) const {
    return map_.direction(p.along_row + p.row_size * place.x, p.depth + p.depth_size * place.y, p.side);
  }

  // Calls function(mean radiance, solid angle, column, row) for each texel of the grid in these bounds.
  template <typename Function>
  void for_each(const Bounds& b, Function function) const {
    for (int row = b.first_row; row < b.end_row; ++row) {
      const double* texels = means_.data() + static_cast<std::size_t>(row / rows_per_texel_) *
                                                 static_cast<std::size_t>(image_width_);
      const double solid_angle = solid_angles_[static_cast<std::size_t>(row)];
      for (int column = b.first_column; column < b.end_column; ++column)
        function(texels[columns_per_texel_ == 1 ? column : column / columns_per_texel_], solid_angle, column,
                 row);
    }
  }

  void add_grid() {
    made_.width_ = width_;
    made_.height_ = height_;
    for (int column = 0; column < width_; ++column)
      made_.sector_of_column_.push_back(static_cast<std::uint8_t>(std::int64_t{column} * kSectors / width_));
    for (int row = 0; row < height_; ++row)
      made_.band_of_row_.push_back(static_cast<std::uint8_t>(std::int64_t{row} * kBands / height_));
  }

  void measure_light() {
    double over_sphere = 0, lit = 0;
    for_each({0, 0, width_, height_}, [&](double radiance, double solid_angle, int, int) {
      over_sphere += radiance * solid_angle;
      if (radiance > 0) lit += solid_angle;
    });
    assert(over_sphere >= 0 && std::isfinite(over_sphere));
    made_.radiance_over_sphere_ = over_sphere;
    density_per_radiance_ = (1 - kUniformDirections) / over_sphere;
    least_density_ = kUniformDirections / lit;
  }

  // Per solid angle, without the cosine.
  double lit_density(double radiance) const { return radiance * density_per_radiance_ + least_density_; }
  double density(double radiance) const { return radiance > 0 ? lit_density(radiance) : 0; }

  void add_cell(std::size_t index) {
    const Bounds within = bounds(index);
    double& solid_angle = cell_solid_angle_[index];
    double highest = 0;
    Bounds brightest = within;
    for_each(within, [&](double radiance, double angle, int column, int row) {
      const double here = density(radiance);
      solid_angle += angle;
      light_[index] += radiance * angle;
      probability_[index] += here * angle;
      if (here > highest) highest = here, brightest = {column, row, column + 1, row + 1};
    });
    made_.cells_.push_back({.patch = patch(within)});
    EnvironmentDistribution::Cell& cell = made_.cells_.back();
    for (std::size_t i = 0; i < kPlaces; ++i) directions_[i].set(index, direction(cell.patch, place(i)));
    if (highest * solid_angle <= kMaxUneven * probability_[index]) return;
    brightest_.set(index, direction(patch(brightest), {0.5f, 0.5f}));
    cell.uneven = static_cast<std::int32_t>(made_.texels_.size());
    made_.texels_.push_back({within.first_column, within.first_row, texels(within)});
  }

  // The radiance values at the corners between which the image is interpolated in and around a texel. At
  // the cell's edge it is the maximum from there to the edge, since light of a sun beyond the edge leaks in
  // by interpolation and the density does not.
  double radiance_around(const Bounds& within, int column, int row) const {
    const auto span = [](int texel, int first, int end) {
      return std::pair{static_cast<float>(texel) + (texel == first ? 0.0f : 0.5f),
                       static_cast<float>(texel) + (texel + 1 == end ? 1.0f : 0.5f)};
    };
    const auto [left, right] = span(column, within.first_column, within.end_column);
    const auto [top, bottom] = span(row, within.first_row, within.end_row);
    constexpr double kMax =
        std::numeric_limits<float>::max();  // larger values might be interpolated to infinity
    double most = 0;
    for (float along = left; along <= right; along += 0.5f)
      for (float down = top; down <= bottom; down += 0.5f)
        most = std::max(
            most, radiance_at_({along / static_cast<float>(width_), 1 - down / static_cast<float>(height_)}));
    return std::min(most, kMax);
  }

  // Texels that are not entirely black get positive weight, so that the density is positive wherever there
  // is light.
  sampling::BilinearDistribution texels(const Bounds& within) const {
    std::vector<double> weights;
    for_each(within, [&](double mean, double angle, int column, int row) {
      weights.push_back(mean > 0 ? lit_density(radiance_around(within, column, row)) * angle : 0);
    });
    return {within.end_column - within.first_column, within.end_row - within.first_row, weights};
  }

  // Cosines for a normal bin, averaged over its normals and over each cell; for a high-contrast cell, half
  // of the weight is at its brightest position.
  OfCells cosines_of(std::uint32_t facing) const {
    OfCells cosines{};
    for (std::size_t n = 0; n < kPlaces; ++n) {
      const auto normal = broadcast<FloatN>(bin_normal(facing, place(n)));
      const auto cosine = [normal](Vec3Of<FloatN> direction) {
        return larger(FloatN(0.0f), dot(normal, direction));
      };
      for (std::size_t first = 0; first < kCells; first += kLaneCount) {
        FloatN mean = 0.0f;
        for (std::size_t i = 0; i < kPlaces; ++i)
          mean = mean + place_weight(i) * cosine(directions_[i].from(first));
        const FloatN with_brightest = 0.5f * (mean + cosine(brightest_.from(first)));
        const FloatLanes values(place_weight(n) * select(uneven(first), with_brightest, mean));
        for (std::size_t lane = 0; lane < kLaneCount; ++lane)
          cosines[first + lane] += static_cast<double>(values[lane]);
      }
    }
    return cosines;
  }
  // Of the cells from `first` on.
  MaskN uneven(std::size_t first) const {
    unsigned bits = 0;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane)
      bits |= (made_.cells_[first + lane].uneven != EnvironmentDistribution::kEven ? 1u : 0u) << lane;
    return MaskN::from_bits(bits);
  }

  // Adds the tables for a normal bin.
  void add_choices(const OfCells& cosines) {
    made_.choices_.push_back(choice(probability_, cosines));
    OfCells excess = excess_over(compensation_level(cosines));
    const double sum = std::accumulate(excess.begin(), excess.end(), 0.0);
    for (double& of_cell : excess) of_cell /= sum;
    compensated_.push_back(choice(excess, cosines));
    made_.importance_.push_back(importance(cosines));
  }

  static double sum_of_products(const OfCells& a, const OfCells& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
  }

  // The light of each cell that exceeds a uniform environment of this radiance.
  OfCells excess_over(double level) const {
    OfCells excess;
    for (std::size_t cell = 0; cell < kCells; ++cell)
      excess[cell] = std::max(0.0, light_[cell] - level * cell_solid_angle_[cell]);
    return excess;
  }

  // The level of EnvironmentDistribution's compensated tables: that with as much irradiance above it as
  // fills the hemisphere up to it. Newton's method from 0: the excess is convex in the level, so levels
  // rise, and the set of brighter cells shrinks until it contains the solution. Lower than the brightest
  // visible cell.
  double compensation_level(const OfCells& cosines) const {
    const double hemisphere = sum_of_products(cosines, cell_solid_angle_);
    double level = 0;
    for (std::size_t step = 0; step < kCells; ++step) {
      double irradiance = 0, measure = hemisphere;
      for (std::size_t cell = 0; cell < kCells; ++cell) {
        if (!(light_[cell] > level * cell_solid_angle_[cell])) continue;
        irradiance += cosines[cell] * light_[cell];
        measure += cosines[cell] * cell_solid_angle_[cell];
      }
      const double next = irradiance / measure;
      if (!(next > level)) break;
      level = next;
    }
    return level;
  }

  EnvironmentDistribution::Importance importance(const OfCells& cosines) const {
    const double mean = sum_of_products(cosines, light_) / sum_of_products(cosines, cell_solid_angle_);
    const OfCells excess = excess_over(mean);
    EnvironmentDistribution::Importance sums;
    for (std::size_t cell = 0; cell < kCells; ++cell) {
      const bool even = made_.cells_[cell].uneven == EnvironmentDistribution::kEven;
      const double cosine = (1 - kAnyCosine) * cosines[cell] + kAnyCosine * kMeanCosine;
      sums.uncompensated += (even ? kUniformCellWeight : 1) * cosine * light_[cell];
      sums.total += cosine * light_[cell];
      sums.excess += cosine * excess[cell];
    }
    return sums;
  }

  // The table in proportion to probability times cosine; the probabilities sum to 1.
  static EnvironmentDistribution::Choice choice(const OfCells& probability, const OfCells& cosines) {
    const double reflected = sum_of_products(cosines, probability);
    OfCells weights;
    for (std::size_t cell = 0; cell < kCells; ++cell) {
      const double share = reflected > 0 ? cosines[cell] / reflected : 1;
      weights[cell] = probability[cell] * ((1 - kAnyCosine) * share + kAnyCosine);
    }
    std::array<double, kBands> of_bands;
    EnvironmentDistribution::Choice made;
    for (std::size_t band = 0; band < kBands; ++band) {
      const double* of_sectors = weights.data() + band * kSectors;
      of_bands[band] = std::accumulate(of_sectors, of_sectors + kSectors, 0.0);
      made.sectors[band] = shares_of<kSectors>(of_sectors, EnvironmentDistribution::kWhole);
    }
    made.bands = shares_of<kBands>(of_bands.data(), EnvironmentDistribution::kWhole);
    return made;
  }

  const int columns_per_texel_, rows_per_texel_, image_width_, width_, height_;
  const std::vector<double>& means_;
  const EnvironmentDistribution::RadianceAt& radiance_at_;
  const EquirectangularMap& map_;
  std::vector<double> solid_angles_;  // of a texel in each row
  double density_per_radiance_ = 0, least_density_ = 0;
  OfCells cell_solid_angle_{};
  OfCells light_{}, probability_{};  // integrals over the cell's solid angle: radiance, density
  std::array<Directions, kPlaces> directions_{};
  Directions brightest_{};
  std::vector<EnvironmentDistribution::Choice> compensated_;  // by facing
  EnvironmentDistribution made_;
};

EnvironmentDistribution EnvironmentDistribution::build(int width, int height,
                                                       const std::vector<double>& means,
                                                       const RadianceAt& radiance_at,
                                                       const EquirectangularMap& map) {
  return EnvironmentDistributionBuilder(width, height, means, radiance_at, map).build();
}

}  // namespace tessera::core::lights
