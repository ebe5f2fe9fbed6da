// Emissive shapes as sources that can be sampled: a triangle of a mesh, a quad, or a sphere. Immutable.
// Densities are per solid angle at the point that is lit.
#pragma once

#include <array>
#include <optional>
#include <variant>
#include <vector>

#include "core/lights/light_bounds.hpp"
#include "core/lights/light_sample.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

struct TriangleLight {
  Vec3 p0, p1, p2;
  Vec2 uv0, uv1, uv2;
};
// Texture coordinates run along the edges.
template <typename T>
struct QuadLightOf {
  Vec3Of<T> corner, edge_u, edge_v;
};
using QuadLight = QuadLightOf<float>;
struct SphereLight {
  Vec3 center;
  float radius;
  float deviation = 0;  // its surface may lie so far from the true one
  // Its own axes in the world, which its texture coordinates go by; all of unit length.
  Vec3 x_axis{1, 0, 0}, y_axis{0, 1, 0}, z_axis{0, 0, 1};
};
using LightShape = std::variant<TriangleLight, QuadLight, SphereLight>;

struct SurfaceEmission {
  ColorParameter radiance;  // uniform over directions
  double mean_radiance;     // of the radiance over the surface
  bool two_sided = true;    // else only from the front
};

class AreaLight {
 public:
  // `front` is the outward normal of a triangle or quad, as SurfacePoint has it; unused by spheres.
  AreaLight(LightShape shape, Vec3 front, const SurfaceEmission& emission);

  // Emitted radiance at a point of the light (its position and uv count), towards `wo`.
  Rgb emitted(const std::vector<Texture>& textures, const SurfacePoint& point, Vec3 wo) const;

  std::optional<LightSample> sample(const std::vector<Texture>& textures, Vec3 p_lit, Vec2 u) const;

  bool is_quad() const { return std::holds_alternative<QuadLight>(shape_); }
  // Eight quads, each lane as sample() does.
  static LightSamples sample_quads(const std::array<const AreaLight*, 8>& quads,
                                   const std::vector<Texture>& textures, Vec3Of<Float8> p_lit,
                                   Vec2Of<Float8> u);

  // A sphere that shines alike all over.
  bool is_even_sphere() const {
    return std::holds_alternative<SphereLight>(shape_) && emission_.radiance.texture < 0;
  }
  static LightSamples sample_even_spheres(const std::array<const AreaLight*, 8>& spheres,
                                          Vec3Of<Float8> p_lit, Vec2Of<Float8> u);

  // The density with which sample() finds p_light, a point of the light, from p_lit.
  float pdf(Vec3 p_lit, Vec3 p_light) const;

  // Watts, the mean of the channels, over all sides that emit.
  double power() const;
  LightBounds bounds() const;

 private:
  // A point of the light with the density of its direction.
  struct Found {
    SurfacePoint point;
    Vec3 wi;
    float pdf;
  };
  Found flat(const SurfacePoint& point, Vec3 p_lit) const;
  Found find(const TriangleLight& triangle, Vec3 p_lit, Vec2 u) const;
  Found find(const QuadLight& quad, Vec3 p_lit, Vec2 u) const;
  Found find(const SphereLight& sphere, Vec3 p_lit, Vec2 u) const;

  LightShape shape_;
  Vec3 front_;
  float area_;
  SurfaceEmission emission_;
};

}  // namespace tessera::core
