// SPDX-License-Identifier: Apache-2.0
#include "core/shading/diffuse_lobes.hpp"

#include <array>
#include <cmath>
#include <cstddef>

#include "core/materials/directional_albedo.hpp"
#include "core/materials/fresnel.hpp"
#include "core/materials/microfacet.hpp"
#include "core/math/table_interpolation.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core::shading {
namespace {

// Constants of Portsmouth, Kutz and Hill 2025: 1/2 - 2 / (3 pi) and 2/3 - 28 / (15 pi).
constexpr float kFujii1 = 0.287793409f, kFujii2 = 0.0724882112f;

// The directional albedo of Fujii's model for a white surface (ibid., the polynomial fit).
template <typename T>
T fujii_albedo(T cosine, T roughness) {
  const T m = 1 - cosine;
  const T g = m * (0.0571085289f + m * (0.491881867f + m * (-0.332181442f + m * 0.0714429953f)));
  return (1 + roughness * g) / (1 + kFujii1 * roughness);
}

template <typename T>
T mean_fujii_albedo(T roughness) {
  return (1 + kFujii2 * roughness) / (1 + kFujii1 * roughness);
}

template <typename T>
BsdfSampleOf<T> cosine_sample(Vec2Of<T> u) {
  return unweighed_sample<T>(true, sampling::sample_cosine_hemisphere(u));
}

}  // namespace

template <typename T>
DiffuseLobe<T>::DiffuseLobe(RgbOf<T> reflectance, T oren_nayar_roughness)
    : color(reflectance), roughness(oren_nayar_roughness) {
  const T mean = mean_fujii_albedo(roughness);
  multiple_scattering = quotient(color * color * mean, plus_gray<T>(color * (mean - 1), 1.0f));
}

template <typename T>
BsdfValueOf<T> DiffuseLobe<T>::evaluate(Vec3Of<T> wo, Vec3Of<T> wi, T diffuse_cos) const {
  const MaskOf<T> rough = roughness != 0, lit = !(wi.z <= 0);
  RgbOf<T> value = color * (diffuse_cos / kPi);
  if (any(rough)) {
    const T s = dot(wi, wo) - wi.z * wo.z;
    const T s_over_t = select(s > 0, s / larger(wi.z, wo.z), s);
    const T single = (1 + roughness * s_over_t) / (1 + kFujii1 * roughness);
    const T lost_mean = 1 - mean_fujii_albedo(roughness);
    const T multiple = larger(T(0.0f), 1 - fujii_albedo(wo.z, roughness)) *
                       larger(T(0.0f), 1 - fujii_albedo(wi.z, roughness)) / larger(T(1e-7f), lost_mean);
    value = select(rough, (color * single + multiple_scattering * multiple) * (diffuse_cos / kPi), value);
  }
  return only_where<T>(lit, {value, sampling::pdf_cosine_hemisphere(wi.z)});
}

template <typename T>
BsdfSampleOf<T> DiffuseLobe<T>::sample(Vec3Of<T>, Vec2Of<T> u, T) const {
  return cosine_sample(u);
}

template <typename T>
BsdfValueOf<T> DiffuseTransmissionLobe<T>::evaluate(Vec3Of<T>, Vec3Of<T> wi, T) const {
  return only_where<T>(!(wi.z >= 0), {RgbOf<T>::gray(-wi.z / kPi), sampling::pdf_cosine_hemisphere(-wi.z)});
}

template <typename T>
BsdfSampleOf<T> DiffuseTransmissionLobe<T>::sample(Vec3Of<T>, Vec2Of<T> u, T) const {
  const Vec3Of<T> above = sampling::sample_cosine_hemisphere(u);
  return unweighed_sample<T>(true, {above.x, above.y, -above.z});
}

// The boundary reflects internally what it does not transmit, whose mean from inside is that from outside
// over eta^2 (reciprocity). Unless compensated, it loses what single scattering does.
template <typename T>
CoveredDiffuseLobe<T>::CoveredDiffuseLobe(RgbOf<T> reflectance, const Boundary& boundary, MaskOf<T> nonlinear,
                                          MaskOf<T> compensated)
    : boundary_(boundary) {
  const DirectionalAlbedo& tables = DirectionalAlbedo::tables(boundary.facets);
  const T eta = boundary.eta;
  mean_transmitted_ = tables.template mean_transmitted<T>(boundary.alpha, eta);
  T kept = T(1.0f);
  if (!all(compensated))
    kept = select(compensated, kept, tables.template mean_scattered_inside<T>(boundary.alpha, eta));
  const T internally_reflected = boundary.internal_reflection * (kept - mean_transmitted_ / (eta * eta));
  const RgbOf<T> again =
      select(nonlinear, reflectance * internally_reflected, RgbOf<T>::gray(internally_reflected));
  color_ = quotient(reflectance, RgbOf<T>::gray(1) - again) / (eta * eta);
}

template <typename T>
T CoveredDiffuseLobe<T>::transmitted(T cosine) const {
  const T alpha = boundary_.alpha, eta = boundary_.eta;
  const MaskOf<T> smooth = alpha < kMinAlpha;
  T rough{};
  if (!all(smooth)) {
    const DirectionalAlbedo& tables = DirectionalAlbedo::tables(boundary_.facets);
    rough =
        tables.template scattered<T>(cosine, alpha, eta) - tables.template reflected<T>(cosine, alpha, eta);
  }
  return any(smooth) ? select(smooth, 1 - fresnel_dielectric<T>(cosine, eta), rough) : rough;
}

template <typename T>
BsdfValueOf<T> CoveredDiffuseLobe<T>::evaluate(Vec3Of<T> wo, Vec3Of<T> wi, T diffuse_cos) const {
  const MaskOf<T> lit = !(wi.z <= 0);
  if (!any(lit)) return {};
  return only_where<T>(lit, {color_ * (transmitted(wo.z) * transmitted(wi.z) * diffuse_cos / kPi),
                             sampling::pdf_cosine_hemisphere(wi.z)});
}

template <typename T>
BsdfSampleOf<T> CoveredDiffuseLobe<T>::sample(Vec3Of<T>, Vec2Of<T> u, T) const {
  return cosine_sample(u);
}

namespace {

constexpr float kMinSheenRoughness = 0.1f;

template <typename T>
T sheen(Vec3Of<T> wo, Vec3Of<T> wi, T roughness) {
  const T cos_h = (wo.z + wi.z) / length(wo + wi);
  const T sin2 = larger(T(0.0f), 1 - cos_h * cos_h);
  const T inverse_alpha = 1 / (roughness * roughness);
  const T power = to_float(pow(widened(sin2), widened(inverse_alpha / 2)));
  const T density = (2 + inverse_alpha) * power / (2 * kPi);
  return density / (4 * (wo.z + wi.z - wo.z * wi.z));
}

// The directional albedo of sheen, by quadrature; thread-safe.
class SheenAlbedo {
 public:
  static const SheenAlbedo& table() {
    static const SheenAlbedo all_values;
    return all_values;
  }

  template <typename T>
  T at(T cos_o, T roughness) const {
    return interpolated<kNodes, kNodes>(values_[0].data(),
                                        (roughness - kMinSheenRoughness) / (1 - kMinSheenRoughness), cos_o);
  }

 private:
  static constexpr std::uint32_t kNodes = 16;

  static float place_of(std::size_t node) { return static_cast<float>(node) / (kNodes - 1.0f); }

  SheenAlbedo() {
    for (std::size_t row = 0; row < kNodes; ++row)
      for (std::size_t column = 0; column < kNodes; ++column)
        values_[row][column] = integrated(larger(1e-3f, place_of(column)),
                                          kMinSheenRoughness + (1 - kMinSheenRoughness) * place_of(row));
  }

  // Over cosines spaced more densely near the horizon, and half of all azimuths.
  static float integrated(float cos_o, float roughness) {
    constexpr int kCosines = 32, kAzimuths = 24;
    const Vec3 wo{std::sqrt(1 - cos_o * cos_o), 0, cos_o};
    float sum = 0;
    for (int i = 0; i < kCosines; ++i) {
      const float root = (static_cast<float>(i) + 0.5f) / kCosines, cos_i = root * root;
      const float sin_i = std::sqrt(1 - cos_i * cos_i);
      for (int j = 0; j < kAzimuths; ++j) {
        const auto [s, c] = sin_cos_turns((static_cast<float>(j) + 0.5f) / (2 * kAzimuths));
        sum += sheen(wo, {sin_i * c, sin_i * s, cos_i}, roughness) * cos_i * 2 * root;
      }
    }
    return sum * 2 * kPi / (kCosines * kAzimuths);
  }

  std::array<std::array<float, kNodes>, kNodes> values_{};
};

}  // namespace

template <typename T>
SheenLobe<T>::SheenLobe(T sheen_roughness) : roughness(larger(T(kMinSheenRoughness), sheen_roughness)) {}

// Where it would reflect more than it receives, it is scaled down to that.
template <typename T>
BsdfValueOf<T> SheenLobe<T>::evaluate(Vec3Of<T> wo, Vec3Of<T> wi, T) const {
  const MaskOf<T> lit = !(wi.z <= 0);
  if (!any(lit)) return {};
  const T scale = 1 / larger(T(1.0f), SheenAlbedo::table().at(wo.z, roughness));
  return only_where<T>(lit, {RgbOf<T>::gray(sheen(wo, wi, roughness) * wi.z * scale), T(1 / (2 * kPi))});
}

template <typename T>
BsdfSampleOf<T> SheenLobe<T>::sample(Vec3Of<T>, Vec2Of<T> u, T) const {
  return unweighed_sample<T>(true, sampling::sample_hemisphere(u));
}

template <typename T>
T SheenLobe<T>::albedo(T cos_o) const {
  return smaller(T(1.0f), SheenAlbedo::table().at(cos_o, roughness));
}

template struct DiffuseLobe<float>;
template struct DiffuseLobe<FloatN>;
template struct DiffuseTransmissionLobe<float>;
template struct DiffuseTransmissionLobe<FloatN>;
template struct CoveredDiffuseLobe<float>;
template struct CoveredDiffuseLobe<FloatN>;
template struct SheenLobe<float>;
template struct SheenLobe<FloatN>;

}  // namespace tessera::core::shading
