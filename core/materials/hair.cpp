// SPDX-License-Identifier: Apache-2.0
#include "core/materials/hair.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/materials/fresnel.hpp"
#include "core/math/bessel.hpp"
#include "core/math/elementary.hpp"

namespace tessera::core {
namespace {

constexpr double kHairPi = std::numbers::pi;
// Below these, lobes are too narrow for the numbers that sample them.
constexpr float kMinHairRoughness = 0.02f, kMinHairIor = 1.01f;

double power(double x, int n) {
  double product = 1;
  for (; n > 0; n >>= 1, x *= x)
    if ((n & 1) != 0) product *= x;
  return product;
}

// The polynomial of Chiang et al. 2016, equation 9, in the azimuthal roughness.
double multiple_scattering(float beta_n) {
  const double b = static_cast<double>(std::clamp(beta_n, kMinHairRoughness, 1.0f));
  return 5.969 + b * (-0.215 + b * (2.532 + b * (-10.73 + b * (5.574 + b * 0.245))));
}

double safe_sqrt(double x) {
  return std::sqrt(std::max(x, 0.0));
}

// From -1 to 1, to -pi/2 to pi/2.
double arc_sine(double x) {
  return static_cast<double>(atan2(static_cast<float>(x), static_cast<float>(safe_sqrt(1 - x * x))));
}

// The sum of the lobes' light, per channel, that is not lost by absorption alone.
Rgb transmitted(Rgb absorption, double path) {
  const auto channel = [path](float a) { return static_cast<float>(exp(-static_cast<double>(a) * path)); };
  return {channel(absorption.r), channel(absorption.g), channel(absorption.b)};
}

}  // namespace

Rgb hair_absorption(Rgb color, float beta_n) {
  const double scale = 1 / multiple_scattering(beta_n);
  const auto channel = [scale](float c) {
    constexpr float kDarkest = 1e-4f;
    const double x = log(static_cast<double>(std::clamp(c, kDarkest, 1.0f))) * scale;
    return static_cast<float>(x * x);
  };
  return {channel(color.r), channel(color.g), channel(color.b)};
}

Rgb hair_color(Rgb absorption, float beta_n) {
  const double scale = multiple_scattering(beta_n);
  const auto channel = [scale](float a) {
    return static_cast<float>(exp(-scale * safe_sqrt(static_cast<double>(a))));
  };
  return {channel(absorption.r), channel(absorption.g), channel(absorption.b)};
}

Rgb melanin_absorption(float eumelanin, float pheomelanin) {
  return Rgb{0.419f, 0.697f, 1.37f} * std::max(eumelanin, 0.0f) +
         Rgb{0.187f, 0.4f, 1.05f} * std::max(pheomelanin, 0.0f);
}

Rgb absorption_at(const Hair& model, const std::vector<Texture>& textures, const UvSets& uv) {
  const auto at = [&](const auto& parameter) { return parameter.evaluate(textures, uv); };
  switch (model.pigment) {
    case HairPigment::kReflectance:
      return hair_absorption(at(model.reflectance), at(model.beta_n));
    case HairPigment::kAbsorption:
      return at(model.sigma_a);
    case HairPigment::kMelanin:
      break;
  }
  return melanin_absorption(at(model.eumelanin), at(model.pheomelanin));
}

HairBsdf::HairBsdf(const Hair& model, const std::vector<Texture>& textures, const UvSets& uv)
    : absorption_(absorption_at(model, textures, uv)) {
  const auto at = [&](const ScalarParameter& parameter) { return parameter.evaluate(textures, uv); };
  const auto roughness = [&](const ScalarParameter& parameter) {
    return static_cast<double>(std::clamp(at(parameter), kMinHairRoughness, 1.0f));
  };
  offset_ = static_cast<double>(std::clamp(2 * uv.first.y - 1, -1.0f, 1.0f));
  offset_angle_ = arc_sine(offset_);
  eta_ = static_cast<double>(std::clamp(at(model.ior), kMinHairIor, kMaxIor));

  const double beta_m = roughness(model.beta_m), beta_n = roughness(model.beta_n);
  const double deviation = 0.726 * beta_m + 0.812 * beta_m * beta_m + 3.7 * power(beta_m, 20);
  const double variance = deviation * deviation;
  const std::array<double, kLobes> variances{variance, variance / 4, 4 * variance, 4 * variance};
  for (std::size_t p = 0; p < kLobes; ++p) {
    inverse_variances_[p] = 1 / variances[p];
    norms_[p] = inverse_variances_[p] / (1 - exp(-2 * inverse_variances_[p]));
  }
  constexpr double kSqrtPiOver8 = 0.62665706865775012560;
  logistic_scale_ = kSqrtPiOver8 * (0.265 * beta_n + 1.194 * beta_n * beta_n + 5.372 * power(beta_n, 22));
  logistic_start_ = 1 / (1 + exp(kHairPi / logistic_scale_));
  logistic_norm_ = 1 - 2 * logistic_start_;

  const float tilt = model.tilt_degrees * (1.0f / 360);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [sine, cosine] = sin_cos_turns(tilt * static_cast<float>(1u << i));
    tilt_sines_[i] = static_cast<double>(sine);
    tilt_cosines_[i] = static_cast<double>(cosine);
  }
}

void HairBsdf::orient(Vec3 tangent_local) {
  const float size = length(tangent_local);
  if (!(size > 0)) return;
  const Vec3 axis = tangent_local / size;
  const Vec3 across = Vec3{0, 0, 1} - axis * axis.z;
  const float across_size = length(across);
  if (!(across_size > 1e-3f)) return;
  axis_ = axis;
  normal_ = across / across_size;
  side_ = cross(normal_, axis_);
}

HairBsdf::Inclined HairBsdf::incline(Vec3 w) const {
  const double sine = std::clamp(static_cast<double>(dot(w, axis_)), -1.0, 1.0);
  return {sine, safe_sqrt(1 - sine * sine), static_cast<double>(atan2(dot(w, normal_), dot(w, side_)))};
}

// The light that takes the way of each lobe: Fresnel's reflectance and the absorption along the ray inside.
void HairBsdf::attenuate(const Inclined& wo, Viewed& viewed) const {
  const double cos_o = std::max(wo.cosine, 1e-6);
  const double sin_t = wo.sine / eta_, cos_t = safe_sqrt(1 - sin_t * sin_t);
  const double eta_across = safe_sqrt(eta_ * eta_ - wo.sine * wo.sine) / cos_o;  // seen across the hair
  const double sin_gamma = offset_ / eta_across, cos_gamma = safe_sqrt(1 - sin_gamma * sin_gamma);
  viewed.refracted_offset = arc_sine(sin_gamma);
  const Rgb inside = transmitted(absorption_, 2 * cos_gamma / cos_t);
  const double cos_normal = wo.cosine * safe_sqrt(1 - offset_ * offset_);
  const float f = fresnel_dielectric(static_cast<float>(cos_normal), static_cast<float>(eta_));
  const Rgb once = inside * ((1 - f) * (1 - f)), twice = once * inside * f;
  const auto rest = [f](float twice_channel, float inside_channel) {
    return twice_channel * f * inside_channel / (1 - inside_channel * f);
  };
  viewed.attenuations = {Rgb::gray(f), once, twice,
                         Rgb{rest(twice.r, inside.r), rest(twice.g, inside.g), rest(twice.b, inside.b)}};
  if (f >= 1) viewed.attenuations = {Rgb::gray(1), Rgb{}, Rgb{}, Rgb{}};
}

HairBsdf::Viewed HairBsdf::view(Vec3 wo_local) const {
  const Inclined wo = incline(wo_local);
  Viewed viewed;
  viewed.azimuth = wo.azimuth;
  attenuate(wo, viewed);
  double sum = 0;
  for (std::size_t p = 0; p < kLobes; ++p) sum += static_cast<double>(mean(viewed.attenuations[p]));
  for (std::size_t p = 0; p < kLobes; ++p)
    viewed.chances[p] = static_cast<double>(mean(viewed.attenuations[p])) / sum;
  // Scales tilt R back by twice their angle, TT forward by it, and TRT by four times.
  constexpr std::array<std::size_t, 3> kTilt{1, 0, 2};
  for (std::size_t p = 0; p < 3; ++p) {
    const double sine = p == 0 ? -tilt_sines_[kTilt[p]] : tilt_sines_[kTilt[p]];
    const double cosine = tilt_cosines_[kTilt[p]];
    viewed.sines[p] = wo.sine * cosine + wo.cosine * sine;
    viewed.cosines[p] = std::fabs(wo.cosine * cosine - wo.sine * sine);
  }
  viewed.sines[3] = wo.sine;
  viewed.cosines[3] = wo.cosine;
  return viewed;
}

// d'Eon et al. 2011, equation 7: a Gaussian on the sphere, averaged over the azimuth.
double HairBsdf::longitudinal(std::size_t lobe, const Viewed& viewed, const Inclined& wi) const {
  const double inverse = inverse_variances_[lobe];
  const double a = wi.cosine * viewed.cosines[lobe] * inverse, b = wi.sine * viewed.sines[lobe] * inverse;
  return norms_[lobe] * exp(a - b - inverse) * scaled_bessel_i0(a);
}

double HairBsdf::turn(std::size_t lobe, const Viewed& viewed) const {
  const auto p = static_cast<double>(lobe);
  return 2 * p * viewed.refracted_offset - 2 * offset_angle_ + p * kHairPi;
}

// A logistic distribution, cut off at half a turn.
double HairBsdf::azimuthal(std::size_t lobe, const Viewed& viewed, double wi_azimuth) const {
  if (lobe == kLobes - 1) return 1 / (2 * kHairPi);
  double angle = wi_azimuth - viewed.azimuth - turn(lobe, viewed);
  angle -= 2 * kHairPi * std::nearbyint(angle / (2 * kHairPi));
  const double e = exp(-std::fabs(angle) / logistic_scale_);
  return e / (logistic_scale_ * (1 + e) * (1 + e) * logistic_norm_);
}

BsdfValue HairBsdf::evaluate(const Viewed& viewed, Vec3 wi_local) const {
  const Inclined wi = incline(wi_local);
  Rgb value{};
  double pdf = 0;
  for (std::size_t p = 0; p < kLobes; ++p) {
    const double lobe = longitudinal(p, viewed, wi) * azimuthal(p, viewed, wi.azimuth);
    value += viewed.attenuations[p] * static_cast<float>(lobe);
    pdf += viewed.chances[p] * lobe;
  }
  return {value, static_cast<float>(pdf)};
}

BsdfValue HairBsdf::evaluate(Vec3 wo_local, Vec3 wi_local, float) const {
  if (wo_local.z <= 0) return {};
  return evaluate(view(wo_local), wi_local);
}

std::optional<BsdfSample> HairBsdf::sample(Vec3 wo_local, Vec2 u, float u_lobe) const {
  if (wo_local.z <= 0) return std::nullopt;
  const Viewed viewed = view(wo_local);
  double rest = static_cast<double>(u_lobe);
  std::size_t p = 0;
  while (p + 1 < kLobes && rest >= viewed.chances[p]) rest -= viewed.chances[p++];
  rest = viewed.chances[p] > 0 ? std::clamp(rest / viewed.chances[p], 0.0, 1.0) : 0;

  // d'Eon et al. 2013: the inclination.
  const double u_x = static_cast<double>(u.x), inverse = inverse_variances_[p];
  const double cos_theta = 1 + log(std::max(u_x + (1 - u_x) * exp(-2 * inverse), 1e-300)) / inverse;
  const double sin_theta = safe_sqrt(1 - cos_theta * cos_theta);
  const auto [unused, cos_phi] = sin_cos_turns(u.y);
  const double sine = std::clamp(
      -cos_theta * viewed.sines[p] + sin_theta * static_cast<double>(cos_phi) * viewed.cosines[p], -1.0, 1.0);
  const double cosine = safe_sqrt(1 - sine * sine);

  double angle = 2 * kHairPi * rest;
  if (p + 1 < kLobes) {
    const double share = std::clamp(logistic_start_ + rest * logistic_norm_, 1e-300, 1 - 1e-16);
    angle = turn(p, viewed) - logistic_scale_ * log(1 / share - 1);
  }
  const double turns = (viewed.azimuth + angle) / (2 * kHairPi);
  const auto [sin_azimuth, cos_azimuth] = sin_cos_turns(static_cast<float>(turns));
  const Vec3 wi = normalize(axis_ * static_cast<float>(sine) +
                            (side_ * cos_azimuth + normal_ * sin_azimuth) * static_cast<float>(cosine));
  const BsdfValue value = evaluate(viewed, wi);
  if (!(value.pdf > 0)) return std::nullopt;
  BsdfSample sample = weighed_sample(wi, value);
  sample.transmitted = wi.z < 0;
  return sample;
}

}  // namespace tessera::core
