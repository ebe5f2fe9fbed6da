// SPDX-License-Identifier: Apache-2.0
#include "core/materials/microfacets.hpp"

#include <array>

#include "core/materials/anisotropic_ggx.hpp"
#include "core/math/elementary.hpp"

namespace tessera::core {
namespace {

constexpr double kInverseSqrtPi = 0.56418958354775628695;

// erfc(x) / exp(-x^2) for x >= 0; the absolute error of erfc is below 1.5e-7 (Hastings 1955). Real is double
// or DoubleN.
template <typename Real>
Real scaled_erfc(Real x) {
  const Real t = 1 / (1 + 0.3275911 * x);
  return t * polynomial(t, std::array{0.254829592, -0.284496736, 1.421413741, -1.453152027, 1.061405429});
}

// The integral of (cosine - s sine) exp(-s^2) / sqrt(pi) over s from minus infinity to `slope`: of the
// microfacets of Beckmann's distribution with alpha 1 whose slope is lower, the area that a viewer at the
// angle sees.
template <typename Real>
Real area_below(Real slope, Real cosine, Real sine) {
  using std::fabs;
  const Real bell = exp(-slope * slope);
  const Real tail = bell * scaled_erfc(fabs(slope));
  return (cosine * select(slope < 0, tail, 2 - tail) + sine * bell * kInverseSqrtPi) / 2;
}

// The area of those that face the viewer.
template <typename Real>
Real area_facing(Real cosine, Real sine) {
  return select(sine * 1e4 < cosine, cosine, area_below(cosine / sine, cosine, sine));
}

// The slope below which the fraction u of the visible area lies, by Newton's method. It starts at the
// inflection of the integral, which is convex below and concave above, so that every step stays on one side
// of the solution.
template <typename T, typename Real = WideOf<T>>
Real slope_at(Real u, Real cosine, Real sine) {
  using std::fabs, std::sqrt;
  constexpr int kMaxSteps = 24;
  constexpr double kTolerance = 1e-7;
  const Real wanted = u * area_facing(cosine, sine);
  Real slope = -sine / (cosine + sqrt(cosine * cosine + 2 * sine * sine));
  MaskOf<T> done = false;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Real missing = wanted - area_below(slope, cosine, sine);
    const Real rate = (cosine - slope * sine) * exp(-slope * slope) * kInverseSqrtPi;
    done = done | (fabs(missing) < kTolerance * wanted) | !(rate > 0);
    if (all(done)) break;
    slope = select(done, slope, slope + missing / rate);
  }
  return slope;
}

// Numbers of which neither slope is infinite.
template <typename T>
WideOf<T> inside_unit(T u) {
  constexpr double kMin = 0x1p-25;
  return clamp_between(widened(u), kMin, 1 - kMin);
}

}  // namespace

template <typename T>
T MicrofacetsOf<T>::density(Vec3Of<T> h) const {
  if (kind_.distribution == MicrofacetDistribution::kGgx)
    return AnisotropicGgxOf<T>(alpha_x_, alpha_y_).density(h);
  const T x = h.x / alpha_x_, y = h.y / alpha_y_, cos2 = h.z * h.z;
  const T bell = to_float(exp(-widened((x * x + y * y) / cos2)));
  return select(cos2 > 0, bell / (kPi * alpha_x_ * alpha_y_ * cos2 * cos2), T(0.0f));
}

template <typename T>
T MicrofacetsOf<T>::projected_area(Vec3Of<T> w) const {
  using std::sqrt;
  const T x = alpha_x_ * w.x, y = alpha_y_ * w.y, across2 = x * x + y * y;
  if (kind_.distribution == MicrofacetDistribution::kGgx) return (w.z + sqrt(across2 + w.z * w.z)) / 2;
  return to_float(area_facing(widened(w.z), sqrt(widened(across2))));
}

template <typename T>
T MicrofacetsOf<T>::smith_visibility(Vec3Of<T> wo, Vec3Of<T> wi) const {
  const T area_o = projected_area(wo), area_i = projected_area(wi);
  if (kind_.masking == SmithMasking::kSeparable) return 0.25f / (area_o * area_i);
  return 0.25f / (area_o * wi.z + area_i * wo.z - wo.z * wi.z);
}

// Beckmann's slopes are sampled along and across the direction to the viewer, where they are independent
// (Heitz and d'Eon 2014; Jakob 2014).
template <typename T>
Vec3Of<T> MicrofacetsOf<T>::sample_visible(Vec3Of<T> wo, Vec2Of<T> u) const {
  using std::sqrt;
  if (kind_.distribution == MicrofacetDistribution::kGgx)
    return AnisotropicGgxOf<T>(alpha_x_, alpha_y_).sample_visible(wo, u);
  const Vec3Of<T> stretched = normalize(Vec3Of<T>{alpha_x_ * wo.x, alpha_y_ * wo.y, wo.z});
  const T sine = sqrt(stretched.x * stretched.x + stretched.y * stretched.y);
  const MaskOf<T> leans = sine > 0;
  const T toward_x = select(leans, stretched.x / sine, T(1.0f));
  const T toward_y = select(leans, stretched.y / sine, T(0.0f));
  const T along = to_float(slope_at<T>(inside_unit(u.x), widened(stretched.z), widened(sine)));
  const T across = to_float(slope_at<T>(inside_unit(u.y), WideOf<T>(1.0), WideOf<T>(0.0)));
  return normalize(Vec3Of<T>{-alpha_x_ * (toward_x * along - toward_y * across),
                             -alpha_y_ * (toward_y * along + toward_x * across), T(1.0f)});
}

template class MicrofacetsOf<float>;
template class MicrofacetsOf<FloatN>;

}  // namespace tessera::core
