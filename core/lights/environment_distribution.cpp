// SPDX-License-Identifier: Apache-2.0
#include "core/lights/environment_distribution.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>

#include "core/math/elementary.hpp"
#include "core/math/lane_array.hpp"
#include "core/math/row_lookup.hpp"
#include "core/sampling/hash.hpp"

namespace tessera::core::lights {
namespace {

// Clamps the sine of the angle to the pole, because the density of interpolated texels is infinite at the
// poles.
constexpr float kMinSine = 1e-6f;

// Extends the 24 bits of each number with bits derived from all of them: after the choice of a rare cell,
// too few of the 24 remain to choose its texels.
Vec2Of<double> with_more_bits(Vec2 u) {
  const std::uint64_t more = sampling::hash(std::uint64_t{as_bits(u.x)}, as_bits(u.y));
  const auto refined = [](float number, std::uint64_t bits) {
    return static_cast<double>(to_word(number * 0x1p24f)) * 0x1p-24 +
           static_cast<double>(bits >> 8) * 0x1p-48;
  };
  return {refined(u.x, more >> 32), refined(u.y, more & 0xffffffff)};
}

// The index of the texel that contains a position. NaN also maps into the image.
std::uint32_t texel_at(float place, int texels) {
  return to_word(larger(0.0f, smaller(place, static_cast<float>(texels - 1))));
}

// The index of the interval that contains a number below the total.
template <std::size_t kCount>
std::size_t share_at(const std::array<std::int16_t, kCount>& begins, std::uint32_t number) {
  assert(number < static_cast<std::uint32_t>(begins.back()));
  std::uint32_t up_to = 0;
  for (std::size_t i = 0; i + 1 < kCount; i += 16)
    up_to += count_up_to(static_cast<std::int16_t>(number), begins.data() + i);
  return up_to - 1;
}

}  // namespace

// The intervals of one or several cells, and their locations.
template <typename T>
struct EnvironmentDistribution::SharesOf {
  T band_begin, band_size, sector_begin, sector_size;
  PatchOf<T> patch;

  T chance() const {
    constexpr float kUnit = 1 / (float{kWhole} * float{kWhole});
    return band_size * sector_size * kUnit;
  }
  // The relative position of numbers in their intervals, in [0, 1). The total is a power of two, so no
  // rounding crosses an interval's end.
  template <typename U>
  Vec2Of<U> within(Vec2Of<U> u) const {
    return {(u.x * U(float{kWhole}) - U(sector_begin)) / U(sector_size),
            (u.y * U(float{kWhole}) - U(band_begin)) / U(band_size)};
  }
};

struct EnvironmentDistribution::Chosen {
  SharesOf<float> shares;
  std::int32_t uneven;  // as in Cell
};

class EnvironmentDistribution::ChosenLanes {
 public:
  void set(std::size_t lane, const SharesOf<float>& shares) {
    band_begin_.set(lane, shares.band_begin), band_size_.set(lane, shares.band_size);
    sector_begin_.set(lane, shares.sector_begin), sector_size_.set(lane, shares.sector_size);
    along_row_.set(lane, shares.patch.along_row), row_size_.set(lane, shares.patch.row_size);
    depth_.set(lane, shares.patch.depth), depth_size_.set(lane, shares.patch.depth_size);
    side_.set(lane, shares.patch.side), per_solid_angle_.set(lane, shares.patch.per_solid_angle);
  }
  SharesOf<FloatN> all() const {
    return {band_begin_.all(),
            band_size_.all(),
            sector_begin_.all(),
            sector_size_.all(),
            {along_row_.all(), row_size_.all(), depth_.all(), depth_size_.all(), side_.all(),
             per_solid_angle_.all()}};
  }

 private:
  FloatLanes band_begin_, band_size_, sector_begin_, sector_size_;
  FloatLanes along_row_, row_size_, depth_, depth_size_, side_, per_solid_angle_;
};

class EnvironmentDistribution::PlaceLanes {
 public:
  explicit PlaceLanes(const PlaceOf<FloatN>& all)
      : along_row_(all.along_row), depth_(all.depth), side_(all.side), pdf_(all.pdf) {}
  void set(std::size_t lane, const PlaceOf<float>& place) {
    along_row_.set(lane, place.along_row), depth_.set(lane, place.depth);
    side_.set(lane, place.side), pdf_.set(lane, place.pdf);
  }
  PlaceOf<FloatN> all() const { return {along_row_.all(), depth_.all(), side_.all(), pdf_.all()}; }

 private:
  FloatLanes along_row_, depth_, side_, pdf_;
};

EnvironmentDistribution::Chosen EnvironmentDistribution::chosen(std::uint32_t table, std::size_t band,
                                                                std::size_t sector) const {
  const Choice& choice = choices_[table];
  const Cell& cell = cells_[band * kSectors + sector];
  const auto begin = [](const auto& shares, std::size_t i) { return static_cast<float>(shares[i]); };
  const auto size = [](const auto& shares, std::size_t i) {
    return static_cast<float>(shares[i + 1] - shares[i]);
  };
  const Shares<kSectors>& sectors = choice.sectors[band];
  return {{begin(choice.bands, band), size(choice.bands, band), begin(sectors, sector), size(sectors, sector),
           cell.patch},
          cell.uneven};
}

// The numbers are fractions of the total.
EnvironmentDistribution::Chosen EnvironmentDistribution::choose(std::uint32_t table, std::uint32_t x,
                                                                std::uint32_t y) const {
  const Choice& choice = choices_[table];
  const std::size_t band = share_at(choice.bands, y);
  return chosen(table, band, share_at(choice.sectors[band], x));
}

EnvironmentDistribution::PlaceOf<float> EnvironmentDistribution::sample_texels(const Chosen& chosen,
                                                                               Vec2 u) const {
  const auto& [first_column, first_row, distribution] = texels_[static_cast<std::size_t>(chosen.uneven)];
  const auto [place, density] = distribution.sample(chosen.shares.within(with_more_bits(u)));
  const float column = static_cast<float>(first_column) + place.x,
              row = static_cast<float>(first_row) + place.y;
  const auto width = static_cast<float>(width_), height = static_cast<float>(height_);
  const bool upper = 2 * row <= height;
  const float half_sine = sin(kPi / 2 * (upper ? row : height - row) / height);
  return {column / width, 2 * half_sine * half_sine, upper ? 1.0f : -1.0f,
          chosen.shares.chance() * density * texels_per_solid_angle(row)};
}

// `row` is counted from the upper pole.
float EnvironmentDistribution::texels_per_solid_angle(float row) const {
  const auto width = static_cast<float>(width_), height = static_cast<float>(height_);
  const float inside = larger(0.0f, smaller(row, height));
  const float sine = sin(kPi * std::min(inside, height - inside) / height);
  return width * height / (2 * kPi * kPi * std::max(sine, kMinSine));
}

EnvironmentDistribution::PlaceOf<float> EnvironmentDistribution::sample(std::uint32_t table, Vec2 u) const {
  const Chosen cell = choose(table, to_word(u.x * float{kWhole}), to_word(u.y * float{kWhole}));
  return cell.uneven == kEven ? cell.shares.patch.at(cell.shares.within(u), cell.shares.chance())
                              : sample_texels(cell, u);
}

EnvironmentDistribution::PlaceOf<FloatN> EnvironmentDistribution::sample(U32xN tables,
                                                                         Vec2Of<FloatN> u) const {
  const WordLanes table(tables), x(to_word(u.x * float{kWhole})), y(to_word(u.y * float{kWhole}));
  std::array<Chosen, kLaneCount> of_lanes;
  ChosenLanes lanes;
  unsigned uneven = 0;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    of_lanes[lane] = choose(table[lane], x[lane], y[lane]);
    lanes.set(lane, of_lanes[lane].shares);
    uneven |= (of_lanes[lane].uneven == kEven ? 0u : 1u) << lane;
  }
  const SharesOf<FloatN> cells = lanes.all();
  const PlaceOf<FloatN> even = cells.patch.at(cells.within(u), cells.chance());
  if (uneven == 0) return even;
  const FloatLanes u_x(u.x), u_y(u.y);
  PlaceLanes places(even);
  for (; uneven != 0; uneven &= uneven - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(uneven));
    places.set(lane, sample_texels(of_lanes[lane], {u_x[lane], u_y[lane]}));
  }
  return places.all();
}

// `place` is an image position in texels, from the upper left corner.
float EnvironmentDistribution::pdf_at(std::uint32_t table, Vec2 place) const {
  const auto [shares, uneven] =
      chosen(table, band_of_row_[texel_at(place.y, height_)], sector_of_column_[texel_at(place.x, width_)]);
  if (uneven == kEven) return shares.chance() * shares.patch.per_solid_angle;
  const auto& [first_column, first_row, distribution] = texels_[static_cast<std::size_t>(uneven)];
  const Vec2 within{place.x - static_cast<float>(first_column), place.y - static_cast<float>(first_row)};
  return shares.chance() * distribution.density(within) * texels_per_solid_angle(place.y);
}

float EnvironmentDistribution::pdf(std::uint32_t table, Vec2 uv) const {
  return pdf_at(table, {uv.x * static_cast<float>(width_), (1 - uv.y) * static_cast<float>(height_)});
}

FloatN EnvironmentDistribution::pdf(U32xN tables, Vec2Of<FloatN> uv) const {
  const WordLanes table(tables);
  const FloatLanes x(uv.x * static_cast<float>(width_)), y((1 - uv.y) * static_cast<float>(height_));
  FloatLanes pdf;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    pdf.set(lane, pdf_at(table[lane], {x[lane], y[lane]}));
  return pdf.all();
}

}  // namespace tessera::core::lights
