// A vertex of a path: the surface that a ray met and how it scatters, in world space. Lives on the stack of
// the thread that traces the path.
#pragma once

#include <array>
#include <optional>

#include "core/geometry/primitives.hpp"
#include "core/lights/light_sample.hpp"
#include "core/materials/bsdf.hpp"
#include "core/math/frame.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core {

class PathVertex {
 public:
  PathVertex(const Scene& scene, const Ray& ray, const Hit& hit);

  Vec3 position() const { return surface_.position; }
  const SurfacePoint& surface() const { return surface_; }
  // The true one, on the side of wo.
  Vec3 side_normal() const { return side_normal_; }
  // Unit, towards where the ray came from.
  Vec3 wo() const { return wo_; }
  bool is_delta() const { return bsdf_.is_delta(); }
  // For the choice of lights.
  LitPoint lit_point() const { return {position(), bsdf_.transmits() ? Vec3{} : frame_.normal}; }

  // BSDF times cosine for light from `wi`, a unit direction away from the surface, on either side of it; and
  // the density per solid angle with which sample() chooses `wi`.
  BsdfValue evaluate(Vec3 wi) const;

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

  Ray ray_along(Vec3 wi) const;
  // The open segment between this point and another surface's, for shadow rays.
  Ray ray_to(const SurfacePoint& other) const;
  // What is in between where it hits anything.
  Ray ray_toward(const LightSample& light) const;

 private:
  PathVertex(const Scene& scene, const Material& material, const Hit& hit, const SurfacePoint& surface,
             Vec3 wo);

  Scattered delta_to_world(const BsdfSample& local) const;
  // What the BSDF is multiplied by where the shading normal is not the true one.
  float side_factor(Vec3 wi, Vec3 wi_local) const;

  SurfacePoint surface_;
  Vec3 wo_;
  Vec3 side_normal_;  // geometric, on the side of wo
  Frame frame_;       // around the shading normal, on the side of wo
  Vec3 wo_local_;
  Bsdf bsdf_;
};

}  // namespace tessera::core
