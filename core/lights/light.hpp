// Emissive shapes as sources that can be sampled. A light is one emissive shape: a triangle of a mesh, a
// quad, or a sphere. Immutable, shared by all threads.
//
// How to add a kind: a struct here, its cases in light.cpp (sample, pdf, power), and Scene::build, which
// finds the lights. Densities are per solid angle at the point that is lit.
#pragma once

#include <optional>
#include <variant>

#include "core/geometry/primitives.hpp"
#include "core/math/rgb.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

struct TriangleLight {
  Vec3 p0, p1, p2;
};
struct QuadLight {
  Vec3 corner, edge_u, edge_v;
};
struct SphereLight {
  Vec3 center;
  float radius;
};
using LightShape = std::variant<TriangleLight, QuadLight, SphereLight>;

struct LightSample {
  SurfacePoint point;  // on the light; shading normal and uv are not set
  Vec3 wi;             // unit, from the lit point to it
  float pdf = 0;
  Rgb radiance;  // that leaves it towards the lit point
};

class Light {
 public:
  // `front` is the outward normal of a triangle or quad, as SurfacePoint has it; unused by spheres.
  Light(LightShape shape, Vec3 front, Rgb radiance, bool two_sided);

  // Emitted radiance at a point of the light, towards `wo`.
  Rgb emitted(Vec3 p_light, Vec3 wo) const;

  // A direction from `p_lit` to the light. Nothing where the light cannot be sampled from there, or sends
  // nothing along the direction found.
  std::optional<LightSample> sample(Vec3 p_lit, Vec2 u) const;

  // The density with which sample() finds p_light, a point of the light, from p_lit.
  float pdf(Vec3 p_lit, Vec3 p_light) const;

  // Luminous power in watts weighed by luminance, over all sides that emit.
  double power() const;

 private:
  std::optional<LightSample> sample_flat(const SurfacePoint& point, float area, Vec3 p_lit) const;
  std::optional<LightSample> sample(const TriangleLight& shape, Vec3 p_lit, Vec2 u) const;
  std::optional<LightSample> sample(const QuadLight& shape, Vec3 p_lit, Vec2 u) const;
  std::optional<LightSample> sample(const SphereLight& shape, Vec3 p_lit, Vec2 u) const;

  LightShape shape_;
  Vec3 front_;
  float area_;
  Rgb radiance_;
  bool two_sided_;
};

}  // namespace tessera::core
