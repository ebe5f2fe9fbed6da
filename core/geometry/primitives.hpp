// All shapes of a scene as flat arrays. Triangles are numbered first, then spheres: those numbers are the
// primitive ids that hits carry. Immutable while rendering.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry/aabb.hpp"
#include "core/geometry/ray.hpp"
#include "core/geometry/sphere.hpp"
#include "core/geometry/surface.hpp"
#include "core/geometry/triangle.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

// The largest magnitude of a coordinate, and of a sphere's radius, that Scene::build admits: areas and
// squared distances, which are floats, stay finite. Intersection itself is safe with any finite float.
inline constexpr float kMaxCoordinate = 1e15f;

class Primitives {
 public:
  using Triangle = std::array<std::uint32_t, 3>;  // indices into the vertex arrays
  using Sphere = core::Sphere;

  // Makes room for so much more, so that adding it takes no memory but its own.
  void reserve(std::size_t vertices, std::size_t triangles);
  // Appends a mesh's vertices and triangles (same conventions as MeshDescription: normals and uvs are empty
  // or as many as positions; indices count from the mesh's own first vertex). All triangles come before all
  // spheres. The first mesh's arrays are taken over as they are, where they are given away.
  void add_mesh(std::vector<Vec3> positions, const std::vector<Vec3>& normals, const std::vector<Vec2>& uvs,
                std::vector<Triangle> triangles, const std::vector<std::uint32_t>& triangle_materials);
  void add_sphere(Vec3 center, float radius, std::uint32_t material);

  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(triangles_.size()); }
  std::uint32_t sphere_count() const { return static_cast<std::uint32_t>(spheres_.size()); }
  std::uint32_t count() const { return triangle_count() + sphere_count(); }
  bool is_sphere(std::uint32_t primitive) const { return primitive >= triangle_count(); }

  std::uint32_t material(std::uint32_t primitive) const {
    return is_sphere(primitive) ? sphere_materials_[primitive - triangle_count()]
                                : triangle_materials_[primitive];
  }
  TriangleCorners triangle_corners(std::uint32_t primitive) const {
    const auto& [v0, v1, v2] = triangles_[primitive];
    return {positions_[v0], positions_[v1], positions_[v2]};
  }
  std::array<Vec2, 3> triangle_uvs(std::uint32_t primitive) const {
    if (uvs_.empty()) return {};
    const auto& [v0, v1, v2] = triangles_[primitive];
    return {uvs_[v0], uvs_[v1], uvs_[v2]};
  }
  const Sphere& sphere(std::uint32_t primitive) const { return spheres_[primitive - triangle_count()]; }

  // The radius of a sphere around every point that a ray can hit; 0 where there is none.
  double bounding_radius() const;

  // Contains every point that a ray can hit; empty where none can be, as with triangles without area.
  Aabb bounds(std::uint32_t primitive) const;

  // Makes `hit` this primitive's intersection if it is nearer (or as near, with a lower id) and t <
  // ray.t_max. Returns whether it did.
  bool intersect(std::uint32_t primitive, const Ray& ray, Hit& hit) const;

  // The surface where `ray` met it; `hit` is what intersect() made of this ray. Meshes without uvs have uv
  // (0, 0).
  SurfacePoint surface(const Ray& ray, const Hit& hit) const;
  // Where surface() made `point` of the same hit.
  Tangents tangents(const Hit& hit, const SurfacePoint& point) const;

 private:
  SurfacePoint triangle_surface(const Hit& hit) const;
  SurfacePoint sphere_surface(const Ray& ray, const Hit& hit) const;
  Tangents triangle_tangents(const Triangle& triangle) const;

  std::vector<Vec3> positions_;
  std::vector<Vec3> normals_;  // of unit length; zero where there is none; empty where no mesh has any
  std::vector<Vec2> uvs_;      // empty where no mesh has any
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> triangle_materials_;
  std::vector<Sphere> spheres_;
  std::vector<std::uint32_t> sphere_materials_;
};

}  // namespace tessera::core
