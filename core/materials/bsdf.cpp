// SPDX-License-Identifier: Apache-2.0
#include "core/materials/bsdf.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/overloaded.hpp"
#include "core/materials/layered_materials.hpp"
#include "core/materials/limits.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core {
namespace {

// Whether the side that the viewer sees is the black back of a one-sided surface.
bool is_black_back(const Material& material, bool outside) {
  return !outside && !material.two_sided && !transmits_light(material.model);
}

}  // namespace

Bsdf::AtPoint Bsdf::look_up(const Material& material, const std::vector<Texture>& textures, Vec2 uv,
                            bool outside, Rgb tint) {
  if (is_black_back(material, outside)) return LambertBsdf{Rgb{}};
  const auto at = [&](const auto& parameter) { return parameter.evaluate(textures, uv); };
  return std::visit(
      Overloaded{
          [&](const Lambert& m) -> AtPoint { return LambertBsdf{at(m.albedo) * tint}; },
          [&](const Mirror& m) -> AtPoint { return MirrorBsdf{at(m.reflectance) * tint}; },
          [&](const Glass& m) -> AtPoint {
            const float ior = std::clamp(at(m.ior), 1.0f, kMaxIor), eta = outside ? ior : 1 / ior;
            const float alpha = squared_roughness(at(m.roughness));
            if (alpha < kMinAlpha || ior - 1 < kMinBending)
              return SmoothDielectricBsdf{eta, m.fresnel, at(m.reflectance), at(m.transmittance)};
            return RoughDielectricBsdf{Ggx(alpha), eta, m.fresnel, at(m.reflectance), at(m.transmittance)};
          },
          [&](const Phong& m) -> AtPoint {
            const Rgb diffuse = at(m.diffuse) * tint, specular = at(m.specular);
            const Rgb scale = normalize_energy(diffuse, specular);
            return PhongBsdf{diffuse * scale, specular * scale,
                             std::clamp(at(m.exponent), 0.0f, kMaxExponent), m.lobe};
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
          // Resolved before (scatterer_at), or never hit.
          [&](const Blend&) -> AtPoint { return LobeMixture(); },
          [&](const Null&) -> AtPoint { return LobeMixture(); },
          [&](const auto& layered) -> AtPoint {
            return lobes_of(layered, MaterialPoint{textures, uv, outside, tint});
          },
      },
      material.model);
}

Bsdf::Bsdf(const Material& material, const std::vector<Texture>& textures, Vec2 uv, bool outside, Rgb tint)
    : at_point_(look_up(material, textures, uv, outside, tint)),
      uniform_(material.sampling == Sampling::kUniform && !has_delta()) {}

bool Bsdf::is_delta() const {
  return std::visit(Overloaded{[](const LobeMixture& lobes) { return lobes.is_delta(); },
                               [](const auto& bsdf) { return bsdf.kIsDelta; }},
                    at_point_);
}

bool Bsdf::has_delta() const {
  const auto* lobes = std::get_if<LobeMixture>(&at_point_);
  return lobes != nullptr ? lobes->has_delta() : is_delta();
}

bool Bsdf::transmits() const {
  if (const auto* lobes = std::get_if<LobeMixture>(&at_point_)) return lobes->transmits();
  return std::holds_alternative<RoughDielectricBsdf>(at_point_);
}

void Bsdf::orient(Vec3 tangent_local) {
  if (auto* lobes = std::get_if<LobeMixture>(&at_point_)) lobes->orient(tangent_local);
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
  return std::visit([&](const auto& bsdf) { return bsdf.sample(wo_local, u, u_lobe); }, at_point_);
}

std::array<std::optional<BsdfSample>, 2> Bsdf::delta_branches(Vec3 wo_local) const {
  if (const auto* mirror = std::get_if<MirrorBsdf>(&at_point_))
    return {mirror->sample(wo_local, {}, 0), std::nullopt};
  if (const auto* glass = std::get_if<SmoothDielectricBsdf>(&at_point_)) return glass->branches(wo_local);
  if (const auto* lobes = std::get_if<LobeMixture>(&at_point_)) return lobes->delta_branches(wo_local);
  return {};
}

float Bsdf::uniform_pdf(Vec3 wo_local, Vec3 wi_local) const {
  if (wo_local.z <= 0) return 0;
  if (transmits()) return 1 / (4 * kPi);
  return wi_local.z > 0 ? 1 / (2 * kPi) : 0;
}

float Bsdf::transmitted_eta() const {
  if (const auto* lobes = std::get_if<LobeMixture>(&at_point_)) return lobes->transmitted_eta();
  return std::get_if<RoughDielectricBsdf>(&at_point_)->eta;
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
