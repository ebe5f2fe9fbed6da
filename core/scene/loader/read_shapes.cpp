// SPDX-License-Identifier: Apache-2.0
// Reads shapes of a scene file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/placement.hpp"
#include "core/scene/analytic_shapes.hpp"
#include "core/scene/loader/scene_file.hpp"
#include "core/scene/loader/table_reader.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

using scene_keys::kShapeTypes;

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

std::vector<std::uint32_t> read_material_names(const Field& field,
                                               const std::vector<MaterialEntry>& materials) {
  const auto* items = field.value().get_if<JsonValue::Array>();
  if (items == nullptr || items->empty()) {
    field.must_be("a list of names of materials");
    return {};
  }
  std::vector<std::uint32_t> indices;
  for (std::size_t i = 0; i < items->size(); ++i)
    if (const auto index = read_material_name(field.element(i), materials)) indices.push_back(*index);
  return indices;
}

// The keys of a shape: those of its table, and those common to all shapes.
template <typename Table>
struct Written {
  Table keys{};
  std::optional<std::uint32_t> material{};
  TransformEntry placement{};

  // That of the shape's description: an animated shape stays in its own space.
  Transform transform() const { return placement.motion.empty() ? placement.transform : Transform(); }
};

template <typename Table>
Written<Table> read_written(const TableReader& read, const std::vector<MaterialEntry>& materials) {
  Written<Table> shape;
  ParameterTracks none;
  read.read(kKeys<Table>, shape.keys, none);
  if (const auto material = read.find("material")) shape.material = read_material_name(*material, materials);
  if (const auto transform = read.find("transform")) shape.placement = read_transform(*transform);
  return shape;
}

template <typename Table>
TableReader reader_of(const Field& field) {
  const std::size_t type = ShapeKeys(Table()).index();
  return TableReader(field, kShapeTypes[type], rules_of(kTypeKey, kKeys<Table>), {});
}

// A single keyframe is as good as none.
void read_mesh_files(const Field& field, MeshEntry& mesh) {
  mesh.file_place = field.place();
  if (!has_keyframes(field)) {
    mesh.file = read_text(field);
    return;
  }
  for (const auto& [frame, file] : read_keyframes(field)) {
    mesh.steps.frames.push_back(frame);
    mesh.steps.values.push_back(read_text(file));
  }
  if (!mesh.steps.empty()) mesh.file = mesh.steps.values.front();
  if (mesh.steps.frames.size() < 2) mesh.steps = {};
}

ShapeEntry read_mesh(const Field& field, const std::vector<MaterialEntry>& materials) {
  const auto object = reader_of<MeshKeys>(field);
  const auto common = read_written<MeshKeys>(object, materials);
  MeshEntry mesh;
  if (const auto file = object.find("file")) read_mesh_files(*file, mesh);
  mesh.normals = common.keys.normals;
  mesh.material = common.material;
  if (const auto material = object.find("default_material"))
    mesh.default_material = read_material_name(*material, materials);
  if (const auto list = object.find("materials")) {
    mesh.materials = read_material_names(*list, materials);
    if (mesh.material || mesh.default_material)
      list->mistake("leave 'material' and 'default_material' out where 'materials' are given, or this");
  }
  mesh.colors =
      common.keys.vertex_colors.value_or(mesh.material ? VertexColors::kIgnore : VertexColors::kUse);
  mesh.transform = common.transform();
  return {std::move(mesh), field.place(), common.placement};
}

ShapeEntry read_sphere(const Field& field, const std::vector<MaterialEntry>& materials) {
  const std::size_t mistakes_before = field.mistakes().count();
  const auto common = read_written<SphereDescription>(reader_of<SphereDescription>(field), materials);
  if (field.mistakes().count() > mistakes_before)
    return {ShapeDescription(SphereDescription{}), field.place()};
  const Transform t = common.transform();
  if (!(uniform_scale(t, 1e-4f) > 0))
    field.mistake("a sphere must stay round: its transform must scale by the same factor in all directions");
  const auto& [center, radius, unused] = common.keys;
  const SphereDescription sphere{t.point(center), radius * t.scales().x, common.material.value_or(0)};
  if (!is_finite(sphere.center) || !std::isfinite(sphere.radius) || !(sphere.radius > 0))
    field.mistake("the transformed sphere is too large or too small to be computed");
  return {ShapeDescription(sphere), field.place(), common.placement};
}

// Converts a mirrored quad to triangles, which keeps its uv and its outward side.
MeshDescription mirrored_quad(const QuadDescription& q) {
  MeshDescription mesh;
  mesh.positions = {q.corner, q.corner + q.edge_u, q.corner + q.edge_u + q.edge_v, q.corner + q.edge_v};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  mesh.triangle_materials = {q.material};
  return mesh;
}

ShapeEntry read_quad(const Field& field, const std::vector<MaterialEntry>& materials) {
  const std::size_t mistakes_before = field.mistakes().count();
  const auto common = read_written<QuadDescription>(reader_of<QuadDescription>(field), materials);
  const Transform t = common.transform();
  if (field.mistakes().count() > mistakes_before) return {ShapeDescription(QuadDescription{}), field.place()};
  const QuadDescription& written = common.keys;
  const QuadDescription quad{t.point(written.corner), t.direction(written.edge_u),
                             t.direction(written.edge_v), common.material.value_or(0)};
  const float area = length(cross(quad.edge_u, quad.edge_v));
  if (!(area > 0) || !std::isfinite(area) || !is_finite(quad.corner))
    field.mistake("'edge_u' and 'edge_v' must span an area that is greater than 0 and can be computed");
  if (t.determinant() < 0) return {ShapeDescription(mirrored_quad(quad)), field.place()};
  return {ShapeDescription(quad), field.place(), common.placement};
}

// The shape is returned by description(), which is called only if there are no mistakes yet.
template <typename Table, typename Description>
ShapeEntry analytic_entry(const Field& field, std::size_t mistakes_before, const Written<Table>& common,
                          const Description& description) {
  using Shape = decltype(description());
  if (field.mistakes().count() > mistakes_before) return {ShapeDescription(Shape{}), field.place()};
  Shape shape = description();
  shape.material = common.material.value_or(0);
  return {ShapeDescription(placed(shape, common.transform())), field.place(), common.placement};
}

ShapeEntry read_disk(const Field& field, const std::vector<MaterialEntry>& materials) {
  const std::size_t mistakes_before = field.mistakes().count();
  const auto written = read_written<DiskKeys>(reader_of<DiskKeys>(field), materials);
  const DiskKeys& keys = written.keys;
  if (!has_direction(Vec3d(keys.normal)))
    field.mistake("'normal' must have a length that is greater than 0 and can be computed");
  if (!(keys.inner_radius < keys.radius)) field.mistake("'inner_radius' must be less than 'radius'");
  return analytic_entry(field, mistakes_before, written, [&] {
    DiskDescription disk = make_disk(keys.center, keys.normal, keys.radius, keys.inner_radius);
    disk.flipped = keys.flip_normal;
    return disk;
  });
}

ShapeEntry read_cylinder(const Field& field, const std::vector<MaterialEntry>& materials) {
  const std::size_t mistakes_before = field.mistakes().count();
  const auto written = read_written<CylinderKeys>(reader_of<CylinderKeys>(field), materials);
  const CylinderKeys& keys = written.keys;
  if (keys.start == keys.end) field.mistake("'start' and 'end' must be two points");
  return analytic_entry(field, mistakes_before, written, [&] {
    CylinderDescription cylinder = make_cylinder(keys.start, keys.end, keys.radius);
    cylinder.flipped = keys.flip_normal;
    return cylinder;
  });
}

// Lists of the vectors of each curve.
template <typename Read>
void read_lists(const Field& field, std::string_view expected, const Read& read) {
  const auto* lists = field.value().get_if<JsonValue::Array>();
  if (lists == nullptr || lists->empty()) return field.must_be(expected);
  for (std::size_t i = 0; i < lists->size(); ++i) {
    const Field list = field.element(i);
    const auto* items = list.value().get_if<JsonValue::Array>();
    if (items == nullptr || items->empty()) return list.must_be("a list of at least one point");
    read(list, items->size());
  }
}

// The coordinates and, as a fourth number, the radius.
void read_control_point(const Field& field, CurveStrands& strands) {
  const auto* items = field.value().get_if<JsonValue::Array>();
  if (items == nullptr || items->size() != 4) {
    strands.points.push_back(read_vec3(field, ranges::kCoordinate));
    return;
  }
  Vec3 point;
  for (int axis = 0; axis < 3; ++axis)
    point[axis] = read_float(field.element(static_cast<std::size_t>(axis)), ranges::kCoordinate);
  strands.points.push_back(point);
  strands.radii.push_back(read_float(field.element(3), ranges::kNotNegative));
}

void read_control_points(const Field& field, CurveStrands& strands) {
  read_lists(field, "a list of curves, each a list of points [x, y, z] or [x, y, z, radius]",
             [&](const Field& curve, std::size_t count) {
               for (std::size_t i = 0; i < count; ++i) read_control_point(curve.element(i), strands);
               strands.counts.push_back(static_cast<std::uint32_t>(count));
             });
  if (!strands.radii.empty() && strands.radii.size() != strands.points.size())
    field.mistake("either all points have a radius as their fourth number, or none");
}

ShapeEntry read_curves(const Field& field, const std::vector<MaterialEntry>& materials) {
  const auto object = reader_of<CurvesKeys>(field);
  const auto common = read_written<CurvesKeys>(object, materials);
  CurvesEntry curves;
  curves.place = field.place();
  curves.material = common.material.value_or(0);
  curves.transform = common.transform();
  CurveStrands& strands = curves.strands;
  strands.basis = common.keys.basis;
  strands.shape = common.keys.shape;
  curves.radius = common.keys.radius;
  const auto file = object.find("file"), points = object.find("points");
  if (file.has_value() == points.has_value()) {
    field.mistake("curves need either 'points' or a 'file'");
  } else if (file) {
    curves.file = read_text(*file);
    curves.file_place = file->place();
  } else {
    read_control_points(*points, strands);
  }
  if (const auto normals = object.find("normals"))
    read_lists(*normals, "a list of normals for each curve", [&](const Field& curve, std::size_t count) {
      for (std::size_t i = 0; i < count; ++i)
        strands.normals.push_back(read_vec3(curve.element(i), ranges::kCoordinate));
    });
  if (!(uniform_scale(common.transform(), 1e-4f) > 0))
    field.mistake("curves must stay round: their transform must scale by the same factor in all directions");
  return {std::move(curves), field.place(), common.placement};
}

// The index among `objects`.
std::optional<std::uint32_t> read_object_name(const Field& field, const std::vector<ObjectEntry>& objects) {
  const std::string name = read_text(field);
  const auto found =
      std::find_if(objects.begin(), objects.end(), [&](const auto& object) { return object.name == name; });
  if (found != objects.end()) return static_cast<std::uint32_t>(found - objects.begin());
  std::vector<std::string_view> known;
  for (const auto& object : objects) known.push_back(object.name);
  if (!name.empty())
    field.mistake(fmt::format("there is no object {}{}", in_quotes(name), suggestion(name, known)));
  return std::nullopt;
}

bool has_emissive_sphere(const ObjectEntry& object, std::optional<std::uint32_t> material,
                         const std::vector<MaterialEntry>& materials) {
  return std::any_of(object.shapes.begin(), object.shapes.end(), [&](const ShapeEntry& entry) {
    const auto* shape = std::get_if<ShapeDescription>(&entry.shape);
    const auto* sphere = shape == nullptr ? nullptr : std::get_if<SphereDescription>(shape);
    return sphere != nullptr &&
           !is_black(materials[material.value_or(sphere->material)].material.emission.value);
  });
}

ShapeEntry read_instance(const Field& field, const std::vector<MaterialEntry>& materials,
                         const std::vector<ObjectEntry>& objects) {
  const std::size_t mistakes_before = field.mistakes().count();
  const auto object = reader_of<InstanceKeys>(field);
  const auto common = read_written<InstanceKeys>(object, materials);
  InstanceDescription instance{0, common.placement.transform, common.material};
  const auto entry = [&] { return ShapeEntry{ShapeDescription(instance), field.place(), common.placement}; };
  if (const auto name = object.find("object")) instance.object = read_object_name(*name, objects).value_or(0);
  if (field.mistakes().count() > mistakes_before) return entry();
  if (!Placement::can_place(instance.to_world)) {
    field.mistake("the transform flattens the object, or scales or moves it too far to be computed");
  } else if (has_emissive_sphere(objects[instance.object], instance.material, materials) &&
             !(uniform_scale(instance.to_world, kRoundToRounding) > 0)) {
    field.mistake(
        "a sphere of the object emits light and must stay round: the transform must scale by the same factor "
        "in all directions");
  }
  return entry();
}

std::string read_shape_name(const Field& field) {
  std::string name = read_text(field);
  if (name.empty()) field.must_be("a text that is not empty");
  return name;
}

// Objects are the same in all instances, and so are their shapes.
void refuse_motion(const ShapeEntry& entry, const Field& field) {
  if (const auto transform = find_member_field(field, "transform");
      transform && !entry.placement.motion.empty())
    transform->mistake("a shape of an object cannot move by itself: animate the transforms of its instances");
}

}  // namespace

std::vector<ObjectEntry> read_objects(const Field& field, const std::vector<MaterialEntry>& materials) {
  const auto entries = read_named(field);
  std::vector<ObjectEntry> objects;  // all names first, for instances
  for (const auto& [name, entry] : entries) objects.push_back({name, {}});
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const ObjectReader object(entries[i].second, scene_keys::kObject);
    if (const auto shapes = object.find("shapes"))
      objects[i].shapes = read_shapes(*shapes, materials, objects, ShapeOwner::kObject);
  }
  return objects;
}

std::vector<ShapeEntry> read_shapes(const Field& field, const std::vector<MaterialEntry>& materials,
                                    const std::vector<ObjectEntry>& objects, ShapeOwner owner) {
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
    if (*type == 0) shapes.push_back(read_mesh(entry, materials));
    if (*type == 1) shapes.push_back(read_sphere(entry, materials));
    if (*type == 2) shapes.push_back(read_quad(entry, materials));
    if (*type == 4) shapes.push_back(read_disk(entry, materials));
    if (*type == 5) shapes.push_back(read_cylinder(entry, materials));
    if (*type == 6) shapes.push_back(read_curves(entry, materials));
    if (*type == 3) shapes.push_back(read_instance(entry, materials, objects));
    if (const auto name = find_member_field(entry, "name")) shapes.back().name = read_shape_name(*name);
    if (owner == ShapeOwner::kObject) refuse_motion(shapes.back(), entry);
  }
  return shapes;
}

}  // namespace tessera::core
