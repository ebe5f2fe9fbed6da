// SPDX-License-Identifier: Apache-2.0
// The surfaces that several rays hit, one in each lane, with the materials that scatter there: what a kernel
// of BSDFs makes vertices of. Whatever was hit, and in whatever instance, has become a surface point here, so
// kernels differ by material alone. Lives on the stack of the thread that traces the paths.
//
// A new kind of primitive is one function in core/geometry/surface_lanes.cpp; nothing changes here.
#pragma once

#include <array>
#include <cstddef>

#include "core/geometry/surface_points.hpp"
#include "core/integrators/vertex.hpp"
#include "core/materials/model_at.hpp"
#include "core/math/lane_array.hpp"

namespace tessera::core::integrators {

struct SurfaceBatch {
  using Materials = MaterialsOf<FloatN>;

  // `materials` are those that scatter light (scatterer_of). `plain_triangles`: that
  // Primitives::is_plain_triangle() holds in all lanes, which is faster.
  SurfaceBatch(const Scene& scene, const RayRows& rays, const HitRows& hits, const Materials& materials,
               bool plain_triangles);

  // outward_normal() in each lane.
  Vec3Of<FloatN> outward_normals() const;
  // The base colours' vertex colours; white without any.
  RgbOf<FloatN> tints() const;
  // What the models' parameters are evaluated at.
  MaterialPointOf<FloatN> material_point() const {
    return {scene.textures(),
            {uv_sets(), surface.position, surface.geometric_normal},
            side.outside,
            tints(),
            scene.primitives().has_vertex_colors(),
            wavelength};
  }
  UvSetsOf<FloatN> uv_sets() const { return scene.primitives().uv_sets(hits, surface.uv); }
  // The lanes where the viewer sees the back of a surface that only its front scatters from.
  MaskN black_backs() const;
  // The lanes with ShadingNormals::kPlain.
  MaskN plain_normals() const;

  const Scene& scene;
  const HitRows& hits;
  const Materials& materials;
  SurfacePointOf<FloatN> surface;
  Vec3Of<FloatN> wo;  // unit, towards the origins of the rays
  ViewedSide<FloatN> side;
  const WavelengthOf<FloatN>* wavelength = nullptr;  // of the light, if any of the materials disperses

 private:
  Vec3Of<FloatN> normal_mapped() const;
  Vec3Of<FloatN> bumped(Vec3Of<FloatN> normals) const;
};

}  // namespace tessera::core::integrators
