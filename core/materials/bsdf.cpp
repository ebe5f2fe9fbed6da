#include "core/materials/bsdf.hpp"

#include "core/base/overloaded.hpp"
#include "core/materials/fresnel.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core {
namespace {

constexpr Vec3 kLocalNormal{0, 0, 1};

BsdfSample delta_sample(Vec3 wi_local, Rgb weight) {
  BsdfSample sample;
  sample.wi_local = wi_local;
  sample.weight = weight;
  sample.delta = true;
  return sample;
}

}  // namespace

Bsdf::AtPoint Bsdf::look_up(const MaterialModel& model, const std::vector<Texture>& textures, Vec2 uv,
                            bool outside) {
  return std::visit(
      Overloaded{
          [&](const Lambert& m) -> AtPoint { return Diffuse{m.albedo.evaluate(textures, uv)}; },
          [&](const Mirror& m) -> AtPoint { return Specular{m.reflectance.evaluate(textures, uv)}; },
          [&](const Glass& m) -> AtPoint {
            return Dielectric{outside ? m.ior : 1 / m.ior, m.reflectance.evaluate(textures, uv),
                              m.transmittance.evaluate(textures, uv)};
          },
      },
      model);
}

Bsdf::Bsdf(const MaterialModel& model, const std::vector<Texture>& textures, Vec2 uv, bool outside)
    : at_point_(look_up(model, textures, uv, outside)) {}

bool Bsdf::is_delta() const {
  return !std::holds_alternative<Diffuse>(at_point_);
}

Rgb Bsdf::evaluate(Vec3 wo_local, Vec3 wi_local) const {
  const auto* diffuse = std::get_if<Diffuse>(&at_point_);
  if (!diffuse || wo_local.z <= 0 || wi_local.z <= 0) return {};
  return diffuse->albedo * (wi_local.z / kPi);
}

float Bsdf::pdf(Vec3 wo_local, Vec3 wi_local) const {
  if (is_delta() || wo_local.z <= 0) return 0;
  return pdf_cosine_hemisphere(wi_local.z);
}

std::optional<BsdfSample> Bsdf::sample(Vec3 wo_local, Vec2 u, float u_lobe) const {
  return std::visit([&](const auto& at_point) { return sample(at_point, wo_local, u, u_lobe); }, at_point_);
}

std::optional<BsdfSample> Bsdf::sample(const Diffuse& diffuse, Vec3 wo_local, Vec2 u, float) {
  if (wo_local.z <= 0) return std::nullopt;
  BsdfSample sample;
  sample.wi_local = sample_cosine_hemisphere(u);
  sample.weight = diffuse.albedo;
  sample.pdf = pdf_cosine_hemisphere(sample.wi_local.z);
  return sample;
}

std::optional<BsdfSample> Bsdf::sample(const Specular& specular, Vec3 wo_local, Vec2, float) {
  return delta_sample(reflect(wo_local, kLocalNormal), specular.reflectance);
}

std::array<std::optional<BsdfSample>, 2> Bsdf::delta_branches(Vec3 wo_local) const {
  if (const auto* specular = std::get_if<Specular>(&at_point_))
    return {delta_sample(reflect(wo_local, kLocalNormal), specular->reflectance), std::nullopt};
  const auto* dielectric = std::get_if<Dielectric>(&at_point_);
  if (!dielectric) return {};
  const float reflected = fresnel_dielectric(wo_local.z, dielectric->eta);
  std::array<std::optional<BsdfSample>, 2> branches{sample(*dielectric, wo_local, {}, 0),
                                                    sample(*dielectric, wo_local, {}, 1)};
  if (branches[0]) branches[0]->weight *= reflected;
  if (branches[1]) branches[1]->weight *= 1 - reflected;
  return branches;
}

// One of the two directions is chosen with the probability of its share of the light, which cancels out of
// the weight. Radiance grows by eta^2 where it enters the denser side (Veach 1997, section 5.2); seen from
// the camera's side the path is walked backwards, hence the division.
std::optional<BsdfSample> Bsdf::sample(const Dielectric& dielectric, Vec3 wo_local, Vec2, float u_lobe) {
  const float reflected = fresnel_dielectric(wo_local.z, dielectric.eta);
  if (u_lobe < reflected) return delta_sample(reflect(wo_local, kLocalNormal), dielectric.reflectance);
  const auto wi_local = refract(wo_local, kLocalNormal, dielectric.eta);
  if (!wi_local) return std::nullopt;
  BsdfSample sample = delta_sample(*wi_local, dielectric.transmittance / (dielectric.eta * dielectric.eta));
  sample.transmitted = true;
  sample.eta = dielectric.eta;
  return sample;
}

}  // namespace tessera::core
