// Shapes of a scene file and their transforms.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/scene/loader/scene_file.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

using scene_keys::kNormals;
using scene_keys::kShapeTypes;

using Words = std::span<const std::string_view>;

// Farther, the sine of the angle would lose its accuracy.
constexpr Bounds kDegrees{[](double v) { return v >= -3600 && v <= 3600; }, "between -3600 and 3600"};

Vec3 read_scale(const Field& field) {
  if (field.value().get_if<JsonValue::Array>()) return read_vec3(field, bounds::kNotZero);
  const float factor = read_float(field, bounds::kNotZero);
  return {factor, factor, factor};
}

Transform read_rotation(const Field& field) {
  const std::size_t mistakes_before = field.mistakes().count();
  const ObjectReader object(field, scene_keys::kRotation);
  const Vec3 axis = read_or(object, "axis", Vec3{0, 1, 0}, read_vec3, bounds::kAny);
  const float degrees = read_or(object, "degrees", 0.0f, read_float, kDegrees);
  if (field.mistakes().count() > mistakes_before) return {};
  if (length(axis) > 0 && std::isfinite(length(axis))) return rotation(axis, degrees);
  field.mistake("'axis' must have a length that is greater than 0 and can be computed");
  return {};
}

Transform read_step(const Field& field) {
  const ObjectReader object(field, scene_keys::kTransformStep);
  const auto* members = field.value().get_if<JsonValue::Object>();
  if (members == nullptr) return {};
  if (members->size() != 1) {
    field.mistake("a step is one of 'scale', 'rotate' and 'translate'; write several as a list of steps");
    return {};
  }
  if (const auto factors = object.find("scale")) return scaling(read_scale(*factors));
  if (const auto turn = object.find("rotate")) return read_rotation(*turn);
  if (const auto offset = object.find("translate"))
    return translation(read_vec3(*offset, bounds::kAny));
  return {};
}

bool is_usable(const Transform& t) {
  const float determinant = t.determinant();
  return is_finite(t.origin) && std::isfinite(determinant) && determinant != 0;
}

// Whether the map keeps spheres round: its axes are of one length and at right angles.
bool is_similarity(const Transform& t) {
  const Vec3 s = t.scales();
  const float tolerance = 1e-4f * s.x;
  return std::fabs(s.y - s.x) <= tolerance && std::fabs(s.z - s.x) <= tolerance &&
         std::fabs(dot(t.x_axis, t.y_axis)) <= tolerance * s.x &&
         std::fabs(dot(t.y_axis, t.z_axis)) <= tolerance * s.x &&
         std::fabs(dot(t.z_axis, t.x_axis)) <= tolerance * s.x;
}

std::optional<std::uint32_t> read_material_name(const Field& field,
                                                const std::vector<MaterialEntry>& materials) {
  const std::string name = read_text(field);
  const auto found = std::find_if(materials.begin(), materials.end(),
                                  [&](const auto& m) { return m.material.name == name; });
  if (found != materials.end()) return static_cast<std::uint32_t>(found - materials.begin());
  std::vector<std::string_view> known;
  for (const auto& entry : materials) known.push_back(entry.material.name);
  if (!name.empty())
    field.mistake(fmt::format("there is no material {}{}", in_quotes(name), suggestion(name, known)));
  return std::nullopt;
}

// What all shapes share.
struct Common {
  std::optional<std::uint32_t> material;
  Transform transform;
};

Common read_common(const ObjectReader& object, const std::vector<MaterialEntry>& materials) {
  Common common;
  if (const auto material = object.find("material"))
    common.material = read_material_name(*material, materials);
  if (const auto transform = object.find("transform")) common.transform = read_transform(*transform);
  return common;
}

MeshEntry read_mesh(const Field& field, const std::vector<MaterialEntry>& materials) {
  const ObjectReader object(field, scene_keys::kMesh);
  const Common common = read_common(object, materials);
  MeshEntry mesh;
  if (const auto file = object.find("file")) {
    mesh.file = read_text(*file);
    mesh.file_place = file->place();
  }
  mesh.normals = read_or(object, "normals", mesh.normals, read_choice, Words(kNormals));
  mesh.material = common.material;
  mesh.transform = common.transform;
  return mesh;
}

ShapeDescription read_sphere(const Field& field, const std::vector<MaterialEntry>& materials) {
  const std::size_t mistakes_before = field.mistakes().count();
  const ObjectReader object(field, scene_keys::kSphere);
  const Common common = read_common(object, materials);
  const Vec3 center = read_or(object, "center", Vec3{0, 0, 0}, read_vec3, bounds::kCoordinate);
  const float radius = read_or(object, "radius", 1.0f, read_float, bounds::kPositive);
  if (field.mistakes().count() > mistakes_before) return SphereDescription{};
  if (!is_similarity(common.transform))
    field.mistake("a sphere must stay round: its transform must scale by the same factor in all directions");
  const SphereDescription sphere{common.transform.point(center), radius * common.transform.scales().x,
                                 common.material.value_or(0)};
  if (!is_finite(sphere.center) || !std::isfinite(sphere.radius) || !(sphere.radius > 0))
    field.mistake("the transformed sphere is too large or too small to be computed");
  return sphere;
}

// A mirrored quad turns into triangles, so that its uv and its outside stay where they are.
MeshDescription mirrored_quad(const QuadDescription& q) {
  MeshDescription mesh;
  mesh.positions = {q.corner, q.corner + q.edge_u, q.corner + q.edge_u + q.edge_v, q.corner + q.edge_v};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  mesh.triangle_materials = {q.material};
  return mesh;
}

ShapeDescription read_quad(const Field& field, const std::vector<MaterialEntry>& materials) {
  const std::size_t mistakes_before = field.mistakes().count();
  const ObjectReader object(field, scene_keys::kQuad);
  const Common common = read_common(object, materials);
  const Transform& t = common.transform;
  const auto corner = read_or(object, "corner", Vec3{0, 0, 0}, read_vec3, bounds::kCoordinate);
  const auto edge_u = read_or(object, "edge_u", Vec3{}, read_vec3, bounds::kCoordinate);
  const auto edge_v = read_or(object, "edge_v", Vec3{}, read_vec3, bounds::kCoordinate);
  if (field.mistakes().count() > mistakes_before) return QuadDescription{};
  const QuadDescription quad{t.point(corner), t.direction(edge_u), t.direction(edge_v),
                             common.material.value_or(0)};
  const float area = length(cross(quad.edge_u, quad.edge_v));
  if (!(area > 0) || !std::isfinite(area) || !is_finite(quad.corner))
    field.mistake("'edge_u' and 'edge_v' must span an area that is greater than 0 and can be computed");
  if (t.determinant() < 0) return mirrored_quad(quad);
  return quad;
}

}  // namespace

Transform read_transform(const Field& field) {
  const auto* steps = field.value().get_if<JsonValue::Array>();
  if (steps == nullptr) {
    field.must_be("a list of steps such as [{\"scale\": 2}, {\"translate\": [0, 1, 0]}]");
    return {};
  }
  const std::size_t mistakes_before = field.mistakes().count();
  Transform all;
  for (std::size_t i = 0; i < steps->size(); ++i) all = compose(read_step(field.element(i)), all);
  if (field.mistakes().count() > mistakes_before) return {};
  if (is_usable(all)) return all;
  field.mistake("the steps together scale or move too far to be computed");
  return {};
}

std::vector<ShapeEntry> read_shapes(const Field& field, const std::vector<MaterialEntry>& materials) {
  const auto* items = field.value().get_if<JsonValue::Array>();
  if (items == nullptr || items->empty()) {
    field.must_be("a list of at least one shape");
    return {};
  }
  std::vector<ShapeEntry> shapes;
  for (std::size_t i = 0; i < items->size(); ++i) {
    const Field entry = field.element(i);
    const auto type = read_type(entry, kShapeTypes, "shape");
    if (!type) continue;
    if (*type == 0) shapes.push_back({read_mesh(entry, materials), entry.place()});
    if (*type == 1) shapes.push_back({read_sphere(entry, materials), entry.place()});
    if (*type == 2) shapes.push_back({read_quad(entry, materials), entry.place()});
  }
  return shapes;
}

}  // namespace tessera::core
