// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/mesh_builder.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <unordered_map>
#include <utility>

#include "core/scene/loader/triangle_filter.hpp"
#include "core/scene/loader/vertex_normals.hpp"

namespace tessera::core {
namespace {

// The identity of a vertex: indices into positions, uvs and normals; -1 for none.
struct Corner {
  std::int32_t position = -1, uv = -1, normal = -1;
  bool operator==(const Corner&) const = default;
};

// Numbers distinct corners in order of first appearance. Corners at one position are chained, which keeps
// memory access local for meshes whose adjacent triangles are close in the file. If many corners share a
// position, a hash table takes the later ones.
class CornerIndex {
 public:
  explicit CornerIndex(std::size_t positions) : first_(positions, kNone) {
    corners_.reserve(positions);
    next_.reserve(positions);
  }

  std::uint32_t number(const Corner& corner) {
    std::uint32_t& first = first_[static_cast<std::size_t>(corner.position)];
    int length = 0;
    for (std::uint32_t i = first; i != kNone; i = next_[i], ++length)
      if (corners_[i] == corner) return i;
    if (length >= kLongestChain) return number_in_crowd(corner);
    next_.push_back(first);
    return first = add(corner);
  }

  const std::vector<Corner>& corners() const { return corners_; }

  // Frees the memory needed for numbering; no corner can be numbered afterwards.
  void forget_chains() {
    first_ = next_ = std::vector<std::uint32_t>();
    crowd_.clear();
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  static constexpr int kLongestChain = 32;

  struct Hash {
    std::size_t operator()(const Corner& corner) const {
      std::uint64_t h = static_cast<std::uint32_t>(corner.position);
      h = (h ^ static_cast<std::uint64_t>(static_cast<std::uint32_t>(corner.uv)) << 32) * 0x9e3779b97f4a7c15u;
      h = (h ^ h >> 32 ^ static_cast<std::uint32_t>(corner.normal)) * 0xd6e8feb86659fd93u;
      return h ^ h >> 32;
    }
  };

  std::uint32_t number_in_crowd(const Corner& corner) {
    const auto [known, is_new] = crowd_.try_emplace(corner, static_cast<std::uint32_t>(corners_.size()));
    if (is_new) {
      next_.push_back(kNone);
      add(corner);
    }
    return known->second;
  }

  std::uint32_t add(const Corner& corner) {
    corners_.push_back(corner);
    return static_cast<std::uint32_t>(corners_.size() - 1);
  }

  std::vector<std::uint32_t> first_;  // start of each position's chain
  std::vector<std::uint32_t> next_;   // next in the chain, for each number
  std::vector<Corner> corners_;
  std::unordered_map<Corner, std::uint32_t, Hash> crowd_;
};

// Normals stay outward, also under reflections.
Vec3 transformed_normal(const Transform& transform, Vec3 file_normal) {
  const Vec3 normal = unit({file_normal.x, file_normal.y, file_normal.z});
  const Vec3 n = transform.determinant() < 0 ? -transform.normal(normal) : transform.normal(normal);
  return unit({n.x, n.y, n.z});
}

// The resolved normals of corners: from the file, computed, or none.
struct ShadedCorners {
  std::span<const std::int32_t> normal_of;  // for each corner; empty for flat shading
  std::vector<std::int32_t> own_normal_of;  // storage of normal_of, unless it refers to the file's
  std::vector<Vec3> computed;               // indexed after the file's normals
};

bool has_file_normal(const ObjFile& file, std::size_t corner) {
  const std::int32_t normal = file.corners.normals[corner];
  return normal >= 0 && file.text.normals[static_cast<std::size_t>(normal)] != Vec3{};
}

bool is_flat(const ObjFile& file) {
  return std::all_of(file.runs.begin(), file.runs.end(),
                     [](const ObjFile::Run& run) { return run.smoothing_group == 0u; });
}

ShadedCorners compute_all(const ObjFile& file, Smoothing smoothing) {
  auto [normals, of_corners] = compute_normals(file, smoothing);
  const auto first = static_cast<std::int32_t>(file.text.normals.size());
  for (std::int32_t& normal : of_corners) normal += first;
  ShadedCorners shaded{{}, std::move(of_corners), std::move(normals)};
  shaded.normal_of = shaded.own_normal_of;
  return shaded;
}

ShadedCorners settle_normals(const ObjFile& file, NormalsMode mode) {
  const auto& of_file = file.corners.normals;
  if (mode == NormalsMode::kFlat) return {};
  if (mode == NormalsMode::kSmooth) return compute_all(file, Smoothing::kAll);
  if (of_file.empty()) return is_flat(file) ? ShadedCorners{} : compute_all(file, Smoothing::kByFile);
  std::size_t corner = 0;
  while (corner < of_file.size() && has_file_normal(file, corner)) ++corner;
  if (corner == of_file.size()) return {of_file, {}, {}};
  ShadedCorners shaded = compute_all(file, Smoothing::kByFile);
  for (std::size_t i = 0; i < of_file.size(); ++i)
    if (has_file_normal(file, i)) shaded.own_normal_of[i] = of_file[i];
  return shaded;
}

class MeshBuilder {
 public:
  MeshBuilder(const ObjFile& file, const Transform& transform, VertexColors colors)
      : file_(file), transform_(transform), colors_(colors), vertices_(file.text.positions.size()) {}

  Result<MeshDescription> build(ShadedCorners shaded, const std::vector<std::uint32_t>& materials);

 private:
  void number_vertices(std::span<const std::int32_t> normal_of);
  void fill_vertices(const std::vector<Vec3>& computed_normals);
  void fill_materials(const std::vector<std::uint32_t>& materials);

  const ObjFile& file_;
  Transform transform_;
  VertexColors colors_;
  CornerIndex vertices_;
  MeshDescription mesh_;
};

// Frees data as soon as it is no longer needed (assigning {} would keep the memory), because a large mesh's
// lists dominate memory use.
Result<MeshDescription> MeshBuilder::build(ShadedCorners shaded,
                                           const std::vector<std::uint32_t>& materials) {
  number_vertices(shaded.normal_of);
  vertices_.forget_chains();
  shaded.own_normal_of = std::vector<std::int32_t>();
  fill_vertices(shaded.computed);
  shaded.computed = std::vector<Vec3>();
  vertices_ = CornerIndex(0);
  if (!std::all_of(mesh_.positions.begin(), mesh_.positions.end(), [](Vec3 p) { return is_finite(p); }))
    return fail(ErrorCode::kInvalidArgument, "reaches farther than can be computed after its transform");
  fill_materials(materials);
  remove_superfluous_triangles(mesh_);
  if (mesh_.triangles.empty())
    return fail(ErrorCode::kInvalidArgument, "has no face with an area greater than 0");
  return std::move(mesh_);
}

void MeshBuilder::number_vertices(std::span<const std::int32_t> normal_of) {
  const auto& [positions, uvs, normals] = file_.corners;
  const bool mirrored = transform_.determinant() < 0;
  mesh_.triangles.reserve(file_.triangle_count());
  for (std::size_t t = 0; t < file_.triangle_count(); ++t) {
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = 3 * t + k;
      triangle[k] =
          vertices_.number({positions[i], uvs.empty() ? -1 : uvs[i], normal_of.empty() ? -1 : normal_of[i]});
    }
    if (mirrored) std::swap(triangle[1], triangle[2]);
    mesh_.triangles.push_back(triangle);
  }
}

void MeshBuilder::fill_materials(const std::vector<std::uint32_t>& materials) {
  if (materials.size() == 1) {
    mesh_.triangle_materials = materials;
    return;
  }
  mesh_.triangle_materials.reserve(file_.triangle_count());
  for (std::size_t r = 0; r < file_.runs.size(); ++r) {
    const std::size_t end =
        r + 1 < file_.runs.size() ? file_.runs[r + 1].first_triangle : file_.triangle_count();
    mesh_.triangle_materials.resize(end, materials[r]);
  }
}

void MeshBuilder::fill_vertices(const std::vector<Vec3>& computed_normals) {
  const auto& corners = vertices_.corners();
  const auto& text = file_.text;
  const auto normal = [&](std::int32_t index) {
    const auto i = static_cast<std::size_t>(index);
    return i < text.normals.size() ? text.normals[i] : computed_normals[i - text.normals.size()];
  };
  const auto uv = [](const std::vector<Vec2>& uvs, std::int32_t index) {
    return index < 0 ? Vec2{} : uvs[static_cast<std::size_t>(index)];
  };
  const bool has_second_uvs = !text.second_uvs.empty();
  const bool has_uvs = !file_.corners.uvs.empty(), has_normals = corners.front().normal >= 0;
  const bool has_colors = colors_ == VertexColors::kUse && !text.colors.empty();
  mesh_.positions.reserve(corners.size());
  if (has_uvs) mesh_.uvs.reserve(corners.size());
  if (has_second_uvs) mesh_.second_uvs.reserve(corners.size());
  if (has_normals) mesh_.normals.reserve(corners.size());
  if (has_colors) mesh_.colors.reserve(corners.size());
  if (!text.tangents.empty()) mesh_.tangents.reserve(corners.size());
  for (const Corner& corner : corners) {
    const auto position = static_cast<std::size_t>(corner.position);
    mesh_.positions.push_back(transform_.point(text.positions[position]));
    if (has_colors) mesh_.colors.push_back(text.colors[position]);
    if (!text.tangents.empty()) mesh_.tangents.push_back(transformed(text.tangents[position], transform_));
    if (has_normals) mesh_.normals.push_back(transformed_normal(transform_, normal(corner.normal)));
    if (has_uvs) mesh_.uvs.push_back(uv(text.uvs, corner.uv));
    if (has_second_uvs) mesh_.second_uvs.push_back(uv(text.second_uvs, corner.uv));
  }
}

}  // namespace

Result<MeshDescription> build_mesh(const ObjFile& file, NormalsMode normals, const Transform& transform,
                                   const std::vector<std::uint32_t>& materials, VertexColors colors) {
  return MeshBuilder(file, transform, colors).build(settle_normals(file, normals), materials);
}

}  // namespace tessera::core
