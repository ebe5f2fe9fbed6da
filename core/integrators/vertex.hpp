// A vertex of a path: the surface that a ray met and how it scatters, in world space. Lives on the stack of
// the thread that traces the path.
#pragma once

#include <array>
#include <optional>

#include "core/geometry/primitives.hpp"
#include "core/integrators/shading_normal.hpp"
#include "core/lights/light_sample.hpp"
#include "core/materials/bsdf.hpp"
#include "core/math/frame.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core {

// The side of a surface that its viewer sees, who looks along -wo.
template <typename T>
struct ViewedSide {
  ViewedSide(const SurfacePointOf<T>& surface, Vec3Of<T> wo)
      : outside(dot(surface.geometric_normal, wo) >= 0),
        normal(select(outside, surface.geometric_normal, -surface.geometric_normal)) {}

  // `outward`, the normal that the surface is shaded with, on this side and fit to be shaded with.
  Vec3Of<T> shading_normal(Vec3Of<T> outward, Vec3Of<T> wo) const {
    return bend_toward_viewer(bend_above(select(outside, outward, -outward), normal), wo);
  }

  MaskOf<T> outside;
  Vec3Of<T> normal;  // geometric
};

// What vertices of every material have in common. T is float or Float8.
template <typename T, typename BsdfType>
class VertexOf {
 public:
  VertexOf(const SurfacePointOf<T>& surface, Vec3Of<T> wo, Vec3Of<T> side_normal, Vec3Of<T> shading_normal,
           const BsdfType& bsdf)
      : surface_(surface),
        wo_(wo),
        side_normal_(side_normal),
        frame_(FrameOf<T>::around(shading_normal)),
        wo_local_(frame_.to_local(wo)),
        bsdf_(bsdf) {}

  Vec3Of<T> position() const { return surface_.position; }
  const SurfacePointOf<T>& surface() const { return surface_; }
  // The true one, on the side of wo.
  Vec3Of<T> side_normal() const { return side_normal_; }
  // Unit, towards where the ray came from.
  Vec3Of<T> wo() const { return wo_; }

  // BSDF times cosine for light from `wi`, a unit direction away from the surface, on either side of it; and
  // the density per solid angle with which sample() chooses `wi`.
  BsdfValueOf<T> evaluate(Vec3Of<T> wi) const {
    const Vec3Of<T> wi_local = frame_.to_local(wi);
    const BsdfValueOf<T> scattered = bsdf_.evaluate(wo_local_, wi_local);
    const T factor = side_factor(wi, wi_local);
    return {select(factor > 0, scattered.value * factor, RgbOf<T>{}), scattered.pdf};
  }

  RayOf<T> ray_along(Vec3Of<T> wi) const { return {offset_origin(surface_, wi), wi}; }
  // The open segment between this point and another surface's, for shadow rays.
  RayOf<T> ray_to(const SurfacePointOf<T>& other) const {
    const Vec3Of<T> origin = offset_origin(surface_, other.position - surface_.position);
    const Vec3Of<T> target = offset_origin(other, surface_.position - other.position);
    return {origin, target - origin, T(1.0f)};
  }

 protected:
  // What the BSDF is multiplied by where the shading normal is not the true one: where the two disagree on
  // the side of wi, neither reflection nor transmission leads there.
  T side_factor(Vec3Of<T> wi, Vec3Of<T> wi_local) const {
    const T reflected = smooth_terminator(frame_.normal, side_normal_, wi);
    const T transmitted = select(dot(wi, side_normal_) < 0, T(1.0f), T(0.0f));
    return select(wi_local.z > 0, reflected, transmitted);
  }

  SurfacePointOf<T> surface_;
  Vec3Of<T> wo_;
  Vec3Of<T> side_normal_;  // geometric, on the side of wo
  FrameOf<T> frame_;       // around the shading normal, on the side of wo
  Vec3Of<T> wo_local_;
  BsdfType bsdf_;
};

// Of any material.
class PathVertex : public VertexOf<float, Bsdf> {
 public:
  PathVertex(const Scene& scene, const Ray& ray, const Hit& hit);

  bool is_delta() const { return bsdf_.is_delta(); }
  // For the choice of lights.
  LitPoint lit_point() const { return {position(), bsdf_.transmits() ? Vec3{} : frame_.normal}; }

  struct Scattered {
    Vec3 wi;
    Rgb weight;  // BSDF * cosine / pdf
    float pdf;
    bool delta;
    float eta;  // 1, or the relative index of refraction of the boundary that was crossed
  };
  // Nothing where the path ends.
  std::optional<Scattered> sample(Vec2 u, float u_lobe) const;

  // Every direction that a delta BSDF scatters to, each with its share of the light in the weight: what is
  // reflected, and what is refracted.
  std::array<std::optional<Scattered>, 2> delta_branches() const;

  // What is in between where it hits anything.
  Ray ray_toward(const LightSample& light) const;

 private:
  PathVertex(const Scene& scene, const Material& material, const Hit& hit, const SurfacePoint& surface,
             Vec3 wo);
  PathVertex(const Scene& scene, const Material& material, const Hit& hit, const SurfacePoint& surface,
             Vec3 wo, const ViewedSide<float>& side);

  Scattered delta_to_world(const BsdfSample& local) const;
};

// The outward normal that the surface is shaded with, interpolated and bent by the material's maps.
Vec3 outward_normal(const Scene& scene, const Material& material, const Hit& hit,
                    const SurfacePoint& surface);

}  // namespace tessera::core
