// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/curves.hpp"

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace tessera::core::pbrt {
namespace {

using Bezier = std::array<Vec3d, 4>;

Vec3d mean_of(Vec3d a, Vec3d b) {
  return 0.5 * (a + b);
}

// A quadratic curve as a cubic one.
Bezier elevated(Vec3d a, Vec3d b, Vec3d c) {
  constexpr double kThird = 1.0 / 3;
  return {a, kThird * (a + 2.0 * b), kThird * (2.0 * b + c), c};
}

// `points` are those of the segment: degree + 1.
Bezier bezier_of(const Vec3* points, int degree, bool is_spline) {
  const Vec3d a(points[0]), b(points[1]), c(points[2]);
  if (degree == 2) return is_spline ? elevated(mean_of(a, b), b, mean_of(b, c)) : elevated(a, b, c);
  const Vec3d d(points[3]);
  if (!is_spline) return {a, b, c, d};
  constexpr double kThird = 1.0 / 3, kSixth = 1.0 / 6;
  return {kSixth * (a + 4.0 * b + c), kThird * (2.0 * b + c), kThird * (b + 2.0 * c),
          kSixth * (b + 4.0 * c + d)};
}

// 0 if there is no curve with so many points.
std::size_t segments_with(std::size_t points, std::size_t degree, bool is_spline) {
  if (points < degree + 1) return 0;
  if (is_spline) return points - degree;
  return (points - 1) % degree == 0 ? (points - 1) / degree : 0;
}

CurveShape shape_of_type(const Parameters& p, const Report& report, std::size_t normals, std::size_t ends) {
  const std::string type = p.choice("type", "flat", {"flat", "cylinder", "ribbon"});
  if (type == "cylinder") return CurveShape::kRound;
  if (type == "ribbon" && normals == ends) return CurveShape::kRibbon;
  if (type == "ribbon") report.warn(p.place(), "a ribbon without a normal for each end of a segment is flat");
  return CurveShape::kFlat;
}

void add_segment(const Bezier& bezier, double first_radius, double last_radius, CurveStrands& strands) {
  for (std::size_t i = 0; i < 4; ++i) {
    strands.points.push_back(bezier[i].rounded());
    const double share = static_cast<double>(i) / 3;
    strands.radii.push_back(static_cast<float>((1 - share) * first_radius + share * last_radius));
  }
  strands.counts.push_back(4);
}

}  // namespace

std::optional<CurveStrands> read_curve(const Parameters& p, const Report& report) {
  const std::vector<Vec3> points = p.vectors("P"), normals = p.vectors("N");
  p.find("splitdepth");  // has no effect on the image
  const int degree = p.integer_in("degree", 3, 2, 3);
  const bool is_spline = p.choice("basis", "bezier", {"bezier", "bspline"}) == "bspline";
  const std::size_t segments = segments_with(points.size(), static_cast<std::size_t>(degree), is_spline);
  const float width = p.number("width", 1);
  const auto radius = [&](const char* name) { return static_cast<double>(p.number(name, width)) / 2; };
  const double first_radius = radius("width0"), last_radius = radius("width1");
  const bool has_width = first_radius >= 0 && last_radius >= 0 && first_radius + last_radius > 0;
  if (segments == 0 || !has_width || !std::isfinite(first_radius + last_radius)) {
    report.warn(p.place(), segments == 0 ? "a curve of a number of points that no segments have is left out"
                                         : "a curve without a width is left out");
    return std::nullopt;
  }
  CurveStrands strands{
      CurveBasis::kBezier, shape_of_type(p, report, normals.size(), segments + 1), {}, {}, {}, {}};
  const auto step = static_cast<std::size_t>(is_spline ? 1 : degree);
  for (std::size_t i = 0; i < segments; ++i) {
    const auto radius_at = [&](std::size_t end) {
      const double share = static_cast<double>(end) / static_cast<double>(segments);
      return (1 - share) * first_radius + share * last_radius;
    };
    add_segment(bezier_of(&points[i * step], degree, is_spline), radius_at(i), radius_at(i + 1), strands);
    if (strands.shape == CurveShape::kRibbon)
      strands.normals.insert(strands.normals.end(), {normals[i], normals[i + 1]});
  }
  return strands;
}

}  // namespace tessera::core::pbrt
