// SPDX-License-Identifier: Apache-2.0
// Eight path vertices at once. Each lane is bit-identical to PathVertex for the same ray and hit.
#pragma once

#include <array>
#include <optional>

#include "core/integrators/vertex.hpp"
#include "core/lights/light_sample.hpp"
#include "core/math/lane_array.hpp"

namespace tessera::core {

// The samples of eight BSDFs.
struct BsdfSamples {
  Mask8 found, delta, transmitted;
  Vec3Of<Float8> wi_local;
  RgbOf<Float8> weight;
  Float8 pdf, eta;
};

// Diffuse reflection in all lanes.
struct DiffuseBsdfs : LambertBsdfOf<Float8> {
  Mask8 is_delta() const { return false; }
  Mask8 transmits() const { return false; }
  BsdfSamples sample(Vec3Of<Float8> wo_local, Vec2Of<Float8> u, Float8) const {
    const Vec3Of<Float8> wi_local = sample_cosine_hemisphere(u);
    return {wo_local.z > 0, false, false, wi_local, albedo, pdf_cosine_hemisphere(wi_local.z), 1.0f};
  }
};

// Microfacet reflection over a diffuse base in all lanes.
struct GlossyBsdfs : CookTorranceBsdfOf<Float8> {
  Mask8 is_delta() const { return false; }
  Mask8 transmits() const { return false; }
  BsdfSamples sample(Vec3Of<Float8> wo_local, Vec2Of<Float8> u, Float8 u_lobe) const {
    const auto [found, wi_local, scattered] = find(wo_local, u, u_lobe);
    return {found, false, false, wi_local, scattered.value / scattered.pdf, scattered.pdf, 1.0f};
  }
};

// Any BSDF in each lane, evaluated one by one. Unset lanes scatter nothing.
class MixedBsdfs {
 public:
  void set(std::size_t lane, const Bsdf& bsdf);

  Mask8 is_delta() const { return Mask8::from_bits(delta_); }
  Mask8 transmits() const { return Mask8::from_bits(transmits_); }
  void scale_diffuse(Float8 factor);
  // Bsdf::orient of each lane, unless the tangent is zero.
  void orient(Vec3Of<Float8> tangents_local);
  // Zero if wi is zero, which is not a direction.
  BsdfValueOf<Float8> evaluate(Vec3Of<Float8> wo_local, Vec3Of<Float8> wi_local, Float8 diffuse_cos) const;
  BsdfSamples sample(Vec3Of<Float8> wo_local, Vec2Of<Float8> u, Float8 u_lobe) const;

 private:
  std::array<std::optional<Bsdf>, kLaneCount> bsdfs_;
  unsigned delta_ = 0, transmits_ = 0;  // bit i for lane i
};

template <typename Bsdfs>
class VertexBatch : public VertexOf<Float8, Bsdfs> {
 public:
  using VertexOf<Float8, Bsdfs>::VertexOf;

  Mask8 is_delta() const { return this->bsdf_.is_delta(); }
  // LightSampleContext::normal of each lane.
  Vec3Of<Float8> light_normal() const {
    return select(this->bsdf_.transmits(), Vec3Of<Float8>{}, this->frame_.normal);
  }

  // Turns anisotropic BSDFs to tangents in world space; zero for others.
  void orient(Vec3Of<Float8> tangents) { this->bsdf_.orient(this->frame_.to_local(tangents)); }

  // Shadow rays towards the light samples.
  RayOf<Float8> rays_toward(const LightSamples& lights) const {
    const RayOf<Float8> near = this->ray_to(lights.point);
    if (!any(lights.distant)) return near;
    const RayOf<Float8> far = this->ray_along(lights.wi);
    return {select(lights.distant, far.origin, near.origin),
            select(lights.distant, far.direction, near.direction),
            select(lights.distant, far.t_max, near.t_max)};
  }

  // As PathVertex::Scattered; a path ends if nothing was sampled.
  struct Scattered {
    Mask8 found, delta;
    Vec3Of<Float8> wi;
    RgbOf<Float8> weight;
    Float8 pdf, eta;
  };
  Scattered sample(Vec2Of<Float8> u, Float8 u_lobe) const {
    const BsdfSamples local = this->bsdf_.sample(this->wo_local_, u, u_lobe);
    const auto folded = this->fold(local.wi_local);
    const auto& [value, pdf] = folded.scattered;
    const Vec3Of<Float8> wi = normalize(this->frame_.to_world(folded.wi_local));
    const Mask8 lost = folded.reweighed & !(pdf > 0);
    Scattered next{local.found & !lost,
                   local.delta,
                   wi,
                   select(folded.reweighed, value / pdf, local.weight),
                   select(folded.reweighed, pdf, local.pdf),
                   local.eta};
    if (!any(local.delta)) return next;
    const Vec3Of<Float8> side = select(local.transmitted, -this->side_normal_, this->side_normal_);
    const Vec3Of<Float8> delta_wi = normalize(this->frame_.to_world(local.wi_local));
    next.found = next.found | (local.found & local.delta);
    next.wi = select(local.delta, clamp_above_surface(delta_wi, side), wi);
    next.weight = select(local.delta, local.weight, next.weight);
    return next;
  }
};

// Triangles whose material is_diffuse.
using DiffuseVertices = VertexBatch<DiffuseBsdfs>;
bool is_diffuse(const Material& material);
DiffuseVertices diffuse_vertices(const Scene& scene, const std::array<const Ray*, kLaneCount>& rays,
                                 const std::array<const Hit*, kLaneCount>& hits);

// Triangles whose material is_glossy.
using GlossyVertices = VertexBatch<GlossyBsdfs>;
bool is_glossy(const Material& material);
GlossyVertices glossy_vertices(const Scene& scene, const std::array<const Ray*, kLaneCount>& rays,
                               const std::array<const Hit*, kLaneCount>& hits);

// Any surfaces. Only the first `count` lanes scatter.
using MixedVertices = VertexBatch<MixedBsdfs>;
MixedVertices mixed_vertices(const Scene& scene, const std::array<const Ray*, kLaneCount>& rays,
                             const std::array<const Hit*, kLaneCount>& hits, std::size_t count);

}  // namespace tessera::core
