#include "core/lights/environment_distribution.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/math/lane_array.hpp"
#include "core/math/row_lookup.hpp"

namespace tessera::core {
namespace {

// Of the samples, over all that shines alike: a faint sky is found beside a sun brighter by any factor.
constexpr double kUniformDirections = 0.1;
// Of the samples, without regard to cosines: surfaces of one facing differ a little in what they see.
constexpr double kAnyCosine = 0.05;
// A cell is uneven if the density of a texel in it is above this times the mean. Less than that is little
// beside the noise of shadows.
constexpr double kMostUneven = 1.5;

// What light of even cells counts for when a light is chosen. A light's sample is of less use there than for
// lamps and suns, which no ray that is scattered finds.
constexpr double kFoundAnyway = 0.25;

constexpr float kWhole = 32767;  // of which a choice's shares are
constexpr float kJustBelowOne = 1 - 0x1p-24f;

// Places that stand for all of a cell, or of a facing's square.
constexpr std::array<Vec2, 4> kCellPlaces{Vec2{0.25f, 0.25f}, {0.75f, 0.25f}, {0.25f, 0.75f}, {0.75f, 0.75f}};
constexpr std::array<float, 3> kFacingPlaces{1.0f / 6, 0.5f, 5.0f / 6};

// Into how many parts each of `count` is to be cut to be at least `least` together.
int parts(int count, int least) {
  return (least + count - 1) / count;
}

// How far below the upper pole a row begins, on the unit sphere. By the sine of half the angle, which does
// not cancel near the pole.
double depth_of_row(int row, int rows) {
  const double half_sine =
      static_cast<double>(sin(kPi / 2 * static_cast<float>(row) / static_cast<float>(rows)));
  return 2 * half_sine * half_sine;
}

// What lies between two rows, seen from the nearer pole.
struct Heights {
  Heights(int first, int end, int rows)
      : upper(first + end <= rows),
        begin(depth_of_row(upper ? first : rows - first, rows)),
        size(depth_of_row(upper ? end : rows - end, rows) - begin) {}

  bool upper;
  double begin, size;
};

template <typename T>
WordOf<T> texel_along(T coordinate, int texels) {
  const auto count = static_cast<float>(texels);
  return to_word(larger(T(0.0f), smaller(coordinate * count, T(count - 1))));
}

// Everything of some weight gets one unit, and its share of the others. What is nothing has all at 0.
template <std::size_t kCount>
std::array<std::int16_t, kCount + 1> shares_of(const double* weights) {
  std::array<std::int16_t, kCount + 1> begins{};
  const double sum = std::accumulate(weights, weights + kCount, 0.0);
  if (!(sum > 0)) return begins;
  const auto with_weight = std::count_if(weights, weights + kCount, [](double w) { return w > 0; });
  const double shared = static_cast<double>(kWhole) - static_cast<double>(with_weight);
  double before = 0;
  int units = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    before += weights[i];
    units += weights[i] > 0 ? 1 : 0;
    begins[i + 1] = static_cast<std::int16_t>(static_cast<int>(before / sum * shared + 0.5) + units);
  }
  return begins;
}

// Which of the shares a number falls on, below the end of the last.
template <std::size_t kCount>
std::size_t share_at(const std::array<std::int16_t, kCount>& begins, std::uint32_t number) {
  std::uint32_t up_to = 0;
  for (std::size_t i = 0; i + 1 < kCount; i += 16)
    up_to += count_up_to(static_cast<std::int16_t>(number), begins.data() + i);
  return up_to - 1;
}

}  // namespace

// The picture's texels or parts of them: at least one row for each band, and one column for each sector.
class EnvironmentDistribution::Grid {
 public:
  Grid(int width, int height, const std::vector<double>& radiance)
      : columns_per_texel_(parts(width, kSectors)),
        rows_per_texel_(parts(height, kBands)),
        picture_width_(width),
        width_(width * columns_per_texel_),
        height_(height * rows_per_texel_),
        radiance_(radiance) {
    for (int row = 0; row < height_; ++row)
      solid_angles_.push_back(2 * std::numbers::pi / width_ * std::fabs(Heights(row, row + 1, height_).size));
    for_each(0, 0, width_, height_, [&](double texel_radiance, double solid_angle) {
      over_sphere_ += texel_radiance * solid_angle;
      if (texel_radiance > 0) lit_ += solid_angle;
    });
  }

  int width() const { return width_; }
  int height() const { return height_; }
  int first_row(std::size_t band) const { return (static_cast<int>(band) * height_ + kBands - 1) / kBands; }
  int first_column(std::size_t sector) const {
    return (static_cast<int>(sector) * width_ + kSectors - 1) / kSectors;
  }
  double radiance_over_sphere() const { return over_sphere_; }
  // Per solid angle, without regard to cosines.
  double density(double radiance) const {
    return radiance > 0 ? (1 - kUniformDirections) * radiance / over_sphere_ + kUniformDirections / lit_ : 0;
  }
  PatchOf<float> patch(int first_column, int first_row, int end_column, int end_row) const {
    const double along_row = static_cast<double>(first_column) / width_;
    const double row_size = static_cast<double>(end_column - first_column) / width_;
    const Heights heights(first_row, end_row, height_);
    const double solid_angle = 2 * std::numbers::pi * row_size * std::fabs(heights.size);
    return {static_cast<float>(along_row),     static_cast<float>(row_size),
            static_cast<float>(heights.begin), static_cast<float>(heights.size),
            heights.upper ? 1.0f : -1.0f,      static_cast<float>(1 / solid_angle)};
  }
  // Calls function(radiance, solid angle) for each texel between these columns and rows.
  template <typename Function>
  void for_each(int first_column, int first_row, int end_column, int end_row, Function function) const {
    for (int row = first_row; row < end_row; ++row)
      for (int column = first_column; column < end_column; ++column)
        function(radiance_[static_cast<std::size_t>(row / rows_per_texel_ * picture_width_ +
                                                    column / columns_per_texel_)],
                 solid_angles_[static_cast<std::size_t>(row)]);
  }

 private:
  int columns_per_texel_, rows_per_texel_, picture_width_, width_, height_;
  const std::vector<double>& radiance_;
  std::vector<double> solid_angles_;  // by row
  double over_sphere_ = 0, lit_ = 0;
};

// Of the cells, over their solid angles.
struct EnvironmentDistribution::CellSums {
  OfCells density{}, radiance{};
};

// A cell and its shares; or several.
template <typename T>
struct EnvironmentDistribution::ChosenOf {
  T band_begin, band_share, sector_begin, sector_share;
  PatchOf<T> patch;
  std::int32_t texels;  // as Cell has it; kEven for several

  T chance() const { return band_share * sector_share * (1 / (kWhole * kWhole)); }
  // Where numbers fall in the shares, in [0, 1).
  Vec2Of<T> within(Vec2Of<T> u) const {
    return {smaller((u.x * kWhole - sector_begin) / sector_share, T(kJustBelowOne)),
            smaller((u.y * kWhole - band_begin) / band_share, T(kJustBelowOne))};
  }
};

class EnvironmentDistribution::ChosenLanes {
 public:
  void set(std::size_t lane, const ChosenOf<float>& chosen) {
    band_begin_.set(lane, chosen.band_begin), band_share_.set(lane, chosen.band_share);
    sector_begin_.set(lane, chosen.sector_begin), sector_share_.set(lane, chosen.sector_share);
    along_row_.set(lane, chosen.patch.along_row), row_size_.set(lane, chosen.patch.row_size);
    depth_.set(lane, chosen.patch.depth), depth_size_.set(lane, chosen.patch.depth_size);
    side_.set(lane, chosen.patch.side), per_solid_angle_.set(lane, chosen.patch.per_solid_angle);
  }
  ChosenOf<Float8> all() const {
    return {band_begin_.all(),
            band_share_.all(),
            sector_begin_.all(),
            sector_share_.all(),
            {along_row_.all(), row_size_.all(), depth_.all(), depth_size_.all(), side_.all(),
             per_solid_angle_.all()},
            kEven};
  }

 private:
  FloatLanes band_begin_, band_share_, sector_begin_, sector_share_;
  FloatLanes along_row_, row_size_, depth_, depth_size_, side_, per_solid_angle_;
};

class EnvironmentDistribution::PlaceLanes {
 public:
  explicit PlaceLanes(const PlaceOf<Float8>& all)
      : along_row_(all.along_row), depth_(all.depth), side_(all.side), pdf_(all.pdf) {}
  void set(std::size_t lane, const PlaceOf<float>& place) {
    along_row_.set(lane, place.along_row), depth_.set(lane, place.depth);
    side_.set(lane, place.side), pdf_.set(lane, place.pdf);
  }
  PlaceOf<Float8> all() const { return {along_row_.all(), depth_.all(), side_.all(), pdf_.all()}; }

 private:
  FloatLanes along_row_, depth_, side_, pdf_;
};

EnvironmentDistribution::EnvironmentDistribution(int width, int height, const std::vector<double>& radiance,
                                                 const EquirectangularMap& map) {
  const Grid grid(width, height, radiance);
  width_ = grid.width();
  height_ = grid.height();
  radiance_over_sphere_ = grid.radiance_over_sphere();
  for (int column = 0; column < width_; ++column)
    sector_of_column_.push_back(static_cast<std::uint8_t>(std::int64_t{column} * kSectors / width_));
  for (int row = 0; row < height_; ++row)
    band_of_row_.push_back(static_cast<std::uint8_t>(std::int64_t{row} * kBands / height_));
  for (int row = 0; row < height_; ++row) first_texels_.push_back(grid.patch(0, row, 1, row + 1));
  CellSums sums;
  for (std::size_t cell = 0; cell < kCells; ++cell) add_cell(grid, cell / kSectors, cell % kSectors, sums);

  std::array<std::array<Vec3, kCellPlaces.size()>, kCells> directions;
  for (std::size_t cell = 0; cell < kCells; ++cell)
    for (std::size_t i = 0; i < kCellPlaces.size(); ++i) {
      const PatchOf<float>& patch = cells_[cell].patch;
      directions[cell][i] = map.direction(patch.along_row + patch.row_size * kCellPlaces[i].x,
                                          patch.depth + patch.depth_size * kCellPlaces[i].y, patch.side);
    }
  OfCells cosines;
  for (std::uint32_t facing = 0; facing < kAllSides; ++facing) {
    cosines.fill(0);
    for (const float y : kFacingPlaces)
      for (const float x : kFacingPlaces) {
        const Vec3 normal = normal_facing(facing, {x, y});
        for (std::size_t cell = 0; cell < kCells; ++cell)
          for (const Vec3 direction : directions[cell])
            cosines[cell] += static_cast<double>(std::max(0.0f, dot(normal, direction)));
      }
    constexpr auto kTerms = kFacingPlaces.size() * kFacingPlaces.size() * kCellPlaces.size();
    for (double& cosine : cosines) cosine /= kTerms;
    add_choice(sums, cosines);
  }
  cosines.fill(1.0 / 4);
  add_choice(sums, cosines);
}

void EnvironmentDistribution::add_cell(const Grid& grid, std::size_t band, std::size_t sector,
                                       CellSums& sums) {
  const int first_column = grid.first_column(sector), end_column = grid.first_column(sector + 1);
  const int first_row = grid.first_row(band), end_row = grid.first_row(band + 1);
  const std::size_t index = band * kSectors + sector;
  Cell& cell = cells_[index];
  double whole = 0, highest = 0;
  std::vector<double> shares;
  grid.for_each(first_column, first_row, end_column, end_row, [&](double radiance, double solid_angle) {
    const double density = grid.density(radiance);
    whole += solid_angle;
    highest = std::max(highest, density);
    shares.push_back(density * solid_angle);
    sums.radiance[index] += radiance * solid_angle;
  });
  sums.density[index] = std::accumulate(shares.begin(), shares.end(), 0.0);
  cell.patch = grid.patch(first_column, first_row, end_column, end_row);
  if (highest * whole <= kMostUneven * sums.density[index]) return;
  cell.texels = static_cast<std::int32_t>(texels_.size());
  texels_.push_back(
      {first_column, first_row, GridDistribution(end_column - first_column, end_row - first_row, shares)});
}

void EnvironmentDistribution::add_choice(const CellSums& sums, const OfCells& cosines) {
  double sought = 0;
  for (std::size_t cell = 0; cell < kCells; ++cell)
    sought += (cells_[cell].texels == kEven ? kFoundAnyway : 1) * cosines[cell] * sums.radiance[cell];
  const double reflected = std::inner_product(cosines.begin(), cosines.end(), sums.density.begin(), 0.0);
  OfCells weights;
  for (std::size_t cell = 0; cell < kCells; ++cell)
    weights[cell] =
        sums.density[cell] * (reflected > 0 ? (1 - kAnyCosine) * cosines[cell] / reflected + kAnyCosine : 1);
  std::array<double, kBands> of_bands;
  Choice choice;
  for (std::size_t band = 0; band < kBands; ++band) {
    const double* of_sectors = weights.data() + band * kSectors;
    of_bands[band] = std::accumulate(of_sectors, of_sectors + kSectors, 0.0);
    choice.sectors[band] = shares_of<kSectors>(of_sectors);
  }
  choice.bands = shares_of<kBands>(of_bands.data());
  choices_.push_back(choice);
  sought_.push_back(sought);
}

EnvironmentDistribution::ChosenOf<float> EnvironmentDistribution::chosen(std::uint32_t facing,
                                                                         std::size_t band,
                                                                         std::size_t sector) const {
  const Choice& choice = choices_[facing];
  const Shares<kSectors>& sectors = choice.sectors[band];
  const Cell& cell = cells_[band * kSectors + sector];
  const auto begin = [](const auto& shares, std::size_t i) { return static_cast<float>(shares[i]); };
  const auto share = [](const auto& shares, std::size_t i) {
    return static_cast<float>(shares[i + 1] - shares[i]);
  };
  return {begin(choice.bands, band),
          share(choice.bands, band),
          begin(sectors, sector),
          share(sectors, sector),
          cell.patch,
          cell.texels};
}

// The numbers are of the whole.
EnvironmentDistribution::ChosenOf<float> EnvironmentDistribution::choose(std::uint32_t facing,
                                                                         std::uint32_t x,
                                                                         std::uint32_t y) const {
  const Choice& choice = choices_[facing];
  const std::size_t band = share_at(choice.bands, y);
  return chosen(facing, band, share_at(choice.sectors[band], x));
}

EnvironmentDistribution::PlaceOf<float> EnvironmentDistribution::on_texel(const ChosenOf<float>& chosen,
                                                                          Vec2 within) const {
  const auto& [first_column, first_row, distribution] = texels_[static_cast<std::size_t>(chosen.texels)];
  const GridDistribution::Choice texel = distribution.sample(within);
  PatchOf<float> patch = first_texels_[static_cast<std::size_t>(first_row + texel.y)];
  patch.along_row = static_cast<float>(first_column + texel.x) * patch.row_size;
  return patch.at(texel.within, chosen.chance() * static_cast<float>(texel.pmf));
}

EnvironmentDistribution::PlaceOf<float> EnvironmentDistribution::sample(std::uint32_t facing, Vec2 u) const {
  const auto cell = choose(facing, to_word(u.x * kWhole), to_word(u.y * kWhole));
  const Vec2 within = cell.within(u);
  return cell.texels == kEven ? cell.patch.at(within, cell.chance()) : on_texel(cell, within);
}

EnvironmentDistribution::PlaceOf<Float8> EnvironmentDistribution::sample(U32x8 facings,
                                                                         Vec2Of<Float8> u) const {
  const WordLanes facing(facings), x(to_word(u.x * kWhole)), y(to_word(u.y * kWhole));
  std::array<ChosenOf<float>, kLaneCount> of_lanes;
  ChosenLanes lanes;
  unsigned uneven = 0;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    of_lanes[lane] = choose(facing[lane], x[lane], y[lane]);
    lanes.set(lane, of_lanes[lane]);
    uneven |= (of_lanes[lane].texels == kEven ? 0u : 1u) << lane;
  }
  const ChosenOf<Float8> cells = lanes.all();
  const Vec2Of<Float8> within = cells.within(u);
  const PlaceOf<Float8> even = cells.patch.at(within, cells.chance());
  if (uneven == 0) return even;
  const FloatLanes within_x(within.x), within_y(within.y);
  PlaceLanes places(even);
  for (; uneven != 0; uneven &= uneven - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(uneven));
    places.set(lane, on_texel(of_lanes[lane], {within_x[lane], within_y[lane]}));
  }
  return places.all();
}

float EnvironmentDistribution::pdf_at(std::uint32_t facing, std::uint32_t column, std::uint32_t row) const {
  const auto cell = chosen(facing, band_of_row_[row], sector_of_column_[column]);
  if (cell.texels == kEven) return cell.chance() * cell.patch.per_solid_angle;
  const auto& [first_column, first_row, distribution] = texels_[static_cast<std::size_t>(cell.texels)];
  const double pmf =
      distribution.pmf(static_cast<int>(column) - first_column, static_cast<int>(row) - first_row);
  return cell.chance() * static_cast<float>(pmf) * first_texels_[row].per_solid_angle;
}

float EnvironmentDistribution::pdf(std::uint32_t facing, Vec2 uv) const {
  return pdf_at(facing, texel_along(uv.x, width_), texel_along(1 - uv.y, height_));
}

Float8 EnvironmentDistribution::pdf(U32x8 facings, Vec2Of<Float8> uv) const {
  const WordLanes facing(facings), column(texel_along(uv.x, width_)), row(texel_along(1 - uv.y, height_));
  FloatLanes pdf;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    pdf.set(lane, pdf_at(facing[lane], column[lane], row[lane]));
  return pdf.all();
}

}  // namespace tessera::core
