#include "core/scene/loader/mesh_builder.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace tessera::core {
namespace {

using Corner = ObjFile::Corner;
using Double3 = std::array<double, 3>;

Double3 difference(Vec3 a, Vec3 b) {
  return {double{a.x} - b.x, double{a.y} - b.y, double{a.z} - b.z};
}

// Twice the area times the normal of a triangle. In double precision, so that no triangle is too small or too
// large.
Double3 area_normal(Vec3 a, Vec3 b, Vec3 c) {
  const Double3 u = difference(b, a), v = difference(c, a);
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

// Of unit length; the zero vector stays.
Vec3 unit(const Double3& v) {
  const double largest = std::max({std::fabs(v[0]), std::fabs(v[1]), std::fabs(v[2])});
  if (largest == 0) return {};
  const Double3 scaled{v[0] / largest, v[1] / largest, v[2] / largest};
  const double norm = std::sqrt(scaled[0] * scaled[0] + scaled[1] * scaled[1] + scaled[2] * scaled[2]);
  return {static_cast<float>(scaled[0] / norm), static_cast<float>(scaled[1] / norm),
          static_cast<float>(scaled[2] / norm)};
}

// Gives each distinct corner a number, in the order of their first appearance. An open hash table.
class CornerIndex {
 public:
  explicit CornerIndex(std::size_t expected) : slots_(std::bit_ceil(2 * expected + 16), kEmpty) {}

  std::uint32_t number(const Corner& corner) {
    std::size_t slot = hash(corner) & (slots_.size() - 1);
    while (slots_[slot] != kEmpty && !(corners_[slots_[slot]] == corner))
      slot = (slot + 1) & (slots_.size() - 1);
    if (slots_[slot] == kEmpty) {
      slots_[slot] = static_cast<std::uint32_t>(corners_.size());
      corners_.push_back(corner);
    }
    const std::uint32_t found = slots_[slot];
    if (2 * corners_.size() > slots_.size()) grow();
    return found;
  }

  const std::vector<Corner>& corners() const { return corners_; }

 private:
  static constexpr std::uint32_t kEmpty = 0xffffffffu;

  static std::size_t hash(const Corner& corner) {
    std::uint64_t h = static_cast<std::uint32_t>(corner.position);
    h = (h ^ static_cast<std::uint64_t>(static_cast<std::uint32_t>(corner.uv)) << 32) * 0x9e3779b97f4a7c15u;
    h = (h ^ h >> 32 ^ static_cast<std::uint32_t>(corner.normal)) * 0xd6e8feb86659fd93u;
    return h ^ h >> 32;
  }

  void grow() {
    slots_.assign(2 * slots_.size(), kEmpty);
    for (std::uint32_t i = 0; i < corners_.size(); ++i) {
      std::size_t slot = hash(corners_[i]) & (slots_.size() - 1);
      while (slots_[slot] != kEmpty) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = i;
    }
  }

  std::vector<std::uint32_t> slots_;
  std::vector<Corner> corners_;
};

// Area-weighted means of the normals around each of the file's positions, in the file's space. A position
// whose faces cancel out, as those of a sheet with two sides do, takes the normal of one of them.
std::vector<Vec3> smooth_normals(const ObjFile& file) {
  const auto& positions = file.text.positions;
  std::vector<Double3> sums(positions.size(), Double3{});
  std::vector<Vec3> any(positions.size());
  for (std::size_t i = 0; i < file.corners.size(); i += 3) {
    const auto index = [&](std::size_t k) { return static_cast<std::size_t>(file.corners[i + k].position); };
    const Double3 n = area_normal(positions[index(0)], positions[index(1)], positions[index(2)]);
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t axis = 0; axis < 3; ++axis) sums[index(k)][axis] += n[axis];
      if (any[index(k)] == Vec3{}) any[index(k)] = unit(n);
    }
  }
  std::vector<Vec3> normals(positions.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    normals[i] = unit(sums[i]);
    if (normals[i] == Vec3{}) normals[i] = any[i] == Vec3{} ? Vec3{0, 0, 1} : any[i];
  }
  return normals;
}

// Outward stays outward, for mirrored maps as well.
Vec3 transformed_normal(const Transform& transform, Vec3 file_normal) {
  const Vec3 normal = unit({file_normal.x, file_normal.y, file_normal.z});
  const Vec3 n = transform.determinant() < 0 ? -transform.normal(normal) : transform.normal(normal);
  return unit({n.x, n.y, n.z});
}

bool has_area(const MeshDescription& mesh, const std::array<std::uint32_t, 3>& t) {
  return area_normal(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]) != Double3{};
}

class MeshBuilder {
 public:
  MeshBuilder(const ObjFile& file, NormalsMode mode, const Transform& transform)
      : file_(file), mode_(mode), transform_(transform), vertices_(file.text.positions.size()) {}

  Result<MeshDescription> build(const std::vector<std::uint32_t>& materials);

 private:
  // What of a corner tells vertices apart.
  Corner key(const Corner& corner) const {
    return {corner.position, corner.uv, mode_ == NormalsMode::kFile ? corner.normal : -1};
  }
  bool lacks_normals() const;
  void fill_vertices();
  void fill_normals();

  const ObjFile& file_;
  NormalsMode mode_;
  Transform transform_;
  CornerIndex vertices_;
  MeshDescription mesh_;
};

Result<MeshDescription> MeshBuilder::build(const std::vector<std::uint32_t>& materials) {
  std::vector<std::uint32_t> indices;
  indices.reserve(file_.corners.size());
  for (const Corner& corner : file_.corners) indices.push_back(vertices_.number(key(corner)));
  fill_vertices();
  if (mode_ != NormalsMode::kFlat) fill_normals();
  if (!std::all_of(mesh_.positions.begin(), mesh_.positions.end(), [](Vec3 p) { return is_finite(p); }))
    return fail(ErrorCode::kInvalidArgument, "reaches farther than can be computed after its transform");
  const bool mirrored = transform_.determinant() < 0;
  const bool one_material = materials.size() == 1;
  for (std::size_t t = 0; t < file_.triangle_materials.size(); ++t) {
    const std::array<std::uint32_t, 3> corners{indices[3 * t], indices[3 * t + (mirrored ? 2 : 1)],
                                               indices[3 * t + (mirrored ? 1 : 2)]};
    if (!has_area(mesh_, corners)) continue;
    mesh_.triangles.push_back(corners);
    if (!one_material) mesh_.triangle_materials.push_back(materials[file_.triangle_materials[t]]);
  }
  if (one_material) mesh_.triangle_materials = materials;
  if (mesh_.triangles.empty())
    return fail(ErrorCode::kInvalidArgument, "has no face with an area greater than 0");
  return std::move(mesh_);
}

void MeshBuilder::fill_vertices() {
  const auto& corners = vertices_.corners();
  mesh_.positions.reserve(corners.size());
  for (const Corner& corner : corners)
    mesh_.positions.push_back(
        transform_.point(file_.text.positions[static_cast<std::size_t>(corner.position)]));
  if (std::all_of(corners.begin(), corners.end(), [](const Corner& c) { return c.uv < 0; })) return;
  mesh_.uvs.reserve(corners.size());
  for (const Corner& corner : corners)
    mesh_.uvs.push_back(corner.uv < 0 ? Vec2{} : file_.text.uvs[static_cast<std::size_t>(corner.uv)]);
}

bool is_zero(Vec3 v) {
  return v == Vec3{};
}

bool MeshBuilder::lacks_normals() const {
  return std::any_of(vertices_.corners().begin(), vertices_.corners().end(), [&](const Corner& c) {
    return c.normal < 0 || is_zero(file_.text.normals[static_cast<std::size_t>(c.normal)]);
  });
}

void MeshBuilder::fill_normals() {
  const std::vector<Vec3> computed = lacks_normals() ? smooth_normals(file_) : std::vector<Vec3>{};
  mesh_.normals.reserve(vertices_.corners().size());
  for (const Corner& corner : vertices_.corners()) {
    Vec3 normal;
    if (corner.normal >= 0) normal = file_.text.normals[static_cast<std::size_t>(corner.normal)];
    if (is_zero(normal)) normal = computed[static_cast<std::size_t>(corner.position)];
    mesh_.normals.push_back(transformed_normal(transform_, normal));
  }
}

}  // namespace

Result<MeshDescription> build_mesh(const ObjFile& file, NormalsMode normals, const Transform& transform,
                                   const std::vector<std::uint32_t>& materials) {
  return MeshBuilder(file, normals, transform).build(materials);
}

}  // namespace tessera::core
