// All shapes of a scene as flat arrays. Triangles are numbered first, then spheres: those numbers are the
// primitive ids that hits carry. Immutable while rendering.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry/aabb.hpp"
#include "core/geometry/ray.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

// The surface at a hit, in world space.
struct SurfacePoint {
  Vec3 position;
  Vec3 position_error;    // absolute bounds on the rounding error of each coordinate of `position`
  Vec3 geometric_normal;  // unit, outward: of counter-clockwise triangles, and away from sphere centres;
                          // turned to the side of the interpolated normal where the mesh has normals
  Vec3 shading_normal;    // unit, interpolated; in the hemisphere of geometric_normal
  Vec2 uv;
};

class Primitives {
 public:
  struct Triangle {
    std::uint32_t v0, v1, v2;  // indices into the vertex arrays
  };
  struct Sphere {
    Vec3 center;
    float radius;
  };

  // Appends a mesh's vertices and triangles (same conventions as MeshDescription: normals and uvs are empty or
  // as many as positions; indices count from the mesh's own first vertex). All triangles come before all spheres.
  void add_mesh(const std::vector<Vec3>& positions, const std::vector<Vec3>& normals, const std::vector<Vec2>& uvs,
                const std::vector<std::array<std::uint32_t, 3>>& triangles,
                const std::vector<std::uint32_t>& triangle_materials);
  void add_sphere(Vec3 center, float radius, std::uint32_t material);

  std::uint32_t triangle_count() const;
  std::uint32_t sphere_count() const;
  std::uint32_t count() const { return triangle_count() + sphere_count(); }
  bool is_sphere(std::uint32_t primitive) const { return primitive >= triangle_count(); }

  std::uint32_t material(std::uint32_t primitive) const;
  std::array<Vec3, 3> triangle_corners(std::uint32_t primitive) const;
  const Sphere& sphere(std::uint32_t primitive) const;
  Aabb bounds(std::uint32_t primitive) const;

  // Makes `hit` this primitive's intersection if it is nearer (or as near, with a lower id). Returns whether it did.
  bool intersect(std::uint32_t primitive, const Ray& ray, Hit& hit) const;

  SurfacePoint surface(const Ray& ray, const Hit& hit) const;
};

// Moves a ray's origin off its surface, to the side `direction` leaves from, far enough that rounding cannot
// put it on the wrong side and no farther (Pharr et al. 2023, section 6.8.6).
Vec3 offset_origin(const SurfacePoint& surface, Vec3 direction);

}  // namespace tessera::core
