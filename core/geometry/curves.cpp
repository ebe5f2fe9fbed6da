// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/curves.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/math/simd.hpp"

namespace tessera::core {
namespace {

using Weights = std::array<std::array<double, 4>, 4>;  // of each Bezier point, by the segment's points

constexpr Weights bezier_weights(CurveBasis basis) {
  constexpr double kThird = 1.0 / 3, kSixth = 1.0 / 6;
  switch (basis) {
    case CurveBasis::kLinear:
      return {{{1, 0, 0, 0}, {2 * kThird, kThird, 0, 0}, {kThird, 2 * kThird, 0, 0}, {0, 1, 0, 0}}};
    case CurveBasis::kBezier:
      break;
    case CurveBasis::kBSpline:
      return {{{kSixth, 4 * kSixth, kSixth, 0},
               {0, 2 * kThird, kThird, 0},
               {0, kThird, 2 * kThird, 0},
               {0, kSixth, 4 * kSixth, kSixth}}};
    case CurveBasis::kCatmullRom:
      return {{{0, 1, 0, 0}, {-kSixth, 1, kSixth, 0}, {0, kSixth, 1, -kSixth}, {0, 0, 1, 0}}};
  }
  return {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
}

// The blossom of a Bezier curve (Ramshaw 1987): the weights of its control points.
constexpr std::array<double, 4> blossom(double a, double b, double c) {
  const double x = 1 - a, y = 1 - b, z = 1 - c;
  return {x * y * z, a * y * z + x * b * z + x * y * c, a * b * z + a * y * c + x * b * c, a * b * c};
}

constexpr Weights part_weights(CurveBasis basis, double begin, double end) {
  const Weights whole = bezier_weights(basis);
  const Weights of_bezier = {blossom(begin, begin, begin), blossom(begin, begin, end),
                             blossom(begin, end, end), blossom(end, end, end)};
  Weights weights{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t k = 0; k < 4; ++k) weights[i][k] += of_bezier[i][j] * whole[j][k];
  return weights;
}

constexpr std::size_t kBases = 4, kCodes = 2 * kMaxCurveParts;

constexpr std::array<std::array<Weights, kCodes>, kBases> all_part_weights() {
  std::array<std::array<Weights, kCodes>, kBases> all{};
  for (std::size_t basis = 0; basis < kBases; ++basis)
    for (std::size_t parts = 1; parts <= kMaxCurveParts; parts *= 2)
      for (std::size_t i = 0; i < parts; ++i)
        all[basis][parts + i] =
            part_weights(static_cast<CurveBasis>(basis), static_cast<double>(i) / static_cast<double>(parts),
                         static_cast<double>(i + 1) / static_cast<double>(parts));
  return all;
}

constexpr auto kPartWeights = all_part_weights();

// Whether the part is short for its width and bends little.
bool is_compact(const CurvePart& part) {
  constexpr double kMaxLengthInWidths = 12, kMinCosine = 0.85;
  Vec3d steps[3];
  double polygon = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    steps[i] = part.points[i + 1] - part.points[i];
    polygon += length(steps[i]);
  }
  for (std::size_t i = 0; i < 2; ++i)
    if (!(dot(steps[i], steps[i + 1]) >= kMinCosine * length(steps[i]) * length(steps[i + 1]))) return false;
  return polygon <= kMaxLengthInWidths * 2 * part.max_radius();
}

}  // namespace

CurveStride stride_of(CurveBasis basis) {
  switch (basis) {
    case CurveBasis::kLinear:
      return {2, 1};
    case CurveBasis::kBezier:
      return {4, 3};
    case CurveBasis::kBSpline:
    case CurveBasis::kCatmullRom:
      break;
  }
  return {4, 1};
}

std::optional<std::uint32_t> segments_of(CurveBasis basis, std::uint64_t points) {
  const CurveStride stride = stride_of(basis);
  if (points < stride.points || points > 0xffffffffu) return std::nullopt;
  const std::uint64_t rest = points - stride.points;
  if (rest % stride.step != 0) return std::nullopt;
  return static_cast<std::uint32_t>(rest / stride.step + 1);
}

std::uint64_t segment_count(const CurveStrands& strands) {
  std::uint64_t sum = 0;
  for (const std::uint32_t count : strands.counts) sum += segments_of(strands.basis, count).value_or(0);
  return sum;
}

// A Catmull-Rom spline leaves the hull of its control points by a sixth of their distances at most.
Aabb bounds_of(const CurveStrands& strands) {
  Aabb box;
  float radius = 0;
  for (const Vec3 p : strands.points) box.include(p);
  for (const float r : strands.radii) radius = std::max(radius, r);
  if (box.empty()) return box;
  const float beyond = strands.basis == CurveBasis::kCatmullRom ? 1.0f / 3 : 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float reach = (1 + beyond) * radius + beyond * static_cast<float>(box.extent(axis));
    box.lower[axis] -= reach;
    box.upper[axis] += reach;
  }
  return box;
}

bool Curves::is_sound(const CurveStrands& strands) {
  std::uint64_t points = 0, ends = 0;
  for (const std::uint32_t count : strands.counts) {
    const auto segments = segments_of(strands.basis, count);
    if (!segments) return false;
    points += count;
    ends += std::uint64_t{*segments} + 1;
  }
  const std::size_t normals = strands.normals.size();
  return points == strands.points.size() && (strands.radii.size() == 1 || strands.radii.size() == points) &&
         (strands.shape == CurveShape::kRibbon ? normals == ends : normals == 0);
}

void Curves::add(const CurveStrands& strands, std::uint32_t material) {
  const auto first = static_cast<std::uint32_t>(points_.size());
  if (points_.empty()) points_.reserve(strands.points.size());  // more would copy all for each addition
  for (std::size_t i = 0; i < strands.points.size(); ++i) {
    const Vec3 p = strands.points[i];
    points_.push_back({p.x, p.y, p.z, strands.radii.size() == 1 ? strands.radii[0] : strands.radii[i]});
  }
  sets_.push_back({strands.basis, strands.shape, material});
  auto normal = static_cast<std::uint32_t>(normals_.size());
  normals_.insert(normals_.end(), strands.normals.begin(), strands.normals.end());
  const std::uint32_t step = stride_of(strands.basis).step;
  std::uint32_t point = first;
  for (const std::uint32_t count : strands.counts) {
    const std::uint32_t segments = *segments_of(strands.basis, count);
    const float size = 1 / static_cast<float>(segments);
    for (std::uint32_t i = 0; i < segments; ++i)
      add_segment(strands, point + i * step, static_cast<float>(i) * size, size, normal + i);
    point += count;
    normal += segments + 1;
  }
}

// Divides the segment until all its parts are compact.
void Curves::add_segment(const CurveStrands& strands, std::uint32_t first_point, float begin, float size,
                         std::uint32_t normal) {
  const auto set = static_cast<std::uint32_t>(sets_.size()) - 1;
  const auto part_at = [&](std::uint32_t parts, std::uint32_t i) {
    const float part_size = size / static_cast<float>(parts);
    return Part{{first_point, set << 4 | (parts + i)}, begin + static_cast<float>(i) * part_size, part_size};
  };
  std::uint32_t parts = 1;
  const auto are_compact = [&] {
    for (std::uint32_t i = 0; i < parts; ++i) {
      CurvePart cubic{};
      load(part_at(parts, i).source, cubic);
      if (!is_compact(cubic)) return false;
    }
    return true;
  };
  while (parts < kMaxCurveParts && !are_compact()) parts *= 2;
  const bool is_ribbon = strands.shape == CurveShape::kRibbon;
  if (is_ribbon) part_normals_.resize(parts_.size());
  for (std::uint32_t i = 0; i < parts; ++i) {
    parts_.push_back(part_at(parts, i));
    if (is_ribbon) part_normals_.push_back(normal);
  }
}

// The control points and radii; normals are left out.
void Curves::load(Source source, CurvePart& cubic) const {
  const Set& set = sets_[set_of(source)];
  const Weights& weights = kPartWeights[static_cast<std::size_t>(set.basis)][code_of(source)];
  const ControlPoint* const points = &points_[source.first_point];
  const std::size_t count = stride_of(set.basis).points;
  for (std::size_t i = 0; i < 4; ++i) {
    DoubleHalf sum = DoubleHalf(weights[i][0]) * DoubleHalf::load(&points[0].x) +
                     DoubleHalf(weights[i][1]) * DoubleHalf::load(&points[1].x);
    for (std::size_t k = 2; k < count; ++k)
      sum = sum + DoubleHalf(weights[i][k]) * DoubleHalf::load(&points[k].x);
    alignas(32) double values[4];
    sum.store(values);
    cubic.points[i] = {values[0], values[1], values[2]};
    cubic.radii[i] = values[3];
  }
  cubic.shape = set.shape;
}

CurvePart Curves::part(std::uint32_t number, Source source) const {
  CurvePart cubic;
  load(source, cubic);
  if (cubic.shape == CurveShape::kRibbon) {
    const std::uint32_t code = code_of(source), parts = std::bit_floor(code);
    const double begin = static_cast<double>(code - parts) / parts, end = begin + 1.0 / parts;
    const Vec3d first(normals_[part_normals_[number]]), second(normals_[part_normals_[number] + 1]);
    cubic.normals = {(1 - begin) * first + begin * second, (1 - end) * first + end * second};
  }
  return cubic;
}

ObjectPointOf<float> Curves::point(std::uint32_t number, const ObjectRay& ray, float u, float across) const {
  ObjectPointOf<float> point = point_of_curve(part(number), ray, u);
  point.uv = {parts_[number].begin + u * parts_[number].size, 0.5f + 0.5f * across};
  return point;
}

WideDerivatives Curves::derivatives(std::uint32_t number, Vec3 normal, Vec2 uv) const {
  const Part& part = parts_[number];
  const CurvePart cubic = this->part(number);
  const double u = std::clamp(double{(uv.x - part.begin) / part.size}, 0.0, 1.0);
  const Vec3d tangent = curve_tangent(cubic, u);
  const Vec3d across = cross(Vec3d(normal), tangent);
  const double across_length = length(across);
  const double width = across_length > 0 ? 2 * curve_radius(cubic, u) / across_length : 0;
  return {(1 / double{part.size}) * tangent, width * across};
}

}  // namespace tessera::core
