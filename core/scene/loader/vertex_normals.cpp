// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/vertex_normals.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <tuple>

namespace tessera::core {
namespace {

// Where more triangles meet, edges are smoothed all the same: telling them apart takes the square of their
// number.
constexpr std::size_t kMaxCreaseTriangles = 256;

AreaNormal operator+(const AreaNormal& a, const AreaNormal& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

// The corners grouped by position: those of `p` are corners[begin[p]] to corners[begin[p + 1]].
struct CornersByPosition {
  std::vector<std::uint32_t> begin, corners;

  std::span<const std::uint32_t> at(std::size_t position) const {
    return std::span(corners).subspan(begin[position], begin[position + 1] - begin[position]);
  }
};

CornersByPosition sort_by_position(const ObjFile& file) {
  const auto& positions = file.corners.positions;
  CornersByPosition sorted;
  auto& begin = sorted.begin;
  // Counts are shifted by one entry, so that filling the list moves each entry to its final value.
  begin.assign(file.text.positions.size() + 2, 0);
  for (const std::int32_t p : positions) ++begin[static_cast<std::size_t>(p) + 2];
  for (std::size_t p = 2; p < begin.size(); ++p) begin[p] += begin[p - 1];
  sorted.corners.resize(positions.size());
  for (std::uint32_t i = 0; i < positions.size(); ++i)
    sorted.corners[begin[static_cast<std::size_t>(positions[i]) + 1]++] = i;
  return sorted;
}

// A corner at the current position, and its triangle.
struct Around {
  std::optional<std::uint32_t> group;
  std::uint32_t corner;
  AreaNormal area_normal;
  Vec3 unit_normal;
  Vec3 result;
};

class NormalComputer {
 public:
  NormalComputer(const ObjFile& file, Smoothing smoothing) : file_(file), smoothing_(smoothing) {}

  ComputedNormals compute();

 private:
  void gather(std::span<const std::uint32_t> corners);
  void at_position();
  void settle_group(std::span<Around> group) const;
  void number();

  const ObjFile& file_;
  Smoothing smoothing_;
  std::vector<Around> around_;  // of one position; kept to reuse its memory
  ComputedNormals result_;
};

ComputedNormals NormalComputer::compute() {
  result_.of_corners.resize(file_.corners.positions.size());
  result_.normals.reserve(file_.text.positions.size());
  const CornersByPosition sorted = sort_by_position(file_);
  for (std::size_t p = 0; p < file_.text.positions.size(); ++p) {
    gather(sorted.at(p));
    at_position();
    number();
  }
  return std::move(result_);
}

void NormalComputer::gather(std::span<const std::uint32_t> corners) {
  around_.clear();
  for (const std::uint32_t corner : corners) {
    const std::size_t triangle = corner / 3;
    const auto position = [&](std::size_t k) {
      return file_.text.positions[static_cast<std::size_t>(file_.corners.positions[3 * triangle + k])];
    };
    const AreaNormal normal = area_normal(position(0), position(1), position(2));
    around_.push_back({std::nullopt, corner, normal, unit(normal), {}});
    if (smoothing_ == Smoothing::kByFile) around_.back().group = file_.run_of(triangle).smoothing_group;
  }
}

void NormalComputer::at_position() {
  std::sort(around_.begin(), around_.end(), [](const Around& a, const Around& b) {
    return std::tie(a.group, a.corner) < std::tie(b.group, b.corner);
  });
  for (auto begin = around_.begin(); begin != around_.end();) {
    const auto end =
        std::find_if(begin, around_.end(), [&](const Around& a) { return a.group != begin->group; });
    settle_group({begin, end});
    begin = end;
  }
}

void NormalComputer::settle_group(std::span<Around> group) const {
  const bool flat = group.front().group == 0u;
  const bool creases =
      smoothing_ == Smoothing::kByFile && !group.front().group && group.size() <= kMaxCreaseTriangles;
  AreaNormal all;
  for (const Around& a : group) all = all + a.area_normal;
  for (Around& a : group) {
    AreaNormal sum = all;
    if (creases) {
      sum = {};
      for (const Around& b : group)
        if (dot(b.unit_normal, a.unit_normal) >= kCreaseCosine) sum = sum + b.area_normal;
    }
    a.result = flat ? a.unit_normal : unit(sum);
    // Around a two-sided sheet, all normals cancel.
    if (a.result == Vec3{}) a.result = a.unit_normal;
    if (a.result == Vec3{}) a.result = {0, 0, 1};
  }
}

// Gives equal normals at one position the same index, so that smooth surfaces share vertices.
void NormalComputer::number() {
  const auto key = [](const Around& a) { return std::tie(a.result.x, a.result.y, a.result.z, a.corner); };
  std::sort(around_.begin(), around_.end(),
            [&](const Around& a, const Around& b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < around_.size(); ++i) {
    if (i == 0 || around_[i].result != around_[i - 1].result) result_.normals.push_back(around_[i].result);
    result_.of_corners[around_[i].corner] = static_cast<std::int32_t>(result_.normals.size()) - 1;
  }
}

}  // namespace

AreaNormal area_normal(Vec3 a, Vec3 b, Vec3 c) {
  const AreaNormal u{double{b.x} - a.x, double{b.y} - a.y, double{b.z} - a.z};
  const AreaNormal v{double{c.x} - a.x, double{c.y} - a.y, double{c.z} - a.z};
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

Vec3 unit(const AreaNormal& v) {
  const double largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  if (largest == 0) return {};
  const double x = v.x / largest, y = v.y / largest, z = v.z / largest;
  const double norm = std::sqrt(x * x + y * y + z * z);
  return {static_cast<float>(x / norm), static_cast<float>(y / norm), static_cast<float>(z / norm)};
}

ComputedNormals compute_normals(const ObjFile& file, Smoothing smoothing) {
  return NormalComputer(file, smoothing).compute();
}

VertexTangent transformed(const VertexTangent& tangent, const Transform& transform) {
  const auto unit_of = [](Vec3 v) { return unit({v.x, v.y, v.z}); };
  // Unit length first, so that the products do not overflow.
  const Vec3 direction = unit_of(transform.direction(unit_of(tangent.direction)));
  return {direction, transform.determinant() < 0 ? -tangent.handedness : tangent.handedness};
}

}  // namespace tessera::core
