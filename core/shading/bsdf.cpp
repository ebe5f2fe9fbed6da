// SPDX-License-Identifier: Apache-2.0
#include "core/shading/bsdf.hpp"

#include "core/base/overloaded.hpp"
#include "core/sampling/warp.hpp"
#include "core/shading/bsdf_at.hpp"
#include "core/shading/layered_materials.hpp"

namespace tessera::core::shading {

template <typename T>
typename BsdfOf<T>::AtPoint BsdfOf<T>::look_up(const MaterialsOf<T>& materials,
                                               const MaterialPointOf<T>& at) {
  const ModelAt<T, Material> material(materials, at);
  const auto model_at = [&]<typename Model>(const Model&) {
    return ModelAt<T, Model>(models_of<Model>(materials), at);
  };
  const auto specular = [&]() -> AtPoint { return specular_at<T, GgxOf<T>>(materials, at); };
  return std::visit(Overloaded{
                        [&](const Mirror&) { return specular(); },
                        [&](const Glass& glass) -> AtPoint {
                          if (glass.microfacets.is_correlated_ggx()) return specular();
                          return specular_at<T, MicrofacetsOf<T>>(materials, at);
                        },
                        // What it transmits does not stop here (interception_at).
                        [&](const ThinDielectric& pane) -> AtPoint {
                          if (passes_straight(material.first())) return specular();
                          return closure_at(model_at(pane));
                        },
                        [&](const CookTorrance& m) -> AtPoint {
                          return bsdf_at(model_at(m), material.holds([](const Material& one) {
                            return one.sampling == Sampling::kHalfVector;
                          }));
                        },
                        [&](const Hair& m) -> AtPoint { return HairBsdfOf<T>(model_at(m)); },
                        [&](const Disney& m) -> AtPoint { return DisneyBsdfOf<T>(model_at(m)); },
                        [&](const Lambert& m) -> AtPoint { return bsdf_at(model_at(m)); },
                        [&](const Phong& m) -> AtPoint { return bsdf_at(model_at(m)); },
                        // Resolved before (scatterer_at), and never hit.
                        [](const Blend&) -> AtPoint { return ClosureOf<T>(); },
                        [](const Null&) -> AtPoint { return ClosureOf<T>(); },
                        [&](const auto& m) -> AtPoint { return closure_at(model_at(m)); },
                    },
                    first_of(materials).model);
}

template <typename T>
BsdfOf<T>::BsdfOf(const MaterialsOf<T>& materials, const MaterialPointOf<T>& at)
    : at_point_(look_up(materials, at)) {
  const ModelAt<T, Material> material(materials, at);
  const MaskOf<T> wanted =
      material.holds([](const Material& one) { return one.sampling == Sampling::kUniform; });
  uniform_ = wanted & !has_delta();
}

template <typename T>
MaskOf<T> BsdfOf<T>::is_delta() const {
  return std::visit([](const auto& bsdf) { return bsdf.is_delta(); }, at_point_);
}

template <typename T>
MaskOf<T> BsdfOf<T>::has_delta() const {
  const auto* closure = std::get_if<ClosureOf<T>>(&at_point_);
  return closure != nullptr ? closure->has_delta() : is_delta();
}

template <typename T>
MaskOf<T> BsdfOf<T>::transmits() const {
  return std::visit([](const auto& bsdf) { return bsdf.transmits(); }, at_point_);
}

template <typename T>
void BsdfOf<T>::orient(Vec3Of<T> tangent_local) {
  std::visit(
      [&](auto& bsdf) {
        if constexpr (requires { bsdf.orient(tangent_local); }) bsdf.orient(tangent_local);
      },
      at_point_);
}

template <typename T>
void BsdfOf<T>::turn_coat(MaskOf<T> lanes, const FrameOf<T>& axes, Vec3Of<T> wo_local) {
  if (auto* closure = std::get_if<ClosureOf<T>>(&at_point_)) closure->turn_coat(lanes, axes, wo_local);
}

template <typename T>
void BsdfOf<T>::look_from(T cos_o) {
  if (auto* closure = std::get_if<ClosureOf<T>>(&at_point_)) closure->look_from(cos_o);
}

template <typename T>
void BsdfOf<T>::scale_diffuse(T factor) {
  std::visit([&](auto& bsdf) { bsdf.scale_diffuse(factor); }, at_point_);
}

template <typename T>
BsdfValueOf<T> BsdfOf<T>::evaluate(Vec3Of<T> wo_local, Vec3Of<T> wi_local, T diffuse_cos) const {
  BsdfValueOf<T> value =
      std::visit([&](const auto& bsdf) { return bsdf.evaluate(wo_local, wi_local, diffuse_cos); }, at_point_);
  if (any(uniform_)) value.pdf = select(uniform_, uniform_pdf(wo_local, wi_local), value.pdf);
  return value;
}

template <typename T>
BsdfSampleOf<T> BsdfOf<T>::sample(Vec3Of<T> wo_local, Vec2Of<T> u, T u_lobe) const {
  if (all(uniform_)) return sample_uniformly(wo_local, u);
  const BsdfSampleOf<T> sampled =
      std::visit([&](const auto& bsdf) { return bsdf.sample(wo_local, u, u_lobe); }, at_point_);
  return any(uniform_) ? select(uniform_, sample_uniformly(wo_local, u), sampled) : sampled;
}

template <typename T>
DeltaBranches BsdfOf<T>::delta_branches(Vec3 wo_local) const {
  if constexpr (std::is_same_v<T, float>)
    return std::visit(
        [&](const auto& bsdf) -> DeltaBranches {
          if constexpr (requires { bsdf.delta_branches(wo_local); }) return bsdf.delta_branches(wo_local);
          return {};
        },
        at_point_);
  return {};
}

template <typename T>
T BsdfOf<T>::uniform_pdf(Vec3Of<T> wo_local, Vec3Of<T> wi_local) const {
  const T above = select(wi_local.z > 0, T(1 / (2 * kPi)), T(0.0f));
  return select(wo_local.z <= 0, T(0.0f), select(transmits(), T(1 / (4 * kPi)), above));
}

template <typename T>
T BsdfOf<T>::transmitted_eta() const {
  return std::visit(
      [](const auto& bsdf) {
        if constexpr (requires { bsdf.transmitted_eta(); }) return bsdf.transmitted_eta();
        return T(1.0f);
      },
      at_point_);
}

template <typename T>
BsdfSampleOf<T> BsdfOf<T>::sample_uniformly(Vec3Of<T> wo_local, Vec2Of<T> u) const {
  const Vec3Of<T> wi = select(transmits(), sampling::sample_sphere(u), sampling::sample_hemisphere(u));
  return weighed_sample<T>(!(wo_local.z <= 0), wi, evaluate(wo_local, wi, wi.z), transmitted_eta());
}

template class BsdfOf<float>;
template class BsdfOf<FloatN>;

}  // namespace tessera::core::shading
