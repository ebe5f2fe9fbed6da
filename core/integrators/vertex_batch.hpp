// SPDX-License-Identifier: Apache-2.0
// Path vertices in lanes. Each lane is bit-identical to PathVertex for the same ray and hit.
#pragma once

#include <cstdint>

#include "core/integrators/surface_batch.hpp"
#include "core/integrators/vertex.hpp"
#include "core/lights/light_sample.hpp"
#include "core/math/lane_array.hpp"
#include "core/shading/bsdf.hpp"

namespace tessera::core::integrators {

template <typename Bsdfs>
class VertexBatch : public VertexOf<FloatN, Bsdfs> {
 public:
  // `shading_normal` is on the side of the viewer.
  VertexBatch(const SurfaceBatch& batch, Vec3Of<FloatN> shading_normal, const Bsdfs& bsdfs)
      : VertexOf<FloatN, Bsdfs>(batch.surface, batch.wo, batch.side.normal, shading_normal,
                                batch.plain_normals(), bsdfs),
        black_(batch.black_backs()) {}

  MaskN is_delta() const { return this->bsdf_.is_delta() & !black_; }
  // LightSampleContext::normal of each lane.
  Vec3Of<FloatN> light_normal() const {
    return select(this->bsdf_.transmits(), Vec3Of<FloatN>{}, this->frame_.normal);
  }

  // Turns anisotropic BSDFs to tangents in world space; lanes with a tangent of zero stay.
  void orient(Vec3Of<FloatN> tangents) { this->bsdf_.orient(this->frame_.to_local(tangents)); }

  BsdfValueOf<FloatN> evaluate(Vec3Of<FloatN> wi) const {
    const BsdfValueOf<FloatN> value = VertexOf<FloatN, Bsdfs>::evaluate(wi);
    if (!any(black_)) return value;
    return {select(black_, RgbOf<FloatN>{}, value.value), select(black_, FloatN(0.0f), value.pdf)};
  }

  // Shadow rays towards the light samples.
  RayOf<FloatN> rays_toward(const lights::LightSamples& lights) const {
    const RayOf<FloatN> near = this->ray_to(lights.point);
    if (!any(lights.distant)) return near;
    const RayOf<FloatN> far = this->ray_along(lights.wi);
    return {select(lights.distant, far.origin, near.origin),
            select(lights.distant, far.direction, near.direction),
            select(lights.distant, far.t_max, near.t_max)};
  }

  // As PathVertex::Scattered; a path ends if nothing was sampled.
  struct Scattered {
    MaskN found, delta;
    Vec3Of<FloatN> wi;
    RgbOf<FloatN> weight;
    FloatN pdf, eta;
  };
  Scattered sample(Vec2Of<FloatN> u, FloatN u_lobe) const {
    BsdfSampleOf<FloatN> local = this->bsdf_.sample(this->wo_local_, u, u_lobe);
    if (any(black_)) local.found = local.found & !black_;
    const auto folded = this->fold(local.wi_local);
    const auto& [value, pdf] = folded.scattered;
    const Vec3Of<FloatN> wi = normalize(this->frame_.to_world(folded.wi_local));
    const MaskN lost = folded.lost | (folded.reweighed & !(pdf > 0));
    Scattered next{local.found & !lost,
                   local.delta,
                   wi,
                   select(folded.reweighed, value / pdf, local.weight),
                   select(folded.reweighed, pdf, local.pdf),
                   local.eta};
    if (!any(local.delta)) return next;
    const Vec3Of<FloatN> side = select(local.transmitted, -this->side_normal_, this->side_normal_);
    const Vec3Of<FloatN> delta_wi = normalize(this->frame_.to_world(local.wi_local));
    next.found = next.found | (local.found & local.delta);
    next.wi = select(local.delta, clamp_above_surface(delta_wi, side), wi);
    next.weight = select(local.delta, local.weight, next.weight);
    return next;
  }

 private:
  MaskN black_;  // lanes that scatter nothing
};

// What vertices are shaded by. Frequent BSDFs have kernels of their own: Lambert's, CookTorrance's, Phong's,
// those of mirrors and glass, and those of layered materials (layered_materials.hpp). All others share one.
enum class Kernel : std::uint8_t { kDiffuse, kGlossy, kPhong, kSpecular, kLayered, kGeneral };
Kernel kernel_of(const Material& material);

// A batch must hold materials of the kernel only; layered and general ones must be of one model and one kind
// of microfacets.
using DiffuseVertices = VertexBatch<shading::LambertBsdfOf<FloatN>>;
DiffuseVertices diffuse_vertices(const SurfaceBatch& batch);

using GlossyVertices = VertexBatch<shading::CookTorranceBsdfOf<FloatN>>;
GlossyVertices glossy_vertices(const SurfaceBatch& batch);

using PhongVertices = VertexBatch<shading::PhongBsdfOf<FloatN>>;
PhongVertices phong_vertices(const SurfaceBatch& batch);

using SpecularVertices = VertexBatch<shading::SpecularBsdfOf<FloatN>>;
SpecularVertices specular_vertices(const SurfaceBatch& batch);

using LayeredVertices = VertexBatch<shading::ClosureOf<FloatN>>;
LayeredVertices layered_vertices(const SurfaceBatch& batch);

using GeneralVertices = VertexBatch<shading::BsdfOf<FloatN>>;
GeneralVertices general_vertices(const SurfaceBatch& batch);

}  // namespace tessera::core::integrators
