// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>

namespace tessera::core {
namespace {

struct Point {
  double x, y;
};

// Twice the signed area of a triangle; positive if counter-clockwise.
double twice_area(Point a, Point b, Point c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Projects along the dominant axis of the normal (Newell's sum), seen from the side where the polygon is
// counter-clockwise. Coordinates are relative to the first corner, so that small polygons far from the
// origin keep their shape.
std::vector<Point> project(std::span<const Vec3> corners) {
  const Vec3 o = corners[0];
  const auto relative = [&](std::size_t i) {
    const Vec3 p = corners[i % corners.size()];
    return std::array<double, 3>{double{p.x} - o.x, double{p.y} - o.y, double{p.z} - o.z};
  };
  std::array<double, 3> normal{};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto p = relative(i), q = relative(i + 1);
    for (std::size_t k = 0; k < 3; ++k)
      normal[k] += p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3];
  }
  std::size_t axis = std::fabs(normal[1]) > std::fabs(normal[0]) ? 1 : 0;
  if (std::fabs(normal[2]) > std::fabs(normal[axis])) axis = 2;
  const bool from_behind = normal[axis] < 0;
  std::vector<Point> points;
  points.reserve(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto p = relative(i);
    const Point seen{p[(axis + 1) % 3], p[(axis + 2) % 3]};
    points.push_back(from_behind ? Point{seen.y, seen.x} : seen);
  }
  return points;
}

bool same(Point a, Point b) {
  return a.x == b.x && a.y == b.y;
}

// What is left of a polygon while ears are cut off. A simple polygon has an ear; one that intersects itself
// or is degenerate may have none.
class Outline {
 public:
  explicit Outline(std::span<const Vec3> corners)
      : points_(project(corners)), next_(corners.size()), previous_(corners.size()), left_(corners.size()) {
    std::iota(next_.begin(), next_.end(), 1u);
    next_.back() = 0;
    for (std::uint32_t i = 0; i < next_.size(); ++i) previous_[next_[i]] = i;
    for (std::uint32_t i = 0; i < next_.size(); ++i)
      if (is_reflex(i)) reflex_.push_back(i);
  }

  std::size_t left() const { return left_; }
  std::uint32_t first() const { return first_; }
  std::uint32_t next(std::uint32_t corner) const { return next_[corner]; }
  std::size_t reflex_count() const { return reflex_.size(); }
  std::array<std::uint32_t, 3> triangle_at(std::uint32_t corner) const {
    return {previous_[corner], corner, next_[corner]};
  }

  // The next ear from `start` on, if there is one. Subtracts the points looked at from `budget`, and ends
  // when that is used up.
  std::optional<std::uint32_t> find_ear(std::uint32_t start, std::int64_t& budget) const {
    std::uint32_t corner = start;
    for (std::size_t k = 0; k < left_ && budget > 0; ++k, corner = next_[corner])
      if (is_ear(corner, budget)) return corner;
    return std::nullopt;
  }
  // Its neighbours may become convex.
  void cut_off(std::uint32_t ear) {
    const std::uint32_t before = previous_[ear], after = next_[ear];
    next_[before] = after;
    previous_[after] = before;
    --left_;
    if (ear == first_) first_ = after;
    for (const std::uint32_t corner : {before, after})
      if (!is_reflex(corner)) std::erase(reflex_, corner);
  }

 private:
  double twice_area_at(std::uint32_t corner) const {
    return twice_area(points_[previous_[corner]], points_[corner], points_[next_[corner]]);
  }
  bool is_reflex(std::uint32_t corner) const { return twice_area_at(corner) < 0; }
  // Whether the triangle at the corner is convex and contains no reflex corner.
  bool is_ear(std::uint32_t corner, std::int64_t& budget) const {
    --budget;
    if (!(twice_area_at(corner) > 0)) return false;
    budget -= static_cast<std::int64_t>(reflex_.size());
    const Point a = points_[previous_[corner]], b = points_[corner], c = points_[next_[corner]];
    return std::ranges::none_of(reflex_, [&](std::uint32_t other) {
      const Point p = points_[other];
      const bool inside = twice_area(a, b, p) >= 0 && twice_area(b, c, p) >= 0 && twice_area(c, a, p) >= 0;
      return inside && !same(p, a) && !same(p, b) && !same(p, c);
    });
  }

  std::vector<Point> points_;
  std::vector<std::uint32_t> next_, previous_;  // of the corners that are left
  std::vector<std::uint32_t> reflex_;
  std::size_t left_;
  std::uint32_t first_ = 0;
};

// Of find_ear() for a polygon, which usually looks at each reflex corner a few times for each ear.
constexpr std::int64_t kMaxPoints = std::int64_t{1} << 28;

}  // namespace

bool triangulate(std::span<const Vec3> corners, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  const auto count = static_cast<std::uint32_t>(corners.size());
  if (count == 3) {
    triangles.push_back({0, 1, 2});
    return true;
  }
  Outline outline(corners);
  if (outline.reflex_count() == 0) {
    for (std::uint32_t i = 1; i + 1 < count; ++i) triangles.push_back({0, i, i + 1});
    return true;
  }
  if (count * outline.reflex_count() > kMaxConcaveCorners * kMaxConcaveCorners) return false;
  const std::size_t before = triangles.size();
  std::int64_t budget = kMaxPoints;
  std::uint32_t start = 0;
  while (outline.left() > 3) {
    const auto ear = outline.find_ear(start, budget);
    if (!ear) break;
    triangles.push_back(outline.triangle_at(*ear));
    start = outline.next(*ear);
    outline.cut_off(*ear);
  }
  if (budget <= 0) {
    triangles.resize(before);
    return false;
  }
  const std::uint32_t first = outline.first();
  for (std::uint32_t i = outline.next(first); outline.next(i) != first; i = outline.next(i))
    triangles.push_back({first, i, outline.next(i)});
  return true;
}

}  // namespace tessera::core
