#include "core/scene/loader/mesh_builder.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "core/scene/loader/vertex_normals.hpp"

namespace tessera::core {
namespace {

using Corner = ObjFile::Corner;
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

// Outward stays outward, for mirrored maps as well.
Vec3 transformed_normal(const Transform& transform, Vec3 file_normal) {
  const Vec3 normal = unit({file_normal.x, file_normal.y, file_normal.z});
  const Vec3 n = transform.determinant() < 0 ? -transform.normal(normal) : transform.normal(normal);
  return unit({n.x, n.y, n.z});
}

bool is_zero(Vec3 v) {
  return v == Vec3{};
}

bool has_area(const MeshDescription& mesh, const std::array<std::uint32_t, 3>& t) {
  return area_normal(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]) != AreaNormal{};
}

// The corners with their normals settled: those of the file, or those computed, or none.
struct ShadedCorners {
  std::vector<Corner> corners;
  std::vector<Vec3> normals;  // that the corners refer to
};

ShadedCorners settle_normals(const ObjFile& file, NormalsMode mode) {
  ShadedCorners shaded{file.corners, {}};
  if (mode == NormalsMode::kFile) shaded.normals = file.text.normals;
  const auto has_normal = [&](const Corner& c) {
    return c.normal >= 0 && mode == NormalsMode::kFile &&
           !is_zero(shaded.normals[static_cast<std::size_t>(c.normal)]);
  };
  if (mode == NormalsMode::kFlat) {
    for (Corner& corner : shaded.corners) corner.normal = -1;
  } else if (!std::all_of(shaded.corners.begin(), shaded.corners.end(), has_normal)) {
    const auto computed = compute_normals(file, mode == NormalsMode::kSmooth ? kNoCreases : kCreaseCosine);
    const auto first = static_cast<std::int32_t>(shaded.normals.size());
    for (std::size_t i = 0; i < shaded.corners.size(); ++i)
      if (!has_normal(shaded.corners[i])) shaded.corners[i].normal = first + computed.of_corners[i];
    shaded.normals.insert(shaded.normals.end(), computed.normals.begin(), computed.normals.end());
  }
  return shaded;
}

class MeshBuilder {
 public:
  MeshBuilder(const ObjFile& file, const ShadedCorners& shaded, const Transform& transform)
      : file_(file), shaded_(shaded), transform_(transform), vertices_(file.text.positions.size()) {}

  Result<MeshDescription> build(const std::vector<std::uint32_t>& materials);

 private:
  void fill_vertices();

  const ObjFile& file_;
  const ShadedCorners& shaded_;
  Transform transform_;
  CornerIndex vertices_;
  MeshDescription mesh_;
};

Result<MeshDescription> MeshBuilder::build(const std::vector<std::uint32_t>& materials) {
  std::vector<std::uint32_t> indices;
  indices.reserve(shaded_.corners.size());
  for (const Corner& corner : shaded_.corners) indices.push_back(vertices_.number(corner));
  fill_vertices();
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
  const bool has_uvs = std::any_of(corners.begin(), corners.end(), [](const Corner& c) { return c.uv >= 0; });
  for (const Corner& corner : corners) {
    mesh_.positions.push_back(
        transform_.point(file_.text.positions[static_cast<std::size_t>(corner.position)]));
    if (corner.normal >= 0)
      mesh_.normals.push_back(
          transformed_normal(transform_, shaded_.normals[static_cast<std::size_t>(corner.normal)]));
    if (has_uvs)
      mesh_.uvs.push_back(corner.uv < 0 ? Vec2{} : file_.text.uvs[static_cast<std::size_t>(corner.uv)]);
  }
}

}  // namespace

Result<MeshDescription> build_mesh(const ObjFile& file, NormalsMode normals, const Transform& transform,
                                   const std::vector<std::uint32_t>& materials) {
  return MeshBuilder(file, settle_normals(file, normals), transform).build(materials);
}

}  // namespace tessera::core
