// SPDX-License-Identifier: Apache-2.0
// All curves of a scene or object: control points, and references to the parts of their segments that rays
// are tested against. A part is a segment, or a half, quarter or eighth of a long, thin or bent one, so that
// its bounds are tight. Immutable while rendering.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/prefetch.hpp"
#include "core/geometry/curve.hpp"
#include "core/geometry/disk.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

enum class CurveBasis : std::uint8_t { kLinear, kBezier, kBSpline, kCatmullRom };

// A segment has the control points [step * i, step * i + points) of its curve.
struct CurveStride {
  std::uint32_t points, step;
};
CurveStride stride_of(CurveBasis basis);
// The number of segments of a curve with so many control points; nothing if there is no such curve.
std::optional<std::uint32_t> segments_of(CurveBasis basis, std::uint64_t points);

// Curves, one behind the other.
struct CurveStrands {
  CurveBasis basis = CurveBasis::kBSpline;
  CurveShape shape = CurveShape::kRound;
  std::vector<Vec3> points{};           // control points
  std::vector<float> radii{};           // one per control point, or one for all
  std::vector<std::uint32_t> counts{};  // the number of control points of each curve
  std::vector<Vec3> normals{};          // of ribbons: one per end of a segment of each curve; else empty
};
// The number of segments, provided that each curve has any.
std::uint64_t segment_count(const CurveStrands& strands);

// A box that contains all curves.
Aabb bounds_of(const CurveStrands& strands);

// A segment becomes at most so many parts.
inline constexpr std::uint32_t kMaxCurveParts = 8;

class Curves {
 public:
  // Whether every count makes a curve, and the arrays are as long as they must be.
  static bool is_sound(const CurveStrands& strands);
  // Appends curves, which must be sound.
  void add(const CurveStrands& strands, std::uint32_t material);

  std::uint32_t part_count() const { return static_cast<std::uint32_t>(parts_.size()); }
  std::uint32_t material(std::uint32_t number) const { return sets_[set_of(parts_[number].source)].material; }
  CurvePart part(std::uint32_t number) const { return part(number, source(number)); }

  // Where the control points of a part are, for callers that keep it and look them up early.
  struct Source {
    std::uint32_t first_point;
    std::uint32_t set_and_code;  // the code in the lowest four bits
  };
  Source source(std::uint32_t number) const { return parts_[number].source; }
  CurvePart part(std::uint32_t number, Source source) const;
  // Prefetches what material() and source() read.
  void prefetch_part(std::uint32_t number) const { prefetch(parts_[number]); }
  void prefetch_points(Source source) const {
    const std::size_t count = std::min<std::size_t>(4, points_.size() - source.first_point);
    prefetch_bytes(std::as_bytes(std::span(&points_[source.first_point], count)));
  }

  // The surface at a hit, of which `u` and `across` are CurveHit's. The texture coordinates are the share of
  // the curve's segments, and (1 + across) / 2.
  ObjectPointOf<float> point(std::uint32_t number, const ObjectRay& ray, float u, float across) const;
  // The derivatives by the texture coordinates where the normal is `normal`; need not be perpendicular.
  WideDerivatives derivatives(std::uint32_t number, Vec3 normal, Vec2 uv) const;

 private:
  struct alignas(16) ControlPoint {
    float x, y, z, radius;
  };
  struct Set {
    CurveBasis basis;
    CurveShape shape;
    std::uint32_t material;
  };
  // A dyadic part of a segment: of 2^level parts, the one with number `code - 2^level`.
  struct Part {
    Source source;
    float begin, size;  // of the curve's texture coordinate u
  };
  static std::uint32_t set_of(Source source) { return source.set_and_code >> 4; }
  static std::uint32_t code_of(Source source) { return source.set_and_code & 15u; }

  void add_segment(const CurveStrands& strands, std::uint32_t first_point, float begin, float size,
                   std::uint32_t normal);
  void load(Source source, CurvePart& cubic) const;

  std::vector<ControlPoint> points_;
  std::vector<Set> sets_;
  std::vector<Part> parts_;
  std::vector<Vec3> normals_;                // of ribbons
  std::vector<std::uint32_t> part_normals_;  // for each part, up to the last ribbon's: its first normal
};

}  // namespace tessera::core
