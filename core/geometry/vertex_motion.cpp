// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/vertex_motion.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/object_point.hpp"
#include "core/geometry/rounding.hpp"

namespace tessera::core {
namespace {

// Those of each vertex at all steps become neighbours. convert(value) is stored.
template <typename Value, typename Convert>
std::vector<Vec3> by_vertex(const std::vector<MeshStep>& steps, std::vector<Value> MeshStep::*list,
                            const Convert& convert) {
  const std::size_t vertices = (steps[0].*list).size();
  std::vector<Vec3> all;
  all.reserve(steps.size() * vertices);
  for (std::size_t vertex = 0; vertex < vertices; ++vertex)
    for (const MeshStep& step : steps) all.push_back(convert((step.*list)[vertex]));
  return all;
}

float largest(Vec3 v) {
  return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

}  // namespace

bool are_sound(const std::vector<MeshStep>& steps, std::size_t vertices, VertexParts parts) {
  if (steps.size() < 2) return false;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (!std::isfinite(steps[i].frame) || (i > 0 && !(steps[i].frame > steps[i - 1].frame))) return false;
    if (steps[i].positions.size() != vertices) return false;
    if (steps[i].normals.size() != (parts.normals ? vertices : 0)) return false;
    if (steps[i].tangents.size() != (parts.tangents ? vertices : 0)) return false;
  }
  return true;
}

VertexMotion::VertexMotion(const std::vector<MeshStep>& steps)
    : positions_(by_vertex(steps, &MeshStep::positions, [](Vec3 p) { return p; })),
      normals_(by_vertex(steps, &MeshStep::normals, [](Vec3 n) { return unit_or_zero(Vec3d(n)); })),
      tangents_(by_vertex(steps, &MeshStep::tangents,
                          [](const VertexTangent& t) { return unit_or_zero(Vec3d(t.direction)); })) {
  for (const MeshStep& step : steps) frames_.push_back(step.frame);
}

VertexMotion::Moment VertexMotion::at(float frame) const {
  const auto after = std::upper_bound(frames_.begin(), frames_.end(), frame);
  if (after == frames_.begin()) return {0, 0};
  if (after == frames_.end()) return {frames_.size() - 2, 1};
  const auto next = static_cast<std::size_t>(after - frames_.begin());
  const double begin = frames_[next - 1], end = frames_[next];
  return {next - 1, (double{frame} - begin) / (end - begin)};
}

// The sum of products has an error far below that of rounding to float: so it is exact where both are equal.
Vec3 VertexMotion::between(const std::vector<Vec3>& vectors, std::size_t vertex, Moment moment) const {
  const Vec3* const at = &vectors[vertex * frames_.size() + moment.step];
  return ((1 - moment.part) * Vec3d(at[0]) + moment.part * Vec3d(at[1])).rounded();
}

// Paths are straight between the ends of the interval and the steps inside. Positions between stray from
// them by roundings of the numbers at both steps.
Aabb VertexMotion::bounds(const std::array<std::size_t, 3>& vertices, FrameInterval interval) const {
  const Moment first = at(interval.begin), last = at(interval.end);
  Aabb box;
  float farthest = 0;
  for (const std::size_t vertex : vertices) {
    box.include(position(vertex, first));
    box.include(position(vertex, last));
    for (std::size_t step = first.step + 1; step <= last.step; ++step)
      box.include(position(vertex, {step, 0}));
    for (std::size_t step = first.step; step <= last.step + 1; ++step)
      farthest = std::max(farthest, largest(positions_[vertex * frames_.size() + step]));
  }
  const double error = gamma<double>(8) * double{farthest};
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = next_float_down(static_cast<float>(double{box.lower[axis]} - error));
    box.upper[axis] = next_float_up(static_cast<float>(double{box.upper[axis]} + error));
  }
  return box;
}

}  // namespace tessera::core
