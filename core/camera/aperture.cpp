// SPDX-License-Identifier: Apache-2.0
#include "core/camera/aperture.hpp"

#include <algorithm>
#include <cstddef>

#include "core/math/elementary.hpp"
#include "core/math/lane_array.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core {
namespace {

float cross(Vec2 a, Vec2 b) {
  return a.x * b.y - a.y * b.x;
}

}  // namespace

Aperture::Aperture(float radius, int blades, float rotation_degrees) : radius_(radius) {
  for (int corner = 0; blades > 0 && corner <= blades; ++corner) {
    const float turns = static_cast<float>(corner % blades) / static_cast<float>(blades);
    const float angle = 2 * kPi * turns + rotation_degrees * (kPi / 180);
    corners_.push_back(Vec2{-sin(angle), cos(angle)} * radius);
  }
}

// The concentric map with its circles replaced by polygons. In the triangle between the centre and an edge,
// the density is proportional to the distance from the centre and uniform along the edge.
Vec2 Aperture::sample_polygon(Vec2 u) const {
  const std::size_t edges = corners_.size() - 1;
  const sampling::PolarPoint point = sampling::sample_disk_polar(u);
  const float along = point.turns * static_cast<float>(edges);
  const std::size_t edge = std::min(static_cast<std::size_t>(along), edges - 1);
  const Vec2 a = corners_[edge], b = corners_[edge + 1];
  return (a + (b - a) * (along - static_cast<float>(edge))) * point.radius;
}

Vec2Of<FloatN> Aperture::sample_polygon(Vec2Of<FloatN> u) const {
  const FloatLanes u_x(u.x), u_y(u.y);
  FloatLanes x, y;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const Vec2 point = sample_polygon(Vec2{u_x[lane], u_y[lane]});
    x.set(lane, point.x), y.set(lane, point.y);
  }
  return {x.all(), y.all()};
}

float Aperture::area() const {
  if (corners_.empty()) return kPi * radius_ * radius_;
  float doubled = 0;
  for (std::size_t edge = 0; edge + 1 < corners_.size(); ++edge)
    doubled += cross(corners_[edge], corners_[edge + 1]);
  return doubled / 2;
}

bool Aperture::contains(Vec2 point) const {
  if (corners_.empty()) return point.x * point.x + point.y * point.y <= radius_ * radius_;
  for (std::size_t edge = 0; edge + 1 < corners_.size(); ++edge) {
    const Vec2 a = corners_[edge], b = corners_[edge + 1];
    if (cross(b - a, point - a) < 0) return false;
  }
  return true;
}

}  // namespace tessera::core
