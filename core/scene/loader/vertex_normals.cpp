#include "core/scene/loader/vertex_normals.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

namespace tessera::core {
namespace {

// Where more triangles meet, edges are smoothed all the same: telling them apart takes the square of their
// number.
constexpr std::size_t kMaxCreaseTriangles = 256;

AreaNormal operator+(const AreaNormal& a, const AreaNormal& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

// The corners at each position, by position: those of `p` are corners[begin[p]] to corners[begin[p + 1]].
struct CornersByPosition {
  std::vector<std::uint32_t> begin, corners;

  std::span<const std::uint32_t> at(std::size_t position) const {
    return std::span(corners).subspan(begin[position], begin[position + 1] - begin[position]);
  }
};

CornersByPosition sort_by_position(const ObjFile& file) {
  CornersByPosition sorted;
  sorted.begin.assign(file.text.positions.size() + 1, 0);
  for (const auto& corner : file.corners) ++sorted.begin[static_cast<std::size_t>(corner.position) + 1];
  for (std::size_t p = 1; p < sorted.begin.size(); ++p) sorted.begin[p] += sorted.begin[p - 1];
  std::vector<std::uint32_t> next = sorted.begin;
  sorted.corners.resize(file.corners.size());
  for (std::uint32_t i = 0; i < file.corners.size(); ++i)
    sorted.corners[next[static_cast<std::size_t>(file.corners[i].position)]++] = i;
  return sorted;
}

class NormalComputer {
 public:
  NormalComputer(const ObjFile& file, float crease_cosine) : file_(file), crease_cosine_(crease_cosine) {}

  ComputedNormals compute();

 private:
  AreaNormal triangle_normal(std::uint32_t triangle) const;
  void at_position(std::span<const std::uint32_t> corners);
  AreaNormal sum_around(std::span<const std::uint32_t> corners, std::optional<std::uint32_t> triangle) const;
  std::int32_t number(Vec3 normal, std::size_t first);

  const ObjFile& file_;
  float crease_cosine_;
  std::vector<AreaNormal> area_normals_;
  std::vector<Vec3> unit_normals_;  // of triangles
  ComputedNormals result_;
};

ComputedNormals NormalComputer::compute() {
  const auto triangles = static_cast<std::uint32_t>(file_.triangle_materials.size());
  area_normals_.reserve(triangles);
  unit_normals_.reserve(triangles);
  for (std::uint32_t t = 0; t < triangles; ++t) {
    area_normals_.push_back(triangle_normal(t));
    unit_normals_.push_back(unit(area_normals_.back()));
  }
  result_.of_corners.resize(file_.corners.size());
  const CornersByPosition sorted = sort_by_position(file_);
  for (std::size_t p = 0; p < file_.text.positions.size(); ++p) at_position(sorted.at(p));
  return std::move(result_);
}

AreaNormal NormalComputer::triangle_normal(std::uint32_t triangle) const {
  const auto position = [&](std::size_t k) {
    return file_.text
        .positions[static_cast<std::size_t>(file_.corners[3 * std::size_t{triangle} + k].position)];
  };
  return area_normal(position(0), position(1), position(2));
}

void NormalComputer::at_position(std::span<const std::uint32_t> corners) {
  const std::size_t first = result_.normals.size();
  const bool creases = crease_cosine_ != kNoCreases && corners.size() <= kMaxCreaseTriangles;
  const AreaNormal all = creases ? AreaNormal{} : sum_around(corners, std::nullopt);
  for (const std::uint32_t corner : corners) {
    const std::uint32_t triangle = corner / 3;
    Vec3 normal = unit(creases ? sum_around(corners, triangle) : all);
    // Around a sheet with two sides everything cancels out.
    if (normal == Vec3{}) normal = unit_normals_[triangle];
    if (normal == Vec3{}) normal = {0, 0, 1};
    result_.of_corners[corner] = number(normal, first);
  }
}

// Over the triangles within the crease angle of one of them, or over all.
AreaNormal NormalComputer::sum_around(std::span<const std::uint32_t> corners,
                                      std::optional<std::uint32_t> triangle) const {
  AreaNormal sum;
  for (const std::uint32_t corner : corners)
    if (!triangle || dot(unit_normals_[corner / 3], unit_normals_[*triangle]) >= crease_cosine_)
      sum = sum + area_normals_[corner / 3];
  return sum;
}

// The place of `normal` among those of one position, which begin at `first`.
std::int32_t NormalComputer::number(Vec3 normal, std::size_t first) {
  auto& normals = result_.normals;
  const auto found = std::find(normals.begin() + static_cast<std::ptrdiff_t>(first), normals.end(), normal);
  const auto place = found - normals.begin();
  if (found == normals.end()) normals.push_back(normal);
  return static_cast<std::int32_t>(place);
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

ComputedNormals compute_normals(const ObjFile& file, float crease_cosine) {
  return NormalComputer(file, crease_cosine).compute();
}

}  // namespace tessera::core
