// SPDX-License-Identifier: Apache-2.0
#include "core/spectra/color_space.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tessera::core::spectra {
namespace {

using Row = std::array<double, 3>;

constexpr Chromaticity kD65{0.3127, 0.329};

// IEC 61966-2-1, computed from the primaries with more digits, and its inverse.
constexpr ColorMatrix kRec709FromXyz{{{{3.2404542, -1.5371385, -0.4985314},
                                       {-0.969266, 1.8760108, 0.041556},
                                       {0.0556434, -0.2040259, 1.0572252}}}};
constexpr ColorMatrix kXyzFromRec709{{{{0.4124564, 0.3575761, 0.1804375},
                                       {0.2126729, 0.7151522, 0.072175},
                                       {0.0193339, 0.119192, 0.9503041}}}};
constexpr ColorMatrix kConesFromXyz{
    {{{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}}};
constexpr ColorMatrix kXyzFromCones{{{{0.9869929, -0.1470543, 0.1599627},
                                      {0.4323053, 0.5183603, 0.0492912},
                                      {-0.0085287, 0.0400428, 0.9684867}}}};

Row product(const ColorMatrix& matrix, const Row& v) {
  Row result{};
  for (std::size_t i = 0; i < 3; ++i)
    result[i] = matrix.rows[i][0] * v[0] + matrix.rows[i][1] * v[1] + matrix.rows[i][2] * v[2];
  return result;
}

ColorMatrix product(const ColorMatrix& a, const ColorMatrix& b) {
  ColorMatrix result;
  for (std::size_t column = 0; column < 3; ++column) {
    const Row image = product(a, Row{b.rows[0][column], b.rows[1][column], b.rows[2][column]});
    for (std::size_t row = 0; row < 3; ++row) result.rows[row][column] = image[row];
  }
  return result;
}

Rgb in_gamut(const Row& color) {
  const auto channel = [](double value) { return static_cast<float>(std::max(value, 0.0)); };
  return {channel(color[0]), channel(color[1]), channel(color[2])};
}

Row xyz_of(Chromaticity c) {
  return {c.x / c.y, 1, (1 - c.x - c.y) / c.y};
}

struct NamedIlluminant {
  std::string_view name;
  Chromaticity chromaticity;
};

constexpr NamedIlluminant kIlluminants[] = {{"A", {0.44757, 0.40745}},
                                            {"D50", {0.34567, 0.3585}},
                                            {"D55", {0.33242, 0.34743}},
                                            {"D60", {0.32168, 0.33767}},
                                            {"D65", kD65},
                                            {"D75", {0.29902, 0.31485}},
                                            {"F1", {0.3131, 0.33727}},
                                            {"F2", {0.37208, 0.37529}},
                                            {"F3", {0.4091, 0.3943}},
                                            {"F4", {0.44018, 0.40329}},
                                            {"F5", {0.31379, 0.34531}},
                                            {"F6", {0.3779, 0.38835}},
                                            {"F7", {0.31292, 0.32933}},
                                            {"F8", {0.34588, 0.35875}},
                                            {"F9", {0.37417, 0.37281}},
                                            {"F10", {0.34609, 0.35986}},
                                            {"F11", {0.38052, 0.37713}},
                                            {"F12", {0.43695, 0.40441}}};

}  // namespace

Rgb ColorMatrix::operator()(Rgb color) const {
  return in_gamut(product(
      *this, Row{static_cast<double>(color.r), static_cast<double>(color.g), static_cast<double>(color.b)}));
}

Rgb color_of(Chromaticity chromaticity) {
  return in_gamut(product(kRec709FromXyz, xyz_of(chromaticity)));
}

std::optional<Chromaticity> illuminant(std::string_view name) {
  for (const auto& [known, chromaticity] : kIlluminants)
    if (known == name) return chromaticity;
  return std::nullopt;
}

Chromaticity daylight(double kelvin) {
  const double t = std::clamp(kelvin, 4000.0, 25000.0);
  const double inverse = 1000 / t;
  const double x = t <= 7000 ? ((-4.607 * inverse + 2.9678) * inverse + 0.09911) * inverse + 0.244063
                             : ((-2.0064 * inverse + 1.9018) * inverse + 0.24748) * inverse + 0.23704;
  return {x, (-3 * x + 2.87) * x - 0.275};
}

// Rec. 2020 and P3: from the primaries of ITU-R BT.2020 and SMPTE EG 432-1. ACES: by Bradford's adaptation.
std::optional<ColorMatrix> to_rec709(std::string_view color_space) {
  if (color_space == "srgb") return ColorMatrix{};
  if (color_space == "rec2020")
    return ColorMatrix{{{{1.6604910, -0.5876411, -0.0728499},
                         {-0.1245505, 1.1328999, -0.0083494},
                         {-0.0181508, -0.1005789, 1.1187297}}}};
  if (color_space == "dci-p3")
    return ColorMatrix{
        {{{1.2249402, -0.2249402, 0}, {-0.0420570, 1.0420570, 0}, {-0.0196376, -0.0786361, 1.0982737}}}};
  if (color_space == "aces2065-1")
    return ColorMatrix{{{{2.5216862, -1.1341310, -0.3875552},
                         {-0.2764799, 1.3727191, -0.0962392},
                         {-0.0153781, -0.1529754, 1.1683535}}}};
  return std::nullopt;
}

namespace {

// Of XYZ.
ColorMatrix adaptation_to_d65(Chromaticity from) {
  const Row source = product(kConesFromXyz, xyz_of(from)), target = product(kConesFromXyz, xyz_of(kD65));
  ColorMatrix scale;
  for (std::size_t i = 0; i < 3; ++i) scale.rows[i][i] = target[i] / source[i];
  return product(kXyzFromCones, product(scale, kConesFromXyz));
}

double determinant(const Row& a, const Row& b, const Row& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - b[0] * (a[1] * c[2] - a[2] * c[1]) +
         c[0] * (a[1] * b[2] - a[2] * b[1]);
}

// Not divided by y, which is 0 for the imaginary primaries of some spaces.
Row direction_of(Chromaticity c) {
  return {c.x, c.y, 1 - c.x - c.y};
}

}  // namespace

// The columns of the map to XYZ are the primaries, scaled so that (1, 1, 1) is white (by Cramer's rule).
std::optional<ColorMatrix> to_rec709(const Primaries& primaries) {
  const Row r = direction_of(primaries.red), g = direction_of(primaries.green),
            b = direction_of(primaries.blue);
  const double volume = determinant(r, g, b);
  constexpr double kFlat = 1e-6;
  if (!(std::fabs(volume) > kFlat) || !(primaries.white.y > kFlat)) return std::nullopt;
  const Row white = xyz_of(primaries.white);
  const Row scale{determinant(white, g, b) / volume, determinant(r, white, b) / volume,
                  determinant(r, g, white) / volume};
  ColorMatrix to_xyz;
  for (std::size_t i = 0; i < 3; ++i) to_xyz.rows[i] = {r[i] * scale[0], g[i] * scale[1], b[i] * scale[2]};
  return product(kRec709FromXyz, product(adaptation_to_d65(primaries.white), to_xyz));
}

ColorMatrix white_balance(Chromaticity from) {
  return product(kRec709FromXyz, product(adaptation_to_d65(from), kXyzFromRec709));
}

}  // namespace tessera::core::spectra
