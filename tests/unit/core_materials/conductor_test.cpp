// SPDX-License-Identifier: Apache-2.0
// The named metals reflect what their measured indices say, integrated over the spectrum. This is also how
// the values in core/materials/conductor.cpp were found.
#include "core/materials/conductor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <span>

#include "core/materials/fresnel.hpp"

namespace tessera::core {
namespace {

// The colour matching functions of the CIE 1931 observer (ISO/CIE 11664-1) and the power of illuminant D65
// (ISO/CIE 11664-2), from 380 to 700 nm in steps of 10 nm.
struct Observed {
  double x, y, z, power;
};
constexpr int kFirstNm = 380, kStepNm = 10;
constexpr Observed kSpectrum[] = {
    {0.001368, 3.9e-05, 0.00645, 49.9755}, {0.004243, 0.00012, 0.02005, 54.6482},
    {0.01431, 0.000396, 0.06785, 82.7549}, {0.04351, 0.00121, 0.2074, 91.486},
    {0.13438, 0.004, 0.6456, 93.4318},     {0.2839, 0.0116, 1.3856, 86.6823},
    {0.34828, 0.023, 1.74706, 104.865},    {0.3362, 0.038, 1.77211, 117.008},
    {0.2908, 0.06, 1.6692, 117.812},       {0.19536, 0.09098, 1.28764, 114.861},
    {0.09564, 0.13902, 0.81295, 115.923},  {0.03201, 0.20802, 0.46518, 108.811},
    {0.0049, 0.323, 0.272, 109.354},       {0.0093, 0.503, 0.1582, 107.802},
    {0.06327, 0.71, 0.07825, 104.79},      {0.1655, 0.862, 0.04216, 107.689},
    {0.2904, 0.954, 0.0203, 104.405},      {0.43345, 0.99495, 0.00875, 104.046},
    {0.5945, 0.995, 0.0039, 100},          {0.7621, 0.952, 0.0021, 96.3342},
    {0.9163, 0.87, 0.00165, 95.788},       {1.0263, 0.757, 0.0011, 88.6856},
    {1.0622, 0.631, 0.0008, 90.0062},      {1.0026, 0.503, 0.00034, 89.5991},
    {0.85445, 0.381, 0.00019, 87.6987},    {0.6424, 0.265, 5e-05, 83.2886},
    {0.4479, 0.175, 2e-05, 83.6992},       {0.2835, 0.107, 0, 80.0268},
    {0.1649, 0.061, 0, 80.2146},           {0.0874, 0.032, 0, 82.2778},
    {0.04677, 0.017, 0, 78.2842},          {0.0227, 0.00821, 0, 69.7213},
    {0.011359, 0.004102, 0, 71.6091}};

struct Measured {
  double nm, eta, k;
};
// Johnson and Christy 1972, table I.
constexpr Measured kCopper[] = {{381.5, 1.33, 2.045}, {397.4, 1.32, 2.116}, {413.3, 1.28, 2.207},
                                {430.5, 1.25, 2.305}, {450.9, 1.24, 2.397}, {471.4, 1.25, 2.483},
                                {495.9, 1.22, 2.564}, {520.9, 1.18, 2.608}, {548.6, 1.02, 2.577},
                                {582.1, 0.7, 2.704},  {616.8, 0.3, 3.205},  {659.5, 0.22, 3.747},
                                {704.5, 0.21, 4.205}, {756, 0.24, 4.665}};
constexpr Measured kGold[] = {{381.5, 1.46, 1.933}, {397.4, 1.47, 1.952}, {413.3, 1.46, 1.958},
                              {430.5, 1.45, 1.948}, {450.9, 1.38, 1.914}, {471.4, 1.31, 1.849},
                              {495.9, 1.04, 1.833}, {520.9, 0.62, 2.081}, {548.6, 0.43, 2.455},
                              {582.1, 0.29, 2.863}, {616.8, 0.21, 3.272}, {659.5, 0.14, 3.697},
                              {704.5, 0.13, 4.103}, {756, 0.14, 4.542}};
constexpr Measured kSilver[] = {{381.5, 0.05, 1.864}, {397.4, 0.05, 2.07},  {413.3, 0.05, 2.275},
                                {430.5, 0.04, 2.462}, {450.9, 0.04, 2.657}, {471.4, 0.05, 2.869},
                                {495.9, 0.05, 3.093}, {520.9, 0.05, 3.324}, {548.6, 0.06, 3.586},
                                {582.1, 0.05, 3.858}, {616.8, 0.06, 4.152}, {659.5, 0.05, 4.483},
                                {704.5, 0.04, 4.838}, {756, 0.03, 5.242}};
// Rakić 1995, table 1.
constexpr Measured kAluminium[] = {
    {364.66, 0.39877, 4.3957}, {413.28, 0.52135, 5.0008}, {442.8, 0.6079, 5.3676}, {476.87, 0.7278, 5.7781},
    {516.6, 0.8734, 6.2418},   {563.57, 1.0728, 6.7839},  {619.93, 1.366, 7.4052}, {652.25, 1.5724, 7.7354},
    {688.81, 1.8301, 8.0601},  {729.32, 2.1606, 8.3565},  {774.91, 2.6154, 8.4914}};

// Querry 1985, 70 % copper.
constexpr Measured kBrass[] = {
    {380, 1.487, 1.818}, {400, 1.445, 1.805}, {420, 1.35, 1.786},  {440, 1.191, 1.797}, {460, 0.994, 1.883},
    {480, 0.816, 2.046}, {500, 0.686, 2.25},  {520, 0.602, 2.464}, {540, 0.549, 2.668}, {560, 0.505, 2.86},
    {580, 0.468, 3.059}, {600, 0.45, 3.253},  {620, 0.449, 3.434}, {640, 0.444, 3.609}, {660, 0.445, 3.778},
    {680, 0.444, 3.943}, {700, 0.446, 4.106}};
// Johnson and Christy 1974.
constexpr Measured kChromium[] = {{381, 1.92, 2.74}, {397, 2, 2.83},    {413, 2.08, 2.93}, {431, 2.19, 3.04},
                                  {451, 2.33, 3.14}, {471, 2.51, 3.24}, {496, 2.75, 3.3},  {521, 2.94, 3.33},
                                  {549, 3.18, 3.33}, {582, 3.22, 3.3},  {617, 3.17, 3.3},  {659, 3.09, 3.34},
                                  {704, 3.05, 3.39}};
// Johnson and Christy 1974.
constexpr Measured kNickel[] = {{381, 1.72, 2.48}, {397, 1.72, 2.57}, {413, 1.7, 2.69},  {431, 1.71, 2.82},
                                {451, 1.73, 2.95}, {471, 1.78, 3.09}, {496, 1.82, 3.25}, {521, 1.85, 3.42},
                                {549, 1.92, 3.61}, {582, 1.96, 3.8},  {617, 1.99, 4.02}, {659, 1.99, 4.26},
                                {704, 2.06, 4.5}};
// Weaver, Olson and Lynch 1975, figures.
constexpr Measured kTungsten[] = {{379, 3.459, 2.556},   {400.2, 3.406, 2.415}, {425.3, 3.346, 2.439},
                                  {448.7, 3.314, 2.511}, {469.4, 3.332, 2.591}, {493.7, 3.384, 2.668},
                                  {511.1, 3.433, 2.7},   {529.8, 3.49, 2.716},  {548.9, 3.522, 2.739},
                                  {573.9, 3.526, 2.794}, {599.7, 3.557, 2.86},  {626, 3.607, 2.906},
                                  {657.2, 3.697, 2.943}, {680.8, 3.797, 2.914}, {700.8, 3.871, 2.879}};
// Inagaki, Arakawa and Williams 1981.
constexpr Measured kMercury[] = {{364.66, 0.713, 3.074}, {387.45, 0.7982, 3.294}, {413.28, 0.898, 3.538},
                                 {442.8, 1.027, 3.802},  {476.86, 1.186, 4.09},   {516.6, 1.383, 4.406},
                                 {563.56, 1.621, 4.75},  {619.92, 1.91, 5.15},    {688.8, 2.284, 5.582},
                                 {774.9, 2.746, 6.054}};
// Pflüger et al. 1984.
constexpr Measured kTitaniumNitride[] = {
    {354.2, 2.14, 1.06}, {413.3, 1.74, 1.04}, {495.9, 1.2, 1.65}, {619.9, 1.32, 2.69}, {826.6, 1.82, 3.81}};
// Stephens and Malitson 1952, dispersion formula.
constexpr Measured kMagnesiumOxide[] = {
    {380, 1.7673, 0}, {400, 1.7621, 0}, {420, 1.7577, 0}, {440, 1.754, 0},  {460, 1.7507, 0},
    {480, 1.7479, 0}, {500, 1.7455, 0}, {520, 1.7433, 0}, {540, 1.7413, 0}, {560, 1.7396, 0},
    {580, 1.7381, 0}, {600, 1.7366, 0}, {620, 1.7354, 0}, {640, 1.7342, 0}, {660, 1.7332, 0},
    {680, 1.7322, 0}, {700, 1.7313, 0}};
// DeVore 1951, dispersion formula.
constexpr Measured kTitaniumDioxide[] = {
    {380, 3.1179, 0}, {400, 2.996, 0},  {420, 2.9074, 0}, {440, 2.8403, 0}, {460, 2.7878, 0},
    {480, 2.7458, 0}, {500, 2.7114, 0}, {520, 2.6827, 0}, {540, 2.6586, 0}, {560, 2.638, 0},
    {580, 2.6203, 0}, {600, 2.6049, 0}, {620, 2.5915, 0}, {640, 2.5796, 0}, {660, 2.5691, 0},
    {680, 2.5597, 0}, {700, 2.5512, 0}};
// DeVore 1951, dispersion formula.
constexpr Measured kTitaniumDioxideExtraordinary[] = {
    {380, 3.5671, 0}, {400, 3.4037, 0}, {420, 3.2869, 0}, {440, 3.1994, 0}, {460, 3.1315, 0},
    {480, 3.0775, 0}, {500, 3.0335, 0}, {520, 2.997, 0},  {540, 2.9664, 0}, {560, 2.9404, 0},
    {580, 2.918, 0},  {600, 2.8986, 0}, {620, 2.8817, 0}, {640, 2.8667, 0}, {660, 2.8535, 0},
    {680, 2.8418, 0}, {700, 2.8312, 0}};
// Peter 1923, dispersion formula.
constexpr Measured kDiamond[] = {{380, 2.4741, 0}, {400, 2.4641, 0}, {420, 2.4557, 0}, {440, 2.4486, 0},
                                 {460, 2.4424, 0}, {480, 2.437, 0},  {500, 2.4324, 0}, {520, 2.4282, 0},
                                 {540, 2.4246, 0}, {560, 2.4214, 0}, {580, 2.4185, 0}, {600, 2.4159, 0},
                                 {620, 2.4136, 0}, {640, 2.4115, 0}, {660, 2.4096, 0}, {680, 2.4078, 0},
                                 {700, 2.4062, 0}};
// Li 1976, dispersion formula.
constexpr Measured kCaesiumIodide[] = {{380, 1.8653, 0}, {400, 1.8506, 0}, {420, 1.8386, 0}, {440, 1.8286, 0},
                                       {460, 1.8201, 0}, {480, 1.8129, 0}, {500, 1.8067, 0}, {520, 1.8013, 0},
                                       {540, 1.7966, 0}, {560, 1.7925, 0}, {580, 1.7888, 0}, {600, 1.7856, 0},
                                       {620, 1.7827, 0}, {640, 1.7801, 0}, {660, 1.7777, 0}, {680, 1.7756, 0},
                                       {700, 1.7736, 0}};
// Singh et al. 1971, dispersion formula.
constexpr Measured kSiliconCarbide[] = {
    {380, 2.7947, 0}, {400, 2.7679, 0}, {420, 2.7456, 0}, {440, 2.7267, 0}, {460, 2.7107, 0},
    {480, 2.6969, 0}, {500, 2.6849, 0}, {520, 2.6744, 0}, {540, 2.6652, 0}, {560, 2.6571, 0},
    {580, 2.6499, 0}, {600, 2.6434, 0}, {620, 2.6376, 0}, {640, 2.6324, 0}, {660, 2.6277, 0},
    {680, 2.6234, 0}, {700, 2.6195, 0}};
// Rakić et al. 1998, Lorentz-Drude model.
constexpr Measured kBeryllium[] = {
    {380, 2.777, 3.094}, {400, 2.87, 3.115},  {420, 2.959, 3.13},  {440, 3.041, 3.14},  {460, 3.116, 3.146},
    {480, 3.182, 3.148}, {500, 3.239, 3.149}, {520, 3.288, 3.15},  {540, 3.329, 3.151}, {560, 3.362, 3.153},
    {580, 3.389, 3.157}, {600, 3.41, 3.164},  {620, 3.426, 3.173}, {640, 3.437, 3.185}, {660, 3.443, 3.2},
    {680, 3.446, 3.217}, {700, 3.446, 3.238}};

Measured interpolated(std::span<const Measured> table, double nm) {
  const auto next =
      std::find_if(table.begin() + 1, table.end() - 1, [nm](const Measured& m) { return m.nm > nm; });
  const Measured &a = *(next - 1), &b = *next;
  const double t = (nm - a.nm) / (b.nm - a.nm);
  return {nm, a.eta + t * (b.eta - a.eta), a.k + t * (b.k - a.k)};
}

// Linear Rec. 709 with D65 as white, from XYZ (IEC 61966-2-1).
std::array<double, 3> rec709(std::array<double, 3> xyz) {
  const auto [x, y, z] = xyz;
  return {3.2404542 * x - 1.5371385 * y - 0.4985314 * z, -0.969266 * x + 1.8760108 * y + 0.041556 * z,
          0.0556434 * x - 0.2040259 * y + 1.0572252 * z};
}

// The colour of white light that the metal reflects.
std::array<double, 3> integrated(std::span<const Measured> table, double cos_i) {
  std::array<double, 3> reflected{}, all{};
  double nm = kFirstNm;
  for (const Observed& observed : kSpectrum) {
    const Measured index = interpolated(table, nm);
    const auto share = static_cast<double>(conductor_reflectance(
        static_cast<float>(cos_i), static_cast<float>(index.eta), static_cast<float>(index.k)));
    const std::array<double, 3> power{observed.x * observed.power, observed.y * observed.power,
                                      observed.z * observed.power};
    for (std::size_t i = 0; i < 3; ++i) reflected[i] += share * power[i], all[i] += power[i];
    nm += kStepNm;
  }
  const std::array<double, 3> colour = rec709(reflected), white = rec709(all);
  return {colour[0] / white[0], colour[1] / white[1], colour[2] / white[2]};
}

struct Metal {
  const char* name;
  Conductor conductor;
  std::span<const Measured> table;
};

class Conductors : public testing::TestWithParam<Metal> {};

TEST_P(Conductors, ReflectWhatTheSpectrumAddsUpTo) {
  const auto [name, conductor, table] = GetParam();
  const ComplexIndex index = complex_index(conductor);
  for (const double cos_i : {1.0, 0.8, 0.6, 0.4, 0.2, 0.1}) {
    const Rgb reflected = fresnel_conductor(static_cast<float>(cos_i), index.eta, index.k);
    const std::array<double, 3> expected = integrated(table, cos_i);
    // Gold is more saturated than Rec. 709 can show; a surface does not reflect more than it receives.
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(static_cast<double>(reflected[c]), std::min(expected[static_cast<std::size_t>(c)], 1.0),
                  0.005)
          << name << ", channel " << c << ", cosine " << cos_i;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Metals, Conductors,
    testing::Values(
        Metal{"copper", Conductor::kCopper, kCopper}, Metal{"gold", Conductor::kGold, kGold},
        Metal{"silver", Conductor::kSilver, kSilver}, Metal{"aluminium", Conductor::kAluminium, kAluminium},
        Metal{"brass", Conductor::kBrass, kBrass}, Metal{"chromium", Conductor::kChromium, kChromium},
        Metal{"nickel", Conductor::kNickel, kNickel}, Metal{"tungsten", Conductor::kTungsten, kTungsten},
        Metal{"mercury", Conductor::kMercury, kMercury},
        Metal{"titanium_nitride", Conductor::kTitaniumNitride, kTitaniumNitride},
        Metal{"magnesium_oxide", Conductor::kMagnesiumOxide, kMagnesiumOxide},
        Metal{"titanium_dioxide", Conductor::kTitaniumDioxide, kTitaniumDioxide},
        Metal{"titanium_dioxide_extraordinary", Conductor::kTitaniumDioxideExtraordinary,
              kTitaniumDioxideExtraordinary},
        Metal{"diamond", Conductor::kDiamond, kDiamond},
        Metal{"caesium_iodide", Conductor::kCaesiumIodide, kCaesiumIodide},
        Metal{"silicon_carbide", Conductor::kSiliconCarbide, kSiliconCarbide},
        Metal{"beryllium", Conductor::kBeryllium, kBeryllium}));

}  // namespace
}  // namespace tessera::core
