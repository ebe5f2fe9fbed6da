// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "core/math/elementary.hpp"
#include "core/scene/import/corner_uvs.hpp"
#include "core/scene/loader/mesh_file.hpp"
#include "core/scene/loader/vertex_normals.hpp"
#include "core/scene/loader/wording.hpp"
#include "core/scene/pbrt/curves.hpp"
#include "core/scene/pbrt/files.hpp"
#include "core/scene/pbrt/loop_subdivision.hpp"
#include "core/scene/pbrt/tessellation.hpp"

namespace tessera::core::pbrt {
namespace {

using Corners = std::array<std::uint32_t, 3>;

// The texture coordinates at the corners of triangles without any.
constexpr CornerUvs kDefaultUvs{Vec2{0, 0}, {1, 0}, {1, 1}};

// Of twice the length of the triangle's area.
Vec3 corner_normal(const MeshDescription& mesh, const Corners& t) {
  const Vec3 a = mesh.positions[t[0]];
  return cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
}

// Turns triangles whose normals lie on their back.
void face_normals(MeshDescription& mesh) {
  for (Corners& t : mesh.triangles) {
    const Vec3 sum = mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]];
    if (dot(corner_normal(mesh, t), sum) < 0) std::swap(t[1], t[2]);
  }
}

// To the space of the placement. The front of a triangle is the side of its vertex normals, or else that of
// its order of corners in its own space, which a reflection keeps. pbrt's bitangents are right-handed in
// render space.
void move_to_placement(MeshDescription& mesh, const ShapePlacement& at) {
  const Transform transform = at.to_world.transform();
  for (Vec3& p : mesh.positions) p = transform.point(p);
  const bool reflects = at.to_world.determinant() < 0;
  const float sign = reflects != at.reverse_orientation ? -1.0f : 1.0f;
  for (Vec3& n : mesh.normals) {
    const float size = length(n);
    if (size > 0 && std::isfinite(size)) n = transform.normal(n / size) * sign;
  }
  for (VertexTangent& tangent : mesh.tangents) tangent = {transformed(tangent, transform).direction};
  if (!mesh.normals.empty()) return face_normals(mesh);
  if (sign < 0)
    for (Corners& t : mesh.triangles) std::swap(t[1], t[2]);
}

// The areas of the triangles of a mesh.
struct TriangleAreas {
  double sum = 0;
  bool are_equal = true;  // but for 1 %
};

TriangleAreas areas_of(const MeshDescription& mesh) {
  constexpr double kMaxRatio = 1.01;
  double sum = 0, least = std::numeric_limits<double>::infinity(), greatest = 0;
  for (const Corners& t : mesh.triangles) {
    const double area = static_cast<double>(length(corner_normal(mesh, t))) / 2;
    sum += area;
    least = std::min(least, area);
    greatest = std::max(greatest, area);
  }
  return {sum, greatest <= kMaxRatio * least};
}

bool has_valid_indices(const MeshDescription& mesh) {
  return std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Corners& t) {
    return std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return v < mesh.positions.size(); });
  });
}

// The factor by which all lengths grow; 0 if they do not grow alike.
float even_scale(const Matrix& matrix) {
  const Transform t = matrix.transform();
  const Vec3 sizes = t.scales();
  const float mean_size = (sizes.x + sizes.y + sizes.z) / 3;
  const float skew = std::max({std::fabs(dot(t.x_axis, t.y_axis)), std::fabs(dot(t.y_axis, t.z_axis)),
                               std::fabs(dot(t.z_axis, t.x_axis))});
  const auto differs = [&](float size) { return std::fabs(size / mean_size - 1) > 1e-4f; };
  if (!(mean_size > 0) || differs(sizes.x) || differs(sizes.y) || differs(sizes.z)) return 0;
  return skew <= 1e-4f * mean_size * mean_size ? mean_size : 0;
}

// From the sphere of our texture coordinates, whose pole is +y, to that of pbrt, whose pole is +z.
Matrix pole_up() {
  return {{{{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}}}};
}

std::string shape_name(const Parameters& p, std::string_view kind) {
  return fmt::format("{} in line {}", kind, p.place().line);
}

float radius_of(const Parameters& p, std::string_view name, float otherwise) {
  const float radius = p.number(name, otherwise);
  if (radius < 0) p.remark(name, "is negative; it is taken without its sign");
  return std::fabs(radius);
}

std::uint32_t as_index(std::int32_t index) {
  return static_cast<std::uint32_t>(index);
}

std::vector<Corners> triangles_of(const Parameters& p, std::size_t positions) {
  const std::vector<std::int32_t> indices = p.integers("indices", 3);
  if (indices.empty() && positions == 3) return {{0, 1, 2}};
  std::vector<Corners> triangles;
  triangles.reserve(indices.size() / 3);
  for (std::size_t i = 0; i + 3 <= indices.size(); i += 3)
    triangles.push_back({as_index(indices[i]), as_index(indices[i + 1]), as_index(indices[i + 2])});
  return triangles;
}

std::vector<Vec2> uvs_of(const Parameters& p) {
  std::vector<Vec2> uvs = p.points2("uv");
  return uvs.empty() ? p.points2("st") : uvs;
}

}  // namespace

// A boundary whose outside is the denser side is one of the inverse index that faces the other way.
void Shapes::turn_inside_out(const Parameters& p, ShapePlacement& at) {
  at.reverse_orientation = !at.reverse_orientation;
  std::swap(at.surface.media.interior, at.surface.media.exterior);
  if (at.surface.light && !at.surface.light->two_sided)
    report_.warn(p.place(), "a dielectric of an index below 1 emits to its inside");
}

Status Shapes::add(const std::string& kind, const Parameters& p, ShapePlacement placement) {
  if (surfaces_.is_reversed(placement.surface)) turn_inside_out(p, placement);
  placement.surface.alpha = textures_.alpha(p);
  if (placement.surface.alpha)
    if (const Rgb* constant = constant_of(placement.surface.alpha); constant != nullptr && constant->r >= 1)
      placement.surface.alpha = nullptr;
  Status added;
  if (kind == "sphere") {
    added = add_sphere(p, placement);
  } else if (kind == "disk") {
    added = add_disk(p, placement);
  } else if (kind == "cylinder") {
    added = add_cylinder(p, placement);
  } else if (kind == "trianglemesh") {
    added = add_triangles(p, placement);
  } else if (kind == "plymesh") {
    added = add_ply(p, placement);
  } else if (kind == "bilinearmesh") {
    added = add_patches(p, placement);
  } else if (kind == "curve") {
    added = add_curve(p, placement);
  } else if (kind == "loopsubdiv") {
    added = add_subdivision(p, placement);
  } else {
    const std::string text = fmt::format("the shape {} is not supported; it is left out", in_quotes(kind));
    report_.warn(p.place(), text, text);
    return {};
  }
  if (added) report_.tell(p, fmt::format("the shape '{}'", kind));
  return added;
}

template <typename Description>
Status Shapes::add_analytic(Description shape, double area, const Parameters& p, const ShapePlacement& at) {
  auto material = surfaces_.material(at.surface, area, p.place());
  if (!material) return fail(material.error());
  if (!*material) return {};
  shape.material = **material;
  builder_.add_shape(std::move(shape), shape_name(p, "shape"), at.object, file_place(p.place()));
  return {};
}

// A whole sphere stays one. Where its texture coordinates count or it is stretched, it is placed as an
// instance, which has its own poles; where that is not possible, it becomes triangles.
Status Shapes::add_sphere(const Parameters& p, const ShapePlacement& at) {
  PartialSphere sphere;
  sphere.radius = radius_of(p, "radius", 1);
  const float za = p.number("zmin", -sphere.radius), zb = p.number("zmax", sphere.radius);
  sphere.z_min = std::clamp(std::min(za, zb), -sphere.radius, sphere.radius);
  sphere.z_max = std::clamp(std::max(za, zb), -sphere.radius, sphere.radius);
  sphere.phi_max = p.number_in("phimax", 360, 0, 360);
  if (!(sphere.radius > 0) || sphere.phi_max == 0 || sphere.z_min == sphere.z_max) {
    report_.warn(p.place(), "a sphere without a surface is left out");
    return {};
  }
  const bool is_whole =
      sphere.z_min <= -sphere.radius && sphere.z_max >= sphere.radius && sphere.phi_max >= 360;
  const float growth = even_scale(at.to_world);
  const bool is_turned = at.reverse_orientation && surfaces_.has_sides(at.surface);
  if (!is_whole || is_turned || (growth == 0 && at.surface.light))
    return add_mesh(sphere_mesh(sphere), p, at, 1);
  const double radius = static_cast<double>(sphere.radius) * static_cast<double>(growth);
  const double area = 4 * std::numbers::pi * radius * radius;
  if (growth > 0 && !surfaces_.is_textured(at.surface))
    return add_analytic(SphereDescription{at.to_world.point({}), static_cast<float>(radius), 0}, area, p, at);
  ShapePlacement own = at;
  own.object = builder_.add_object(shape_name(p, "sphere"));
  InstanceDescription instance;
  instance.object = *own.object;
  instance.to_world = (at.to_world * pole_up()).transform();
  if (!builder_.add_shape(instance, shape_name(p, "sphere"), at.object, file_place(p.place()))) return {};
  return add_analytic(SphereDescription{{}, sphere.radius, 0}, area, p, own);
}

Status Shapes::add_disk(const Parameters& p, const ShapePlacement& at) {
  PartialDisk disk;
  disk.height = p.number("height", 0);
  disk.radius = radius_of(p, "radius", 1);
  disk.inner_radius = radius_of(p, "innerradius", 0);
  disk.phi_max = p.number_in("phimax", 360, 0, 360);
  if (!(disk.radius > disk.inner_radius) || disk.phi_max == 0) {
    report_.warn(p.place(), "a disk without a surface is left out");
    return {};
  }
  if (disk.phi_max < 360) return add_mesh(disk_mesh(disk), p, at, 1);
  DiskDescription whole;
  whole.center = at.to_world.point({0, 0, disk.height});
  whole.radius_u = at.to_world.direction({disk.radius, 0, 0});
  whole.radius_v = at.to_world.direction({0, disk.radius, 0});
  whole.inner = disk.inner_radius / disk.radius;
  whole.flipped = (at.to_world.determinant() < 0) != at.reverse_orientation;
  const double inner = static_cast<double>(whole.inner);
  const double area = std::numbers::pi * (1 - inner * inner) *
                      static_cast<double>(length(cross(whole.radius_u, whole.radius_v)));
  return add_analytic(whole, area, p, at);
}

Status Shapes::add_cylinder(const Parameters& p, const ShapePlacement& at) {
  PartialCylinder cylinder;
  cylinder.radius = radius_of(p, "radius", 1);
  const float za = p.number("zmin", -1), zb = p.number("zmax", 1);
  cylinder.z_min = std::min(za, zb);
  cylinder.z_max = std::max(za, zb);
  cylinder.phi_max = p.number_in("phimax", 360, 0, 360);
  if (!(cylinder.radius > 0) || cylinder.phi_max == 0 || cylinder.z_min == cylinder.z_max) {
    report_.warn(p.place(), "a cylinder without a surface is left out");
    return {};
  }
  const float growth = even_scale(at.to_world);
  if (cylinder.phi_max < 360 || growth == 0) return add_mesh(cylinder_mesh(cylinder), p, at, 1);
  CylinderDescription whole;
  whole.start = at.to_world.point({0, 0, cylinder.z_min});
  whole.axis = at.to_world.direction({0, 0, cylinder.z_max - cylinder.z_min});
  whole.radius_u = at.to_world.direction({cylinder.radius, 0, 0});
  whole.radius_v = at.to_world.direction({0, cylinder.radius, 0});
  whole.flipped = at.reverse_orientation;
  const double area = 2 * std::numbers::pi * static_cast<double>(length(whole.radius_u)) *
                      static_cast<double>(length(whole.axis));
  return add_analytic(whole, area, p, at);
}

Status Shapes::add_triangles(const Parameters& p, const ShapePlacement& at) {
  MeshDescription mesh;
  mesh.positions = p.vectors("P");
  mesh.normals = p.vectors("N");
  mesh.uvs = uvs_of(p);
  mesh.triangles = triangles_of(p, mesh.positions.size());
  if (mesh.triangles.empty() && !p.has("indices")) {
    report_.warn(p.place(), "the shape 'trianglemesh' has no indices; it is left out");
    return {};
  }
  for (const Vec3& tangent : p.vectors("S")) mesh.tangents.push_back({tangent});
  return add_mesh(std::move(mesh), p, at);
}

Status Shapes::add_ply(const Parameters& p, const ShapePlacement& at) {
  const std::string written = p.file_name("filename");
  const Place place = p.place_of(p.find("filename"));
  if (written.empty()) {
    report_.warn(place, "the shape 'plymesh' has no file name; it is left out");
    return {};
  }
  const auto path = find_file(builder_, place, written);
  if (!path) {
    report_.warn(place, "missing mesh " + written,
                 fmt::format("the mesh {} does not exist; it is left out", in_quotes(written)));
    return {};
  }
  auto bytes = builder_.read(*path);
  if (!bytes) return fail(bytes.error());
  auto file = read_ply(*bytes, builder_.shown(*path), builder_.limits().triangles);
  *bytes = std::string();  // frees it
  if (!file) {
    if (file.error().code == ErrorCode::kResourceExhausted) return fail(file.error());
    report_.warn(place, "mesh " + written, file.error().message + "; it is left out");
    return {};
  }
  builder_.warnings().of(builder_.shown(*path)) = file->warnings;
  file->mesh.colors = {};
  file->mesh.tangents = {};
  return add_mesh(std::move(file->mesh), p, at);
}

Status Shapes::add_patches(const Parameters& p, const ShapePlacement& at) {
  const std::vector<Vec3> positions = p.vectors("P");
  std::vector<Vec3> normals = p.vectors("N");
  std::vector<Vec2> uvs = uvs_of(p);
  const auto drop_incomplete = [&](auto& list, std::string_view name) {
    if (list.empty() || list.size() == positions.size()) return;
    p.remark(name, "has not one value for each vertex; it is ignored");
    list.clear();
  };
  drop_incomplete(normals, "N");
  drop_incomplete(uvs, p.has("uv") ? "uv" : "st");
  std::vector<std::int32_t> indices = p.integers("indices", 4);
  if (indices.empty() && positions.size() == 4) indices = {0, 1, 2, 3};
  std::vector<std::array<std::uint32_t, 4>> patches;
  for (std::size_t i = 0; i + 4 <= indices.size(); i += 4) {
    std::array<std::uint32_t, 4> patch{};
    for (std::size_t corner = 0; corner < 4; ++corner) patch[corner] = as_index(indices[i + corner]);
    if (std::any_of(patch.begin(), patch.end(), [&](std::uint32_t v) { return v >= positions.size(); })) {
      report_.warn(p.place(), "a bilinear patch with a corner that is no vertex is left out");
      continue;
    }
    patches.push_back(patch);
  }
  const std::uint64_t triangles = bilinear_triangles(positions, patches);
  if (auto fits = builder_.check_triangles(*p.place().file, triangles); !fits) return fits;
  return add_mesh(bilinear_mesh(positions, normals, uvs, patches), p, at, patches.size());
}

Status Shapes::add_curve(const Parameters& p, const ShapePlacement& at) {
  auto strands = read_curve(p, report_);
  if (!strands) return {};
  Surface surface = at.surface;
  if (surface.light) report_.warn(p.place(), "curves that emit light are not supported; they are dark");
  surface.light = nullptr;
  auto material = surfaces_.material(surface, 0, p.place());
  if (!material) return fail(material.error());
  if (!*material) return {};
  float growth = even_scale(at.to_world);
  if (growth == 0) {
    report_.warn(p.place(), "curves that are scaled unevenly have their mean width");
    growth = static_cast<float>(pow(std::fabs(at.to_world.determinant()), 1.0 / 3));
  }
  const Transform transform = at.to_world.transform();
  for (Vec3& point : strands->points) point = transform.point(point);
  for (float& radius : strands->radii) radius *= growth;
  for (Vec3& normal : strands->normals) normal = transform.normal(normal);
  return builder_.add_curves({std::move(*strands), **material}, shape_name(p, "curves"), at.object,
                             file_place(p.place()));
}

Status Shapes::add_subdivision(const Parameters& p, const ShapePlacement& at) {
  MeshDescription control;
  control.positions = p.vectors("P");
  control.triangles = triangles_of(p, control.positions.size());
  if (!has_valid_indices(control)) {
    report_.warn(p.place(), "a subdivision surface with a corner that is no vertex is left out");
    return {};
  }
  p.find("scheme");
  const char* given = p.has("nlevels") && !p.has("levels") ? "nlevels" : "levels";
  const int levels = p.integer_in(given, 3, 0, kMaxSubdivisionLevels);
  const std::uint64_t triangles = std::uint64_t{control.triangles.size()} << (2 * levels);
  if (auto fits = builder_.check_triangles(*p.place().file, triangles); !fits) return fits;
  return add_mesh(subdivide(control, levels), p, at);
}

Status Shapes::add_mesh(MeshDescription mesh, const Parameters& p, const ShapePlacement& at,
                        std::optional<std::size_t> shapes) {
  const std::size_t vertices = mesh.positions.size();
  if (!mesh.normals.empty() && mesh.normals.size() != vertices) {
    report_.warn(p.place(), "normals are ignored: there is not one for each vertex");
    mesh.normals.clear();
  }
  if (!mesh.tangents.empty() && mesh.tangents.size() != vertices) {
    report_.warn(p.place(), "tangents are ignored: there is not one for each vertex");
    mesh.tangents.clear();
  }
  if (!has_valid_indices(mesh)) {
    report_.warn(p.place(), "triangles with a corner that is no vertex are left out");
    std::erase_if(mesh.triangles, [&](const Corners& t) {
      return std::any_of(t.begin(), t.end(), [&](std::uint32_t v) { return v >= vertices; });
    });
  }
  if (mesh.uvs.empty() && surfaces_.is_textured(at.surface)) give_corner_uvs(mesh, kDefaultUvs);
  move_to_placement(mesh, at);
  const TriangleAreas areas = areas_of(mesh);
  const std::size_t lights = std::max<std::size_t>(shapes.value_or(mesh.triangles.size()), 1);
  auto material = surfaces_.material(at.surface, areas.sum / static_cast<double>(lights), p.place());
  if (!material) return fail(material.error());
  if (!*material) return {};
  if (at.surface.light && at.surface.light->power && lights > 1 && !areas.are_equal)
    report_.warn(p.place(),
                 "the power of each part of an area light is not supported, because their areas differ; all "
                 "have the radiance of the mean area");
  mesh.triangle_materials = {**material};
  return builder_.add_mesh(std::move(mesh), shape_name(p, "mesh"), at.object, *p.place().file,
                           p.place().line);
}

}  // namespace tessera::core::pbrt
