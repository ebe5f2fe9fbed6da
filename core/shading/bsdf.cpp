// SPDX-License-Identifier: Apache-2.0
#include "core/shading/bsdf.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/overloaded.hpp"
#include "core/materials/limits.hpp"
#include "core/sampling/warp.hpp"
#include "core/shading/layered_materials.hpp"

namespace tessera::core {

Bsdf::AtPoint Bsdf::look_up(const Material& material, const std::vector<Texture>& textures, const UvSets& uv,
                            bool outside, Rgb tint) {
  if (!outside && is_one_sided(material)) return ClosureOf<float>();  // which scatters nothing
  const auto at = [&](const auto& parameter) { return parameter.evaluate(textures, uv); };
  return std::visit(
      Overloaded{
          [&](const Lambert& m) -> AtPoint { return LambertBsdf{at(m.albedo) * tint}; },
          [&](const Mirror& m) -> AtPoint { return MirrorBsdf{at(m.reflectance) * tint}; },
          [&](const Glass& m) -> AtPoint {
            const float ior = std::clamp(at(m.ior), 1.0f, kMaxIor), eta = outside ? ior : 1 / ior;
            const float alpha = squared_roughness(at(m.roughness));
            if (alpha < kMinAlpha || ior - 1 < kMinBending)
              return SmoothDielectricBsdf{eta, fresnel_of(m.fresnel), at(m.reflectance), at(m.transmittance)};
            if (m.microfacets.is_correlated_ggx())
              return RoughDielectricBsdf{Ggx(alpha), eta, fresnel_of(m.fresnel), at(m.reflectance),
                                         at(m.transmittance)};
            return RoughDielectricOf<float, Microfacets>{Microfacets(m.microfacets, alpha), eta,
                                                         fresnel_of(m.fresnel), at(m.reflectance),
                                                         at(m.transmittance)};
          },
          [&](const Phong& m) -> AtPoint {
            const Rgb diffuse = at(m.diffuse) * tint, specular = at(m.specular);
            const Rgb scale = normalize_energy(diffuse, specular);
            return PhongBsdf{diffuse * scale, specular * scale,
                             std::clamp(at(m.exponent), 0.0f, kMaxExponent), m.lobe == PhongLobe::kNPlus2};
          },
          [&](const CookTorrance& m) -> AtPoint {
            const Rgb diffuse = at(m.diffuse) * tint, specular = at(m.specular);
            const Rgb scale = normalize_energy(diffuse, specular);
            const ComplexIndex index = m.conductor ? complex_index(*m.conductor) : ComplexIndex{};
            return CookTorranceBsdf{
                .diffuse = diffuse * scale,
                .specular = specular * scale,
                .is_metal = m.conductor.has_value(),
                .f0 = m.conductor ? Rgb{} : at(m.f0) * (f0_is_base_color(m) ? tint : Rgb::gray(1)),
                .eta = index.eta,
                .k = index.k,
                .ggx = rough_ggx(at(m.roughness)),
                .schlick_masking = m.masking == Masking::kSchlick,
                .sample_half_vector = material.sampling == Sampling::kHalfVector};
          },
          [&](const Hair& m) -> AtPoint { return HairBsdf(m, textures, uv); },
          [&](const Disney& m) -> AtPoint { return DisneyBsdf(m, textures, uv, outside, tint); },
          // What it transmits does not stop here (interception_at).
          [&](const ThinDielectric& m) -> AtPoint {
            if (passes_straight(material)) return MirrorBsdf{at(m.reflectance)};
            return closure_of(material.model, MaterialPoint{textures, uv, outside, tint});
          },
          // All others are layered; or resolved before (scatterer_at), or never hit.
          [&](const auto&) -> AtPoint {
            return closure_of(material.model, MaterialPoint{textures, uv, outside, tint});
          },
      },
      material.model);
}

Bsdf::Bsdf(const Material& material, const std::vector<Texture>& textures, const UvSets& uv, bool outside,
           Rgb tint)
    : at_point_(look_up(material, textures, uv, outside, tint)),
      uniform_(material.sampling == Sampling::kUniform && !has_delta()) {}

bool Bsdf::is_delta() const {
  return std::visit([](const auto& bsdf) { return bsdf.is_delta(); }, at_point_);
}

bool Bsdf::has_delta() const {
  const auto* closure = std::get_if<ClosureOf<float>>(&at_point_);
  return closure != nullptr ? closure->has_delta() : is_delta();
}

bool Bsdf::transmits() const {
  return std::visit([](const auto& bsdf) { return bsdf.transmits(); }, at_point_);
}

void Bsdf::orient(Vec3 tangent_local) {
  if (auto* closure = std::get_if<ClosureOf<float>>(&at_point_)) closure->orient(tangent_local);
  if (auto* hair = std::get_if<HairBsdf>(&at_point_)) hair->orient(tangent_local);
  if (auto* disney = std::get_if<DisneyBsdf>(&at_point_)) disney->orient(tangent_local);
}

void Bsdf::turn_coat(bool turns, const Frame& axes, Vec3 wo_local) {
  if (auto* closure = std::get_if<ClosureOf<float>>(&at_point_)) closure->turn_coat(turns, axes, wo_local);
}

void Bsdf::look_from(float cos_o) {
  if (auto* closure = std::get_if<ClosureOf<float>>(&at_point_)) closure->look_from(cos_o);
}

void Bsdf::scale_diffuse(float factor) {
  std::visit([&](auto& bsdf) { bsdf.scale_diffuse(factor); }, at_point_);
}

BsdfValue Bsdf::evaluate(Vec3 wo_local, Vec3 wi_local, float diffuse_cos) const {
  BsdfValue value =
      std::visit([&](const auto& bsdf) { return bsdf.evaluate(wo_local, wi_local, diffuse_cos); }, at_point_);
  if (uniform_) value.pdf = uniform_pdf(wo_local, wi_local);
  return value;
}

std::optional<BsdfSample> Bsdf::sample(Vec3 wo_local, Vec2 u, float u_lobe) const {
  if (uniform_) return sample_uniformly(wo_local, u);
  return std::visit([&](const auto& bsdf) { return alone(bsdf.sample(wo_local, u, u_lobe)); }, at_point_);
}

DeltaBranches Bsdf::delta_branches(Vec3 wo_local) const {
  if (const auto* mirror = std::get_if<MirrorBsdf>(&at_point_))
    return {alone(mirror->sample(wo_local, {}, 0)), {}, {}};
  if (const auto* glass = std::get_if<SmoothDielectricBsdf>(&at_point_)) {
    const auto [reflected, refracted] = glass->branches(wo_local);
    return {reflected, refracted, {}};
  }
  if (const auto* closure = std::get_if<ClosureOf<float>>(&at_point_))
    return closure->delta_branches(wo_local);
  return {};
}

float Bsdf::uniform_pdf(Vec3 wo_local, Vec3 wi_local) const {
  if (wo_local.z <= 0) return 0;
  if (transmits()) return 1 / (4 * kPi);
  return wi_local.z > 0 ? 1 / (2 * kPi) : 0;
}

float Bsdf::transmitted_eta() const {
  if (const auto* closure = std::get_if<ClosureOf<float>>(&at_point_)) return closure->transmitted_eta();
  if (std::holds_alternative<HairBsdf>(at_point_)) return 1;
  if (const auto* disney = std::get_if<DisneyBsdf>(&at_point_)) return disney->transmitted_eta();
  if (const auto* ggx = std::get_if<RoughDielectricBsdf>(&at_point_)) return ggx->eta;
  return std::get_if<RoughDielectricOf<float, Microfacets>>(&at_point_)->eta;
}

std::optional<BsdfSample> Bsdf::sample_uniformly(Vec3 wo_local, Vec2 u) const {
  if (wo_local.z <= 0) return std::nullopt;
  const Vec3 wi = transmits() ? sample_sphere(u) : sample_hemisphere(u);
  BsdfSample sample = weighed_sample(wi, evaluate(wo_local, wi));
  sample.transmitted = wi.z < 0;
  if (sample.transmitted) sample.eta = transmitted_eta();
  return sample;
}

}  // namespace tessera::core
