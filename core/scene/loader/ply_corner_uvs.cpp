// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/ply_corner_uvs.hpp"

#include <limits>

namespace tessera::core {
namespace {

// Gives each corner the vertex that has its coordinates, a copy if none has them. The copies of a vertex are
// chained.
class VertexSplitter {
 public:
  explicit VertexSplitter(MeshDescription& mesh)
      : mesh_(mesh), count_(mesh.positions.size()), has_uv_(count_, false), next_(count_, kNone) {
    mesh_.uvs.assign(mesh_.positions.size(), {});
  }

  // A vertex that is not there stays none, whatever copies are added.
  std::uint32_t vertex_with(std::uint32_t vertex, Vec2 uv) {
    if (vertex >= count_) return kNone;
    if (!has_uv_[vertex]) {
      has_uv_[vertex] = true;
      mesh_.uvs[vertex] = uv;
    }
    std::uint32_t last = vertex;
    int length = 0;
    for (std::uint32_t i = vertex; i != kNone && length < kLongestChain; i = next_[i], ++length) {
      if (mesh_.uvs[i] == uv) return i;
      last = i;
    }
    return add_copy(last, uv);
  }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  static constexpr int kLongestChain = 32;  // more copies are not shared

  std::uint32_t add_copy(std::uint32_t of, Vec2 uv) {
    const auto copy = static_cast<std::uint32_t>(mesh_.positions.size());
    const auto append = [of](auto& list) {
      if (list.empty()) return;
      const auto value = list[of];
      list.push_back(value);
    };
    append(mesh_.positions);
    append(mesh_.normals);
    append(mesh_.colors);
    append(mesh_.second_uvs);
    append(mesh_.tangents);
    mesh_.uvs.push_back(uv);
    has_uv_.push_back(true);
    next_.push_back(next_[of]);
    next_[of] = copy;
    return copy;
  }

  MeshDescription& mesh_;
  std::size_t count_;  // of vertices without the copies
  std::vector<bool> has_uv_;
  std::vector<std::uint32_t> next_;
};

}  // namespace

void PlyCornerUvs::read_face(const PlyProperty& property, PlyValues& values) {
  const std::int64_t count = values.next_integer(property.count_type);
  if (count <= 0) return;
  const auto size = static_cast<std::uint64_t>(count);
  if (!values.may_follow(size, values.is_binary() ? size_of(property.type) : 1))
    return values.skip(property.type, size);  // fails
  for (std::uint64_t i = 0; i < size; ++i) face_.push_back(values.next_float(property.type));
}

void PlyCornerUvs::add_triangle(std::size_t triangle, const std::array<std::uint32_t, 3>& corners) {
  if (face_.empty()) return;
  const auto uv = [this](std::size_t corner) {
    return corner < corner_count() ? Vec2{face_[2 * corner], face_[2 * corner + 1]} : Vec2{};
  };
  of_triangles_.resize(triangle);
  of_triangles_.push_back({uv(corners[0]), uv(corners[1]), uv(corners[2])});
}

void PlyCornerUvs::apply(MeshDescription& mesh) {
  if (of_triangles_.empty()) return;
  of_triangles_.resize(mesh.triangles.size());
  VertexSplitter splitter(mesh);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      mesh.triangles[t][k] = splitter.vertex_with(mesh.triangles[t][k], of_triangles_[t][k]);
}

}  // namespace tessera::core
