// SPDX-License-Identifier: Apache-2.0
// Path vertices in lanes. Each lane is bit-identical to PathVertex for the same ray and hit.
#pragma once

#include <array>
#include <optional>

#include "core/integrators/surface_batch.hpp"
#include "core/integrators/vertex.hpp"
#include "core/lights/light_sample.hpp"
#include "core/math/lane_array.hpp"
#include "core/shading/layered_materials.hpp"
#include "core/shading/specular.hpp"

namespace tessera::core {

// Any BSDF in each lane, evaluated one by one. Unset lanes scatter nothing.
class MixedBsdfs {
 public:
  void set(std::size_t lane, const Bsdf& bsdf);

  Mask8 is_delta() const { return Mask8::from_bits(delta_); }
  Mask8 transmits() const { return Mask8::from_bits(transmits_); }
  void scale_diffuse(Float8 factor);
  // Bsdf::orient of each lane, unless the tangent is zero.
  void orient(Vec3Of<Float8> tangents_local);
  // Bsdf::turn_coat of these lanes.
  void turn_coat(Mask8 lanes, const FrameOf<Float8>& axes, Vec3Of<Float8> wo_local);
  // Zero if wi is zero, which is not a direction.
  BsdfValueOf<Float8> evaluate(Vec3Of<Float8> wo_local, Vec3Of<Float8> wi_local, Float8 diffuse_cos) const;
  BsdfSampleOf<Float8> sample(Vec3Of<Float8> wo_local, Vec2Of<Float8> u, Float8 u_lobe) const;

 private:
  std::array<std::optional<Bsdf>, kLaneCount> bsdfs_;
  unsigned delta_ = 0, transmits_ = 0;  // bit i for lane i
};

template <typename Bsdfs>
class VertexBatch : public VertexOf<Float8, Bsdfs> {
 public:
  // `shading_normal` is on the side of the viewer.
  VertexBatch(const SurfaceBatch& batch, Vec3Of<Float8> shading_normal, const Bsdfs& bsdfs)
      : VertexOf<Float8, Bsdfs>(batch.surface, batch.wo, batch.side.normal, shading_normal,
                                batch.plain_normals(), bsdfs),
        black_(batch.black_backs()) {}

  Mask8 is_delta() const { return this->bsdf_.is_delta() & !black_; }
  // LightSampleContext::normal of each lane.
  Vec3Of<Float8> light_normal() const {
    return select(this->bsdf_.transmits(), Vec3Of<Float8>{}, this->frame_.normal);
  }

  // Turns anisotropic BSDFs to tangents in world space; lanes with a tangent of zero stay.
  void orient(Vec3Of<Float8> tangents) { this->bsdf_.orient(this->frame_.to_local(tangents)); }

  BsdfValueOf<Float8> evaluate(Vec3Of<Float8> wi) const {
    const BsdfValueOf<Float8> value = VertexOf<Float8, Bsdfs>::evaluate(wi);
    if (!any(black_)) return value;
    return {select(black_, RgbOf<Float8>{}, value.value), select(black_, Float8(0.0f), value.pdf)};
  }

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
    BsdfSampleOf<Float8> local = this->bsdf_.sample(this->wo_local_, u, u_lobe);
    if (any(black_)) local.found = local.found & !black_;
    const auto folded = this->fold(local.wi_local);
    const auto& [value, pdf] = folded.scattered;
    const Vec3Of<Float8> wi = normalize(this->frame_.to_world(folded.wi_local));
    const Mask8 lost = folded.lost | (folded.reweighed & !(pdf > 0));
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

 private:
  Mask8 black_;  // lanes that scatter nothing
};

// The kernels: BSDFs of these materials have a vector form. A batch must hold materials of one kernel only,
// and layered ones of one model.
enum class Kernel { kDiffuse, kGlossy, kPhong, kSpecular, kLayered, kMixed };
Kernel kernel_of(const Material& material);

// Lambert's.
using DiffuseVertices = VertexBatch<LambertBsdfOf<Float8>>;
DiffuseVertices diffuse_vertices(const SurfaceBatch& batch);

// CookTorrance's.
using GlossyVertices = VertexBatch<CookTorranceBsdfOf<Float8>>;
GlossyVertices glossy_vertices(const SurfaceBatch& batch);

using PhongVertices = VertexBatch<PhongBsdfOf<Float8>>;
PhongVertices phong_vertices(const SurfaceBatch& batch);

// Mirrors' and glasses'.
using SpecularVertices = VertexBatch<SpecularBsdfOf<Float8>>;
SpecularVertices specular_vertices(const SurfaceBatch& batch);

// Those of layered_materials.hpp.
using LayeredVertices = VertexBatch<ClosureOf<Float8>>;
LayeredVertices layered_vertices(const SurfaceBatch& batch);

// Of all materials, one by one: for those without a vector form. Only the first `count` lanes scatter.
using MixedVertices = VertexBatch<MixedBsdfs>;
MixedVertices mixed_vertices(const SurfaceBatch& batch, std::size_t count);

}  // namespace tessera::core
