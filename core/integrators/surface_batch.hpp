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
#include "core/math/lane_array.hpp"
#include "core/shading/layered_materials.hpp"

namespace tessera::core {

struct SurfaceBatch {
  using Materials = std::array<const Material*, kLaneCount>;

  // `materials` are those that scatter light (scatterer_of). `plain_triangles`: that
  // Primitives::is_plain_triangle() holds in all lanes, which is faster.
  SurfaceBatch(const Scene& scene, const RayPointers& rays, const HitPointers& hits,
               const Materials& materials, bool plain_triangles);

  // outward_normal() in each lane.
  Vec3Of<Float8> outward_normals() const;
  // The base colours' vertex colours; white without any.
  RgbOf<Float8> tints() const;
  // What the models' parameters are evaluated at.
  MaterialPointOf<Float8> material_point() const {
    return {scene.textures(), uv_sets(), side.outside, tints()};
  }
  UvSetsOf<Float8> uv_sets() const { return scene.primitives().uv_sets(hits, surface.uv); }
  // The lanes where the viewer sees the back of a surface that only its front scatters from.
  Mask8 black_backs() const;
  // The lanes with ShadingNormals::kPlain.
  Mask8 plain_normals() const;

  const Scene& scene;
  const HitPointers& hits;
  const Materials& materials;
  SurfacePointOf<Float8> surface;
  Vec3Of<Float8> wo;  // unit, towards the origins of the rays
  ViewedSide<Float8> side;

 private:
  Vec3Of<Float8> normal_mapped() const;
  Vec3Of<Float8> bumped(Vec3Of<Float8> normals) const;
};

}  // namespace tessera::core
