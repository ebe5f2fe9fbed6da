// SPDX-License-Identifier: Apache-2.0
#include "core/materials/microfacets.hpp"

#include <algorithm>
#include <array>

#include "core/materials/anisotropic_ggx.hpp"
#include "core/math/elementary.hpp"

namespace tessera::core {
namespace {

constexpr double kInverseSqrtPi = 0.56418958354775628695;

// erfc(x) / exp(-x^2) for x >= 0; the absolute error of erfc is below 1.5e-7 (Hastings 1955).
double scaled_erfc(double x) {
  const double t = 1 / (1 + 0.3275911 * x);
  return t * polynomial(t, std::array{0.254829592, -0.284496736, 1.421413741, -1.453152027, 1.061405429});
}

// The integral of (cosine - s sine) exp(-s^2) / sqrt(pi) over s from minus infinity to `slope`: of the
// microfacets of Beckmann's distribution with alpha 1 whose slope is lower, the area that a viewer at the
// angle sees.
double area_below(double slope, double cosine, double sine) {
  const double bell = exp(-slope * slope);
  const double tail = bell * scaled_erfc(std::fabs(slope));
  return (cosine * (slope < 0 ? tail : 2 - tail) + sine * bell * kInverseSqrtPi) / 2;
}

// The area of those that face the viewer.
double area_facing(double cosine, double sine) {
  return sine * 1e4 < cosine ? cosine : area_below(cosine / sine, cosine, sine);
}

// The slope below which the fraction u of the visible area lies, by Newton's method. It starts at the
// inflection of the integral, which is convex below and concave above, so that every step stays on one side
// of the solution.
double slope_at(double u, double cosine, double sine) {
  constexpr int kMaxSteps = 24;
  constexpr double kTolerance = 1e-7;
  const double wanted = u * area_facing(cosine, sine);
  double slope = -sine / (cosine + std::sqrt(cosine * cosine + 2 * sine * sine));
  for (int step = 0; step < kMaxSteps; ++step) {
    const double missing = wanted - area_below(slope, cosine, sine);
    const double rate = (cosine - slope * sine) * exp(-slope * slope) * kInverseSqrtPi;
    if (std::fabs(missing) < kTolerance * wanted || !(rate > 0)) break;
    slope += missing / rate;
  }
  return slope;
}

// Numbers of which neither slope is infinite.
double inside_unit(float u) {
  constexpr double kMin = 0x1p-25;
  return std::clamp(static_cast<double>(u), kMin, 1 - kMin);
}

}  // namespace

float Microfacets::density(Vec3 h) const {
  if (kind_.distribution == MicrofacetDistribution::kGgx)
    return AnisotropicGgx(alpha_x_, alpha_y_).density(h);
  const float x = h.x / alpha_x_, y = h.y / alpha_y_, cos2 = h.z * h.z;
  if (!(cos2 > 0)) return 0;
  const auto bell = static_cast<float>(exp(-static_cast<double>((x * x + y * y) / cos2)));
  return bell / (kPi * alpha_x_ * alpha_y_ * cos2 * cos2);
}

float Microfacets::projected_area(Vec3 w) const {
  const float x = alpha_x_ * w.x, y = alpha_y_ * w.y, across2 = x * x + y * y;
  if (kind_.distribution == MicrofacetDistribution::kGgx) return (w.z + std::sqrt(across2 + w.z * w.z)) / 2;
  return static_cast<float>(area_facing(static_cast<double>(w.z), std::sqrt(static_cast<double>(across2))));
}

float Microfacets::smith_visibility(Vec3 wo, Vec3 wi) const {
  const float area_o = projected_area(wo), area_i = projected_area(wi);
  if (kind_.masking == SmithMasking::kSeparable) return 0.25f / (area_o * area_i);
  return 0.25f / (area_o * wi.z + area_i * wo.z - wo.z * wi.z);
}

// Beckmann's slopes are sampled along and across the direction to the viewer, where they are independent
// (Heitz and d'Eon 2014; Jakob 2014).
Vec3 Microfacets::sample_visible(Vec3 wo, Vec2 u) const {
  if (kind_.distribution == MicrofacetDistribution::kGgx)
    return AnisotropicGgx(alpha_x_, alpha_y_).sample_visible(wo, u);
  const Vec3 stretched = normalize(Vec3{alpha_x_ * wo.x, alpha_y_ * wo.y, wo.z});
  const float sine = std::sqrt(stretched.x * stretched.x + stretched.y * stretched.y);
  const Vec2 toward = sine > 0 ? Vec2{stretched.x / sine, stretched.y / sine} : Vec2{1, 0};
  const auto along = static_cast<float>(
      slope_at(inside_unit(u.x), static_cast<double>(stretched.z), static_cast<double>(sine)));
  const auto across = static_cast<float>(slope_at(inside_unit(u.y), 1, 0));
  return normalize(Vec3{-alpha_x_ * (toward.x * along - toward.y * across),
                        -alpha_y_ * (toward.y * along + toward.x * across), 1});
}

}  // namespace tessera::core
