// SPDX-License-Identifier: Apache-2.0
// The BSDF at a surface point: a material's model with its textures evaluated. Lives on the stack.
//
// Directions are unit vectors pointing away from the surface, in a local frame whose +z is the shading
// normal on the side of wo. Densities are per solid angle.
#pragma once

#include <array>
#include <optional>
#include <variant>
#include <vector>

#include "core/materials/bsdf_sample.hpp"
#include "core/materials/hair.hpp"
#include "core/materials/material.hpp"
#include "core/shading/closure.hpp"
#include "core/shading/cook_torrance.hpp"
#include "core/shading/disney_bsdf.hpp"
#include "core/shading/lambert.hpp"
#include "core/shading/mirror.hpp"
#include "core/shading/phong.hpp"
#include "core/shading/rough_dielectric.hpp"
#include "core/shading/smooth_dielectric.hpp"

namespace tessera::core {

class Bsdf {
 public:
  // Of a blend, pass the part that scatters (blend.hpp). `outside`: wo is on the side that the outward
  // geometric normal points to. `tint` multiplies the base colour (MeshDescription::colors).
  Bsdf(const Material& material, const std::vector<Texture>& textures, const UvSets& uv, bool outside,
       Rgb tint = Rgb::gray(1));

  // Whether it has only delta lobes, for which evaluate() returns zero; or any.
  bool is_delta() const;
  bool has_delta() const;
  // Whether it also scatters to the other side, by lobes that are not delta.
  bool transmits() const;

  // Turns anisotropic surfaces to the direction of increasing u, which need not be perpendicular to the
  // normal.
  void orient(Vec3 tangent_local);

  // As ClosureOf::turn_coat.
  void turn_coat(bool turns, const Frame& axes, Vec3 wo_local);

  // As ClosureOf::look_from.
  void look_from(float cos_o);

  // Multiplies diffuse reflection, by more than 1 if the shading normal is tilted (VertexOf).
  void scale_diffuse(float factor);

  // bsdf * |cos(wi)|, and the density with which sample() generates wi. It integrates to the probability
  // that sample() returns a sample. The diffuse part uses diffuse_cos instead of the cosine.
  BsdfValue evaluate(Vec3 wo_local, Vec3 wi_local, float diffuse_cos) const;
  BsdfValue evaluate(Vec3 wo_local, Vec3 wi_local) const { return evaluate(wo_local, wi_local, wi_local.z); }
  // Returns nothing if no light is scattered. u_lobe chooses among lobes.
  std::optional<BsdfSample> sample(Vec3 wo_local, Vec2 u, float u_lobe) const;
  DeltaBranches delta_branches(Vec3 wo_local) const;

 private:
  using AtPoint = std::variant<LambertBsdf, MirrorBsdf, SmoothDielectricBsdf, RoughDielectricBsdf,
                               RoughDielectricOf<float, Microfacets>, PhongBsdf, CookTorranceBsdf,
                               ClosureOf<float>, HairBsdf, DisneyBsdf>;

  static AtPoint look_up(const Material& material, const std::vector<Texture>& textures, const UvSets& uv,
                         bool outside, Rgb tint);
  std::optional<BsdfSample> sample_uniformly(Vec3 wo_local, Vec2 u) const;
  float transmitted_eta() const;
  float uniform_pdf(Vec3 wo_local, Vec3 wi_local) const;

  AtPoint at_point_;
  bool uniform_;
};

}  // namespace tessera::core
