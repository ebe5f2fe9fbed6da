// SPDX-License-Identifier: Apache-2.0
#include "core/materials/layered_materials.hpp"

#include <algorithm>
#include <cmath>

#include "core/materials/limits.hpp"

namespace tessera::core {
namespace {

using DielectricLobe = GgxLobe<DielectricReflectance>;
using ConductorLobe = GgxLobe<ConductorReflectance>;
using MetalLobe = GgxLobe<EdgeTintReflectance>;
using FilmLobe = GgxLobe<FilmReflectance>;

constexpr Rgb kWhite = Rgb::gray(1);

float unit(float value) {
  return value > 0 ? std::min(value, 1.0f) : 0;
}

Rgb unit(Rgb color) {
  return {unit(color.r), unit(color.g), unit(color.b)};
}

float mix(float a, float b, float share) {
  return a + (b - a) * share;
}

Rgb mix(Rgb a, Rgb b, float share) {
  return a + (b - a) * share;
}

// A parameter's value at the point, clamped to [0, 1].
template <typename Parameter>
auto share_at(const Parameter& parameter, const MaterialPoint& at) {
  return unit(parameter.evaluate(at.textures, at.uv));
}

float ior_at(const ScalarParameter& parameter, const MaterialPoint& at) {
  return std::clamp(parameter.evaluate(at.textures, at.uv), 1.0f, kMaxIor);
}

// The microfacets of a roughness, or a smooth surface.
struct Facets {
  AnisotropicGgx ggx;
  bool smooth;
};

// OpenPBR 1.1: the mean of the squared alphas stays the fourth power of the roughness.
Facets facets_of(float roughness, float anisotropy) {
  const float alpha = squared_roughness(roughness);
  const float narrow = 1 - anisotropy, along = alpha * std::sqrt(2 / (1 + narrow * narrow));
  return {AnisotropicGgx(std::clamp(along, kMinAlpha, 1.0f), std::clamp(along * narrow, kMinAlpha, 1.0f)),
          alpha < kMinAlpha};
}

float normal_reflectance(float eta) {
  const float r = (eta - 1) / (eta + 1);
  return r * r;
}

// OpenPBR 1.1: the index whose reflectance at normal incidence is `weight` times that of eta.
float reweighed_index(float eta, float weight) {
  const float r = std::min(std::sqrt(weight * normal_reflectance(eta)), 0.818f);  // index 10
  return (1 + r) / (1 - r);
}

class PrincipledLobes {
 public:
  PrincipledLobes(const Principled& model, const MaterialPoint& at)
      : model_(model),
        at_(at),
        // Inside a solid, what lies on its outer side is not in the light's way.
        is_inside_(!at.outside && !model.geometry_thin_walled && share(model.transmission_weight) > 0),
        metalness_(share(model.base_metalness)),
        transmission_((1 - metalness_) * share(model.transmission_weight)),
        coat_(is_inside_ ? 0 : share(model.coat_weight)),
        coat_ior_(coat_ > 0 ? ior_at(model.coat_ior, at) : 1),
        subsurface_(share(model.subsurface_weight)),
        film_(share(model.thin_film_weight)),
        base_color_(share(model.base_color) * at.tint * share(model.base_weight)),
        facets_(base_facets()) {}

  LobeMixture all() {
    add_fuzz();
    add_coat();
    add_metal();
    add_transmission();
    add_glossy_diffuse();
    return lobes_;
  }

 private:
  float share(const ScalarParameter& parameter) const { return share_at(parameter, at_); }
  Rgb share(const ColorParameter& parameter) const { return share_at(parameter, at_); }

  // A rough coat blurs what is below it.
  Facets base_facets() const {
    const float roughness = share(model_.specular_roughness),
                anisotropy = share(model_.specular_roughness_anisotropy);
    if (coat_ == 0) return facets_of(roughness, anisotropy);
    const float of_coat = share(model_.coat_roughness);
    const float r2 = roughness * roughness, c2 = of_coat * of_coat;
    const float blurred = std::sqrt(std::sqrt(std::min(1.0f, r2 * r2 + 2 * c2 * c2)));
    return facets_of(mix(roughness, blurred, coat_), anisotropy);
  }

  void add_fuzz() {
    const float weight = is_inside_ ? 0 : share(model_.fuzz_weight);
    if (weight > 0)
      lobes_.add(SheenLobe(share(model_.fuzz_roughness)), share(model_.fuzz_color) * weight,
                 {.cover = weight});
  }

  void add_coat() {
    if (coat_ == 0) return;
    const Facets facets = facets_of(share(model_.coat_roughness), 0);
    const Rgb tint = mix(kWhite, share(model_.coat_color), coat_) * darkening();
    lobes_.add(DielectricLobe{{coat_ior_}, facets.ggx, facets.smooth, true}, Rgb::gray(coat_),
               {.cover = coat_, .tint = tint});
  }

  // The light that the coat throws back onto the base, again and again (OpenPBR 1.1, coat darkening). A
  // smooth metal sends it back where it leaves, a diffuse base everywhere.
  Rgb darkening() const {
    const float smooth = normal_reflectance(coat_ior_);
    const float rough =
        1 - DirectionalAlbedo::tables().mean_transmitted(0, coat_ior_) / (coat_ior_ * coat_ior_);
    const float back = mix(smooth, rough, mix(1, share(model_.specular_roughness), metalness_));
    const Rgb base = mix(unit(base_color_), kWhite, transmission_);  // what is clear takes nothing away
    const Rgb darkened{(1 - back) / (1 - base.r * back), (1 - back) / (1 - base.g * back),
                       (1 - back) / (1 - base.b * back)};
    return mix(kWhite, darkened, coat_ * share(model_.coat_darkening));
  }

  void add_metal() {
    if (metalness_ == 0) return;
    const Rgb weight = Rgb::gray(metalness_ * share(model_.specular_weight)),
              edge = share(model_.specular_color);
    if (film_ > 0)
      lobes_.add(film_over(unit(base_color_)), weight * edge);
    else
      lobes_.add(MetalLobe{EdgeTintReflectance(unit(base_color_), edge), facets_.ggx, facets_.smooth, true},
                 weight);
  }

  FilmLobe film_over(Rgb f0) const {
    const float thickness = std::max(0.0f, model_.thin_film_thickness.evaluate(at_.textures, at_.uv));
    return {FilmReflectance(f0, film_, ior_at(model_.thin_film_ior, at_), thickness), facets_.ggx,
            facets_.smooth, true};
  }

  // The alpha of the isotropic lobes; 0 if smooth.
  float mean_alpha() const { return facets_.smooth ? 0 : facets_.ggx.mean_alpha(); }

  void add_transmission() {
    if (transmission_ == 0) return;
    const float ior = reweighed_index(ior_at(model_.specular_ior, at_),
                                      model_.specular_weight.evaluate(at_.textures, at_.uv));
    const Rgb reflected = share(model_.specular_color);
    const Rgb transmitted = absorbs_inside(model_) ? kWhite : share(model_.transmission_color);
    if (model_.geometry_thin_walled)
      lobes_.add(ThinGlassLobe{ior, facets_.ggx, facets_.smooth, reflected, transmitted},
                 Rgb::gray(transmission_));
    else
      lobes_.add(GlassLobe(at_.outside ? ior : 1 / ior, mean_alpha(), reflected, transmitted),
                 Rgb::gray(transmission_));
  }

  void add_glossy_diffuse() {
    const float weight = 1 - metalness_ - transmission_;
    if (!(weight > 0)) return;
    // Below the coat; the ratio is turned over where the coat is denser, as total reflection would not be
    // seen from outside (OpenPBR 1.1).
    const float over = ior_at(model_.specular_ior, at_) / mix(1, coat_ior_, coat_);
    const float eta =
        reweighed_index(over < 1 ? 1 / over : over, model_.specular_weight.evaluate(at_.textures, at_.uv));
    const Rgb tint = share(model_.specular_color) * weight;
    if (film_ > 0)
      lobes_.add(film_over(Rgb::gray(normal_reflectance(eta))), tint, {.cover = 1});
    else
      lobes_.add(DielectricLobe{{eta}, facets_.ggx, facets_.smooth, true}, tint, {.cover = 1});
    const Rgb below = share(model_.subsurface_color) * subsurface_;
    const Rgb transmitted = model_.geometry_thin_walled ? below * 0.5f : Rgb{};
    lobes_.add(DiffuseLobe(unit(base_color_ * (1 - subsurface_) + below - transmitted),
                           share(model_.base_diffuse_roughness)),
               Rgb::gray(weight));
    lobes_.add(DiffuseTransmissionLobe{}, transmitted * weight);
  }

  const Principled& model_;
  const MaterialPoint& at_;
  bool is_inside_;
  float metalness_, transmission_, coat_, coat_ior_, subsurface_, film_;
  Rgb base_color_;
  Facets facets_;
  LobeMixture lobes_;
};

}  // namespace

LobeMixture lobes_of(const Principled& model, const MaterialPoint& at) {
  return PrincipledLobes(model, at).all();
}

LobeMixture lobes_of(const Plastic& model, const MaterialPoint& at) {
  const float eta = ior_at(model.ior, at);
  const Facets facets = facets_of(model.roughness.evaluate(at.textures, at.uv), 0);
  LobeMixture lobes;
  lobes.add(DielectricLobe{{eta}, facets.ggx, facets.smooth, false}, share_at(model.specular, at));
  lobes.add(CoveredDiffuseLobe(share_at(model.diffuse, at) * at.tint, eta,
                               facets.smooth ? 0 : facets.ggx.mean_alpha(), model.nonlinear),
            kWhite);
  return lobes;
}

LobeMixture lobes_of(const ConductorMaterial& model, const MaterialPoint& at) {
  const Facets facets =
      facets_of(model.roughness.evaluate(at.textures, at.uv), share_at(model.anisotropy, at));
  const Rgb k = model.k.evaluate(at.textures, at.uv);
  // Without either index, nothing would be defined head-on.
  static constexpr float kMinExtinction = 1e-3f, kMaxIndex = 1e6f;  // its fourth power must fit a float
  const Rgb eta = model.eta.evaluate(at.textures, at.uv);
  const auto bounded = [](float v, float least) { return std::clamp(v, least, kMaxIndex); };
  const ConductorReflectance reflectance{
      {bounded(eta.r, 0), bounded(eta.g, 0), bounded(eta.b, 0)},
      {bounded(k.r, kMinExtinction), bounded(k.g, kMinExtinction), bounded(k.b, kMinExtinction)}};
  LobeMixture lobes;
  lobes.add(ConductorLobe{reflectance, facets.ggx, facets.smooth, false}, share_at(model.specular, at));
  return lobes;
}

// If both add up to more than 1, they are scaled down to that.
LobeMixture lobes_of(const DiffuseTransmission& model, const MaterialPoint& at) {
  const Rgb reflected = share_at(model.reflectance, at) * at.tint,
            transmitted = share_at(model.transmittance, at) * at.tint;
  const Rgb scale = normalize_energy(reflected, transmitted);
  LobeMixture lobes;
  lobes.add(DiffuseLobe(reflected * scale, 0), kWhite);
  lobes.add(DiffuseTransmissionLobe{}, transmitted * scale);
  return lobes;
}

LobeMixture lobes_of(const ThinDielectric& model, const MaterialPoint& at) {
  LobeMixture lobes;
  lobes.add(ThinGlassLobe{ior_at(model.ior, at), AnisotropicGgx(kMinAlpha, kMinAlpha), true,
                          share_at(model.reflectance, at), share_at(model.transmittance, at)},
            kWhite);
  return lobes;
}

}  // namespace tessera::core
