// SPDX-License-Identifier: Apache-2.0
#include "core/shading/disney_bsdf.hpp"

#include <cmath>
#include <type_traits>

#include "core/materials/fresnel.hpp"
#include "core/materials/limits.hpp"
#include "core/math/elementary.hpp"
#include "core/sampling/warp.hpp"
#include "core/shading/shares.hpp"

namespace tessera::core::shading {
namespace {

constexpr float kClearcoatF0 = 0.04f, kClearcoatWeight = 0.25f, kClearcoatMaskingAlpha = 0.25f;
constexpr float kSheenAlbedo = 0.2f;  // roughly, for sampling

template <typename T>
RgbOf<T> root(RgbOf<T> color) {
  using std::sqrt;
  return {sqrt(color.r), sqrt(color.g), sqrt(color.b)};
}

// Schlick's weight of the reflectance at grazing angles.
template <typename T>
T grazing(T cosine) {
  return fifth_power(1 - clamp_between(cosine, 0.0f, 1.0f));
}

template <typename T>
Vec3Of<T> mirrored_below(Vec3Of<T> w) {
  return {w.x, w.y, -w.z};
}

template <typename T>
MicrofacetsOf<T> separable_ggx(T roughness, T anisotropic) {
  using std::sqrt;
  const T alpha = squared_roughness(roughness), aspect = sqrt(1 - 0.9f * anisotropic);
  return {{MicrofacetDistribution::kGgx, SmithMasking::kSeparable},
          clamp_between(alpha / aspect, kMinAlpha, 1.0f),
          clamp_between(alpha * aspect, kMinAlpha, 1.0f)};
}

}  // namespace

template <typename T>
DisneyBsdfOf<T>::DisneyBsdfOf(const Model& model)
    : thin_(model.holds([](const Disney& m) { return m.thin_walled; })),
      roughness_(unit(model(&Disney::roughness))) {
  const T ior = clamp_between(model(&Disney::ior), 1.0f, kMaxIor);
  base_color_ = unit(unit(model(&Disney::base_color)) * model.at().tint);
  const MaskOf<T> clear = model.holds([](const Disney& m) { return transmits_light(m); });
  inside_ = clear & !(model.at().outside | thin_);
  const T metallic = select(thin_, T(0.0f), unit(model(&Disney::metallic)));
  const T transmission = unit(model(&Disney::specular_transmission));
  clear_ = (1 - metallic) * transmission;
  eta_ = select(clear_ > 0, larger(ior, T(1 + kMinBending)), ior);
  eta_ = select(inside_, 1 / eta_, eta_);
  const T specular_tint = unit(model(&Disney::specular_tint));
  set_facets(unit(model(&Disney::anisotropic)), ior);
  set_colors(specular_tint, unit(model(&Disney::sheen_tint)), ior);
  set_weights(model, specular_tint, metallic, transmission);
  set_clearcoat(model);
}

// What a sheet transmits is blurred less, the lower the index (Burley 2015, figure 15).
template <typename T>
void DisneyBsdfOf<T>::set_facets(T anisotropic, T ior) {
  facets_ = separable_ggx(roughness_, anisotropic);
  if (any(thin_)) sheet_facets_ = separable_ggx(unit((0.65f * ior - 0.35f) * roughness_), anisotropic);
}

template <typename T>
void DisneyBsdfOf<T>::set_colors(T specular_tint, T sheen_tint, T ior) {
  // Two crossings of a solid give the base colour.
  transmission_color_ = select(thin_, base_color_, root(base_color_));
  sheen_color_ = RgbOf<T>::gray(T(1.0f));
  const MaskOf<T> tinted = (specular_tint != 0) | (sheen_tint != 0);
  if (!any(tinted)) return;
  const T brightness = luminance(base_color_);
  const RgbOf<T> white = sheen_color_, hue = select(brightness > 0, base_color_ / brightness, white);
  const T contrast = (ior - 1) / (ior + 1);
  tinted_f0_ = select(tinted, unit(hue * (contrast * contrast)), tinted_f0_);
  sheen_color_ = select(tinted, white + (hue - white) * sheen_tint, sheen_color_);
}

template <typename T>
void DisneyBsdfOf<T>::set_weights(const Model& model, T specular_tint, T metallic, T transmission) {
  const auto outside = [&](T weight) { return select(inside_, T(0.0f), weight); };
  const T reflecting = select(thin_, transmission, 1 - metallic);
  dielectric_ = select(inside_, clear_, reflecting * (1 - specular_tint));
  tinted_ = outside(reflecting * specular_tint);
  metal_ = outside(metallic);
  const T through = select(thin_, unit(model(&Disney::diffuse_transmission)), T(0.0f));
  const T opaque = (1 - metallic) * (1 - transmission);
  diffuse_ = outside(opaque * (1 - through));
  diffuse_through_ = outside(opaque * through);
  flatness_ = outside(unit(model(&Disney::flatness)));
  sheen_ = outside(unit(model(&Disney::sheen)) * select(thin_, diffuse_, 1 - metallic));
  clearcoat_ = select(inside_ | thin_, T(0.0f), unit(model(&Disney::clearcoat)));
}

template <typename T>
void DisneyBsdfOf<T>::set_clearcoat(const Model& model) {
  if (!any(clearcoat_ != 0)) return;
  const T alpha = mix(T(0.1f), T(0.001f), unit(model(&Disney::clearcoat_gloss)));
  clearcoat_alpha2_ = alpha * alpha;
  const T log_alpha2 = to_float(log(widened(clearcoat_alpha2_)));
  clearcoat_norm_ = (clearcoat_alpha2_ - 1) / (kPi * log_alpha2);
}

template <typename T>
void DisneyBsdfOf<T>::orient(Vec3Of<T> tangent_local) {
  using std::sqrt;
  const T length2 = tangent_local.x * tangent_local.x + tangent_local.y * tangent_local.y;
  const MaskOf<T> known = length2 > 0;
  const T scale = 1 / sqrt(length2);
  tangent_x_ = select(known, tangent_local.x * scale, tangent_x_);
  tangent_y_ = select(known, tangent_local.y * scale, tangent_y_);
}

// Burley 2012, section 5.4, with Fresnel's exact reflectance of a dielectric that is not tinted.
template <typename T>
RgbOf<T> DisneyBsdfOf<T>::reflectance(T cos_h) const {
  RgbOf<T> sum = RgbOf<T>::gray(dielectric_ * fresnel_dielectric<T>(cos_h, eta_));
  const auto add = [&](T weight, RgbOf<T> f0) {
    const MaskOf<T> reflects = weight > 0;
    if (any(reflects)) sum = select(reflects, sum + fresnel_schlick(cos_h, f0) * weight, sum);
  };
  add(metal_, base_color_);
  add(tinted_, tinted_f0_);
  return sum;
}

template <typename T>
RgbOf<T> DisneyBsdfOf<T>::transmittance(T cos_h) const {
  return transmission_color_ * (clear_ * (1 - fresnel_dielectric<T>(cos_h, eta_)));
}

template <typename T>
typename DisneyBsdfOf<T>::Chances DisneyBsdfOf<T>::chances(T cos_o) const {
  Chances all;
  const T base = max_component(base_color_);
  const MaskOf<T> clear = clear_ > 0;
  all.facets = max_component(reflectance(cos_o));
  if (any(clear)) all.facets = select(clear, all.facets + max_component(transmittance(cos_o)), all.facets);
  all.clearcoat = clearcoat_ * mix(T(kClearcoatF0), T(1.0f), grazing(cos_o)) * cos_o;
  all.diffuse = diffuse_ * base + sheen_ * max_component(sheen_color_) * kSheenAlbedo;
  all.through = diffuse_through_ * base;
  const T sum = all.facets + all.clearcoat + all.diffuse + all.through;
  for (T* chance : {&all.facets, &all.clearcoat, &all.diffuse, &all.through})
    *chance = select(sum > 0, *chance / sum, T(0.0f));
  return all;
}

template <typename T>
T DisneyBsdfOf<T>::transmission_chance(T cos_h) const {
  const MaskOf<T> clear = clear_ > 0;
  if (!any(clear)) return T(0.0f);
  const T through = max_component(transmittance(cos_h)), thrown_back = max_component(reflectance(cos_h));
  return select(clear & (through > 0), through / (through + thrown_back), T(0.0f));
}

// Burley 2015, eq. 4 and section 5.3, without the cosine; cos_d is that of the angle to the half vector.
template <typename T>
RgbOf<T> DisneyBsdfOf<T>::diffuse(T cos_o, T cos_i, T cos_d) const {
  const T o = grazing(cos_o), i = grazing(cos_i), retro = 2 * roughness_ * cos_d * cos_d;
  T shape = (1 - 0.5f * o) * (1 - 0.5f * i) + retro * (o + i + o * i * (retro - 1));
  const MaskOf<T> flat = flatness_ > 0;
  if (any(flat)) {
    const T below = mix(T(1.0f), retro / 2, o) * mix(T(1.0f), retro / 2, i);
    const T flattened = 1.25f * (below * (1 / (cos_o + cos_i) - 0.5f) + 0.5f);
    shape = select(flat, mix(shape, flattened, flatness_), shape);
  }
  return (base_color_ * (diffuse_ * shape / kPi) + sheen_color_ * (sheen_ * grazing(cos_d))) * diffuse_scale_;
}

// GTR of exponent 1 (Burley 2012, eq. 4 of appendix B).
template <typename T>
T DisneyBsdfOf<T>::clearcoat_density(Vec3Of<T> h) const {
  return clearcoat_norm_ / (h.x * h.x + h.y * h.y + clearcoat_alpha2_ * h.z * h.z);
}

// Normals in proportion to D cos (ibid., eq. 5).
template <typename T>
Vec3Of<T> DisneyBsdfOf<T>::sample_clearcoat(Vec2Of<T> u) const {
  using std::sqrt;
  using Real = WideOf<T>;
  const Real alpha2 = widened(clearcoat_alpha2_);
  const Real sin2 = (pow(alpha2, 1 - widened(u.x)) - alpha2) / (1 - alpha2);
  const auto [s, c] = sin_cos_turns(u.y);
  const T sine = to_float(sqrt(larger(Real(0.0), sin2)));
  return {sine * c, sine * s, to_float(sqrt(larger(Real(0.0), 1 - sin2)))};
}

template <typename T>
void DisneyBsdfOf<T>::add_clearcoat(Vec3Of<T> wo, Vec3Of<T> wi, Vec3Of<T> h, T chance,
                                    BsdfValueOf<T>& sum) const {
  const MaskOf<T> coated = clearcoat_ > 0;
  if (!any(coated)) return;
  const GgxOf<T> masking(T{kClearcoatMaskingAlpha});
  const T density = clearcoat_density(h), unmasked = masking.visible(wo.z) * masking.visible(wi.z);
  const T cos_h = dot(wo, h), reflected = mix(T(kClearcoatF0), T(1.0f), grazing(cos_h));
  const T value = clearcoat_ * kClearcoatWeight * reflected * density * unmasked * wi.z;
  sum.value = select(coated, sum.value + RgbOf<T>::gray(value), sum.value);
  sum.pdf = select(coated, sum.pdf + chance * density * h.z * (1 / (4 * cos_h)), sum.pdf);
}

template <typename T>
BsdfValueOf<T> DisneyBsdfOf<T>::reflected(Vec3Of<T> wo, Vec3Of<T> wi, T diffuse_cos) const {
  const Chances chance = chances(wo.z);
  const Vec3Of<T> h = normalize(wo + wi);
  const T cos_h = dot(wo, h), per_direction = 1 / (4 * cos_h);
  const T stays = 1 - transmission_chance(select(thin_, wo.z, cos_h));
  BsdfValueOf<T> sum;
  sum.value = reflectance(cos_h) * (facets_.density(h) * facets_.smith_visibility(wo, wi) * wi.z);
  sum.pdf = chance.facets * stays * facets_.pdf_visible(wo, h) * per_direction;
  add_clearcoat(wo, wi, h, chance.clearcoat, sum);
  const MaskOf<T> scatters = (diffuse_ > 0) | (sheen_ > 0);
  if (any(scatters))
    sum.value = select(scatters, sum.value + diffuse(wo.z, wi.z, cos_h) * diffuse_cos, sum.value);
  sum.pdf = sum.pdf + chance.diffuse * sampling::pdf_cosine_hemisphere(wi.z);
  return sum;
}

// Walter et al. 2007, eq. 17 and 21. Its eta^2 cancels against the compression of radiance (Veach 1997,
// section 5.2).
template <typename T>
BsdfValueOf<T> DisneyBsdfOf<T>::refracted_through_facets(Vec3Of<T> wo, Vec3Of<T> wi) const {
  const Vec3Of<T> across = wo + wi * eta_;
  const Vec3Of<T> h = normalize(select(across.z > 0, across, -across));
  const T cos_oh = dot(wo, h), cos_ih = dot(wi, h);
  const T sum = cos_oh + eta_ * cos_ih, ratio = eta_ * eta_ * -cos_ih / (sum * sum);
  const T visibility = facets_.smith_visibility(wo, mirrored_below(wi));
  const T through = 4 * facets_.density(h) * visibility * cos_oh * -wi.z * ratio / (eta_ * eta_);
  return only_where<T>((cos_oh > 0) & (cos_ih < 0),
                       {transmittance(cos_oh) * through, chances(wo.z).facets * transmission_chance(cos_oh) *
                                                             facets_.pdf_visible(wo, h) * ratio});
}

// Specular transmission as a reflection to the other side, and diffuse transmission.
template <typename T>
BsdfValueOf<T> DisneyBsdfOf<T>::passed_through_sheet(Vec3Of<T> wo, Vec3Of<T> wi) const {
  const Chances chance = chances(wo.z);
  const Vec3Of<T> above = mirrored_below(wi), h = normalize(wo + above);
  const T cos_h = dot(wo, h);
  BsdfValueOf<T> sum{base_color_ * (diffuse_through_ * above.z / kPi),
                     chance.through * sampling::pdf_cosine_hemisphere(above.z)};
  const MaskOf<T> clear = clear_ > 0;
  if (!any(clear)) return sum;
  const T visibility = sheet_facets_.smith_visibility(wo, above);
  const RgbOf<T> value = transmittance(cos_h) * (sheet_facets_.density(h) * visibility * above.z);
  const T pdf = chance.facets * transmission_chance(wo.z) * sheet_facets_.pdf_visible(wo, h) / (4 * cos_h);
  return {select(clear, sum.value + value, sum.value), select(clear, sum.pdf + pdf, sum.pdf)};
}

template <typename T>
BsdfValueOf<T> DisneyBsdfOf<T>::passed(Vec3Of<T> wo, Vec3Of<T> wi) const {
  if (!any(thin_)) return refracted_through_facets(wo, wi);
  const BsdfValueOf<T> through = passed_through_sheet(wo, wi);
  if (all(thin_)) return through;
  const BsdfValueOf<T> refracted = refracted_through_facets(wo, wi);
  return {select(thin_, through.value, refracted.value), select(thin_, through.pdf, refracted.pdf)};
}

template <typename T>
BsdfValueOf<T> DisneyBsdfOf<T>::evaluate_turned(Vec3Of<T> wo, Vec3Of<T> wi, T diffuse_cos) const {
  const MaskOf<T> lit = (wo.z > 0) & (wi.z != 0), reflects = wi.z > 0;
  const MaskOf<T> above = lit & reflects, below = lit & !reflects & transmits();
  BsdfValueOf<T> value{};
  if (any(above)) value = only_where<T>(above, reflected(wo, wi, diffuse_cos));
  if (!any(below)) return value;
  const BsdfValueOf<T> through = passed(wo, wi);
  return {select(below, through.value, value.value), select(below, through.pdf, value.pdf)};
}

namespace {

// Coordinates by a tangent, and back.
template <typename T>
Vec3Of<T> by_tangent(T x, T y, Vec3Of<T> w) {
  return {x * w.x + y * w.y, x * w.y - y * w.x, w.z};
}
template <typename T>
Vec3Of<T> from_tangent(T x, T y, Vec3Of<T> w) {
  return {x * w.x - y * w.y, x * w.y + y * w.x, w.z};
}

}  // namespace

template <typename T>
BsdfValueOf<T> DisneyBsdfOf<T>::evaluate(Vec3Of<T> wo_local, Vec3Of<T> wi_local, T diffuse_cos) const {
  return evaluate_turned(by_tangent(tangent_x_, tangent_y_, wo_local),
                         by_tangent(tangent_x_, tangent_y_, wi_local), diffuse_cos);
}

template <typename T>
typename DisneyBsdfOf<T>::Direction DisneyBsdfOf<T>::sample_sheet(Vec3Of<T> wo, Vec2Of<T> u) const {
  const Vec3Of<T> above = reflect(wo, sheet_facets_.sample_visible(wo, u));
  return {above.z > 0, mirrored_below(above)};
}

template <typename T>
typename DisneyBsdfOf<T>::Direction DisneyBsdfOf<T>::sample_facets(Vec3Of<T> wo, Vec2Of<T> u,
                                                                   T u_side) const {
  const Vec3Of<T> h = facets_.sample_visible(wo, u);
  const T cos_h = dot(wo, h);
  const MaskOf<T> transmits = u_side < transmission_chance(select(thin_, wo.z, cos_h));
  const MaskOf<T> refracts = transmits & !thin_, passes_sheet = transmits & thin_;
  const auto [bends, through] = refracted(wo, h, eta_);
  const Vec3Of<T> back = reflect(wo, h);
  const MaskOf<T> right_side = select_mask(refracts, bends & (through.z < 0), back.z > 0);
  const MaskOf<T> found = right_side & (cos_h > 0);
  const Direction facets{found, select(refracts, through, back)};
  if (!any(passes_sheet)) return facets;
  const Direction sheet = sample_sheet(wo, u);
  return {select_mask(passes_sheet, sheet.found, facets.found), select(passes_sheet, sheet.wi, facets.wi)};
}

template <typename T>
typename DisneyBsdfOf<T>::Direction DisneyBsdfOf<T>::sample_direction(Vec3Of<T> wo, Vec2Of<T> u,
                                                                      T u_lobe) const {
  const Chances chance = chances(wo.z);
  const MaskOf<T> facets = u_lobe < chance.facets;
  const MaskOf<T> clearcoat = (u_lobe < chance.facets + chance.clearcoat) & !facets;
  const Vec3Of<T> even = sampling::sample_cosine_hemisphere(u);
  Direction sampled{true, select(u_lobe >= 1 - chance.through, mirrored_below(even), even)};
  if (any(facets)) {
    const Direction one = sample_facets(wo, u, u_lobe / chance.facets);
    sampled = {select_mask(facets, one.found, sampled.found), select(facets, one.wi, sampled.wi)};
  }
  if (any(clearcoat)) {
    const Vec3Of<T> one = reflect(wo, sample_clearcoat(u));
    sampled = {select_mask(clearcoat, one.z > 0, sampled.found), select(clearcoat, one, sampled.wi)};
  }
  return sampled;
}

template <typename T>
BsdfSampleOf<T> DisneyBsdfOf<T>::sample(Vec3Of<T> wo_local, Vec2Of<T> u, T u_lobe) const {
  const Vec3Of<T> wo = by_tangent(tangent_x_, tangent_y_, wo_local);
  const auto [found, wi] = sample_direction(wo, u, u_lobe);
  BsdfSampleOf<T> sample =
      weighed_sample<T>((wo_local.z > 0) & found, wi, evaluate_turned(wo, wi, wi.z), transmitted_eta());
  sample.wi_local = from_tangent(tangent_x_, tangent_y_, wi);
  return sample;
}

template class DisneyBsdfOf<float>;
template class DisneyBsdfOf<FloatN>;

}  // namespace tessera::core::shading
