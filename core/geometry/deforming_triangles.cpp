// SPDX-License-Identifier: Apache-2.0
// The triangles of meshes that deform. They are the last triangles, and primitives of their own kind only
// while the shutter is open: otherwise they are triangles like others, placed anew at each frame.
#include <algorithm>
#include <iterator>
#include <utility>

#include "core/geometry/primitives.hpp"

namespace tessera::core {

void Primitives::deform_last_mesh(const std::vector<MeshStep>& steps, std::uint32_t first_triangle) {
  auto motion = std::make_shared<const VertexMotion>(steps);
  const auto first_vertex = static_cast<std::uint32_t>(positions_.size() - motion->vertex_count());
  deforming_.push_back({first_triangle, first_vertex, std::move(motion)});
}

bool Primitives::can_deform() const {
  return !deforming_.empty() || std::any_of(objects_.begin(), objects_.end(),
                                            [](const Primitives& object) { return object.can_deform(); });
}

void Primitives::deform(float frame, FrameInterval shutter) {
  shutter_ = shutter;
  const float shown = shutter.empty() ? frame : shutter.at(0.5f);
  is_deforming_ = false;
  for (const auto& [first_triangle, first_vertex, motion] : deforming_) {
    const VertexMotion::Moment moment = motion->at(shown);
    for (std::size_t v = 0; v < motion->vertex_count(); ++v) {
      positions_[first_vertex + v] = motion->position(v, moment);
      if (motion->has_normals()) normals_[first_vertex + v] = motion->normal(v, moment);
      if (motion->has_tangents()) tangents_[first_vertex + v].direction = motion->tangent(v, moment);
    }
    is_deforming_ |= motion->moves(shutter);
  }
  first_moving_ = is_deforming_ ? deforming_.front().first_triangle : 0;
  moving_triangles_ = is_deforming_ ? triangle_count() - first_moving_ : 0;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    Primitives& object = objects_[i];
    if (!object.can_deform()) continue;
    object.deform(frame, shutter);
    is_deforming_ |= object.is_deforming_;
    outlines_[i] = object.outline();
  }
  for (std::size_t i = 0; i < instances_.size(); ++i)
    if (object_of(instances_[i]).can_deform()) instance_bounds_[i] = instance_box(instances_[i]);
}

const Primitives::DeformingMesh& Primitives::mesh_of(std::uint32_t moving_triangle) const {
  const auto behind = std::upper_bound(
      deforming_.begin(), deforming_.end(), moving_triangle,
      [](std::uint32_t triangle, const DeformingMesh& mesh) { return triangle < mesh.first_triangle; });
  return *std::prev(behind);
}

Primitives::MovingTriangle Primitives::moving_triangle(std::uint32_t primitive, float time) const {
  const DeformingMesh& mesh = mesh_of(primitive);
  const VertexMotion::Moment moment = mesh.motion->at(shutter_.at(time));
  MovingTriangle moving{};
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const std::size_t vertex = triangles_[primitive][corner] - mesh.first_vertex;
    moving.corners[corner] = mesh.motion->position(vertex, moment);
    if (mesh.motion->has_normals()) moving.normals[corner] = mesh.motion->normal(vertex, moment);
  }
  return moving;
}

std::array<Vec3, 3> Primitives::moving_tangents(std::uint32_t primitive, float time) const {
  const DeformingMesh& mesh = mesh_of(primitive);
  std::array<Vec3, 3> tangents{};
  if (!mesh.motion->has_tangents()) return tangents;
  const VertexMotion::Moment moment = mesh.motion->at(shutter_.at(time));
  for (std::size_t corner = 0; corner < 3; ++corner)
    tangents[corner] = mesh.motion->tangent(triangles_[primitive][corner] - mesh.first_vertex, moment);
  return tangents;
}

Aabb Primitives::moving_triangle_bounds(std::uint32_t primitive) const {
  const DeformingMesh& mesh = mesh_of(primitive);
  std::array<std::size_t, 3> vertices{};
  for (std::size_t corner = 0; corner < 3; ++corner)
    vertices[corner] = triangles_[primitive][corner] - mesh.first_vertex;
  return mesh.motion->bounds(vertices, shutter_);
}

}  // namespace tessera::core
