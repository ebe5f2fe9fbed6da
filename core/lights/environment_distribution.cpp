#include "core/lights/environment_distribution.hpp"

#include <array>
#include <bit>
#include <cassert>

#include "core/math/lane_array.hpp"
#include "core/math/row_lookup.hpp"

namespace tessera::core {
namespace {

constexpr float kJustBelowOne = 1 - 0x1p-24f;

template <typename T>
WordOf<T> texel_along(T coordinate, int texels) {
  const auto count = static_cast<float>(texels);
  return to_word(larger(T(0.0f), smaller(coordinate * count, T(count - 1))));
}

// Which of the shares a number falls on, below the end of the last.
template <std::size_t kCount>
std::size_t share_at(const std::array<std::int16_t, kCount>& begins, std::uint32_t number) {
  assert(number < static_cast<std::uint32_t>(begins.back()));
  std::uint32_t up_to = 0;
  for (std::size_t i = 0; i + 1 < kCount; i += 16)
    up_to += count_up_to(static_cast<std::int16_t>(number), begins.data() + i);
  return up_to - 1;
}

}  // namespace

// The shares of a cell, and where it lies; or several.
template <typename T>
struct EnvironmentDistribution::SharesOf {
  T band_begin, band_size, sector_begin, sector_size;
  PatchOf<T> patch;

  T chance() const {
    constexpr float kUnit = 1 / (float{kWhole} * float{kWhole});
    return band_size * sector_size * kUnit;
  }
  // Where numbers fall in the shares, in [0, 1). Of their 24 bits the smallest share leaves nine: of an
  // uneven cell as rare as that, some texels are never found.
  Vec2Of<T> within(Vec2Of<T> u) const {
    return {smaller((u.x * float{kWhole} - sector_begin) / sector_size, T(kJustBelowOne)),
            smaller((u.y * float{kWhole} - band_begin) / band_size, T(kJustBelowOne))};
  }
};

struct EnvironmentDistribution::Chosen {
  SharesOf<float> shares;
  std::int32_t uneven;  // as Cell has it
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
  SharesOf<Float8> all() const {
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

EnvironmentDistribution::Chosen EnvironmentDistribution::chosen(std::uint32_t facing, std::size_t band,
                                                                std::size_t sector) const {
  const Choice& choice = choices_[facing];
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

// The numbers are of the whole.
EnvironmentDistribution::Chosen EnvironmentDistribution::choose(std::uint32_t facing, std::uint32_t x,
                                                                std::uint32_t y) const {
  const Choice& choice = choices_[facing];
  const std::size_t band = share_at(choice.bands, y);
  return chosen(facing, band, share_at(choice.sectors[band], x));
}

EnvironmentDistribution::PlaceOf<float> EnvironmentDistribution::on_texel(const Chosen& chosen,
                                                                          Vec2 within) const {
  const auto& [first_column, first_row, distribution] = texels_[static_cast<std::size_t>(chosen.uneven)];
  const GridDistribution::Choice texel = distribution.sample(within);
  PatchOf<float> patch = first_texels_[static_cast<std::size_t>(first_row + texel.y)];
  patch.along_row = static_cast<float>(first_column + texel.x) * patch.row_size;
  return patch.at(texel.within, chosen.shares.chance() * static_cast<float>(texel.pmf));
}

EnvironmentDistribution::PlaceOf<float> EnvironmentDistribution::sample(std::uint32_t facing, Vec2 u) const {
  const Chosen cell = choose(facing, to_word(u.x * float{kWhole}), to_word(u.y * float{kWhole}));
  const Vec2 within = cell.shares.within(u);
  return cell.uneven == kEven ? cell.shares.patch.at(within, cell.shares.chance()) : on_texel(cell, within);
}

EnvironmentDistribution::PlaceOf<Float8> EnvironmentDistribution::sample(U32x8 facings,
                                                                         Vec2Of<Float8> u) const {
  const WordLanes facing(facings), x(to_word(u.x * float{kWhole})), y(to_word(u.y * float{kWhole}));
  std::array<Chosen, kLaneCount> of_lanes;
  ChosenLanes lanes;
  unsigned uneven = 0;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    of_lanes[lane] = choose(facing[lane], x[lane], y[lane]);
    lanes.set(lane, of_lanes[lane].shares);
    uneven |= (of_lanes[lane].uneven == kEven ? 0u : 1u) << lane;
  }
  const SharesOf<Float8> cells = lanes.all();
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
  const auto [shares, uneven] = chosen(facing, band_of_row_[row], sector_of_column_[column]);
  if (uneven == kEven) return shares.chance() * shares.patch.per_solid_angle;
  const auto& [first_column, first_row, distribution] = texels_[static_cast<std::size_t>(uneven)];
  const double pmf =
      distribution.pmf(static_cast<int>(column) - first_column, static_cast<int>(row) - first_row);
  return shares.chance() * static_cast<float>(pmf) * first_texels_[row].per_solid_angle;
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
