// SPDX-License-Identifier: Apache-2.0
#include "core/shading/layered_materials.hpp"

#include <cmath>
#include <type_traits>

#include "core/materials/limits.hpp"
#include "core/shading/shares.hpp"

namespace tessera::core::shading {
namespace {

template <typename T>
RgbOf<T> white() {
  return RgbOf<T>::gray(1);
}

template <typename T>
T bounded_ior(T ior) {
  return clamp_between(ior, 1.0f, kMaxIor);
}

// The microfacets of a roughness, or a smooth surface.
template <typename T>
struct Facets {
  AnisotropicGgxOf<T> ggx;
  MaskOf<T> smooth;

  // The alpha of isotropic lobes; 0 if smooth.
  T mean_alpha() const { return select(smooth, T(0.0f), ggx.mean_alpha()); }
};

// OpenPBR 1.1: the mean of the squared alphas stays the fourth power of the roughness.
template <typename T>
Facets<T> facets_of(T roughness, T anisotropy) {
  using std::sqrt;
  const T alpha = squared_roughness(roughness);
  const T narrow = 1 - anisotropy, along = alpha * sqrt(2 / (1 + narrow * narrow));
  return {AnisotropicGgxOf<T>(clamp_between(along, kMinAlpha, 1.0f),
                              clamp_between(along * narrow, kMinAlpha, 1.0f)),
          alpha < kMinAlpha};
}

// OpenPBR 1.1: the index whose reflectance at normal incidence is `weight` times that of eta.
template <typename T>
T reweighed_index(T eta, T weight) {
  using std::sqrt;
  const T r = smaller(sqrt(weight * normal_reflectance(eta)), T(0.818f));  // index 10
  return (1 + r) / (1 - r);
}

template <typename T>
T inverse_abbe_number_of(const ModelAt<T, Principled>& model) {
  return model.number([](const Principled& m) {
    return disperses(m) ? m.transmission_dispersion.inverse_abbe_number() : 0.0f;
  });
}

template <typename T>
class PrincipledClosure {
 public:
  explicit PrincipledClosure(const ModelAt<T, Principled>& model)
      : model_(model),
        outside_(model.at().outside),
        thin_(model.holds([](const Principled& m) { return m.geometry_thin_walled; })),
        transmission_weight_(share(&Principled::transmission_weight)),
        // Inside a solid, what lies on its outer side is not in the light's way.
        is_inside_((!(outside_ | thin_)) & (transmission_weight_ > 0)),
        metalness_(share(&Principled::base_metalness)),
        transmission_((1 - metalness_) * transmission_weight_),
        coat_(select(is_inside_, T(0.0f), share(&Principled::coat_weight))),
        subsurface_(share(&Principled::subsurface_weight)),
        film_(share(&Principled::thin_film_weight)),
        roughness_(share(&Principled::specular_roughness)),
        ior_(clamp_between(model(&Principled::specular_ior),
                           model.number([](const Principled& m) { return min_ior(m.specular_ior); }),
                           kMaxIor)),
        specular_weight_(model(&Principled::specular_weight)),
        specular_color_(share(&Principled::specular_color)),
        base_color_(share(&Principled::base_color) * model.at().tint * share(&Principled::base_weight)) {
    if (any(coat_ != 0)) {
      coat_roughness_ = share(&Principled::coat_roughness);
      coat_ior_ = select(coat_ > 0, bounded_ior(model(&Principled::coat_ior)), T(1.0f));
    }
    facets_ = base_facets();
  }

  ClosureOf<T> all_layers() {
    add_fuzz();
    add_coat();
    add_metal();
    add_transmission();
    add_glossy_diffuse();
    return closure_;
  }

 private:
  using Below = typename ClosureOf<T>::Below;
  using DielectricLobe = GgxLobe<T, DielectricReflectance>;
  using MetalLobe = GgxLobe<T, EdgeTintReflectance>;

  // A parameter, clamped to [0, 1].
  T share(ScalarParameter Principled::*parameter) const { return unit(model_(parameter)); }
  RgbOf<T> share(ColorParameter Principled::*parameter) const { return unit(model_(parameter)); }

  // A rough coat blurs what is below it.
  Facets<T> base_facets() const {
    using std::sqrt;
    const T anisotropy = share(&Principled::specular_roughness_anisotropy);
    const MaskOf<T> coated = coat_ != 0;
    if (!any(coated)) return facets_of(roughness_, anisotropy);
    const T r2 = roughness_ * roughness_, c2 = coat_roughness_ * coat_roughness_;
    const T blurred = sqrt(sqrt(smaller(T(1.0f), r2 * r2 + 2 * c2 * c2)));
    return facets_of(select(coated, mix(roughness_, blurred, coat_), roughness_), anisotropy);
  }

  void add_fuzz() {
    const T weight = select(is_inside_, T(0.0f), share(&Principled::fuzz_weight));
    const MaskOf<T> has_fuzz = weight > 0;
    if (any(has_fuzz))
      closure_.template add<kFuzzSlot>(has_fuzz, SheenLobe<T>(share(&Principled::fuzz_roughness)),
                                       share(&Principled::fuzz_color) * weight, Below{weight});
  }

  void add_coat() {
    const MaskOf<T> coated = coat_ != 0;
    if (!any(coated)) return;
    const Facets<T> facets = facets_of(coat_roughness_, share(&Principled::coat_roughness_anisotropy));
    const RgbOf<T> tint = mix(white<T>(), share(&Principled::coat_color), coat_) * darkening();
    closure_.template add<kCoatSlot>(coated, DielectricLobe{{coat_ior_}, facets.ggx, facets.smooth, true},
                                     RgbOf<T>::gray(coat_), Below{coat_, tint});
  }

  // The light that the coat reflects internally, onto the base again (OpenPBR 1.1, coat darkening). A smooth
  // metal sends it back where it leaves, a diffuse base everywhere.
  RgbOf<T> darkening() const {
    const T smooth = normal_reflectance(coat_ior_);
    const T rough = 1 - DirectionalAlbedo::tables().template mean_transmitted<T>(T(0.0f), coat_ior_) /
                            (coat_ior_ * coat_ior_);
    const T back = mix(smooth, rough, mix(T(1.0f), roughness_, metalness_));
    // What is clear takes nothing away.
    const RgbOf<T> base = mix(unit(base_color_), white<T>(), transmission_);
    const RgbOf<T> darkened{(1 - back) / (1 - base.r * back), (1 - back) / (1 - base.g * back),
                            (1 - back) / (1 - base.b * back)};
    return mix(white<T>(), darkened, coat_ * share(&Principled::coat_darkening));
  }

  void add_metal() {
    const MaskOf<T> metal = metalness_ != 0, filmed = film_ > 0;
    if (!any(metal)) return;
    const RgbOf<T> weight = RgbOf<T>::gray(metalness_ * unit(specular_weight_));
    const EdgeTintReflectance<T> reflectance(unit(base_color_), specular_color_);
    const MaskOf<T> bare = metal & !filmed, covered = metal & filmed;
    if (any(bare))
      closure_.template add<kMetalSlot>(bare, MetalLobe{reflectance, facets_.ggx, facets_.smooth, true},
                                        weight);
    if (any(covered)) add_under_film<kMetalFilmSlot>(covered, reflectance, weight);
  }

  // Adds a lobe whose reflectance the film changes.
  template <std::size_t kSlot, typename Bare>
  void add_under_film(const MaskOf<T>& where, const Bare& bare, RgbOf<T> weight, Below below = {}) {
    const T thickness = larger(T(0.0f), model_(&Principled::thin_film_thickness));
    const ThinFilmOf<T> film(bare.normal(), film_, bounded_ior(model_(&Principled::thin_film_ior)),
                             thickness);
    closure_.template add<kSlot>(where, {{bare, film}, facets_.ggx, facets_.smooth, true}, weight, below);
  }

  void add_transmission() {
    const MaskOf<T> clear = transmission_ != 0;
    if (!any(clear)) return;
    const T denser = reweighed_index(ior_, specular_weight_), ior = select(ior_ < 1, 1 / denser, denser);
    const RgbOf<T> transmitted = select(model_.holds([](const Principled& m) { return absorbs_inside(m); }),
                                        white<T>(), share(&Principled::transmission_color));
    const RgbOf<T> weight = RgbOf<T>::gray(transmission_);
    const MaskOf<T> solid = clear & !thin_, sheet = clear & thin_;
    if (any(solid)) {
      DielectricBoundaryOf<T> boundary(ior, outside_, specular_color_, transmitted);
      if (const WavelengthOf<T>* light = model_.at().wavelength)
        boundary.disperse(*light, ior, outside_, inverse_abbe_number_of(model_));
      closure_.template add<kGlassSlot>(solid, GlassLobe<T>(boundary, facets_.mean_alpha()), weight);
    }
    if (any(sheet))
      closure_.template add<kThinGlassSlot>(
          sheet, ThinGlassLobe<T>{ior, facets_.ggx, facets_.smooth, specular_color_, transmitted}, weight);
  }

  void add_glossy_diffuse() {
    const T weight = 1 - metalness_ - transmission_;
    const MaskOf<T> opaque = weight > 0, filmed = film_ > 0;
    if (!any(opaque)) return;
    // Below the coat; the ratio is turned over where the coat is denser, as total reflection would not be
    // seen from outside (OpenPBR 1.1).
    const T over = ior_ / mix(T(1.0f), coat_ior_, coat_);
    const T eta = reweighed_index(select(over < 1, 1 / over, over), specular_weight_);
    const RgbOf<T> tint = specular_color_ * weight;
    const MaskOf<T> bare = opaque & !filmed, covered = opaque & filmed;
    const DielectricReflectance<T> reflectance{eta};
    if (any(bare))
      closure_.template add<kBoundarySlot>(
          bare, DielectricLobe{reflectance, facets_.ggx, facets_.smooth, true}, tint, Below{T(1.0f)});
    if (any(covered)) add_under_film<kBoundaryFilmSlot>(covered, reflectance, tint, Below{T(1.0f)});
    const RgbOf<T> below = share(&Principled::subsurface_color) * subsurface_;
    // OpenPBR 1.1, section "Thin-walled case".
    const T forward = model_.number(&Principled::subsurface_scatter_anisotropy);
    const RgbOf<T> transmitted = select(thin_, below * ((1 + forward) * 0.5f), RgbOf<T>{});
    closure_.template add<kDiffuseSlot>(
        opaque,
        DiffuseLobe<T>(unit(base_color_ * (1 - subsurface_) + below - transmitted),
                       share(&Principled::base_diffuse_roughness)),
        RgbOf<T>::gray(weight));
    closure_.template add<kDiffuseTransmissionSlot>(opaque, DiffuseTransmissionLobe<T>{},
                                                    transmitted * weight);
  }

  const ModelAt<T, Principled>& model_;
  MaskOf<T> outside_, thin_;
  T transmission_weight_;
  MaskOf<T> is_inside_;
  T metalness_, transmission_, coat_, subsurface_, film_, roughness_;
  T ior_, specular_weight_;
  RgbOf<T> specular_color_, base_color_;
  T coat_roughness_{}, coat_ior_ = T(1.0f);
  Facets<T> facets_{};
  ClosureOf<T> closure_;
};

// Adds reflection that is not compensated.
template <std::size_t kSlot, std::size_t kOtherSlot, typename T, template <typename> typename Reflectance>
void add_facets(ClosureOf<T>& closure, const Reflectance<T>& reflectance, const Facets<T>& facets,
                MicrofacetKind kind, RgbOf<T> weight) {
  const MaskOf<T> others = !(facets.smooth | kind.is_correlated_ggx());
  if (!all(others))
    closure.template add<kSlot>(!others, {reflectance, facets.ggx, facets.smooth, false}, weight);
  if (any(others))
    closure.template add<kOtherSlot>(
        others,
        {reflectance, MicrofacetsOf<T>(kind, facets.ggx.alpha_x(), facets.ggx.alpha_y()), false, false},
        weight);
}

}  // namespace

template <typename T>
ClosureOf<T> closure_at(const ModelAt<T, Principled>& model) {
  return PrincipledClosure<T>(model).all_layers();
}

template <typename T>
ClosureOf<T> closure_at(const ModelAt<T, Plastic>& model) {
  const T eta = bounded_ior(model(&Plastic::ior));
  const Facets<T> facets = facets_of(model(&Plastic::roughness), T(0.0f));
  const MicrofacetKind kind = model.first().microfacets;
  ClosureOf<T> closure;
  add_facets<kBoundarySlot, kOtherBoundarySlot>(closure, DielectricReflectance<T>{eta}, facets, kind,
                                                unit(model(&Plastic::specular)));
  closure.template add<kCoveredDiffuseSlot>(
      true,
      CoveredDiffuseLobe<T>(unit(model(&Plastic::diffuse)) * model.at().tint,
                            {all(facets.smooth) ? MicrofacetKind{} : kind, facets.mean_alpha(), eta,
                             unit(model(&Plastic::internal_reflection))},
                            model.holds([](const Plastic& m) { return m.nonlinear; }),
                            model.holds([](const Plastic& m) { return m.compensated; })),
      white<T>());
  return closure;
}

template <typename T>
ClosureOf<T> closure_at(const ModelAt<T, ConductorMaterial>& model) {
  const Facets<T> facets =
      facets_of(model(&ConductorMaterial::roughness), unit(model(&ConductorMaterial::anisotropy)));
  // Without either index, nothing would be defined head-on.
  static constexpr float kMinExtinction = 1e-3f, kMaxIndex = 1e6f;  // its fourth power must fit a float
  const RgbOf<T> eta = model(&ConductorMaterial::eta), k = model(&ConductorMaterial::k);
  const auto bounded = [](RgbOf<T> v, float least) -> RgbOf<T> {
    return {clamp_between(v.r, least, kMaxIndex), clamp_between(v.g, least, kMaxIndex),
            clamp_between(v.b, least, kMaxIndex)};
  };
  const ConductorReflectance<T> reflectance{bounded(eta, 0), bounded(k, kMinExtinction)};
  ClosureOf<T> closure;
  add_facets<kConductorSlot, kOtherConductorSlot>(closure, reflectance, facets, model.first().microfacets,
                                                  unit(model(&ConductorMaterial::specular)));
  return closure;
}

// If both add up to more than 1, they are scaled down to that.
template <typename T>
ClosureOf<T> closure_at(const ModelAt<T, DiffuseTransmission>& model) {
  const RgbOf<T> tint = model.at().tint;
  const RgbOf<T> reflected = unit(model(&DiffuseTransmission::reflectance)) * tint,
                 transmitted = unit(model(&DiffuseTransmission::transmittance)) * tint;
  const RgbOf<T> scale = normalize_energy(reflected, transmitted);
  ClosureOf<T> closure;
  closure.template add<kDiffuseSlot>(true, DiffuseLobe<T>(reflected * scale, T(0.0f)), white<T>());
  closure.template add<kDiffuseTransmissionSlot>(true, DiffuseTransmissionLobe<T>{}, transmitted * scale);
  return closure;
}

template <typename T>
ClosureOf<T> closure_at(const ModelAt<T, ThinDielectric>& model) {
  ClosureOf<T> closure;
  closure.template add<kThinGlassSlot>(true,
                                       ThinGlassLobe<T>{bounded_ior(model(&ThinDielectric::ior)),
                                                        AnisotropicGgxOf<T>(T(kMinAlpha), T(kMinAlpha)), true,
                                                        unit(model(&ThinDielectric::reflectance)),
                                                        unit(model(&ThinDielectric::transmittance))},
                                       white<T>());
  return closure;
}

template ClosureOf<float> closure_at(const ModelAt<float, Principled>&);
template ClosureOf<FloatN> closure_at(const ModelAt<FloatN, Principled>&);
template ClosureOf<float> closure_at(const ModelAt<float, Plastic>&);
template ClosureOf<FloatN> closure_at(const ModelAt<FloatN, Plastic>&);
template ClosureOf<float> closure_at(const ModelAt<float, ConductorMaterial>&);
template ClosureOf<FloatN> closure_at(const ModelAt<FloatN, ConductorMaterial>&);
template ClosureOf<float> closure_at(const ModelAt<float, DiffuseTransmission>&);
template ClosureOf<FloatN> closure_at(const ModelAt<FloatN, DiffuseTransmission>&);
template ClosureOf<float> closure_at(const ModelAt<float, ThinDielectric>&);
template ClosureOf<FloatN> closure_at(const ModelAt<FloatN, ThinDielectric>&);

}  // namespace tessera::core::shading
