// SPDX-License-Identifier: Apache-2.0
#include "core/scene/writer/shape_writer.hpp"

#include <algorithm>
#include <utility>

#include "core/base/overloaded.hpp"
#include "core/scene/loader/scene_keys.hpp"
#include "core/scene/tables/shape_tables.hpp"
#include "core/scene/writer/curve_writer.hpp"
#include "core/scene/writer/motion_text.hpp"
#include "core/scene/writer/ply_writer.hpp"

namespace tessera::core {
namespace {

using json_text::Object;

// Whether the name is none, or the one that the loader gives a shape without a name.
bool is_default_name(const std::string& name) {
  return name.empty() || name.starts_with("shapes[");
}

// The materials that a mesh uses, in the order of first use, and the place of each triangle's among them.
struct MeshMaterials {
  std::vector<std::uint32_t> used, of_triangles;
};

MeshMaterials materials_of(const MeshDescription& mesh) {
  MeshMaterials materials;
  std::map<std::uint32_t, std::uint32_t> places;
  for (const std::uint32_t material : mesh.triangle_materials) {
    const auto [place, is_new] =
        places.try_emplace(material, static_cast<std::uint32_t>(materials.used.size()));
    if (is_new) materials.used.push_back(material);
    materials.of_triangles.push_back(place->second);
  }
  return materials;
}

}  // namespace

// The name of its file, or of that of each of its steps.
Result<std::string> ShapeWriter::mesh_file_text(const MeshDescription& mesh,
                                                const std::vector<std::uint32_t>& materials) {
  if (mesh.steps.empty()) {
    const auto path = write_file_("mesh", meshes_++, "ply", write_ply(mesh, materials));
    if (!path) return fail(path.error());
    return json_text::text(*path);
  }
  Track<std::string> files;
  MeshDescription at_step = mesh;
  at_step.steps = {};
  for (const auto& [frame, positions, normals, tangents] : mesh.steps) {
    at_step.positions = positions;
    at_step.normals = normals;
    at_step.tangents = tangents;
    auto path = write_file_("mesh", meshes_++, "ply", write_ply(at_step, materials));
    if (!path) return fail(path.error());
    files.frames.push_back(frame);
    files.values.push_back(std::move(*path));
  }
  return keyframes_text(files, [](const std::string& path) { return json_text::text(path); });
}

Result<Object> ShapeWriter::mesh_object(const MeshDescription& mesh) {
  MeshMaterials materials = materials_of(mesh);
  const bool has_list = mesh.triangle_materials.size() > 1;
  if (!has_list) materials.of_triangles.clear();
  const auto file = mesh_file_text(mesh, materials.of_triangles);
  if (!file) return fail(file.error());
  Object object;
  object.add("type", json_text::text("mesh")).add("file", *file);
  if (has_list) {
    std::vector<std::string> names;
    for (const std::uint32_t material : materials.used) names.push_back(material_name(material));
    object.add("materials", json_text::list(names));
  } else {
    object.add("material", material_name(materials.used.front()));
  }
  if (!mesh.colors.empty()) object.add("vertex_colors", json_text::text("use"));
  if (mesh.normals.empty()) object.add("normals", json_text::text("flat"));
  return object;
}

Object ShapeWriter::instance_object(const InstanceDescription& instance, const InstanceMotion* motion) const {
  Object object;
  object.add("type", json_text::text("instance"));
  object.add("object", json_text::text(names_.objects[instance.object]));
  if (instance.material) object.add("material", material_name(*instance.material));
  if (motion != nullptr)
    object.add("transform", motion_text(motion->steps));
  else if (instance.to_world != Transform())
    object.add("transform", transform_text(instance.to_world));
  return object;
}

// A shape that is written as it is described.
template <typename Shape>
Object ShapeWriter::plain_object(std::string_view type, const Shape& shape) const {
  Object object;
  object.add("type", json_text::text(type));
  TableWriter(names_, object).write(kKeys<Shape>, shape, ParameterTracks());
  return object.add("material", material_name(shape.material));
}

// The unit disk under a matrix, which keeps the radii exactly.
Object ShapeWriter::disk_object(const DiskDescription& disk) const {
  Object object;
  object.add("type", json_text::text("disk")).add("radius", "1");
  object.add_unless("0", "inner_radius", json_text::number(disk.inner));
  if (disk.flipped) object.add("flip_normal", json_text::boolean(true));
  object.add("material", material_name(disk.material));
  const Vec3 normal = cross(disk.radius_u, disk.radius_v);
  object.add("transform", transform_text({disk.radius_u, disk.radius_v, normal, disk.center}));
  return object;
}

Object ShapeWriter::cylinder_object(const CylinderDescription& cylinder) const {
  Object object;
  object.add("type", json_text::text("cylinder")).add("start", json_text::vector(Vec3{0, 0, 0}));
  object.add("end", json_text::vector(Vec3{0, 0, 1})).add("radius", "1");
  if (cylinder.flipped) object.add("flip_normal", json_text::boolean(true));
  object.add("material", material_name(cylinder.material));
  object.add("transform",
             transform_text({cylinder.radius_u, cylinder.radius_v, cylinder.axis, cylinder.start}));
  return object;
}

Result<Object> ShapeWriter::curves_object(const CurvesDescription& curves) {
  const CurveStrands& strands = curves.strands;
  auto path = write_file_("curves", curves_++, "ply", write_curve_file(strands));
  if (!path) return fail(path.error());
  Object object;
  object.add("type", json_text::text("curves")).add("file", json_text::text(*path));
  object.add("basis", json_text::word(scene_keys::kCurveBases, strands.basis));
  object.add("shape", json_text::word(scene_keys::kCurveShapes, strands.shape));
  if (strands.radii.size() == 1) object.add("radius", json_text::number(strands.radii[0]));
  object.add("material", material_name(curves.material));
  return object;
}

Result<std::vector<std::string>> ShapeWriter::texts(
    const std::vector<ShapeDescription>& shapes, const std::vector<std::string>& names,
    const std::map<std::uint32_t, const InstanceMotion*>& motions) {
  std::vector<std::string> texts;
  for (std::uint32_t i = 0; i < shapes.size(); ++i) {
    const auto motion = motions.find(i);
    Result<Object> object = std::visit(
        Overloaded{
            [&](const MeshDescription& mesh) { return mesh_object(mesh); },
            [&](const SphereDescription& sphere) -> Result<Object> { return plain_object("sphere", sphere); },
            [&](const QuadDescription& quad) -> Result<Object> { return plain_object("quad", quad); },
            [&](const DiskDescription& disk) -> Result<Object> { return disk_object(disk); },
            [&](const CylinderDescription& cylinder) -> Result<Object> { return cylinder_object(cylinder); },
            [&](const CurvesDescription& curves) { return curves_object(curves); },
            [&](const InstanceDescription& instance) -> Result<Object> {
              return instance_object(instance, motion == motions.end() ? nullptr : motion->second);
            },
        },
        shapes[i]);
    if (!object) return fail(object.error());
    if (i < names.size() && !is_default_name(names[i])) object->add("name", json_text::text(names[i]));
    texts.push_back(object->on_one_line());
  }
  return texts;
}

}  // namespace tessera::core
