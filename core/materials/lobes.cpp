// SPDX-License-Identifier: Apache-2.0
#include "core/materials/lobes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/materials/limits.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core {
namespace {

const DirectionalAlbedo& albedos() {
  return DirectionalAlbedo::tables();
}

// A sample that the mixture weighs.
BsdfSample toward(Vec3 wi) {
  BsdfSample sample;
  sample.wi_local = wi;
  sample.transmitted = wi.z < 0;
  return sample;
}

Vec3 mirror_direction(Vec3 wo) {
  return {-wo.x, -wo.y, wo.z};
}

// Constants of Portsmouth, Kutz and Hill 2025: 1/2 - 2 / (3 pi) and 2/3 - 28 / (15 pi).
constexpr float kFujii1 = 0.287793409f, kFujii2 = 0.0724882112f;

// The directional albedo of Fujii's model for a white surface (ibid., the polynomial fit).
float fujii_albedo(float cosine, float roughness) {
  const float m = 1 - cosine;
  const float g = m * (0.0571085289f + m * (0.491881867f + m * (-0.332181442f + m * 0.0714429953f)));
  return (1 + roughness * g) / (1 + kFujii1 * roughness);
}

float mean_fujii_albedo(float roughness) {
  return (1 + kFujii2 * roughness) / (1 + kFujii1 * roughness);
}

Rgb plus(Rgb a, float b) {
  return a + Rgb::gray(b);
}

Rgb ratio(Rgb a, Rgb b) {
  return {a.r / b.r, a.g / b.g, a.b / b.b};
}

}  // namespace

DiffuseLobe::DiffuseLobe(Rgb reflectance, float oren_nayar_roughness)
    : color(reflectance), roughness(oren_nayar_roughness) {
  const float mean = mean_fujii_albedo(roughness);
  multiple_scattering = ratio(color * color * mean, plus(color * (mean - 1), 1));
}

BsdfValue DiffuseLobe::evaluate(Vec3 wo, Vec3 wi, float diffuse_cos) const {
  if (wi.z <= 0) return {};
  const float pdf = pdf_cosine_hemisphere(wi.z);
  if (roughness == 0) return {color * (diffuse_cos / kPi), pdf};
  const float s = dot(wi, wo) - wi.z * wo.z;
  const float s_over_t = s > 0 ? s / std::max(wi.z, wo.z) : s;
  const float single = (1 + roughness * s_over_t) / (1 + kFujii1 * roughness);
  const float lost_mean = 1 - mean_fujii_albedo(roughness);
  const float multiple = std::max(0.0f, 1 - fujii_albedo(wo.z, roughness)) *
                         std::max(0.0f, 1 - fujii_albedo(wi.z, roughness)) / std::max(1e-7f, lost_mean);
  return {(color * single + multiple_scattering * multiple) * (diffuse_cos / kPi), pdf};
}

std::optional<BsdfSample> DiffuseLobe::sample(Vec3, Vec2 u, float) const {
  return toward(sample_cosine_hemisphere(u));
}

BsdfValue DiffuseTransmissionLobe::evaluate(Vec3, Vec3 wi, float) const {
  if (wi.z >= 0) return {};
  return {Rgb::gray(-wi.z / kPi), pdf_cosine_hemisphere(-wi.z)};
}

std::optional<BsdfSample> DiffuseTransmissionLobe::sample(Vec3, Vec2 u, float) const {
  const Vec3 above = sample_cosine_hemisphere(u);
  return toward({above.x, above.y, -above.z});
}

// The boundary throws back what it does not transmit, whose mean from inside is that from outside over eta^2
// (reciprocity).
CoveredDiffuseLobe::CoveredDiffuseLobe(Rgb reflectance, float eta, float alpha, bool nonlinear)
    : eta_(eta), alpha_(alpha), mean_transmitted_(albedos().mean_transmitted(alpha, eta)) {
  const float thrown_back = 1 - mean_transmitted_ / (eta * eta);
  const Rgb again = nonlinear ? reflectance * thrown_back : Rgb::gray(thrown_back);
  color_ = ratio(reflectance, Rgb::gray(1) - again) / (eta * eta);
}

float CoveredDiffuseLobe::transmitted(float cosine) const {
  if (alpha_ < kMinAlpha) return 1 - fresnel_dielectric(cosine, eta_);
  return albedos().scattered(cosine, alpha_, eta_) - albedos().reflected(cosine, alpha_, eta_);
}

BsdfValue CoveredDiffuseLobe::evaluate(Vec3 wo, Vec3 wi, float diffuse_cos) const {
  if (wi.z <= 0) return {};
  return {color_ * (transmitted(wo.z) * transmitted(wi.z) * diffuse_cos / kPi), pdf_cosine_hemisphere(wi.z)};
}

std::optional<BsdfSample> CoveredDiffuseLobe::sample(Vec3, Vec2 u, float) const {
  return toward(sample_cosine_hemisphere(u));
}

namespace {

constexpr float kMinSheenRoughness = 0.1f;

float sheen(Vec3 wo, Vec3 wi, float roughness) {
  const float cos_h = (wo.z + wi.z) / length(wo + wi);
  const float sin2 = std::max(0.0f, 1 - cos_h * cos_h);
  const float inverse_alpha = 1 / (roughness * roughness);
  const auto power =
      static_cast<float>(pow(static_cast<double>(sin2), static_cast<double>(inverse_alpha) / 2));
  const float density = (2 + inverse_alpha) * power / (2 * kPi);
  return density / (4 * (wo.z + wi.z - wo.z * wi.z));
}

// The directional albedo of sheen, by quadrature; thread-safe.
class SheenAlbedo {
 public:
  static const SheenAlbedo& table() {
    static const SheenAlbedo all;
    return all;
  }

  float operator()(float cos_o, float roughness) const {
    const auto [row, row_share] = between((roughness - kMinSheenRoughness) / (1 - kMinSheenRoughness));
    const auto [column, column_share] = between(cos_o);
    const auto along = [&, c = column, s = column_share](std::size_t r) {
      return values_[r][c] + s * (values_[r][c + 1] - values_[r][c]);
    };
    return along(row) + row_share * (along(row + 1) - along(row));
  }

 private:
  static constexpr std::size_t kNodes = 16;

  static float place_of(std::size_t node) { return static_cast<float>(node) / (kNodes - 1.0f); }
  static std::pair<std::size_t, float> between(float place) {
    const float scaled = std::clamp(place, 0.0f, 1.0f) * (kNodes - 1.0f);
    const std::size_t low = std::min(static_cast<std::size_t>(scaled), kNodes - 2);
    return {low, scaled - static_cast<float>(low)};
  }

  SheenAlbedo() {
    for (std::size_t row = 0; row < kNodes; ++row)
      for (std::size_t column = 0; column < kNodes; ++column)
        values_[row][column] = integrated(std::max(1e-3f, place_of(column)),
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

SheenLobe::SheenLobe(float sheen_roughness) : roughness(std::max(kMinSheenRoughness, sheen_roughness)) {}

// Where it would reflect more than it receives, it is scaled down to that.
BsdfValue SheenLobe::evaluate(Vec3 wo, Vec3 wi, float) const {
  if (wi.z <= 0) return {};
  const float scale = 1 / std::max(1.0f, SheenAlbedo::table()(wo.z, roughness));
  return {Rgb::gray(sheen(wo, wi, roughness) * wi.z * scale), 1 / (2 * kPi)};
}

std::optional<BsdfSample> SheenLobe::sample(Vec3, Vec2 u, float) const {
  return toward(sample_hemisphere(u));
}

float SheenLobe::albedo(float cos_o) const {
  return std::min(1.0f, SheenAlbedo::table()(cos_o, roughness));
}

namespace {

constexpr float kEdgeCos = 1.0f / 7;

float edge_shape(float cos_i) {
  const float m = 1 - cos_i, m2 = m * m;
  return cos_i * m2 * m2 * m2;
}

}  // namespace

EdgeTintReflectance::EdgeTintReflectance(Rgb f0, Rgb edge)
    : f0_(f0), dip_(fresnel_schlick(kEdgeCos, f0) * (Rgb::gray(1) - edge) / edge_shape(kEdgeCos)) {}

Rgb EdgeTintReflectance::operator()(float cos_i) const {
  const Rgb tinted = fresnel_schlick(cos_i, f0_) - dip_ * edge_shape(std::min(1.0f, cos_i));
  return {std::max(0.0f, tinted.r), std::max(0.0f, tinted.g), std::max(0.0f, tinted.b)};
}

// Turquin 2019: the lost light leaves in the shape of the lobe, attenuated as if all of it met facets
// head-on.
template <typename Reflectance>
Rgb GgxLobe<Reflectance>::compensation(float cos_o) const {
  if (!compensated) return Rgb::gray(1);
  const float kept = albedos().reflecting(cos_o, ggx.mean_alpha());
  return plus(reflectance.normal() * (1 / kept - 1), 1);
}

template <typename Reflectance>
BsdfValue GgxLobe<Reflectance>::evaluate(Vec3 wo, Vec3 wi, float) const {
  if (smooth || wi.z <= 0) return {};
  const Vec3 h = normalize(wo + wi);
  const float cos_oh = dot(wo, h);
  const float facets = ggx.density(h) * ggx.smith_visibility(wo, wi) * wi.z;
  return {reflectance(cos_oh) * compensation(wo.z) * facets, ggx.pdf_visible(wo, h) / (4 * cos_oh)};
}

template <typename Reflectance>
std::optional<BsdfSample> GgxLobe<Reflectance>::sample(Vec3 wo, Vec2 u, float) const {
  if (smooth) return delta_sample(mirror_direction(wo), reflectance(wo.z));
  const Vec3 h = ggx.sample_visible(wo, u);
  if (dot(wo, h) <= 0) return std::nullopt;
  const Vec3 wi = normalize(reflect(wo, h));
  if (wi.z <= 0) return std::nullopt;
  return toward(wi);
}

template <typename Reflectance>
std::array<std::optional<BsdfSample>, 2> GgxLobe<Reflectance>::delta_branches(Vec3 wo) const {
  if (!smooth) return {};
  return {sample(wo, {}, 0), std::nullopt};
}

template <typename Reflectance>
float GgxLobe<Reflectance>::albedo(float cos_o) const {
  if (smooth) return max_component(reflectance(cos_o));
  return albedos().reflecting(cos_o, ggx.mean_alpha()) *
         max_component(reflectance(cos_o) * compensation(cos_o));
}

template <>
float GgxLobe<DielectricReflectance>::albedo(float cos_o) const {
  if (smooth) return fresnel_dielectric(cos_o, reflectance.eta);
  return albedos().reflected(cos_o, ggx.mean_alpha(), reflectance.eta) * compensation(cos_o).r;
}

template struct GgxLobe<DielectricReflectance>;
template struct GgxLobe<ConductorReflectance>;
template struct GgxLobe<EdgeTintReflectance>;
template struct GgxLobe<FilmReflectance>;

GlassLobe::GlassLobe(float eta, float alpha, Rgb reflectance, Rgb transmittance)
    : smooth_{eta, DielectricFresnel::kExact, reflectance, transmittance},
      rough_{Ggx(std::max(alpha, kMinAlpha)), eta, DielectricFresnel::kExact, reflectance, transmittance},
      is_smooth_(alpha < kMinAlpha || std::fabs(eta - 1) < kMinBending) {}

BsdfValue GlassLobe::evaluate(Vec3 wo, Vec3 wi, float diffuse_cos) const {
  if (is_smooth_) return {};
  const BsdfValue single = rough_.evaluate(wo, wi, diffuse_cos);
  return {single.value / albedos().scattered(wo.z, rough_.ggx.alpha(), rough_.eta), single.pdf};
}

std::optional<BsdfSample> GlassLobe::sample(Vec3 wo, Vec2 u, float u_lobe) const {
  return is_smooth_ ? smooth_.sample(wo, u, u_lobe) : rough_.sample(wo, u, u_lobe);
}

std::array<std::optional<BsdfSample>, 2> GlassLobe::delta_branches(Vec3 wo) const {
  if (!is_smooth_) return {};
  return smooth_.branches(wo);
}

// Reflection and transmission together are a surface that reflects everything, with what is transmitted
// mirrored to the other side.
BsdfValue ThinGlassLobe::evaluate(Vec3 wo, Vec3 wi, float) const {
  if (smooth || wi.z == 0) return {};
  const Vec3 above{wi.x, wi.y, std::fabs(wi.z)};
  const Vec3 h = normalize(wo + above);
  const float cos_oh = dot(wo, h), back = reflected(cos_oh);
  const float facets = ggx.density(h) * ggx.smith_visibility(wo, above) * above.z /
                       albedos().reflecting(wo.z, ggx.mean_alpha());
  const float pdf = ggx.pdf_visible(wo, h) / (4 * cos_oh);
  if (wi.z > 0) return {reflectance * (back * facets), back * pdf};
  return {transmittance * ((1 - back) * facets), (1 - back) * pdf};
}

std::optional<BsdfSample> ThinGlassLobe::sample(Vec3 wo, Vec2 u, float u_lobe) const {
  if (smooth) {
    if (u_lobe < reflected(wo.z)) return delta_sample(mirror_direction(wo), reflectance);
    BsdfSample through = delta_sample(-wo, transmittance);
    through.transmitted = true;
    return through;
  }
  const Vec3 h = ggx.sample_visible(wo, u);
  const float cos_oh = dot(wo, h);
  if (cos_oh <= 0) return std::nullopt;
  const Vec3 wi = normalize(reflect(wo, h));
  if (wi.z <= 0) return std::nullopt;
  return toward(u_lobe < reflected(cos_oh) ? wi : Vec3{wi.x, wi.y, -wi.z});
}

std::array<std::optional<BsdfSample>, 2> ThinGlassLobe::delta_branches(Vec3 wo) const {
  if (!smooth) return {};
  const float back = reflected(wo.z);
  BsdfSample through = delta_sample(-wo, transmittance * (1 - back));
  through.transmitted = true;
  return {delta_sample(mirror_direction(wo), reflectance * back), through};
}

}  // namespace tessera::core
