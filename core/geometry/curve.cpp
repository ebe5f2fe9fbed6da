// SPDX-License-Identifier: Apache-2.0
// Both shapes begin at the points of the part that are locally closest to the ray: minima of the distance in
// the plane across the ray, where c . c' = 0. This is a polynomial of degree 5, whose roots are isolated in
// the Bernstein basis by Descartes' rule of signs (Lane and Riesenfeld 1981). A flat curve is hit at such a
// point if it is within the radius. For a round one, the ray is intersected with the cone that touches the
// surface there, and the point moved to where that hit belongs, until it stays (after Reshetov and Luebke
// 2018, whose iteration starts from the ends of the curve).
#include "core/geometry/curve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/rounding.hpp"

namespace tessera::core {
namespace {

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

// The point between `low` and `high`, where the distance falls and rises, that is closest to the ray: by
// Newton's method, which a bisection replaces where it leaves the bracket.
double closest_between(const SeenCurve& curve, double low, double high, double guess, double tolerance) {
  constexpr int kMaxSteps = 60;
  double u = guess;
  for (int step = 0; step < kMaxSteps; ++step) {
    const double x = curve.x().value(u), y = curve.y().value(u);
    const double dx = curve.x().slope(u), dy = curve.y().slope(u);
    const double value = x * dx + y * dy;
    (value < 0 ? low : high) = u;
    const double slope = dx * dx + dy * dy + x * curve.x().bend(u) + y * curve.y().bend(u);
    double next = u - value / slope;
    if (!(next > low && next < high)) next = (low + high) / 2;
    const double moved = std::fabs(next - u);
    u = next;
    if (!(moved > tolerance)) break;
  }
  return u;
}

// Calls visit(u) for each local minimum of the distance inside the part.
template <typename Visit>
void for_each_closest(const SeenCurve& curve, const Quintic& whole, double tolerance, const Visit& visit) {
  constexpr int kMaxDepth = 14;
  struct Piece {
    Quintic f;
    double begin, size;
    int depth;
  };
  std::array<Piece, kMaxDepth + 1> stack;
  std::size_t count = 0;
  stack[count++] = {whole, 0, 1, 0};
  while (count > 0) {
    const Piece piece = stack[--count];
    const Quintic& f = piece.f;
    int changes = 0;
    for (std::size_t i = 1; i < f.size(); ++i) changes += (f[i - 1] < 0) != (f[i] < 0) ? 1 : 0;
    if (changes == 0) continue;
    const bool is_minimum = f[0] < 0 && !(f[5] < 0);
    if (changes == 1 || piece.depth == kMaxDepth) {
      if (!is_minimum) continue;
      const double share = f[0] / (f[0] - f[5]);
      visit(closest_between(curve, piece.begin, piece.begin + piece.size, piece.begin + share * piece.size,
                            tolerance));
      continue;
    }
    // De Casteljau's construction at the middle; the first half is visited first.
    Piece first{f, piece.begin, piece.size / 2, piece.depth + 1}, second = first;
    second.begin += second.size;
    Quintic rest = f;
    for (std::size_t level = 0; level < f.size(); ++level) {
      first.f[level] = rest[0];
      second.f[5 - level] = rest[5 - level];
      for (std::size_t i = 0; i + 1 < f.size() - level; ++i) rest[i] = (rest[i] + rest[i + 1]) / 2;
    }
    stack[count++] = second;
    stack[count++] = first;
  }
}

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

// Where the ray enters the cone around the tangent at a place, whose radius changes as the curve's does
// there; where it misses the cone, where it comes closest.
struct ConeEntry {
  explicit ConeEntry(const CurvePlace& at) {
    const Vec3d &c = at.point, &d = at.tangent;
    squared_speed = dot(d, d);
    // With the ray's point (0, 0, c.z + s), the share of the tangent to its foot is (m + s d.z) / speed^2,
    // and s solves s^2 a + 2 s b + c = 0.
    const double m = -(c.x * d.x + c.y * d.y), widening = at.radius_slope / squared_speed;
    const double r = at.radius + m * widening, dzw = d.z * widening;
    const double a = (d.x * d.x + d.y * d.y) / squared_speed - dzw * dzw;
    const double b = -d.z * (m / squared_speed + r * widening);
    const double rest = c.x * c.x + c.y * c.y - m * m / squared_speed - r * r;
    const double discriminant = b * b - a * rest;
    meets = discriminant >= 0;
    if (meets) {
      const double root = std::sqrt(discriminant);
      s = b > 0 ? (-b - root) / a : rest / (root - b);
    } else {
      s = -b / a;
    }
    along = m + s * d.z;
    meets = meets && r + s * dzw > 0;
  }

  double squared_speed;
  double s;      // from the depth of the place
  double along;  // of the ray's point from the place, times the tangent
  bool meets;
};

struct RoundEntry {
  double u, depth;
};

// The entry of the ray into the round curve near u.
std::optional<RoundEntry> enter_round(const SeenCurve& curve, double u) {
  constexpr int kMaxSteps = 16;
  constexpr double kTolerance = 1e-10, kLastTolerance = 1e-6, kMargin = 0.5;
  for (int step = 1; step <= kMaxSteps; ++step) {
    const CurvePlace at(curve, u);
    const ConeEntry cone(at);
    if (!(std::fabs(cone.along) < std::numeric_limits<double>::max())) return std::nullopt;
    const double turning = -at.point.x * at.bend.x - at.point.y * at.bend.y + cone.s * at.bend.z;
    const double speed2 = cone.squared_speed;
    const double moved = cone.along / std::clamp(speed2 - turning, 0.5 * speed2, 2 * speed2);
    if (std::fabs(moved) <= (step < kMaxSteps ? kTolerance : kLastTolerance))
      return cone.meets ? std::optional(RoundEntry{u, at.point.z + cone.s}) : std::nullopt;
    const double next = std::clamp(u + moved, -kMargin, 1 + kMargin);
    if (!(next != u)) return std::nullopt;
    u = next;
  }
  return std::nullopt;
}

// The offset of the ray from the curve, in radii; see CurveHit::across.
double across_of(Vec3d point, Vec3d tangent, double half_width) {
  const double speed = std::sqrt(tangent.x * tangent.x + tangent.y * tangent.y);
  const double across = (point.y * tangent.x - point.x * tangent.y) / (half_width * speed);
  return std::fabs(across) <= 1 ? across : across > 0 ? 1 : across < 0 ? -1 : 0;
}

constexpr double kEndTolerance = 1e-9;    // parts overlap by this much
constexpr double kRoundTolerance = 1e-4;  // of the closest point, from which a round curve is entered

class CurveFinder {
 public:
  CurveFinder(const CurvePart& part, const ObjectRay& ray) : part_(part), frame_(ray), curve_(part, frame_) {}

  std::optional<CurveHit> find() {
    if (!curve_.may_be_hit()) return std::nullopt;
    curve_.find_powers();
    const Quintic approach = curve_.approach();
    const bool is_round = part_.shape == CurveShape::kRound;
    const auto test = [&](double u) { is_round ? test_round(u) : test_flat(u); };
    if (starts_beyond(approach, is_round)) test(0);
    for_each_closest(curve_, approach, is_round ? kRoundTolerance : 1e-12, test);
    if (ends_before(approach, is_round)) test(1);
    return best_;
  }

 private:
  // Whether an end is the closest point, although the curve's continuation comes closer. A flat curve ends
  // there; a round one may still be hit, from aside.
  bool starts_beyond(const Quintic& approach, bool is_round) const {
    return approach[0] >= 0 && (is_round || approach[0] <= 3 * kEndTolerance * squared_step(0));
  }
  bool ends_before(const Quintic& approach, bool is_round) const {
    return approach[5] <= 0 && (is_round || -approach[5] <= 3 * kEndTolerance * squared_step(1));
  }
  double squared_step(double u) const {
    const double dx = curve_.x().slope(u) / 3, dy = curve_.y().slope(u) / 3;
    return dx * dx + dy * dy;
  }

  void test_flat(double u) {
    const CurvePlace at(curve_, u);
    double half_width = at.radius;
    if (part_.shape == CurveShape::kRibbon) half_width *= facing(u);
    const double distance2 = at.point.x * at.point.x + at.point.y * at.point.y;
    if (!(half_width > 0 && distance2 <= half_width * half_width)) return;
    offer(u, at.point.z, at, half_width);
  }

  // How much of a ribbon's width the ray sees.
  double facing(double u) const {
    const Vec3d normal = (1 - u) * part_.normals[0] + u * part_.normals[1];
    return std::fabs(dot(normal, frame_.along)) / length(normal);
  }

  void test_round(double u) {
    const double x = curve_.x().value(u), y = curve_.y().value(u), r = curve_.max_radius();
    const double dx = kRoundTolerance * curve_.x().slope(u), dy = kRoundTolerance * curve_.y().slope(u);
    if (!(x * x + y * y <= r * r * (1 + 1e-9) + dx * dx + dy * dy)) return;
    const auto entry = enter_round(curve_, u);
    if (!entry || !(entry->u >= -kEndTolerance && entry->u <= 1 + kEndTolerance)) return;
    const CurvePlace at(curve_, entry->u);
    offer(entry->u, entry->depth, at, at.radius);
  }

  void offer(double u, double depth, const CurvePlace& at, double half_width) {
    const double size = std::fabs(at.point.x) + std::fabs(at.point.y) + std::fabs(at.point.z) + half_width;
    if (!(depth > 1e-13 * size)) return;
    const double t = depth / frame_.direction_length;
    if (best_ && !(t < best_->t)) return;
    best_ = CurveHit{t, std::clamp(u, 0.0, 1.0), across_of(at.point, at.tangent, half_width)};
  }

  const CurvePart& part_;
  CurveFrame frame_;
  SeenCurve curve_;
  std::optional<CurveHit> best_;
};

// Bounds on the error of a point: rounding, and that of the iteration.
Vec3d curve_error_terms(const CurvePart& part) {
  constexpr double kIteration = 1 << 14;
  const double radius = part.max_radius();
  Vec3d terms{};
  for (const Vec3d& p : part.points) {
    const Vec3d size = abs(p);
    terms = {std::max(terms.x, size.x), std::max(terms.y, size.y), std::max(terms.z, size.z)};
  }
  return kIteration * (terms + Vec3d{radius, radius, radius});
}

Vec3d value_at(const CurvePart& part, double u) {
  const double v = 1 - u;
  return v * v * v * part.points[0] + 3 * u * v * v * part.points[1] + 3 * u * u * v * part.points[2] +
         u * u * u * part.points[3];
}

Vec3d scaled_to_unit(Vec3d v) {
  const double size = length(v);
  return size > 0 ? (1 / size) * v : Vec3d{};
}

ObjectPointOf<float> point_of_round(const CurvePart& part, const ObjectRay& ray, double u) {
  const CurveFrame frame(ray);
  SeenCurve curve(part, frame);
  curve.find_powers();
  const auto entry = enter_round(curve, u);  // `u` was rounded
  const double exact_u = entry ? entry->u : u;
  const CurvePlace at(curve, exact_u);
  const double s = entry ? entry->depth - at.point.z : -at.radius;
  const Vec3d arm{-at.point.x, -at.point.y, s};
  const Vec3d outward = scaled_to_unit(arm);
  // The normal leans back where the radius grows, by its growth over the length of the surface there.
  const Vec3d along = scaled_to_unit(at.tangent);
  const double speed = length(at.tangent);
  const double surface_speed = std::max(speed - dot(arm, at.bend) / speed, 0.1 * speed);

  ObjectPointOf<float> point;
  point.position = value_at(part, exact_u) + frame.to_object(at.radius * outward);
  point.terms = curve_error_terms(part);
  const Vec3d normal = frame.to_object(outward - at.radius_slope / surface_speed * along);
  // It faces the ray, which enters.
  point.geometric_normal = dot(normal, frame.along) <= 0 ? normal : -1.0 * frame.along;
  point.shading_normal = {};
  return point;
}

// Rays leave from twice the width before or behind the ribbon, so that it does not shadow itself when it
// turns to them (as in Pharr et al. 2023).
ObjectPointOf<float> point_of_flat(const CurvePart& part, const ObjectRay& ray, double u) {
  const CurveFrame frame(ray);
  SeenCurve curve(part, frame);
  curve.find_powers();
  const CurvePlace at(curve, u);
  ObjectPointOf<float> point;
  point.position = value_at(part, u) + frame.to_object({-at.point.x, -at.point.y, 0});
  const double thickness = 2 * at.radius / gamma<double>(16);
  point.terms = curve_error_terms(part) + Vec3d{thickness, thickness, thickness};
  const Vec3d along = frame.to_object(scaled_to_unit(at.tangent));
  const Vec3d facing = part.shape == CurveShape::kRibbon ? (1 - u) * part.normals[0] + u * part.normals[1]
                                                         : -1.0 * frame.along;
  const Vec3d normal = facing - dot(facing, along) * along;
  point.geometric_normal = length(normal) > 1e-9 * length(facing) ? normal : facing;
  point.shading_normal = {};
  return point;
}

}  // namespace

double CurvePart::max_radius() const {
  return std::max({radii[0], radii[1], radii[2], radii[3], 0.0});
}

Aabb CurvePart::bounds() const {
  const double radius = max_radius();
  if (!(radius > 0)) return {};
  Aabb box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] =
        std::minmax({points[0][axis], points[1][axis], points[2][axis], points[3][axis]});
    const double slack = 1e-6 * (high - low + radius) + 1e-12 * (std::fabs(low) + std::fabs(high));
    box.lower[axis] = rounded_down(low - radius - slack);
    box.upper[axis] = -rounded_down(-(high + radius + slack));
  }
  return box;
}

std::optional<CurveHit> intersect_curve(const CurvePart& part, const ObjectRay& ray) {
  return CurveFinder(part, ray).find();
}

ObjectPointOf<float> point_of_curve(const CurvePart& part, const ObjectRay& ray, float u) {
  return part.shape == CurveShape::kRound ? point_of_round(part, ray, double{u})
                                          : point_of_flat(part, ray, double{u});
}

Vec3d curve_tangent(const CurvePart& part, double u) {
  const double v = 1 - u;
  const auto& p = part.points;
  return 3.0 * (v * v * (p[1] - p[0]) + 2 * u * v * (p[2] - p[1]) + u * u * (p[3] - p[2]));
}

double curve_radius(const CurvePart& part, double u) {
  return CubicPowers(part.radii[0], part.radii[1], part.radii[2], part.radii[3]).value(u);
}

CurveTube tube_around(const CurvePart& part) {
  const Vec3 start = part.points[0].rounded(), end = part.points[3].rounded();
  const Vec3d axis = Vec3d(end) - Vec3d(start);
  const double axis_length2 = dot(axis, axis);
  double farthest = 0;
  for (const Vec3d& p : part.points) {
    const Vec3d from = p - Vec3d(start);
    const double foot = axis_length2 > 0 ? dot(from, axis) / axis_length2 : 0;
    farthest = std::max(farthest, length(from - foot * axis));
  }
  const double radius = (farthest + part.max_radius()) * (1 + 1e-4);
  return {start, end, -rounded_down(-radius)};
}

}  // namespace tessera::core
