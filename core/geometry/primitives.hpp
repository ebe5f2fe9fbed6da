// SPDX-License-Identifier: Apache-2.0
// All shapes of a scene as flat arrays, and the instanced objects, which are such arrays themselves. Ids
// number triangles first, then spheres, disks, cylinders, parts of curves, and at last instances. Hits carry
// the ids of shapes; inside an instance, the ids are the object's own, and the hit also carries the
// instance's index. Immutable while rendering.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/prefetch.hpp"
#include "core/geometry/aabb.hpp"
#include "core/geometry/curves.hpp"
#include "core/geometry/cylinder.hpp"
#include "core/geometry/disk.hpp"
#include "core/geometry/geometry_kind.hpp"
#include "core/geometry/instance.hpp"
#include "core/geometry/moving_placement.hpp"
#include "core/geometry/object_point.hpp"
#include "core/geometry/object_ray.hpp"
#include "core/geometry/ray.hpp"
#include "core/geometry/sphere.hpp"
#include "core/geometry/surface.hpp"
#include "core/geometry/triangle.hpp"
#include "core/geometry/vertex_motion.hpp"
#include "core/math/columns.hpp"
#include "core/math/lane_array.hpp"
#include "core/math/rgb.hpp"
#include "core/math/simd_double.hpp"
#include "core/math/uv_sets.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

// The largest magnitude of a coordinate or radius that Scene::build accepts, so that areas and squared
// distances stay finite in float. Intersection itself is safe for any finite float.
inline constexpr float kMaxCoordinate = 1e15f;

// A ray and a hit in each lane.
using RayRows = RowLanes<Ray>;
using HitRows = RowLanes<Hit>;

class Primitives {
 public:
  using Triangle = std::array<std::uint32_t, 3>;  // indices into the vertex arrays
  using Sphere = core::Sphere;

  // Reserves room for this many more elements.
  void reserve(std::size_t vertices, std::size_t triangles);
  // Appends a mesh's vertices and triangles (same conventions as MeshDescription: normals and uvs are empty
  // or as many as positions, and so are tangents and, if there are uvs, second_uvs; indices count from the
  // mesh's own first vertex). All triangles must be added before all spheres, these before all disks, these
  // before all cylinders, and these before all curves. The arrays of the first mesh are moved if they are
  // passed as rvalues.
  void add_mesh(std::vector<Vec3> positions, const std::vector<Vec3>& normals, const std::vector<Vec2>& uvs,
                std::vector<Triangle> triangles, const std::vector<std::uint32_t>& triangle_materials,
                const std::vector<Rgb>& colors = {}, const std::vector<Vec2>& second_uvs = {},
                const std::vector<VertexTangent>& tangents = {});
  // Lets the mesh that was added last deform. `steps` must be sound for it. All meshes that deform must be
  // added after all others. They are at rest until deform() is called.
  void deform_last_mesh(const std::vector<MeshStep>& steps, std::uint32_t first_triangle);
  void add_sphere(Vec3 center, float radius, std::uint32_t material);
  void add_disk(const Disk& disk, std::uint32_t material);
  void add_cylinder(const Cylinder& cylinder, std::uint32_t material);
  // `strands` must be sound (Curves::is_sound).
  void add_curves(const CurveStrands& strands, std::uint32_t material) { curves_.add(strands, material); }

  // Adds an object, which must not contain instances, and returns the index that instances refer to.
  std::uint32_t add_object(Primitives object);
  // Instances must be added last.
  void add_instance(const Instance& instance);
  // Places an instance anew.
  void place_instance(std::uint32_t number, const Placement& placement);
  // Lets an instance move while the shutter is open.
  void move_instance(std::uint32_t number, MovingPlacement motion);
  // Of an instance; null if it does not move.
  std::shared_ptr<const MovingPlacement> motion_of(const Instance& instance) const {
    return instance.motion == kStill ? nullptr : motions_[instance.motion];
  }
  // Lets no instance move any more.
  void stop_instances();
  // Shows meshes that deform, also those of objects, as they are while the shutter is open; if it takes no
  // time, at a frame. Bounds instances anew that do not move.
  void deform(float frame, FrameInterval shutter);
  // Whether there are meshes that deform, also those of objects.
  bool can_deform() const;
  // Whether hits depend on the times of rays.
  bool has_motion() const { return !motions_.empty() || is_deforming_; }

  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(triangles_.size()); }
  std::uint32_t sphere_count() const { return static_cast<std::uint32_t>(spheres_.size()); }
  std::uint32_t instance_count() const { return static_cast<std::uint32_t>(instances_.size()); }
  // All primitives but instances.
  std::uint32_t shape_count() const { return first_curve() + curves_.part_count(); }
  std::uint32_t count() const { return shape_count() + instance_count(); }
  GeometryKind kind(std::uint32_t primitive) const {
    if (is_triangle(primitive))
      return is_moving_triangle(primitive) ? GeometryKind::kMovingTriangle : GeometryKind::kTriangle;
    if (is_instance(primitive)) return GeometryKind::kInstance;
    if (is_curve(primitive)) return GeometryKind::kCurve;
    if (is_sphere(primitive)) return GeometryKind::kSphere;
    return is_disk(primitive) ? GeometryKind::kDisk : GeometryKind::kCylinder;
  }
  bool is_triangle(std::uint32_t primitive) const { return primitive < triangle_count(); }
  // Whether it is a triangle that deforms while the shutter is open.
  bool is_moving_triangle(std::uint32_t primitive) const {
    return primitive - first_moving_ < moving_triangles_;
  }
  bool is_sphere(std::uint32_t primitive) const { return primitive - triangle_count() < sphere_count(); }
  bool is_disk(std::uint32_t primitive) const { return primitive - first_disk() < disks_.size(); }
  bool is_cylinder(std::uint32_t primitive) const { return primitive - first_cylinder() < cylinders_.size(); }
  // Whether it is a part of a curve.
  bool is_curve(std::uint32_t primitive) const { return primitive - first_curve() < curves_.part_count(); }
  // Whether the hit is a triangle outside all instances, which does not move.
  bool is_plain_triangle(const Hit& hit) const { return is_plain(hit) && is_triangle(hit.primitive); }
  // The same of a hit that is a triangle.
  bool is_plain(const Hit& hit) const { return !hit.in_instance() && !is_moving_triangle(hit.primitive); }
  bool is_instance(std::uint32_t primitive) const { return primitive >= shape_count(); }

  const std::vector<Primitives>& objects() const { return objects_; }
  const Instance& instance(std::uint32_t number) const { return instances_[number]; }
  // The index of an instance from its primitive id.
  std::uint32_t instance_number(std::uint32_t primitive) const { return primitive - shape_count(); }
  const Primitives& object_of(const Instance& instance) const { return objects_[instance.object]; }
  // The ray in the space of the instance's object, at the time of the ray.
  ObjectRay to_object(const Instance& instance, const Ray& ray) const {
    return instance.motion == kStill ? instance.placement.to_object(ray)
                                     : motions_[instance.motion]->at(ray.time).to_object(ray);
  }
  // Calls what(placement) with the placement of the hit's instance at the time of the hit.
  template <typename What>
  auto with_placement(const Hit& hit, const What& what) const {
    const Instance& shown = instances_[hit.instance];
    return shown.motion == kStill ? what(shown.placement) : what(motions_[shown.motion]->at(hit.time));
  }

  std::uint32_t material(std::uint32_t primitive) const {
    if (is_triangle(primitive)) return triangle_materials_[primitive];
    return is_curve(primitive) ? curves_.material(primitive - first_curve())
                               : analytic_materials_[primitive - triangle_count()];
  }
  std::uint32_t material(const Hit& hit) const {
    if (!hit.in_instance()) return material(hit.primitive);
    const Instance& shown = instances_[hit.instance];
    return shown.material == kOwnMaterials ? object_of(shown).material(hit.primitive) : shown.material;
  }
  // Whose ids a hit's `primitive` is: the object of its instance, or these primitives.
  const Primitives& owner(const Hit& hit) const {
    return hit.in_instance() ? object_of(instances_[hit.instance]) : *this;
  }
  // Prefetches what material() and prefetch_surface() read for a triangle or curve of these.
  void prefetch_shape(std::uint32_t primitive) const {
    if (is_triangle(primitive)) {
      prefetch(triangle_materials_[primitive]);
      prefetch(triangles_[primitive]);
    } else if (is_curve(primitive)) {
      curves_.prefetch_part(primitive - first_curve());
    }
  }
  // Prefetches the first data that surfaces() reads for a triangle or curve.
  void prefetch_surface(std::uint32_t primitive) const {
    if (is_triangle(primitive)) {
      prefetch_corners(primitive);
    } else if (is_curve(primitive)) {
      prefetch_curve(curve_source(primitive));
    }
  }
  void prefetch_corners(std::uint32_t primitive) const {
    for (const std::uint32_t vertex : triangles_[primitive]) {
      prefetch(positions_[vertex]);
      if (!normals_.empty()) prefetch(normals_[vertex]);
      if (!uvs_.empty()) prefetch(uvs_[vertex]);
    }
  }
  // Of a triangle that moves: in the middle of the time while the shutter is open.
  TriangleCorners triangle_corners(std::uint32_t primitive) const {
    const auto& [v0, v1, v2] = triangles_[primitive];
    return {positions_[v0], positions_[v1], positions_[v2]};
  }
  // At a time from 0, when the shutter opens, to 1, when it closes.
  TriangleCorners triangle_corners(std::uint32_t primitive, float time) const {
    return is_moving_triangle(primitive) ? moving_triangle(primitive, time).corners
                                         : triangle_corners(primitive);
  }
  std::array<Vec2, 3> triangle_uvs(std::uint32_t primitive, UvSet set = UvSet::kFirst) const {
    const std::vector<Vec2>& uvs = set == UvSet::kSecond && !second_uvs_.empty() ? second_uvs_ : uvs_;
    if (uvs.empty()) return {};
    const auto& [v0, v1, v2] = triangles_[primitive];
    return {uvs[v0], uvs[v1], uvs[v2]};
  }
  const Sphere& sphere(std::uint32_t primitive) const { return spheres_[primitive - triangle_count()]; }
  const Disk& disk(std::uint32_t primitive) const { return disks_[primitive - first_disk()]; }
  const Cylinder& cylinder(std::uint32_t primitive) const { return cylinders_[primitive - first_cylinder()]; }
  CurvePart curve(std::uint32_t primitive) const { return curves_.part(primitive - first_curve()); }
  // For curve_line_hit(), and to prefetch what it reads.
  Curves::Source curve_source(std::uint32_t primitive) const {
    return curves_.source(primitive - first_curve());
  }
  void prefetch_curve(Curves::Source source) const { curves_.prefetch_points(source); }

  // The radius of a sphere that encloses every point that a ray can hit; 0 if there is none.
  double bounding_radius() const;

  // Bounds of every point that a ray can hit; empty if there is none, as for triangles without area.
  Aabb bounds(std::uint32_t primitive) const;

  // The area of a shape, which is no instance; 0 for parts of curves, which are never sampled.
  double area(std::uint32_t primitive) const;

  // Replaces `hit` by this primitive's intersection if that is nearer (or equally near with a lower id) and
  // t < ray.t_max. Returns whether it did.
  bool intersect(std::uint32_t primitive, const Ray& ray, Hit& hit) const;
  bool intersect(std::uint32_t primitive, const ObjectRay& ray, Hit& hit) const;
  // The hit of the line in front of the origin, wherever the ray ends, by the kind of a primitive that is no
  // instance.
  std::optional<Hit> line_hit(GeometryKind kind, std::uint32_t primitive, const Ray& ray) const;
  std::optional<Hit> line_hit(GeometryKind kind, std::uint32_t primitive, const ObjectRay& ray) const;
  // The same for a part of a curve, whose source is given.
  template <typename AnyRay>
  std::optional<Hit> curve_line_hit(std::uint32_t primitive, Curves::Source source, const AnyRay& ray) const {
    const auto found = intersect_curve(curves_.part(primitive - first_curve(), source), ObjectRay(ray));
    if (!found) return std::nullopt;
    return Hit{static_cast<float>(found->t), primitive, static_cast<float>(found->u),
               static_cast<float>(found->across)};
  }

  // The surface where `ray` met it; `hit` is the result of intersect() for this ray. Meshes without uvs
  // have uv (0, 0).
  SurfacePoint surface(const Ray& ray, const Hit& hit) const;
  // The surface in each lane, bit-identical to surface() of that lane's ray and hit. Primitives of any kinds,
  // inside and outside instances, may be mixed (surface_lanes.cpp says how to add a kind).
  SurfacePointOf<FloatN> surfaces(const RayRows& rays, const HitRows& hits) const;
  // The same where is_plain_triangle() holds in all lanes.
  SurfacePointOf<FloatN> triangle_surfaces(const HitRows& hits) const;
  // The tangents of the mesh at `point`, the result of surface() for the same hit, interpolated; nullopt if
  // it has none.
  std::optional<Tangents> vertex_tangents(const Hit& hit, const SurfacePoint& point) const;
  // The same or, without them, those of a set of texture coordinates.
  Tangents tangents(const Hit& hit, const SurfacePoint& point, UvSet set = UvSet::kFirst) const;
  UvDerivatives uv_derivatives(const Hit& hit, const SurfacePoint& point, UvSet set = UvSet::kFirst) const;

  // Whether any mesh has a second set of texture coordinates, including objects' meshes.
  bool has_second_uvs() const { return has_second_uvs_; }
  // The texture coordinates at a hit whose surface has `uv`.
  UvSets uv_sets(const Hit& hit, Vec2 uv) const {
    return has_second_uvs_ ? UvSets(uv, second_uv_at(hit, uv)) : UvSets(uv);
  }
  // The same for the hit in each lane.
  UvSetsOf<FloatN> uv_sets(const HitRows& hits, Vec2Of<FloatN> uv) const {
    return has_second_uvs_ ? UvSetsOf<FloatN>(uv, second_uvs_at(hits, uv)) : UvSetsOf<FloatN>(uv);
  }

  // The texture coordinates at a hit that is a triangle: those of its surface(), bit for bit.
  UvSets triangle_uv_sets(const Hit& hit) const {
    return uv_sets(hit, interpolated(owner(hit).triangle_uvs(hit.primitive), corner_weights(hit.b1, hit.b2)));
  }

  // Whether any mesh has vertex colours, including objects' meshes.
  bool has_vertex_colors() const { return has_vertex_colors_; }
  // The vertex colour interpolated at a hit; white if the mesh has none.
  Rgb vertex_color(const Hit& hit) const { return has_vertex_colors_ ? color_at(hit) : Rgb::gray(1); }
  // The same for the hit in each lane.
  RgbOf<FloatN> vertex_colors(const HitRows& hits) const;

 private:
  using ObjectPoint = ObjectPointOf<float>;
  // dp/du and dp/dv times `scale`, which is positive if they exist and otherwise 0.
  struct ModelTangents {
    Vec3d along_u, along_v;
    double scale = 0;
  };
  // The vertices of a mesh that deforms.
  struct DeformingMesh {
    std::uint32_t first_triangle, first_vertex;
    std::shared_ptr<const VertexMotion> motion;
  };
  struct MovingTriangle {
    TriangleCorners corners;
    std::array<Vec3, 3> normals;  // zero for flat shading
  };
  // Boxes of an object's parts, which bound its instances more tightly than its transformed bounding box.
  using Outline = std::vector<Aabb>;

  template <GeometryKind kKind>
  struct Traits;
  template <auto kShape>
  struct AnalyticTraits;
  template <typename What>
  static decltype(auto) with_traits(GeometryKind kind, const What& what);
  bool intersect_instance(std::uint32_t number, const Ray& ray, Hit& hit) const;
  ObjectPoint triangle_point(const Hit& hit) const;
  const DeformingMesh& mesh_of(std::uint32_t moving_triangle) const;
  MovingTriangle moving_triangle(std::uint32_t primitive, float time) const;
  // Of a moving triangle; zero if it has none.
  std::array<Vec3, 3> moving_tangents(std::uint32_t primitive, float time) const;
  Aabb moving_triangle_bounds(std::uint32_t primitive) const;
  // Of any shape.
  template <typename AnyRay>
  ObjectPoint shape_point(const AnyRay& ray, const Hit& hit) const;
  std::uint32_t first_disk() const { return triangle_count() + sphere_count(); }
  std::uint32_t first_cylinder() const { return first_disk() + static_cast<std::uint32_t>(disks_.size()); }
  std::uint32_t first_curve() const {
    return triangle_count() + static_cast<std::uint32_t>(analytic_materials_.size());
  }
  SurfacePoint instance_surface(const Ray& ray, const Hit& hit) const;
  // Kinds of primitives whose surface points are computed in lanes; the last is all others.
  enum SurfaceKind {
    kPlainTriangle,
    kInstancedTriangle,
    kMovingTriangle,
    kInstancedMovingTriangle,
    kPlainSphere,
    kInstancedSphere,
    kOtherSurface
  };
  static constexpr std::size_t kSurfaceKinds = 7;
  SurfaceKind surface_kind(const Hit& hit) const;
  SurfacePointOf<FloatN> surfaces_of(SurfaceKind kind, unsigned lanes, const RayRows& rays,
                                     const HitRows& hits) const;
  AffineMapOf<DoubleN> placements_of(const HitRows& hits) const;
  SurfacePointOf<FloatN> instanced_triangle_surfaces(const HitRows& hits) const;
  ObjectPointOf<FloatN> moving_triangle_points(const HitRows& hits) const;
  SurfacePointOf<FloatN> sphere_surfaces(const RayRows& rays, const HitRows& hits) const;
  SurfacePointOf<FloatN> instanced_sphere_surfaces(const RayRows& rays, const HitRows& hits) const;
  SurfacePointOf<FloatN> surfaces_one_by_one(unsigned lanes, const RayRows& rays, const HitRows& hits) const;
  // Interpolated on a triangle; the direction is zero if there is none.
  VertexTangent vertex_tangent(const Hit& hit) const;
  Tangents uv_tangents(const Hit& hit, const SurfacePoint& point, UvSet set) const;
  ModelTangents triangle_tangents(const Hit& hit, UvSet set) const;
  Tangents instance_tangents(const Hit& hit, const SurfacePoint& point, UvSet set) const;
  // The tangents of the shape that was hit, at its object-space normal and texture coordinates.
  ModelTangents model_tangents(const Hit& hit, Vec3 normal, Vec2 uv, UvSet set) const;
  Rgb color_at(const Hit& hit) const;
  void append_second_uvs(const std::vector<Vec2>& second_uvs, std::size_t first_vertex);
  void append_tangents(const std::vector<VertexTangent>& tangents, std::size_t first_vertex);
  // `uv` where the surface has no second set.
  Vec2 second_uv_at(const Hit& hit, Vec2 uv) const;
  Vec2Of<FloatN> second_uvs_at(const HitRows& hits, Vec2Of<FloatN> uv) const;
  Outline outline() const;
  Aabb instance_box(const Instance& instance) const;

  std::vector<Vec3> positions_;
  // Unit length, but for meshes that deform between two steps; zero if missing; empty if no mesh has any.
  std::vector<Vec3> normals_;
  std::vector<Vec2> uvs_;    // empty if no mesh has any
  std::vector<Rgb> colors_;  // empty if no mesh has any
  bool has_vertex_colors_ = false;
  // Empty if no mesh has any; those of meshes without them are the first.
  std::vector<Vec2> second_uvs_;
  bool has_second_uvs_ = false;
  // Of unit length or zero; those of the last vertices may be missing, and are then zero.
  std::vector<VertexTangent> tangents_;
  bool has_vertex_tangents_ = false;  // some of these or of objects
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> triangle_materials_;
  std::vector<DeformingMesh> deforming_;  // of the last triangles
  FrameInterval shutter_;                 // of these and of objects
  std::uint32_t first_moving_ = 0, moving_triangles_ = 0;
  bool is_deforming_ = false;  // some of these or of objects are moving triangles
  std::vector<Sphere> spheres_;
  std::vector<Disk> disks_;
  std::vector<Cylinder> cylinders_;
  std::vector<std::uint32_t> analytic_materials_;  // of spheres, disks and cylinders, by their ids
  Curves curves_;
  std::vector<Instance> instances_;
  std::vector<std::shared_ptr<const MovingPlacement>> motions_;
  std::vector<Aabb> instance_bounds_;
  std::vector<Primitives> objects_;
  std::vector<Outline> outlines_;  // of the objects
};

}  // namespace tessera::core
