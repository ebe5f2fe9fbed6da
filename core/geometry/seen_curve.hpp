// SPDX-License-Identifier: Apache-2.0
// A part of a curve as a ray sees it; internal to the functions of curve.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/geometry/curve.hpp"

namespace tessera::core {

// A ray moved to the origin, running along +z: `across_x`, `across_y` and `along` are orthonormal and
// right-handed (Duff et al. 2017).
struct CurveFrame {
  explicit CurveFrame(const ObjectRay& ray) : origin(ray.origin), direction_length(length(ray.direction)) {
    along = (1 / direction_length) * ray.direction;
    const double sign = std::copysign(1.0, along.z), a = -1 / (sign + along.z), b = along.x * along.y * a;
    across_x = {1 + sign * along.x * along.x * a, sign * b, -sign * along.x};
    across_y = {b, sign + along.y * along.y * a, -along.y};
  }

  Vec3d to_local(Vec3d point) const {
    const Vec3d p = point - origin;
    return {dot(p, across_x), dot(p, across_y), dot(p, along)};
  }
  Vec3d to_object(Vec3d v) const { return v.x * across_x + v.y * across_y + v.z * along; }

  Vec3d origin, across_x, across_y, along;
  double direction_length;
};

// A cubic polynomial by its powers.
struct CubicPowers {
  CubicPowers() = default;
  CubicPowers(double b0, double b1, double b2, double b3)
      : c0(b0), c1(3 * (b1 - b0)), c2(3 * (b0 - 2 * b1 + b2)), c3(b3 - b0 + 3 * (b1 - b2)) {}

  double value(double u) const { return ((c3 * u + c2) * u + c1) * u + c0; }
  double slope(double u) const { return (3 * c3 * u + 2 * c2) * u + c1; }
  double bend(double u) const { return 6 * c3 * u + 2 * c2; }

  double c0 = 0, c1 = 0, c2 = 0, c3 = 0;
};

// The polynomial c . c' / 3 of two coordinates, in the Bernstein basis.
using Quintic = std::array<double, 6>;

// A part as a ray sees it.
class SeenCurve {
 public:
  SeenCurve(const CurvePart& part, const CurveFrame& frame) : radii_(part.radii) {
    for (std::size_t i = 0; i < 4; ++i) points_[i] = frame.to_local(part.points[i]);
    max_radius_ = part.max_radius();
  }

  // Whether the part may be within its largest radius of the ray, ahead of its origin. Its control points
  // are compared with the directions along and across its ends.
  bool may_be_hit() const {
    const double ex = points_[3].x - points_[0].x, ey = points_[3].y - points_[0].y;
    double low[3] = {kInfinity, kInfinity, kInfinity}, high[3] = {-kInfinity, -kInfinity, -kInfinity};
    for (const Vec3d& p : points_) {
      const double at[3] = {ex * p.y - ey * p.x, ex * p.x + ey * p.y, p.z};
      for (int i = 0; i < 3; ++i) low[i] = std::min(low[i], at[i]), high[i] = std::max(high[i], at[i]);
    }
    const double limit2 = max_radius_ * max_radius_ * (ex * ex + ey * ey) * (1 + 1e-9);
    const auto is_apart = [limit2](double lowest, double highest) {
      const double gap = std::max({lowest, -highest, 0.0});
      return gap * gap > limit2;
    };
    return !is_apart(low[0], high[0]) && !is_apart(low[1], high[1]) && high[2] + max_radius_ > 0;
  }

  void find_powers() {
    x_ = {points_[0].x, points_[1].x, points_[2].x, points_[3].x};
    y_ = {points_[0].y, points_[1].y, points_[2].y, points_[3].y};
    z_ = {points_[0].z, points_[1].z, points_[2].z, points_[3].z};
    r_ = {radii_[0], radii_[1], radii_[2], radii_[3]};
  }

  Quintic approach() const {
    double dx[3], dy[3];
    for (std::size_t i = 0; i < 3; ++i) {
      dx[i] = points_[i + 1].x - points_[i].x;
      dy[i] = points_[i + 1].y - points_[i].y;
    }
    const auto product = [&](std::size_t i, std::size_t j) {
      return points_[i].x * dx[j] + points_[i].y * dy[j];
    };
    return {product(0, 0),
            (2 * product(0, 1) + 3 * product(1, 0)) / 5,
            (product(0, 2) + 6 * product(1, 1) + 3 * product(2, 0)) / 10,
            (3 * product(1, 2) + 6 * product(2, 1) + product(3, 0)) / 10,
            (3 * product(2, 2) + 2 * product(3, 1)) / 5,
            product(3, 2)};
  }

  double max_radius() const { return max_radius_; }
  const CubicPowers& x() const { return x_; }
  const CubicPowers& y() const { return y_; }
  const CubicPowers& z() const { return z_; }
  const CubicPowers& r() const { return r_; }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  std::array<Vec3d, 4> points_;
  std::array<double, 4> radii_;
  double max_radius_;
  CubicPowers x_, y_, z_, r_;
};

// A point of the part with its derivatives, as a ray sees it.
struct CurvePlace {
  CurvePlace(const SeenCurve& curve, double u)
      : point(curve.x().value(u), curve.y().value(u), curve.z().value(u)),
        tangent(curve.x().slope(u), curve.y().slope(u), curve.z().slope(u)),
        bend(curve.x().bend(u), curve.y().bend(u), curve.z().bend(u)),
        radius(curve.r().value(u)),
        radius_slope(curve.r().slope(u)) {}

  Vec3d point, tangent, bend;
  double radius, radius_slope;
};

struct RoundEntry {
  double u, depth;
};

// The entry of the ray into the round curve near u.
std::optional<RoundEntry> enter_round(const SeenCurve& curve, double u);

}  // namespace tessera::core
