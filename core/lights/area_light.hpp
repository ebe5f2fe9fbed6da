// SPDX-License-Identifier: Apache-2.0
// Emissive shapes as light sources: a triangle of a mesh, a quad, a sphere, a disk or a cylinder.
// Immutable. Densities are per solid angle at the reference point.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "core/lights/light_bounds.hpp"
#include "core/lights/light_sample.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core::lights {

struct TriangleLight {
  Vec3 p0, p1, p2;
  // The corners' texture coordinates, apart because few lights need them; null where neither radiance nor
  // opacity has a texture.
  std::shared_ptr<const std::array<UvSets, 3>> uvs{};
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
  float deviation = 0;  // bound on its surface's distance from the exact one
  // The sphere's own axes in the world, which define its texture coordinates; unit length.
  Vec3 x_axis{1, 0, 0}, y_axis{0, 1, 0}, z_axis{0, 0, 1};
};
// As DiskDescription.
struct DiskLight {
  Vec3 center, radius_u, radius_v;
  float inner;
};
// As CylinderDescription.
struct CylinderLight {
  Vec3 start, axis, radius_u, radius_v;
  bool flipped;  // the front is inside
};
using LightShape = std::variant<TriangleLight, QuadLight, SphereLight, DiskLight, CylinderLight>;

struct SurfaceEmission {
  ColorParameter radiance;      // uniform over directions
  double mean_radiance;         // over the surface: radiance times opacity
  bool two_sided = true;        // else only the front emits
  ScalarParameter opacity = 1;  // the fraction of the radiance that is emitted
  bool stops_rays = true;       // else they go on behind it, and meet other points of the light

  bool is_opaque() const { return stops_rays && opacity.texture < 0 && opacity.value >= 1; }
};

class AreaLight {
 public:
  // `front` is the outward normal of a flat shape, as in SurfacePoint; unused by spheres and cylinders.
  AreaLight(LightShape shape, Vec3 front, const SurfaceEmission& emission);

  // Radiance emitted at a point of the light towards `wo`, given that a ray hits the surface. sample()
  // multiplies it by the probability of that, the opacity.
  Rgb emitted(const std::vector<Texture>& textures, Vec3 position, const UvSets& uv, Vec3 wo) const;

  std::optional<LightSample> sample(const std::vector<Texture>& textures, Vec3 p_lit, Vec2 u) const;
  // The same for a ray through p_lit in a direction within the hemisphere of `forward`, which meets the light
  // before or behind p_lit. `wi` is the ray's direction, and the radiance is what arrives against it.
  std::optional<LightSample> sample_along(const std::vector<Texture>& textures, Vec3 p_lit, Vec3 forward,
                                          Vec2 u) const;

  // An opaque quad.
  bool is_quad() const { return batch_ == Batch::kQuads; }
  // Samples such a light in each lane; each lane equals sample().
  static LightSamples sample_quads(const std::array<const AreaLight*, 8>& quads,
                                   const std::vector<Texture>& textures, Vec3Of<FloatN> p_lit,
                                   Vec2Of<FloatN> u);

  // An opaque sphere of uniform radiance.
  bool is_uniform_sphere() const { return batch_ == Batch::kEvenSpheres; }
  static LightSamples sample_uniform_spheres(const std::array<const AreaLight*, 8>& spheres,
                                             Vec3Of<FloatN> p_lit, Vec2Of<FloatN> u);

  // The density with which sample() generates the light's point p_light from p_lit.
  float pdf(Vec3 p_lit, Vec3 p_light) const;

  // Emitted power in watts, averaged over the channels, of all emitting sides.
  double power() const;
  LightBounds bounds() const;

 private:
  // The lights that it is sampled together with.
  enum class Batch : std::uint8_t { kNone, kQuads, kEvenSpheres };
  static Batch batch_of(const LightShape& shape, const SurfaceEmission& emission);

  // A point of the light and the density of its direction.
  struct Sample {
    SurfacePoint point;
    UvSets uv;
    Vec3 wi;
    float pdf;
  };
  Sample find(Vec3 p_lit, Vec2 u) const;
  Sample before(const Sample& behind, Vec3 p_lit) const;
  std::optional<LightSample> emitted_by(const std::vector<Texture>& textures, const Sample& found) const;
  Vec2 uv_of(const SphereLight& sphere, Vec3 outward) const;
  Sample flat(const SurfacePoint& point, Vec3 p_lit) const;
  Sample find(const TriangleLight& triangle, Vec3 p_lit, Vec2 u) const;
  Sample find(const QuadLight& quad, Vec3 p_lit, Vec2 u) const;
  Sample find(const SphereLight& sphere, Vec3 p_lit, Vec2 u) const;
  Sample find(const DiskLight& disk, Vec3 p_lit, Vec2 u) const;
  Sample find(const CylinderLight& cylinder, Vec3 p_lit, Vec2 u) const;
  // The direction of the front at a point, of any length.
  Vec3 front_at(Vec3 position) const;

  LightShape shape_;
  Vec3 front_;
  float area_;
  // Emission, and quantities derived from it.
  ColorParameter radiance_;
  double mean_radiance_;
  ScalarParameter opacity_;
  bool two_sided_, is_opaque_;
  Batch batch_;
};

}  // namespace tessera::core::lights
