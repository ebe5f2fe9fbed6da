// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/meshes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "core/base/suggestion.hpp"
#include "core/math/elementary.hpp"
#include "core/scene/import/corner_uvs.hpp"
#include "core/scene/loader/mesh_builder.hpp"
#include "core/scene/mitsuba/serialized_mesh.hpp"

namespace tessera::core::mitsuba {
namespace {

// A reader's result; an error beyond a limit ends the conversion, any other costs the shape.
template <typename T>
std::optional<T> usable(Conversion& conversion, const Plugin& shape, Result<T> result) {
  if (result) return std::move(*result);
  if (result.error().code == ErrorCode::kResourceExhausted)
    conversion.check(fail(result.error()));
  else
    shape.warn(result.error().message + "; the shape is left out");
  return std::nullopt;
}

// What the reader of a mesh file told. Several shapes may show the file.
void keep_warnings(Conversion& conversion, const std::string& path, const FileWarnings& warnings) {
  SceneWarnings& all = conversion.builder.warnings();
  if (!warnings.empty() && !all.knows(path)) all.of(path) = warnings;
}

Result<ShapeMesh> read_obj_shape(Conversion& conversion, const Plugin& shape, const std::string& path) {
  const auto file = conversion.builder.files().obj(path);
  if (!file) return fail(file.error());
  keep_warnings(conversion, path, (*file)->text.warnings);
  const bool has_normals = !(*file)->corners.normals.empty() && !shape.flag("face_normals", false);
  auto mesh = build_mesh(**file, has_normals ? NormalsMode::kFile : NormalsMode::kFlat, Transform(), {0},
                         VertexColors::kIgnore);
  if (!mesh) return fail(mesh.error().code, fmt::format("{} {}", in_quotes(path), mesh.error().message));
  const bool reversed = shape.flag("flip_tex_coords", true);
  return ShapeMesh{std::move(*mesh), {}, reversed ? UvLayout::kReversedV : UvLayout::kSame};
}

Result<ShapeMesh> read_ply_shape(Conversion& conversion, const Plugin& shape, const std::string& path) {
  const auto bytes = conversion.builder.read(path);
  if (!bytes) return fail(bytes.error());
  auto file = read_ply(*bytes, path, conversion.builder.limits().triangles, MeshAttributes::kKeep);
  if (!file) return fail(file.error());
  keep_warnings(conversion, path, file->warnings);
  file->mesh.tangents = {};
  const bool reversed = shape.flag("flip_tex_coords", false);
  return ShapeMesh{std::move(file->mesh), std::move(file->attributes),
                   reversed ? UvLayout::kReversedV : UvLayout::kSame};
}

Result<ShapeMesh> read_serialized_shape(Conversion& conversion, const Plugin& shape,
                                        const std::string& path) {
  const auto bytes = conversion.builder.read(path);
  if (!bytes) return fail(bytes.error());
  auto file =
      read_serialized_mesh(*bytes, shape.integer("shape_index", 0), conversion.builder.limits().triangles);
  if (!file) return fail(file.error().code, fmt::format("{} {}", in_quotes(path), file.error().message));
  if (file->face_normals) file->mesh.normals.clear();
  const bool reversed = shape.flag("flip_tex_coords", false);
  return ShapeMesh{std::move(file->mesh), {}, reversed ? UvLayout::kReversedV : UvLayout::kSame};
}

// Adds the parallelogram of center, u and v with its texture coordinates, facing `normal`.
void add_face(MeshDescription& mesh, Vec3 center, Vec3 u, Vec3 v, Vec3 normal) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const std::array<Vec2, 4> corners{Vec2{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (const Vec2 uv : corners) {
    mesh.positions.push_back(center + u * (2 * uv.x - 1) + v * (2 * uv.y - 1));
    mesh.normals.push_back(normal);
    mesh.uvs.push_back(uv);
  }
  const std::uint32_t turn = dot(cross(u, v), normal) < 0 ? 1 : 0;  // the order of two corners
  mesh.triangles.push_back({first, first + 1 + turn, first + 2 - turn});
  mesh.triangles.push_back({first, first + 2 + turn, first + 3 - turn});
}

MeshDescription rectangle_mesh() {
  MeshDescription mesh;
  add_face(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  return mesh;
}

// The cube from -1 to 1, with the texture on each of its faces, mirrored.
MeshDescription cube_mesh() {
  MeshDescription mesh;
  const auto add = [&](Vec3 center, Vec3 u, Vec3 v) { add_face(mesh, center, u, v, center); };
  add({0, -1, 0}, {0, 0, 1}, {1, 0, 0});
  add({0, 1, 0}, {-1, 0, 0}, {0, 0, -1});
  add({1, 0, 0}, {0, 1, 0}, {0, 0, -1});
  add({0, 0, 1}, {0, 1, 0}, {1, 0, 0});
  add({-1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  add({0, 0, -1}, {0, -1, 0}, {1, 0, 0});
  return mesh;
}

// Mitsuba's coordinates of points on triangles without any are their barycentric ones.
void give_barycentric_uvs(const Plugin& shape, ShapeMesh& made) {
  constexpr CornerUvs kBarycentric{Vec2{0, 0}, {1, 0}, {0, 1}};
  if (!names_only_vertices(made.mesh))
    return shape.warn(
        "has no texture coordinates, and a triangle names a vertex that is not there; its images are not "
        "shown");
  for (MeshAttribute& attribute : made.attributes)
    if (!attribute.of_triangles) give_to_corners(attribute.values, made.mesh);
  give_corner_uvs(made.mesh, kBarycentric);
  made.layout = UvLayout::kSame;
}

// What Mitsuba does to all meshes.
ShapeMesh finished(const Plugin& shape, ShapeMesh made, bool has_images) {
  MeshDescription& mesh = made.mesh;
  const bool face_normals = shape.flag("face_normals", false);
  if (face_normals) mesh.normals.clear();
  if (!face_normals && mesh.normals.empty()) mesh.normals = angle_weighted_normals(mesh);
  mesh.triangle_materials.clear();
  if (has_images && mesh.uvs.empty()) give_barycentric_uvs(shape, made);
  place_mesh(mesh, shape.transform("to_world"));
  if (shape.flag("flip_normals", false)) flip_mesh(mesh);
  return made;
}

}  // namespace

std::optional<std::string> find_shape_file(const Conversion& conversion, const Plugin& shape) {
  const std::string written = shape.text("filename").value_or("");
  if (written.empty()) {
    shape.warn("lacks a 'filename'; the shape is left out");
    return std::nullopt;
  }
  const auto path = conversion.find_file(written);
  if (!path) shape.warn(fmt::format("{} does not exist; the shape is left out", in_quotes(written)));
  return path;
}

bool is_mesh(const Plugin& shape) {
  const std::string& type = shape.type();
  return type == "obj" || type == "ply" || type == "serialized" || type == "cube" || type == "rectangle";
}

std::optional<ShapeMesh> load_mesh(Conversion& conversion, const Plugin& shape, bool has_images) {
  const std::string& type = shape.type();
  if (type == "cube") return finished(shape, {cube_mesh()}, has_images);
  if (type == "rectangle") return finished(shape, {rectangle_mesh()}, has_images);
  const auto path = find_shape_file(conversion, shape);
  if (!path) return std::nullopt;
  auto* const read = type == "obj" ? read_obj_shape : type == "ply" ? read_ply_shape : read_serialized_shape;
  auto mesh = usable(conversion, shape, read(conversion, shape, *path));
  return mesh ? std::optional(finished(shape, std::move(*mesh), has_images)) : std::nullopt;
}

bool names_only_vertices(const MeshDescription& mesh) {
  const std::size_t count = mesh.positions.size();
  return std::all_of(mesh.triangles.begin(), mesh.triangles.end(),
                     [&](const auto& t) { return t[0] < count && t[1] < count && t[2] < count; });
}

MeshDescription sphere_mesh() {
  constexpr std::uint32_t kAround = 128, kDown = 64;
  MeshDescription mesh;
  for (std::uint32_t j = 0; j <= kDown; ++j)
    for (std::uint32_t i = 0; i <= kAround; ++i) {
      const Vec2 uv{static_cast<float>(i) / kAround, static_cast<float>(j) / kDown};
      const auto [sin_phi, cos_phi] = sin_cos_turns(uv.x);
      const auto [sin_theta, cos_theta] = sin_cos_turns(uv.y / 2);
      const Vec3 p{sin_theta * cos_phi, sin_theta * sin_phi, cos_theta};
      mesh.positions.push_back(p);
      mesh.normals.push_back(p);
      mesh.uvs.push_back(uv);
    }
  const auto vertex = [](std::uint32_t i, std::uint32_t j) { return j * (kAround + 1) + i; };
  for (std::uint32_t j = 0; j < kDown; ++j)
    for (std::uint32_t i = 0; i < kAround; ++i) {
      if (j + 1 < kDown) mesh.triangles.push_back({vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1)});
      if (j > 0) mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i + 1, j)});
    }
  return mesh;
}

void place_mesh(MeshDescription& mesh, const Transform& to_world) {
  const float sign = to_world.determinant() < 0 ? -1.0f : 1.0f;
  for (Vec3& position : mesh.positions) position = to_world.point(position);
  for (Vec3& normal : mesh.normals) normal = to_world.normal(normal) * sign;
  if (mesh.normals.size() != mesh.positions.size()) return;
  for (auto& [a, b, c] : mesh.triangles) {
    const std::size_t count = mesh.positions.size();
    if (a >= count || b >= count || c >= count) continue;  // repaired when it is added
    const Vec3 face = cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
    if (dot(face, mesh.normals[a] + mesh.normals[b] + mesh.normals[c]) < 0) std::swap(b, c);
  }
}

void flip_mesh(MeshDescription& mesh) {
  for (Vec3& normal : mesh.normals) normal = -normal;
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

std::vector<Vec3> angle_weighted_normals(const MeshDescription& mesh) {
  std::vector<Vec3> normals(mesh.positions.size());
  for (const auto& triangle : mesh.triangles) {
    if (triangle[0] >= normals.size() || triangle[1] >= normals.size() || triangle[2] >= normals.size())
      continue;
    const auto corner = [&](std::size_t i) { return mesh.positions[triangle[i % 3]]; };
    const Vec3 face = normalize(cross(corner(1) - corner(0), corner(2) - corner(0)));
    if (!is_finite(face)) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 to_next = normalize(corner(i + 1) - corner(i)),
                 to_last = normalize(corner(i + 2) - corner(i));
      normals[triangle[i]] += face * atan2(length(cross(to_next, to_last)), dot(to_next, to_last));
    }
  }
  return normals;
}

}  // namespace tessera::core::mitsuba
