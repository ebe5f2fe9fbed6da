// SPDX-License-Identifier: Apache-2.0
#include "core/scene/writer/ply_writer.hpp"

#include <fmt/format.h>

#include <bit>
#include <initializer_list>
#include <string_view>
#include <utility>

namespace tessera::core {
namespace {

class PlyWriter {
 public:
  PlyWriter(const MeshDescription& mesh, const std::vector<std::uint32_t>& materials)
      : mesh_(mesh), materials_(materials) {}

  std::string write();

 private:
  void header();
  void add_properties(std::string_view type, std::initializer_list<std::string_view> names);
  void vertex(std::size_t i);
  void put(std::uint32_t bits);
  void put(float value) { put(std::bit_cast<std::uint32_t>(value)); }

  const MeshDescription& mesh_;
  const std::vector<std::uint32_t>& materials_;
  std::string bytes_;
};

std::string PlyWriter::write() {
  constexpr std::size_t kMaxVertexBytes = 68, kMaxFaceBytes = 17, kHeaderBytes = 1024;
  bytes_.reserve(kHeaderBytes + kMaxVertexBytes * mesh_.positions.size() +
                 kMaxFaceBytes * mesh_.triangles.size());
  header();
  for (std::size_t i = 0; i < mesh_.positions.size(); ++i) vertex(i);
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    bytes_ += '\3';
    for (const std::uint32_t corner : mesh_.triangles[t]) put(corner);
    if (!materials_.empty()) put(materials_[t]);
  }
  return std::move(bytes_);
}

void PlyWriter::header() {
  bytes_ += fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh_.positions.size());
  add_properties("float", {"x", "y", "z"});
  if (!mesh_.normals.empty()) add_properties("float", {"nx", "ny", "nz"});
  if (!mesh_.tangents.empty()) add_properties("float", {"tx", "ty", "tz", "tw"});
  if (!mesh_.uvs.empty()) add_properties("float", {"u", "v"});
  if (!mesh_.second_uvs.empty()) add_properties("float", {"u1", "v1"});
  if (!mesh_.colors.empty()) add_properties("float", {"red", "green", "blue"});
  bytes_ += fmt::format("element face {}\nproperty list uchar uint vertex_indices\n", mesh_.triangles.size());
  if (!materials_.empty()) add_properties("uint", {"material_index"});
  bytes_ += "end_header\n";
}

void PlyWriter::add_properties(std::string_view type, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) bytes_ += fmt::format("property {} {}\n", type, name);
}

void PlyWriter::vertex(std::size_t i) {
  const auto put_vector = [this](Vec3 v) {
    put(v.x);
    put(v.y);
    put(v.z);
  };
  put_vector(mesh_.positions[i]);
  if (!mesh_.normals.empty()) put_vector(mesh_.normals[i]);
  if (!mesh_.tangents.empty()) {
    put_vector(mesh_.tangents[i].direction);
    put(mesh_.tangents[i].handedness);
  }
  for (const std::vector<Vec2>* uvs : {&mesh_.uvs, &mesh_.second_uvs}) {
    if (uvs->empty()) continue;
    put((*uvs)[i].x);
    put((*uvs)[i].y);
  }
  if (!mesh_.colors.empty()) put_vector({mesh_.colors[i].r, mesh_.colors[i].g, mesh_.colors[i].b});
}

void PlyWriter::put(std::uint32_t bits) {
  for (int shift = 0; shift < 32; shift += 8) bytes_ += static_cast<char>(bits >> shift & 0xff);
}

}  // namespace

std::string write_ply(const MeshDescription& mesh, const std::vector<std::uint32_t>& materials) {
  return PlyWriter(mesh, materials).write();
}

}  // namespace tessera::core
