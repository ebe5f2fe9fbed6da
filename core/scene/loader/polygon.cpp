// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/polygon.hpp"

#include <cmath>
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

// The remaining corners, and those of them that are reflex.
struct Outline {
  std::vector<Point> points;
  std::vector<std::uint32_t> left, reflex;

  Point at(std::size_t i) const { return points[left[i % left.size()]]; }
  std::size_t before(std::size_t i) const { return (i + left.size() - 1) % left.size(); }
  std::array<std::uint32_t, 3> triangle(std::size_t i, std::size_t j, std::size_t k) const {
    return {left[i % left.size()], left[j % left.size()], left[k % left.size()]};
  }
  bool is_reflex(std::size_t i) const { return twice_area(at(before(i)), at(i), at(i + 1)) < 0; }

  void find_reflex() {
    for (std::size_t i = 0; i < left.size(); ++i)
      if (is_reflex(i)) reflex.push_back(left[i]);
  }
  // Its neighbours may become convex.
  void cut_off(std::size_t ear) {
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
    for (const std::size_t i : {before(ear), ear % left.size()})
      if (!is_reflex(i)) std::erase(reflex, left[i]);
  }
};

bool same(Point a, Point b) {
  return a.x == b.x && a.y == b.y;
}

// Whether the triangle at corner `i` is an ear: it is convex and contains no reflex corner.
bool is_ear(const Outline& outline, std::size_t i) {
  const Point a = outline.at(outline.before(i)), b = outline.at(i), c = outline.at(i + 1);
  if (!(twice_area(a, b, c) > 0)) return false;
  for (const std::uint32_t corner : outline.reflex) {
    const Point p = outline.points[corner];
    const bool inside = twice_area(a, b, p) >= 0 && twice_area(b, c, p) >= 0 && twice_area(c, a, p) >= 0;
    if (inside && !same(p, a) && !same(p, b) && !same(p, c)) return false;
  }
  return true;
}

// The next ear from `start` on. A simple polygon has one; nullopt if it is self-intersecting or degenerate.
std::optional<std::size_t> find_ear(const Outline& outline, std::size_t start) {
  for (std::size_t k = 0; k < outline.left.size(); ++k)
    if (const std::size_t i = (start + k) % outline.left.size(); is_ear(outline, i)) return i;
  return std::nullopt;
}

}  // namespace

bool triangulate(std::span<const Vec3> corners, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  const auto count = static_cast<std::uint32_t>(corners.size());
  if (count == 3) {
    triangles.push_back({0, 1, 2});
    return true;
  }
  Outline outline{project(corners), std::vector<std::uint32_t>(count), {}};
  std::iota(outline.left.begin(), outline.left.end(), 0u);
  outline.find_reflex();
  if (outline.reflex.empty()) {
    for (std::uint32_t i = 1; i + 1 < count; ++i) triangles.push_back({0, i, i + 1});
    return true;
  }
  if (count * outline.reflex.size() > kMaxConcaveCorners * kMaxConcaveCorners) return false;
  std::optional<std::size_t> ear = 0;
  while (outline.left.size() > 3 && (ear = find_ear(outline, *ear))) {
    triangles.push_back(outline.triangle(outline.before(*ear), *ear, *ear + 1));
    outline.cut_off(*ear);
  }
  for (std::size_t i = 1; i + 1 < outline.left.size(); ++i)
    triangles.push_back(outline.triangle(0, i, i + 1));
  return true;
}

}  // namespace tessera::core
