// SPDX-License-Identifier: Apache-2.0
// Both shapes begin at the points of the part that are locally closest to the ray: minima of the distance in
// the plane across the ray, where c . c' = 0. This is a polynomial of degree 5, whose roots are isolated in
// the Bernstein basis by Descartes' rule of signs (Lane and Riesenfeld 1981). A flat curve is hit at such a
// point if it is within the radius. For a round one, the ray is intersected with the cone that touches the
// surface there, and the point moved to where that hit belongs, until it stays (after Reshetov and Luebke
// 2018, whose iteration starts from the ends of the curve).
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/geometry/curve.hpp"
#include "core/geometry/seen_curve.hpp"

namespace tessera::core {
namespace {

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
    for_each_closest(curve_, approach, is_round ? kRoundTolerance : 1e-12, [&](double u) {
      if (!(is_round && has_passed(u))) test(u);
    });
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

  // Whether the ray is inside of a round curve where it is closest to it, and that is behind the origin: so
  // it entered behind the origin, too. This holds for the curve that a ray has just left.
  bool has_passed(double u) const {
    const double x = curve_.x().value(u), y = curve_.y().value(u), r = curve_.r().value(u);
    return curve_.z().value(u) <= 0 && x * x + y * y < r * r;
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

}  // namespace

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

std::optional<CurveHit> intersect_curve(const CurvePart& part, const ObjectRay& ray) {
  return CurveFinder(part, ray).find();
}

}  // namespace tessera::core
