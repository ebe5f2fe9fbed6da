#include "core/scene/loader/triangle_filter.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <tuple>

#include "core/scene/loader/vertex_normals.hpp"

namespace tessera::core {
namespace {

using Points = std::array<Vec3, 3>;

bool is_before(Vec3 a, Vec3 b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

// The triangle's corners in their order, but from the same one on wherever the triangle begins.
Points points_of(const MeshDescription& mesh, const std::array<std::uint32_t, 3>& triangle) {
  Points points{mesh.positions[triangle[0]], mesh.positions[triangle[1]], mesh.positions[triangle[2]]};
  std::rotate(points.begin(), std::min_element(points.begin(), points.end(), is_before), points.end());
  return points;
}

std::size_t hash(const Points& points) {
  std::uint64_t h = 0;
  for (const Vec3 p : points)
    for (const float c : {p.x, p.y, p.z}) {
      // 0 and -0 are equal.
      h = (h ^ std::bit_cast<std::uint32_t>(c + 0.0f)) * 0x9e3779b97f4a7c15u;
      h ^= h >> 32;
    }
  return h;
}

// Triangles that are kept, by where they lie. An open hash table, four fifths full at most.
class KeptTriangles {
 public:
  explicit KeptTriangles(const MeshDescription& mesh)
      : mesh_(mesh), slots_(std::bit_ceil(mesh.triangles.size() + mesh.triangles.size() / 4 + 1), kEmpty) {}

  // False if an equal one is there; `index` is that of `triangle` in the mesh.
  bool add(const std::array<std::uint32_t, 3>& triangle, std::uint32_t index) {
    const Points points = points_of(mesh_, triangle);
    std::size_t slot = hash(points) & (slots_.size() - 1);
    while (slots_[slot] != kEmpty) {
      if (points_of(mesh_, mesh_.triangles[slots_[slot]]) == points) return false;
      slot = (slot + 1) & (slots_.size() - 1);
    }
    slots_[slot] = index;
    return true;
  }

 private:
  static constexpr std::uint32_t kEmpty = 0xffffffffu;

  const MeshDescription& mesh_;
  std::vector<std::uint32_t> slots_;
};

bool has_area(const MeshDescription& mesh, const std::array<std::uint32_t, 3>& t) {
  return area_normal(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]) != AreaNormal{};
}

}  // namespace

void remove_superfluous_triangles(MeshDescription& mesh) {
  KeptTriangles kept(mesh);
  const bool one_material = mesh.triangle_materials.size() == 1;
  std::size_t count = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto triangle = mesh.triangles[t];
    if (!has_area(mesh, triangle) || !kept.add(triangle, static_cast<std::uint32_t>(count))) continue;
    mesh.triangles[count] = triangle;
    if (!one_material) mesh.triangle_materials[count] = mesh.triangle_materials[t];
    ++count;
  }
  mesh.triangles.resize(count);
  if (!one_material) mesh.triangle_materials.resize(count);
}

}  // namespace tessera::core
