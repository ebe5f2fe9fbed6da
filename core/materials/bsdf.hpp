// SPDX-License-Identifier: Apache-2.0
// How a surface scatters light at one point: a material's model with its textures looked up. Lives on the
// stack.
//
// Directions are unit vectors pointing away from the surface, in a local frame whose +z is the shading normal
// on the side of wo. Densities are per solid angle.
#pragma once

#include <array>
#include <optional>
#include <variant>
#include <vector>

#include "core/materials/bsdf_sample.hpp"
#include "core/materials/cook_torrance.hpp"
#include "core/materials/lambert.hpp"
#include "core/materials/material.hpp"
#include "core/materials/mirror.hpp"
#include "core/materials/phong.hpp"
#include "core/materials/rough_dielectric.hpp"
#include "core/materials/smooth_dielectric.hpp"

namespace tessera::core {

class Bsdf {
 public:
  // `outside`: wo is on the side that the outward geometric normal points to. `tint` multiplies the base
  // colour (MeshDescription::colors).
  Bsdf(const Material& material, const std::vector<Texture>& textures, Vec2 uv, bool outside,
       Rgb tint = Rgb::gray(1));

  // Scatters into single directions only: evaluate and pdf are zero. Otherwise into none.
  bool is_delta() const;
  // Scatters to the other side too.
  bool transmits() const;

  // Multiplies diffuse reflection: by more than 1 where a shading normal leans (VertexOf).
  void scale_diffuse(float factor);

  // bsdf * |cos(wi)|, and the density with which sample() chooses wi: its integral is the probability that
  // sample() answers at all. The diffuse part has diffuse_cos instead of the cosine.
  BsdfValue evaluate(Vec3 wo_local, Vec3 wi_local, float diffuse_cos) const;
  BsdfValue evaluate(Vec3 wo_local, Vec3 wi_local) const { return evaluate(wo_local, wi_local, wi_local.z); }
  // Nothing where no light is scattered. u_lobe chooses among lobes.
  std::optional<BsdfSample> sample(Vec3 wo_local, Vec2 u, float u_lobe) const;
  // Every direction that a delta BSDF scatters to, each with its share of the light in the weight: what is
  // reflected, and what is refracted.
  std::array<std::optional<BsdfSample>, 2> delta_branches(Vec3 wo_local) const;

 private:
  using AtPoint = std::variant<LambertBsdf, MirrorBsdf, SmoothDielectricBsdf, RoughDielectricBsdf, PhongBsdf,
                               CookTorranceBsdf>;

  static AtPoint look_up(const Material& material, const std::vector<Texture>& textures, Vec2 uv,
                         bool outside, Rgb tint);
  std::optional<BsdfSample> sample_uniformly(Vec3 wo_local, Vec2 u) const;
  float uniform_pdf(Vec3 wo_local, Vec3 wi_local) const;

  AtPoint at_point_;
  bool uniform_;
};

}  // namespace tessera::core
