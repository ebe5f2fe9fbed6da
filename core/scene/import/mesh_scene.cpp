// SPDX-License-Identifier: Apache-2.0
// A bare mesh as a scene: the mesh, with its materials if it has any, in a studio.
#include <fmt/format.h>

#include <optional>
#include <utility>

#include "core/scene/import/front_ends.hpp"
#include "core/scene/import/indexed_mesh.hpp"
#include "core/scene/import/scene_builder.hpp"
#include "core/scene/import/scene_format.hpp"
#include "core/scene/loader/mesh_file.hpp"
#include "core/scene/loader/obj_materials.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

constexpr int kMeshSceneWidthPx = 800, kMeshSceneHeightPx = 600;

// Printers build upwards along z; the front of a print is at the lower edge of its plate.
constexpr SceneDefaults kStlDefaults{.up = {0, 0, 1}, .front = {0, -1, 0}};

// The mesh; an error gets the name of the file.
Result<MeshDescription> named(const std::string& file, Result<MeshDescription> mesh) {
  if (mesh) return mesh;
  return fail(mesh.error().code, fmt::format("{} {}", in_quotes(file), mesh.error().message));
}

Result<ObjFile> read_obj_file(SceneBuilder& builder) {
  const std::string name = builder.shown(builder.scene_path());
  const auto bytes = builder.read(builder.scene_path());
  if (!bytes) return fail(bytes.error().within(name));
  return read_obj(*bytes, name, builder.limits().triangles, builder.limits().warnings);
}

Result<MeshDescription> read_obj_mesh(SceneBuilder& builder, ObjMaterials& materials) {
  const std::string& path = builder.scene_path();
  const std::string name = builder.shown(path);
  const auto obj = read_obj_file(builder);
  if (!obj) return fail(obj.error());
  builder.warnings().of(name) = obj->text.warnings;
  const auto of_runs = materials.of_runs(path, *obj, std::nullopt);
  if (!of_runs) return fail(of_runs.error().within(name));
  auto mesh = named(name, build_mesh(*obj, NormalsMode::kFile, Transform(), *of_runs));
  if (mesh) materials.settle_bump_heights(*mesh);
  return mesh;
}

Result<MeshDescription> read_indexed_mesh(SceneBuilder& builder, ObjMaterials& materials,
                                          SceneFormat format) {
  const std::string name = builder.shown(builder.scene_path());
  auto bytes = builder.read(builder.scene_path());
  if (!bytes) return fail(bytes.error().within(name));
  const SceneLimit& limit = builder.limits().triangles;
  auto file = format == SceneFormat::kStl ? read_stl(*bytes, name, limit) : read_ply(*bytes, name, limit);
  if (!file) return fail(file.error());
  *bytes = std::string();  // frees it
  builder.warnings().of(name) = file->warnings;
  auto of_images = materials.of_images(builder.scene_path(), *file, std::nullopt);
  if (!of_images) return fail(of_images.error().within(name));
  file->mesh.triangle_materials = std::move(*of_images);
  return named(name, build_indexed_mesh(std::move(file->mesh), NormalsMode::kFile, Transform(),
                                        VertexColors::kUse, builder.warnings().of(name)));
}

}  // namespace

Result<SceneDescription> read_mesh_scene(AssetSource& assets, const std::string& scene_path,
                                         const std::string& display_path, const SceneLimits& limits) {
  SceneBuilder builder(assets, scene_path, display_path, limits);
  builder.scene().settings.width_px = kMeshSceneWidthPx;
  builder.scene().settings.height_px = kMeshSceneHeightPx;
  ObjMaterials materials(builder.files(), builder.scene(), builder.warnings());
  const auto format = format_of(assets, scene_path);
  if (!format) return fail(format.error().within(display_path));
  auto mesh = *format == SceneFormat::kObj ? read_obj_mesh(builder, materials)
                                           : read_indexed_mesh(builder, materials, *format);
  if (!mesh) return fail(mesh.error());
  if (auto counted = builder.count_triangles(scene_path, mesh->triangles.size()); !counted)
    return fail(counted.error().within(display_path));
  builder.add_shape(std::move(*mesh), scene_path, std::nullopt, {scene_path});
  return builder.finish(format == SceneFormat::kStl ? kStlDefaults : SceneDefaults());
}

}  // namespace tessera::core
