// SPDX-License-Identifier: Apache-2.0
#include "core/scene/validate_shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/overloaded.hpp"
#include "core/geometry/placement.hpp"
#include "core/geometry/primitives.hpp"
#include "core/scene/analytic_shapes.hpp"
#include "core/scene/validate_materials.hpp"
#include "core/scene/validation.hpp"

namespace tessera::core {
namespace {

tl::unexpected<Error> invalid_shape(std::string message) {
  return fail(ErrorCode::kInvalidArgument, std::move(message));
}

bool is_share(Rgb c) {
  return is_valid_radiance(c) && max_component(c) <= 1;
}

// The coordinates are checked before those of the mesh at rest, which lie between.
Status check_steps(const MeshDescription& mesh) {
  if (!are_sound(mesh.steps, mesh.positions.size(),
                 {.normals = !mesh.normals.empty(), .tangents = !mesh.tangents.empty()}))
    return invalid_shape(
        "a mesh that deforms needs two steps or more, in the order of their frames, of equally many "
        "vertices");
  for (const MeshStep& step : mesh.steps)
    for (std::size_t i = 0; i < step.positions.size(); ++i)
      if (!is_valid_point(step.positions[i]))
        return invalid_shape(fmt::format("frame {}, vertex {}: coordinates must be numbers of at most {:g}",
                                         step.frame, i + 1, kMaxCoordinate));
  return {};
}

Status check_mesh(const MeshDescription& mesh, std::size_t material_count) {
  if (!mesh.steps.empty())
    if (auto ok = check_steps(mesh); !ok) return ok;
  const std::size_t vertices = mesh.positions.size(), triangles = mesh.triangles.size();
  for (std::size_t i = 0; i < vertices; ++i)
    if (!is_valid_point(mesh.positions[i]))
      return invalid_shape(
          fmt::format("vertex {}: coordinates must be numbers of at most {:g}", i + 1, kMaxCoordinate));
  if (!mesh.normals.empty() && mesh.normals.size() != vertices)
    return invalid_shape(fmt::format("{} normals for {} vertices", mesh.normals.size(), vertices));
  if (!mesh.uvs.empty() && mesh.uvs.size() != vertices)
    return invalid_shape(fmt::format("{} texture coordinates for {} vertices", mesh.uvs.size(), vertices));
  if (!mesh.second_uvs.empty() && mesh.second_uvs.size() != mesh.uvs.size())
    return invalid_shape(fmt::format("{} second texture coordinates for {} first ones",
                                     mesh.second_uvs.size(), mesh.uvs.size()));
  if (!mesh.tangents.empty() && mesh.tangents.size() != vertices)
    return invalid_shape(fmt::format("{} tangents for {} vertices", mesh.tangents.size(), vertices));
  if (!mesh.colors.empty() && mesh.colors.size() != vertices)
    return invalid_shape(fmt::format("{} colours for {} vertices", mesh.colors.size(), vertices));
  for (std::size_t i = 0; i < mesh.colors.size(); ++i)
    if (!is_share(mesh.colors[i]))
      return invalid_shape(fmt::format("vertex {}: colours must be numbers between 0 and 1", i + 1));
  for (std::size_t i = 0; i < triangles; ++i)
    for (const std::uint32_t v : mesh.triangles[i])
      if (v >= vertices)
        return invalid_shape(fmt::format("triangle {}: there is no vertex {}", i + 1, v + 1));
  if (mesh.triangle_materials.size() != 1 && mesh.triangle_materials.size() != triangles)
    return invalid_shape(
        fmt::format("{} materials for {} triangles", mesh.triangle_materials.size(), triangles));
  for (const std::uint32_t m : mesh.triangle_materials)
    if (m >= material_count) return invalid_shape(fmt::format("there is no material {}", m));
  return {};
}

Aabb bounds_of(const ShapeDescription& shape) {
  Aabb box;
  if (const auto* mesh = std::get_if<MeshDescription>(&shape)) {
    for (const Vec3 p : mesh->positions) box.include(p);
    for (const MeshStep& step : mesh->steps)
      for (const Vec3 p : step.positions) box.include(p);
  } else if (const auto* sphere = std::get_if<SphereDescription>(&shape)) {
    const Vec3 reach{sphere->radius, sphere->radius, sphere->radius};
    box.include(sphere->center - reach);
    box.include(sphere->center + reach);
  } else if (const auto* quad = std::get_if<QuadDescription>(&shape)) {
    for (const Vec3 p : {quad->corner, quad->corner + quad->edge_u})
      for (const Vec3 q : {p, p + quad->edge_v}) box.include(q);
  } else if (const auto* disk = std::get_if<DiskDescription>(&shape)) {
    box = geometry_of(*disk).bounds();
  } else if (const auto* cylinder = std::get_if<CylinderDescription>(&shape)) {
    box = geometry_of(*cylinder).bounds();
  } else if (const auto* curves = std::get_if<CurvesDescription>(&shape)) {
    box = bounds_of(curves->strands);
  }
  return box;
}

// The properties of an object that its instances depend on.
struct ObjectFacts {
  Aabb bounds;
  std::vector<std::uint32_t> sphere_materials;
  bool has_curves = false, deforms = false;
};

ObjectFacts facts_of(const ObjectDescription& object) {
  ObjectFacts facts;
  for (const ShapeDescription& shape : object.shapes) {
    facts.bounds.include(bounds_of(shape));
    if (const auto* sphere = std::get_if<SphereDescription>(&shape))
      facts.sphere_materials.push_back(sphere->material);
    facts.has_curves |= std::holds_alternative<CurvesDescription>(shape);
    facts.deforms |= deforms(shape);
  }
  return facts;
}

bool has_emissive_sphere(const ObjectFacts& object, const InstanceDescription& instance,
                         const SceneDescription& scene) {
  return std::any_of(object.sphere_materials.begin(), object.sphere_materials.end(),
                     [&](std::uint32_t m) { return can_emit(instance.material.value_or(m), scene); });
}

PlacementLimits limits_of(const ObjectFacts& object, const InstanceDescription& instance,
                          const SceneDescription& scene) {
  return {object.bounds, has_emissive_sphere(object, instance, scene)};
}

Status check_transform(const Transform& to_world) {
  if (Placement::can_place(to_world)) return {};
  return invalid_shape("the transform flattens the object, or scales or moves it too far to be computed");
}

Status curves_cannot_emit() {
  return invalid_shape("curves cannot emit light: give them a material without emission");
}

Status deforming_meshes_cannot_emit() {
  return invalid_shape("a mesh that deforms cannot emit light: give it a material without emission");
}

Status check_instance(const InstanceDescription& instance, const SceneDescription& scene,
                      const std::vector<ObjectFacts>& objects) {
  if (instance.object >= objects.size())
    return invalid_shape(fmt::format("there is no object {}", instance.object));
  if (instance.material && *instance.material >= scene.materials.size())
    return invalid_shape(fmt::format("there is no material {}", *instance.material));
  if (instance.material && objects[instance.object].has_curves && can_emit(*instance.material, scene))
    return curves_cannot_emit();
  if (instance.material && objects[instance.object].deforms && can_emit(*instance.material, scene))
    return deforming_meshes_cannot_emit();
  return validate_placement(instance.to_world, limits_of(objects[instance.object], instance, scene));
}

Status check_disk(const DiskDescription& disk) {
  if (!is_valid_point(disk.center) || !is_valid_point(disk.radius_u) || !is_valid_point(disk.radius_v))
    return invalid_shape(fmt::format("coordinates must be numbers of at most {:g}", kMaxCoordinate));
  if (!(disk.inner >= 0 && disk.inner < 1))
    return invalid_shape("the inner radius must be 0 or greater, and less than the radius");
  if (!geometry_of(disk).can_be_hit()) return invalid_shape("the disk has no area that can be computed");
  return {};
}

Status check_cylinder(const CylinderDescription& c) {
  if (!is_valid_point(c.start) || !is_valid_point(c.axis) || !is_valid_point(c.radius_u) ||
      !is_valid_point(c.radius_v))
    return invalid_shape(fmt::format("coordinates must be numbers of at most {:g}", kMaxCoordinate));
  if (!Cylinder::can_be_hit(c.start, c.axis, c.radius_u, c.radius_v))
    return invalid_shape("the cylinder is flat, or too small or too large to be computed");
  return {};
}

Status check_curves(const CurvesDescription& curves, const SceneDescription& scene) {
  const CurveStrands& strands = curves.strands;
  if (curves.material >= scene.materials.size())
    return invalid_shape(fmt::format("there is no material {}", curves.material));
  if (can_emit(curves.material, scene)) return curves_cannot_emit();
  if (strands.counts.empty()) return invalid_shape("needs at least one curve");
  if (!Curves::is_sound(strands))
    return invalid_shape("the control points, radii or normals are not as many as the curves need");
  for (std::size_t i = 0; i < strands.points.size(); ++i)
    if (!is_valid_point(strands.points[i]))
      return invalid_shape(fmt::format("control point {}: coordinates must be numbers of at most {:g}", i + 1,
                                       kMaxCoordinate));
  for (std::size_t i = 0; i < strands.radii.size(); ++i)
    if (!(strands.radii[i] >= 0 && strands.radii[i] <= kMaxCoordinate))
      return invalid_shape(fmt::format("radius {}: must be between 0 and {:g}", i + 1, kMaxCoordinate));
  for (std::size_t i = 0; i < strands.normals.size(); ++i)
    if (!(length_squared(strands.normals[i]) > 0) || !is_valid_point(strands.normals[i]))
      return invalid_shape(fmt::format("normal {}: must have a length", i + 1));
  return {};
}

// For a scene or an object; `objects` is empty for the latter, which cannot contain instances.
Status check_shape(const ShapeDescription& shape, const SceneDescription& scene,
                   const std::vector<ObjectFacts>& objects) {
  const std::size_t material_count = scene.materials.size();
  return std::visit(
      Overloaded{
          [&](const MeshDescription& mesh) -> Status {
            if (auto ok = check_mesh(mesh, material_count); !ok || mesh.steps.empty()) return ok;
            const std::set<std::uint32_t> materials(mesh.triangle_materials.begin(),
                                                    mesh.triangle_materials.end());
            return std::any_of(materials.begin(), materials.end(),
                               [&](std::uint32_t m) { return can_emit(m, scene); })
                       ? deforming_meshes_cannot_emit()
                       : Status();
          },
          [&](const SphereDescription& s) -> Status {
            if (!is_valid_point(s.center) || !(s.radius > 0 && s.radius <= kMaxCoordinate))
              return invalid_shape(fmt::format(
                  "the centre must be numbers of at most {:g} and the radius above 0", kMaxCoordinate));
            if (s.material >= material_count)
              return invalid_shape(fmt::format("there is no material {}", s.material));
            return {};
          },
          [&](const QuadDescription& q) -> Status {
            if (!is_valid_point(q.corner) || !is_valid_point(q.edge_u) || !is_valid_point(q.edge_v))
              return invalid_shape(
                  fmt::format("coordinates must be numbers of at most {:g}", kMaxCoordinate));
            if (q.material >= material_count)
              return invalid_shape(fmt::format("there is no material {}", q.material));
            return {};
          },
          [&](const InstanceDescription& i) { return check_instance(i, scene, objects); },
          [&](const DiskDescription& d) -> Status {
            if (d.material >= material_count)
              return invalid_shape(fmt::format("there is no material {}", d.material));
            return check_disk(d);
          },
          [&](const CylinderDescription& c) -> Status {
            if (c.material >= material_count)
              return invalid_shape(fmt::format("there is no material {}", c.material));
            return check_cylinder(c);
          },
          [&](const CurvesDescription& c) { return check_curves(c, scene); },
      },
      shape);
}

Status check_shapes(const std::vector<ShapeDescription>& shapes, const std::vector<std::string>& names,
                    const SceneDescription& scene, const std::vector<ObjectFacts>& objects) {
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (auto ok = check_shape(shapes[i], scene, objects); !ok) {
      const bool named = i < names.size() && !names[i].empty();
      return fail(ok.error().within(named ? names[i] : fmt::format("shapes[{}]", i)));
    }
  }
  return {};
}

Status check_object(const ObjectDescription& object, const SceneDescription& scene) {
  if (object.shapes.empty()) return invalid_shape("needs at least one shape");
  for (const ShapeDescription& shape : object.shapes)
    if (std::holds_alternative<InstanceDescription>(shape))
      return invalid_shape("an object cannot hold instances of others; write them among the scene's shapes");
  return check_shapes(object.shapes, object.shape_names, scene, {});
}

}  // namespace

bool is_valid_point(Vec3 p) {
  const auto in_range = [](float c) { return std::fabs(c) <= kMaxCoordinate; };
  return in_range(p.x) && in_range(p.y) && in_range(p.z);
}

bool can_emit(std::uint32_t material, const SceneDescription& scene) {
  if (!is_black(scene.materials[material].emission.value)) return true;
  const auto& animated = scene.animation.materials;
  return std::any_of(animated.begin(), animated.end(), [material](const IndexedTracks& each) {
    return each.index == material && each.tracks.color("emission") != nullptr;
  });
}

Status validate_shape(const ShapeDescription& shape, const SceneDescription& scene) {
  const auto* instance = std::get_if<InstanceDescription>(&shape);
  return instance == nullptr ? check_shape(shape, scene, {}) : check_transform(instance->to_world);
}

void check_instances(const SceneDescription& scene,
                     const std::function<void(std::size_t, const Error&)>& refuse) {
  std::vector<ObjectFacts> objects;
  for (const ObjectDescription& object : scene.objects) objects.push_back(facts_of(object));
  for (std::size_t i = 0; i < scene.shapes.size(); ++i)
    if (const auto* instance = std::get_if<InstanceDescription>(&scene.shapes[i]))
      if (const Status ok = check_instance(*instance, scene, objects); !ok) refuse(i, ok.error());
}

Status check_all_shapes(const SceneDescription& scene) {
  std::vector<ObjectFacts> objects;
  for (const ObjectDescription& object : scene.objects) {
    if (auto ok = check_object(object, scene); !ok)
      return fail(ok.error().within(fmt::format("object '{}'", object.name)));
    objects.push_back(facts_of(object));
  }
  return check_shapes(scene.shapes, scene.shape_names, scene, objects);
}

PlacementLimits placement_limits(const SceneDescription& scene, const InstanceDescription& instance) {
  return limits_of(facts_of(scene.objects[instance.object]), instance, scene);
}

Status validate_placement(const Transform& to_world, const PlacementLimits& limits) {
  if (auto ok = check_transform(to_world); !ok) return ok;
  const Aabb box = Placement(to_world).bounds(limits.object_bounds);
  if (!is_valid_point(box.lower) || !is_valid_point(box.upper))
    return invalid_shape(fmt::format("the object reaches farther than {:g} there", kMaxCoordinate));
  if (limits.must_stay_round && !(uniform_scale(to_world, kRoundToRounding) > 0))
    return invalid_shape(
        "a sphere that emits must stay round: the transform must scale by the same factor in all directions");
  return {};
}

}  // namespace tessera::core
