// SPDX-License-Identifier: Apache-2.0
// The vertices of a mesh that deforms: from one step to the next they move along straight lines, before the
// first step and after the last one they stay. Immutable.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry/aabb.hpp"
#include "core/geometry/surface.hpp"
#include "core/math/track.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

// All vertices of a mesh at a frame.
struct MeshStep {
  float frame = 0;
  std::vector<Vec3> positions{};
  std::vector<Vec3> normals{};            // one per position; or empty: flat shading
  std::vector<VertexTangent> tangents{};  // one per position, with the handedness of all steps; or empty
};

// What vertices have beside positions.
struct VertexParts {
  bool normals = false, tangents = false;
};

// Whether the steps are at least two, at finite frames that increase, each of `vertices` positions and of as
// many of the parts, or of none.
bool are_sound(const std::vector<MeshStep>& steps, std::size_t vertices, VertexParts parts);

class VertexMotion {
 public:
  // Between a step and the next one.
  struct Moment {
    std::size_t step = 0;
    double part = 0;  // of the way, from 0 to 1
  };

  // The steps must be sound. Normals and tangents are made unit vectors, as those of meshes.
  explicit VertexMotion(const std::vector<MeshStep>& steps);

  std::size_t vertex_count() const { return positions_.size() / frames_.size(); }
  bool has_normals() const { return !normals_.empty(); }
  bool has_tangents() const { return !tangents_.empty(); }
  Moment at(float frame) const;
  // At a step, to the bit, those of the step. Also between steps that are equal.
  Vec3 position(std::size_t vertex, Moment moment) const { return between(positions_, vertex, moment); }
  // Unit vectors at steps, interpolated linearly between.
  Vec3 normal(std::size_t vertex, Moment moment) const { return between(normals_, vertex, moment); }
  Vec3 tangent(std::size_t vertex, Moment moment) const { return between(tangents_, vertex, moment); }

  // Whether there are two different steps in the interval.
  bool moves(FrameInterval interval) const {
    return !interval.empty() && interval.begin < frames_.back() && interval.end > frames_.front();
  }
  // Bounds of all points of a triangle during the interval.
  Aabb bounds(const std::array<std::size_t, 3>& vertices, FrameInterval interval) const;

 private:
  Vec3 between(const std::vector<Vec3>& vectors, std::size_t vertex, Moment moment) const;

  std::vector<float> frames_;
  std::vector<Vec3> positions_, normals_, tangents_;  // those of a vertex at all steps are neighbours
};

}  // namespace tessera::core
