// SPDX-License-Identifier: Apache-2.0
#include "core/shading/hair_bsdf.hpp"

#include <cmath>
#include <numbers>

#include "core/materials/fresnel.hpp"
#include "core/materials/hair.hpp"
#include "core/math/bessel.hpp"
#include "core/math/elementary.hpp"

namespace tessera::core::shading {
namespace {

constexpr double kHairPi = std::numbers::pi;
constexpr float kMinHairIor = 1.01f;

template <typename Real>
Real power(Real x, int n) {
  Real product = 1;
  for (; n > 0; n >>= 1, x = x * x)
    if ((n & 1) != 0) product = product * x;
  return product;
}

template <typename Real>
Real safe_sqrt(Real x) {
  using std::sqrt;
  return sqrt(larger(x, Real(0.0)));
}

// From -1 to 1, to -pi/2 to pi/2.
template <typename T>
WideOf<T> arc_sine(WideOf<T> x) {
  return widened(atan2<T>(to_float(x), to_float(safe_sqrt(1 - x * x))));
}

// The sum of the lobes' light, per channel, that is not lost by absorption alone.
template <typename T>
RgbOf<T> transmitted(RgbOf<T> absorption, WideOf<T> path) {
  const auto channel = [path](T a) { return to_float(exp(-widened(a) * path)); };
  return {channel(absorption.r), channel(absorption.g), channel(absorption.b)};
}

}  // namespace

template <typename T>
HairBsdfOf<T>::HairBsdfOf(const ModelAt<T, Hair>& model) : absorption_(absorption_of(model)) {
  const auto roughness = [&](ScalarParameter Hair::*parameter) {
    return widened(clamp_between(model(parameter), kMinHairRoughness, 1.0f));
  };
  offset_ = widened(clamp_between(2 * model.at().texture_point.uv.first.y - 1, -1.0f, 1.0f));
  offset_angle_ = arc_sine<T>(offset_);
  eta_ = widened(clamp_between(model(&Hair::ior), kMinHairIor, kMaxIor));
  set_longitudinal(roughness(&Hair::beta_m));
  set_azimuthal(roughness(&Hair::beta_n));
  set_tilts(model.number(&Hair::tilt_degrees));
}

template <typename T>
void HairBsdfOf<T>::set_longitudinal(Real beta_m) {
  const Real deviation = 0.726 * beta_m + 0.812 * beta_m * beta_m + 3.7 * power(beta_m, 20);
  const Real variance = deviation * deviation;
  const std::array<Real, kLobes> variances{variance, variance / 4, 4 * variance, 4 * variance};
  for (std::size_t p = 0; p < kLobes; ++p) {
    inverse_variances_[p] = 1 / variances[p];
    norms_[p] = inverse_variances_[p] / (1 - exp(-2 * inverse_variances_[p]));
  }
}

template <typename T>
void HairBsdfOf<T>::set_azimuthal(Real beta_n) {
  constexpr double kSqrtPiOver8 = 0.62665706865775012560;
  logistic_scale_ = kSqrtPiOver8 * (0.265 * beta_n + 1.194 * beta_n * beta_n + 5.372 * power(beta_n, 22));
  logistic_start_ = 1 / (1 + exp(kHairPi / logistic_scale_));
  logistic_norm_ = 1 - 2 * logistic_start_;
}

template <typename T>
void HairBsdfOf<T>::set_tilts(T degrees) {
  const T turns = degrees * (1.0f / 360);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [sine, cosine] = sin_cos_turns(turns * static_cast<float>(1u << i));
    tilt_sines_[i] = widened(sine);
    tilt_cosines_[i] = widened(cosine);
  }
}

template <typename T>
void HairBsdfOf<T>::orient(Vec3Of<T> tangent_local) {
  const T size = length(tangent_local);
  const Vec3Of<T> axis = tangent_local / size;
  const Vec3Of<T> across = Vec3Of<T>{T(0.0f), T(0.0f), T(1.0f)} - axis * axis.z;
  const T across_size = length(across);
  const MaskOf<T> known = (size > 0) & (across_size > 1e-3f);
  axis_ = select(known, axis, axis_);
  normal_ = select(known, across / across_size, normal_);
  side_ = select(known, cross(normal_, axis_), side_);
}

template <typename T>
typename HairBsdfOf<T>::Inclined HairBsdfOf<T>::incline(Vec3Of<T> w) const {
  const Real sine = clamp_between(widened(dot(w, axis_)), -1.0, 1.0);
  return {sine, safe_sqrt(1 - sine * sine), widened(atan2<T>(dot(w, normal_), dot(w, side_)))};
}

// The light that takes the way of each lobe: Fresnel's reflectance and the absorption along the ray inside.
template <typename T>
void HairBsdfOf<T>::attenuate(const Inclined& wo, Viewed& viewed) const {
  const Real cos_o = larger(wo.cosine, Real(1e-6));
  const Real sin_t = wo.sine / eta_, cos_t = safe_sqrt(1 - sin_t * sin_t);
  const Real eta_across = safe_sqrt(eta_ * eta_ - wo.sine * wo.sine) / cos_o;  // seen across the hair
  const Real sin_gamma = offset_ / eta_across, cos_gamma = safe_sqrt(1 - sin_gamma * sin_gamma);
  viewed.refracted_offset = arc_sine<T>(sin_gamma);
  const RgbOf<T> inside = transmitted<T>(absorption_, 2 * cos_gamma / cos_t);
  const Real cos_normal = wo.cosine * safe_sqrt(1 - offset_ * offset_);
  const T f = fresnel_dielectric<T>(to_float(cos_normal), to_float(eta_));
  const RgbOf<T> once = inside * ((1 - f) * (1 - f)), twice = once * inside * f;
  const auto rest = [f](T twice_channel, T inside_channel) {
    return twice_channel * f * inside_channel / (1 - inside_channel * f);
  };
  viewed.attenuations = {RgbOf<T>::gray(f), once, twice,
                         RgbOf<T>{rest(twice.r, inside.r), rest(twice.g, inside.g), rest(twice.b, inside.b)}};
  const MaskOf<T> total = f >= 1;
  if (!any(total)) return;
  for (std::size_t p = 0; p < kLobes; ++p)
    viewed.attenuations[p] = select(total, RgbOf<T>::gray(T(p == 0 ? 1.0f : 0.0f)), viewed.attenuations[p]);
}

// Scales tilt R back by twice their angle, TT forward by it, and TRT by four times.
template <typename T>
void HairBsdfOf<T>::tilt(const Inclined& wo, Viewed& viewed) const {
  using std::fabs;
  constexpr std::array<std::size_t, 3> kTilt{1, 0, 2};
  for (std::size_t p = 0; p < 3; ++p) {
    const Real sine = p == 0 ? -tilt_sines_[kTilt[p]] : tilt_sines_[kTilt[p]];
    const Real cosine = tilt_cosines_[kTilt[p]];
    viewed.sines[p] = wo.sine * cosine + wo.cosine * sine;
    viewed.cosines[p] = fabs(wo.cosine * cosine - wo.sine * sine);
  }
  viewed.sines[3] = wo.sine;
  viewed.cosines[3] = wo.cosine;
}

template <typename T>
typename HairBsdfOf<T>::Viewed HairBsdfOf<T>::view(Vec3Of<T> wo_local) const {
  const Inclined wo = incline(wo_local);
  Viewed viewed;
  viewed.azimuth = wo.azimuth;
  attenuate(wo, viewed);
  Real sum = 0;
  for (std::size_t p = 0; p < kLobes; ++p) sum = sum + widened(mean(viewed.attenuations[p]));
  for (std::size_t p = 0; p < kLobes; ++p) viewed.chances[p] = widened(mean(viewed.attenuations[p])) / sum;
  tilt(wo, viewed);
  return viewed;
}

// d'Eon et al. 2011, equation 7: a Gaussian on the sphere, averaged over the azimuth.
template <typename T>
WideOf<T> HairBsdfOf<T>::longitudinal(std::size_t lobe, const Viewed& viewed, const Inclined& wi) const {
  const Real inverse = inverse_variances_[lobe];
  const Real a = wi.cosine * viewed.cosines[lobe] * inverse, b = wi.sine * viewed.sines[lobe] * inverse;
  return norms_[lobe] * exp(a - b - inverse) * scaled_bessel_i0(a);
}

template <typename T>
WideOf<T> HairBsdfOf<T>::turn(std::size_t lobe, const Viewed& viewed) const {
  const auto p = static_cast<double>(lobe);
  return 2 * p * viewed.refracted_offset - 2 * offset_angle_ + p * kHairPi;
}

// A logistic distribution, cut off at half a turn.
template <typename T>
WideOf<T> HairBsdfOf<T>::azimuthal(std::size_t lobe, const Viewed& viewed, Real wi_azimuth) const {
  using std::fabs, std::nearbyint;
  if (lobe == kLobes - 1) return 1 / (2 * kHairPi);
  Real angle = wi_azimuth - viewed.azimuth - turn(lobe, viewed);
  angle = angle - 2 * kHairPi * nearbyint(angle / (2 * kHairPi));
  const Real e = exp(-fabs(angle) / logistic_scale_);
  return e / (logistic_scale_ * (1 + e) * (1 + e) * logistic_norm_);
}

template <typename T>
BsdfValueOf<T> HairBsdfOf<T>::evaluate(const Viewed& viewed, Vec3Of<T> wi_local) const {
  const Inclined wi = incline(wi_local);
  RgbOf<T> value{};
  Real pdf = 0;
  for (std::size_t p = 0; p < kLobes; ++p) {
    const Real lobe = longitudinal(p, viewed, wi) * azimuthal(p, viewed, wi.azimuth);
    value += viewed.attenuations[p] * to_float(lobe);
    pdf = pdf + viewed.chances[p] * lobe;
  }
  return {value, to_float(pdf)};
}

template <typename T>
BsdfValueOf<T> HairBsdfOf<T>::evaluate(Vec3Of<T> wo_local, Vec3Of<T> wi_local, T) const {
  const MaskOf<T> seen = !(wo_local.z <= 0);
  if (!any(seen)) return {};
  return only_where<T>(seen, evaluate(view(wo_local), wi_local));
}

template <typename T>
typename HairBsdfOf<T>::Chosen HairBsdfOf<T>::choose(const Viewed& viewed, T u_lobe) const {
  Chosen chosen{true, widened(u_lobe), inverse_variances_[3], viewed.sines[3], viewed.cosines[3], Real(0.0)};
  Real chance = viewed.chances[3];
  for (std::size_t p = 0; p + 1 < kLobes; ++p) {
    const MaskOf<T> beyond = chosen.is_last & (chosen.u >= viewed.chances[p]);
    const MaskOf<T> is_this = chosen.is_last & !beyond;
    chosen.u = select(beyond, chosen.u - viewed.chances[p], chosen.u);
    chosen.inverse_variance = select(is_this, inverse_variances_[p], chosen.inverse_variance);
    chosen.sine = select(is_this, viewed.sines[p], chosen.sine);
    chosen.cosine = select(is_this, viewed.cosines[p], chosen.cosine);
    chosen.turn = select(is_this, turn(p, viewed), chosen.turn);
    chance = select(is_this, viewed.chances[p], chance);
    chosen.is_last = beyond;
  }
  chosen.u = select(chance > 0, clamp_between(chosen.u / chance, 0.0, 1.0), Real(0.0));
  return chosen;
}

template <typename T>
typename HairBsdfOf<T>::Inclined HairBsdfOf<T>::sample_lobe(const Chosen& lobe, const Viewed& viewed,
                                                            Vec2Of<T> u) const {
  // d'Eon et al. 2013: the inclination.
  const Real u_x = widened(u.x), inverse = lobe.inverse_variance;
  const Real cos_theta = 1 + log(larger(u_x + (1 - u_x) * exp(-2 * inverse), Real(1e-300))) / inverse;
  const Real sin_theta = safe_sqrt(1 - cos_theta * cos_theta);
  const Real cos_phi = widened(sin_cos_turns(u.y).cos);
  const Real sine = clamp_between(-cos_theta * lobe.sine + sin_theta * cos_phi * lobe.cosine, -1.0, 1.0);
  const Real share = clamp_between(logistic_start_ + lobe.u * logistic_norm_, 1e-300, 1 - 1e-16);
  const Real angle =
      select(lobe.is_last, 2 * kHairPi * lobe.u, lobe.turn - logistic_scale_ * log(1 / share - 1));
  return {sine, safe_sqrt(1 - sine * sine), viewed.azimuth + angle};
}

template <typename T>
BsdfSampleOf<T> HairBsdfOf<T>::sample(Vec3Of<T> wo_local, Vec2Of<T> u, T u_lobe) const {
  const MaskOf<T> seen = !(wo_local.z <= 0);
  if (!any(seen)) return {};
  const Viewed viewed = view(wo_local);
  const Inclined sampled = sample_lobe(choose(viewed, u_lobe), viewed, u);
  const auto [sin_azimuth, cos_azimuth] = sin_cos_turns(to_float(sampled.azimuth / (2 * kHairPi)));
  const Vec3Of<T> wi = normalize(axis_ * to_float(sampled.sine) +
                                 (side_ * cos_azimuth + normal_ * sin_azimuth) * to_float(sampled.cosine));
  return weighed_sample<T>(seen, wi, evaluate(viewed, wi), T(1.0f));
}

template class HairBsdfOf<float>;
template class HairBsdfOf<FloatN>;

}  // namespace tessera::core::shading
