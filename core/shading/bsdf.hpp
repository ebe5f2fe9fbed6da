// SPDX-License-Identifier: Apache-2.0
// The BSDF of any material at a surface point, with its textures evaluated; or of one in each lane, whose
// materials are of one model and one kind of microfacets. Lives on the stack.
//
// Directions are unit vectors pointing away from the surface, in a local frame whose +z is the shading
// normal on the side of wo. Densities are per solid angle.
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "core/materials/bsdf_sample.hpp"
#include "core/materials/model_at.hpp"
#include "core/shading/closure.hpp"
#include "core/shading/cook_torrance.hpp"
#include "core/shading/disney_bsdf.hpp"
#include "core/shading/hair_bsdf.hpp"
#include "core/shading/lambert.hpp"
#include "core/shading/phong.hpp"
#include "core/shading/specular.hpp"

namespace tessera::core::shading {

// T is float for one point, or FloatN for one in each lane.
template <typename T>
class BsdfOf {
 public:
  // Of blends, pass the parts that scatter (blend.hpp).
  BsdfOf(const MaterialsOf<T>& materials, const MaterialPointOf<T>& at);

  // Whether it has only delta lobes, for which evaluate() returns zero; or any.
  MaskOf<T> is_delta() const;
  MaskOf<T> has_delta() const;
  // Whether it also scatters to the other side, by lobes that are not delta.
  MaskOf<T> transmits() const;

  // Turns anisotropic surfaces to the direction of increasing u, which need not be perpendicular to the
  // normal.
  void orient(Vec3Of<T> tangent_local);

  // As ClosureOf::turn_coat.
  void turn_coat(MaskOf<T> lanes, const FrameOf<T>& axes, Vec3Of<T> wo_local);

  // As ClosureOf::look_from.
  void look_from(T cos_o);

  // Multiplies diffuse reflection, by more than 1 if the shading normal is tilted (VertexOf).
  void scale_diffuse(T factor);

  // bsdf * |cos(wi)|, and the density with which sample() generates wi. It integrates to the probability
  // that sample() returns a sample. The diffuse part uses diffuse_cos instead of the cosine.
  BsdfValueOf<T> evaluate(Vec3Of<T> wo_local, Vec3Of<T> wi_local, T diffuse_cos) const;
  // Not found if no light is scattered. u_lobe chooses among lobes.
  BsdfSampleOf<T> sample(Vec3Of<T> wo_local, Vec2Of<T> u, T u_lobe) const;
  // For T = float.
  DeltaBranches delta_branches(Vec3 wo_local) const;

 private:
  using AtPoint =
      std::variant<LambertBsdfOf<T>, PhongBsdfOf<T>, CookTorranceBsdfOf<T>, SpecularBsdfOf<T>,
                   SpecularBsdfOf<T, MicrofacetsOf<T>>, ClosureOf<T>, HairBsdfOf<T>, DisneyBsdfOf<T>>;

  static AtPoint look_up(const MaterialsOf<T>& materials, const MaterialPointOf<T>& at);
  BsdfSampleOf<T> sample_uniformly(Vec3Of<T> wo_local, Vec2Of<T> u) const;
  T transmitted_eta() const;
  T uniform_pdf(Vec3Of<T> wo_local, Vec3Of<T> wi_local) const;

  AtPoint at_point_;
  MaskOf<T> uniform_;  // Sampling::kUniform
};
extern template class BsdfOf<float>;
extern template class BsdfOf<FloatN>;

// The BSDF at one point.
class Bsdf : public BsdfOf<float> {
 public:
  // `outside`: wo is on the side that the outward geometric normal points to. `tint` multiplies the base
  // colour (MeshDescription::colors).
  Bsdf(const Material& material, const std::vector<Texture>& textures, const TexturePoint& point,
       bool outside, Rgb tint = Rgb::gray(1))
      : Bsdf(material, {textures, point, outside, tint}) {}
  Bsdf(const Material& material, const MaterialPoint& at)
      : BsdfOf(&material, at), black_(!at.outside && is_one_sided(material)) {}

  bool is_delta() const { return !black_ && BsdfOf::is_delta(); }
  bool has_delta() const { return !black_ && BsdfOf::has_delta(); }
  using BsdfOf::evaluate;
  BsdfValue evaluate(Vec3 wo_local, Vec3 wi_local, float diffuse_cos) const {
    return black_ ? BsdfValue{} : BsdfOf::evaluate(wo_local, wi_local, diffuse_cos);
  }
  BsdfValue evaluate(Vec3 wo_local, Vec3 wi_local) const { return evaluate(wo_local, wi_local, wi_local.z); }
  // Returns nothing if no light is scattered.
  std::optional<BsdfSample> sample(Vec3 wo_local, Vec2 u, float u_lobe) const {
    return black_ ? std::nullopt : alone(BsdfOf::sample(wo_local, u, u_lobe));
  }
  DeltaBranches delta_branches(Vec3 wo_local) const {
    return black_ ? DeltaBranches{} : BsdfOf::delta_branches(wo_local);
  }

 private:
  bool black_;  // the back of a surface that only its front scatters from
};

}  // namespace tessera::core::shading
