// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import/scene_bounds.hpp"

#include <variant>
#include <vector>

#include "core/base/overloaded.hpp"
#include "core/scene/analytic_shapes.hpp"

namespace tessera::core {
namespace {

Aabb transformed_box(const Aabb& box, const Transform& transform) {
  Aabb result;
  if (box.empty()) return result;
  for (const float x : {box.lower.x, box.upper.x})
    for (const float y : {box.lower.y, box.upper.y})
      for (const float z : {box.lower.z, box.upper.z}) result.include(transform.point({x, y, z}));
  return result;
}

// `objects` are the boxes of the objects that instances name.
Aabb shape_bounds(const ShapeDescription& shape, const std::vector<Aabb>& objects) {
  Aabb box;
  std::visit(Overloaded{[&](const MeshDescription& mesh) {
                          for (const Vec3 p : mesh.positions) box.include(p);
                        },
                        [&](const SphereDescription& sphere) {
                          const Vec3 reach{sphere.radius, sphere.radius, sphere.radius};
                          box.include(sphere.center - reach);
                          box.include(sphere.center + reach);
                        },
                        [&](const QuadDescription& quad) {
                          for (const Vec3 p : {quad.corner, quad.corner + quad.edge_u})
                            for (const Vec3 q : {p, p + quad.edge_v}) box.include(q);
                        },
                        [&](const DiskDescription& disk) { box.include(geometry_of(disk).bounds()); },
                        [&](const CylinderDescription& c) {
                          if (Cylinder::can_be_hit(c.start, c.axis, c.radius_u, c.radius_v))
                            box.include(geometry_of(c).bounds());
                        },
                        [&](const CurvesDescription& curves) { box.include(bounds_of(curves.strands)); },
                        [&](const InstanceDescription& instance) {
                          if (instance.object < objects.size())
                            box.include(transformed_box(objects[instance.object], instance.to_world));
                        }},
             shape);
  return box;
}

Aabb bounds_of_all(const std::vector<ShapeDescription>& shapes, const std::vector<Aabb>& objects) {
  Aabb box;
  for (const ShapeDescription& shape : shapes) box.include(shape_bounds(shape, objects));
  return box;
}

}  // namespace

Aabb scene_bounds(const SceneDescription& scene) {
  std::vector<Aabb> objects;
  for (const ObjectDescription& object : scene.objects)
    objects.push_back(bounds_of_all(object.shapes, objects));
  return bounds_of_all(scene.shapes, objects);
}

}  // namespace tessera::core
