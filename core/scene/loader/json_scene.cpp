// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/json_scene.hpp"

#include <fmt/format.h>

#include <utility>

#include "core/scene/import/deforming_mesh.hpp"
#include "core/scene/import/indexed_mesh.hpp"
#include "core/scene/import/nested_instances.hpp"
#include "core/scene/import/scene_format.hpp"
#include "core/scene/loader/asset_cache.hpp"
#include "core/scene/loader/coordinate_grid.hpp"
#include "core/scene/loader/curve_file.hpp"
#include "core/scene/loader/file_warnings.hpp"
#include "core/scene/loader/light_limit.hpp"
#include "core/scene/loader/mesh_builder.hpp"
#include "core/scene/loader/mesh_file.hpp"
#include "core/scene/loader/obj_materials.hpp"
#include "core/scene/loader/plausibility.hpp"
#include "core/scene/loader/scene_file.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

// The reason why strands are not sound.
std::string why_unsound(const CurveStrands& strands) {
  for (std::size_t i = 0; i < strands.counts.size(); ++i)
    if (!segments_of(strands.basis, strands.counts[i]))
      return fmt::format("curve {} has {} points; {}", i + 1, strands.counts[i],
                         strands.basis == CurveBasis::kLinear   ? "it needs 2 or more"
                         : strands.basis == CurveBasis::kBezier ? "it needs 4, 7, 10, ..."
                                                                : "it needs 4 or more");
  if (strands.shape == CurveShape::kRibbon)
    return "ribbons need 'normals', one more for each curve than it has segments";
  if (!strands.normals.empty()) return "only ribbons have 'normals'";
  return "the numbers of points of the curves do not add up to the points";
}

// What messages and Cryptomatte call a shape without a file.
std::string shown_name(const ShapeEntry& entry, std::size_t number) {
  return entry.name.empty() ? fmt::format("shapes[{}]", number) : entry.name;
}

// Adds assets to the scene description. Errors are added to the Mistakes at the field that names the asset.
class SceneAssembler {
 public:
  SceneAssembler(AssetSource& assets, Mistakes& mistakes, const SceneLimits& limits)
      : assets_(assets),
        warnings_(limits.warnings),
        cache_(assets, limits, warnings_),
        mistakes_(mistakes),
        limits_(limits) {}
  SceneAssembler(const SceneAssembler&) = delete;
  SceneAssembler& operator=(const SceneAssembler&) = delete;

  SceneDescription assemble(SceneFile file);

 private:
  void add_texture(const TextureEntry& entry);
  void add_grid(const GridEntry& entry);
  void add_scene_shape(ShapeEntry entry, std::size_t number);
  // Adds a shape to the scene or to an object. `number` is its place in the list.
  template <typename Owner>
  void add_shape(ShapeEntry entry, std::size_t number, Owner& owner);
  void add_object(ObjectEntry entry);
  Result<MeshDescription> load_mesh(const MeshEntry& entry);
  template <typename Owner>
  void add_curves(CurvesEntry entry, std::string name, Owner& owner);
  Result<CurvesDescription> load_curves(CurvesEntry entry);
  Result<MeshDescription> load_obj_mesh(const MeshEntry& entry);
  // From a PLY or STL file.
  Result<MeshDescription> load_indexed_mesh(const MeshEntry& entry, SceneFormat format);
  // From PLY files.
  Result<MeshDescription> load_deforming_mesh(const MeshEntry& entry);
  // A file of triangles, which are counted.
  Result<MeshFile> read_mesh_file(const std::string& path, SceneFormat format);
  // The scene's material for each triangle of the file, or one for all.
  Result<std::vector<std::uint32_t>> materials_of(const MeshEntry& entry, const MeshDescription& mesh);
  // Adds a file's triangles to the scene's total, if the limits allow it.
  Status count_triangles(const std::string& path, std::size_t triangles);

  AssetSource& assets_;
  SceneWarnings warnings_;
  AssetCache cache_;
  Mistakes& mistakes_;
  const SceneLimits& limits_;
  std::uint64_t triangles_ = 0;
  SceneDescription scene_;
  ObjMaterials obj_materials_{cache_, scene_, warnings_};
};

SceneDescription SceneAssembler::assemble(SceneFile file) {
  scene_.settings = file.settings;
  scene_.camera = file.camera;
  scene_.display = file.display;
  scene_.lights = std::move(file.lights);
  scene_.environment = file.environment;
  scene_.animation.camera = std::move(file.camera_animation);
  scene_.animation.lights = std::move(file.light_animations);
  scene_.animation.media = std::move(file.media_animations);
  scene_.animation.environment = std::move(file.environment_animation);
  for (const auto& texture : file.textures) add_texture(texture);
  for (const auto& grid : file.grids) add_grid(grid);
  scene_.media = std::move(file.media);
  scene_.camera_medium = file.camera_medium;
  std::vector<Place> material_places;
  for (auto& entry : file.materials) {
    if (!entry.tracks.empty())
      scene_.animation.materials.push_back(
          {static_cast<std::uint32_t>(scene_.materials.size()), std::move(entry.tracks)});
    scene_.materials.push_back(std::move(entry.material));
    material_places.push_back(std::move(entry.place));
  }
  for (auto& object : file.objects) add_object(std::move(object));
  for (std::size_t i = 0; i < file.shapes.size(); ++i) add_scene_shape(std::move(file.shapes[i]), i);
  if (mistakes_.empty()) check_plausibility(scene_, material_places, file.shapes_place, mistakes_);
  scene_.warnings = warnings_.messages();
  for (std::size_t i = 0; i < material_places.size(); ++i)
    if (has_subsurface(scene_.materials[i].model))
      scene_.warnings.push_back(fmt::format("{}: subsurface scattering is approximated by diffuse reflection",
                                            material_places[i].field));
  return std::move(scene_);
}

void SceneAssembler::add_texture(const TextureEntry& entry) {
  if (entry.procedural) {
    scene_.textures.push_back({.image = nullptr, .uv_set = entry.uv_set, .procedural = entry.procedural});
    return;
  }
  auto image =
      cache_.image(entry.file, entry.color_space, entry.channel, FloatFiles::kRefuseSrgb, entry.layer);
  if (!image) mistakes_.add(entry.file_place, image.error().message, image.error().code);
  scene_.textures.push_back({image ? *image : nullptr, entry.wrap, entry.scale, entry.offset, entry.wrap_v,
                             entry.shear, entry.uv_set, entry.filter, std::nullopt});
}

void SceneAssembler::add_grid(const GridEntry& entry) {
  auto grid = cache_.grid(entry.file);
  if (!grid) mistakes_.add(entry.file_place, grid.error().message, grid.error().code);
  VoxelGrid& added = scene_.grids.emplace_back(grid ? std::move(*grid) : VoxelGrid{});
  added.filter = entry.filter;
  added.border = entry.border;
}

void SceneAssembler::add_object(ObjectEntry entry) {
  ObjectDescription object;
  object.name = std::move(entry.name);
  for (std::size_t i = 0; i < entry.shapes.size(); ++i) add_shape(std::move(entry.shapes[i]), i, object);
  scene_.objects.push_back(std::move(object));
}

// An animated shape becomes an instance of an object of its own, so that only its placement changes.
void SceneAssembler::add_scene_shape(ShapeEntry entry, std::size_t number) {
  TransformEntry placement = std::move(entry.placement);
  const auto* shape = std::get_if<ShapeDescription>(&entry.shape);
  const bool is_instance = shape != nullptr && std::holds_alternative<InstanceDescription>(*shape);
  if (placement.motion.empty() || is_instance) {
    add_shape(std::move(entry), number, scene_);
  } else {
    const std::string name = shown_name(entry, number);
    const auto object = static_cast<std::uint32_t>(scene_.objects.size());
    ObjectDescription own{name, {}, {}};
    add_shape(std::move(entry), number, own);
    scene_.objects.push_back(std::move(own));
    scene_.shapes.emplace_back(InstanceDescription{object, placement.transform, std::nullopt});
    scene_.shape_names.push_back(name);
  }
  if (!placement.motion.empty())
    scene_.animation.instances.push_back(
        {static_cast<std::uint32_t>(scene_.shapes.size()) - 1, std::move(placement.motion)});
}

template <typename Owner>
void SceneAssembler::add_shape(ShapeEntry entry, std::size_t number, Owner& owner) {
  std::string name = shown_name(entry, number);
  if (auto* shape = std::get_if<ShapeDescription>(&entry.shape)) {
    owner.shapes.push_back(std::move(*shape));
    owner.shape_names.push_back(std::move(name));
    return;
  }
  const auto* mesh_entry = std::get_if<MeshEntry>(&entry.shape);
  const std::string& file =
      mesh_entry != nullptr ? mesh_entry->file : std::get<CurvesEntry>(entry.shape).file;
  if (entry.name.empty() && !file.empty()) name += fmt::format(" ({})", file);
  if (mesh_entry == nullptr)
    return add_curves(std::get<CurvesEntry>(std::move(entry.shape)), std::move(name), owner);
  auto mesh = load_mesh(*mesh_entry);
  if (!mesh) return mistakes_.add(mesh_entry->file_place, mesh.error().message, mesh.error().code);
  owner.shapes.emplace_back(std::move(*mesh));
  owner.shape_names.push_back(std::move(name));
}

template <typename Owner>
void SceneAssembler::add_curves(CurvesEntry entry, std::string name, Owner& owner) {
  const Place place = entry.file.empty() ? entry.place : entry.file_place;
  auto curves = load_curves(std::move(entry));
  if (!curves) return mistakes_.add(place, curves.error().message, curves.error().code);
  owner.shapes.emplace_back(std::move(*curves));
  owner.shape_names.push_back(std::move(name));
}

// A segment counts as many triangles as it may have parts.
Result<CurvesDescription> SceneAssembler::load_curves(CurvesEntry entry) {
  CurveStrands strands = std::move(entry.strands);
  if (!entry.file.empty()) {
    const auto bytes = assets_.read(entry.file);
    if (!bytes) return fail(bytes.error());
    auto read = read_curve_file(*bytes, entry.file);
    if (!read) return fail(read.error());
    read->basis = strands.basis;
    read->shape = strands.shape;
    if (read->normals.empty()) read->normals = std::move(strands.normals);
    strands = std::move(*read);
  }
  if (strands.radii.empty() != entry.radius.has_value())
    return fail(ErrorCode::kInvalidArgument, entry.radius
                                                 ? "leave 'radius' out where points have radii of their own"
                                                 : "curves need a 'radius', or a radius of each point");
  if (entry.radius) strands.radii = {*entry.radius};
  if (!Curves::is_sound(strands)) return fail(ErrorCode::kInvalidArgument, why_unsound(strands));
  if (auto counted = count_triangles(entry.file, kMaxCurveParts * segment_count(strands)); !counted)
    return fail(counted.error());
  const float scale = entry.transform.scales().x;
  for (Vec3& point : strands.points) point = entry.transform.point(point);
  for (float& radius : strands.radii) radius *= scale;
  for (Vec3& normal : strands.normals) normal = entry.transform.normal(normal);
  return CurvesDescription{std::move(strands), entry.material};
}

Result<MeshDescription> SceneAssembler::load_mesh(const MeshEntry& entry) {
  if (!entry.steps.empty()) return load_deforming_mesh(entry);
  const auto format = format_by_ending(entry.file);
  if (format == SceneFormat::kPly || format == SceneFormat::kStl) return load_indexed_mesh(entry, *format);
  if (!entry.materials.empty())
    return fail(ErrorCode::kInvalidArgument, "'materials' is for PLY files; OBJ files name their materials");
  return load_obj_mesh(entry);
}

Result<MeshFile> SceneAssembler::read_mesh_file(const std::string& path, SceneFormat format) {
  const auto bytes = assets_.read(path);
  if (!bytes) return fail(bytes.error());
  auto file = format == SceneFormat::kStl ? read_stl(*bytes, path, limits_.triangles)
                                          : read_ply(*bytes, path, limits_.triangles);
  if (!file) return fail(file.error());
  // Vertices take memory as well, also those that no triangle has.
  const std::size_t size = std::max(file->mesh.triangles.size(), file->mesh.positions.size() / 3);
  if (auto counted = count_triangles(path, size); !counted) return fail(counted.error());
  return file;
}

// The triangles of each step count.
Result<MeshDescription> SceneAssembler::load_deforming_mesh(const MeshEntry& entry) {
  std::vector<StepFile> steps;
  FileWarnings warnings;
  for (std::size_t i = 0; i < entry.steps.frames.size(); ++i) {
    const std::string& path = entry.steps.values[i];
    if (format_by_ending(path) != SceneFormat::kPly)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("{} is no PLY file: only those can be the keyframes of a mesh, because their "
                              "vertices keep their order",
                              in_quotes(path)));
    auto file = read_mesh_file(path, SceneFormat::kPly);
    if (!file) return fail(file.error());
    if (i == 0) {
      warnings = std::move(file->warnings);
      tell_coarse_coordinates(file->mesh, warnings);
    }
    steps.push_back({entry.steps.frames[i], path, std::move(file->mesh)});
  }
  auto materials = materials_of(entry, steps[0].mesh);
  if (!materials) return fail(materials.error());
  steps[0].mesh.triangle_materials = std::move(*materials);
  auto mesh = join_steps(std::move(steps), entry.normals, entry.transform, entry.colors, warnings);
  if (!warnings_.knows(entry.file)) warnings_.of(entry.file) = std::move(warnings);
  if (mesh) scene_.animation.deforms = true;
  return mesh;
}

Result<MeshDescription> SceneAssembler::load_indexed_mesh(const MeshEntry& entry, SceneFormat format) {
  auto file = read_mesh_file(entry.file, format);
  if (!file) return fail(file.error());
  tell_coarse_coordinates(file->mesh, file->warnings);
  const bool is_known = warnings_.knows(entry.file);
  if (!is_known) warnings_.of(entry.file) = file->warnings;
  if (entry.colors == VertexColors::kIgnore) file->mesh.colors = {};
  const bool has_own = entry.material || !entry.materials.empty();
  auto materials = has_own ? materials_of(entry, file->mesh)
                           : obj_materials_.of_images(entry.file, *file, entry.default_material);
  if (!materials) return fail(materials.error());
  file->mesh.triangle_materials = std::move(*materials);
  auto mesh = build_indexed_mesh(std::move(file->mesh), entry.normals, entry.transform, entry.colors,
                                 is_known ? file->warnings : warnings_.of(entry.file));
  if (!mesh)
    return fail(mesh.error().code, fmt::format("{} {}", in_quotes(entry.file), mesh.error().message));
  return mesh;
}

Result<std::vector<std::uint32_t>> SceneAssembler::materials_of(const MeshEntry& entry,
                                                                const MeshDescription& mesh) {
  if (entry.materials.empty()) {
    const bool is_colored = entry.colors == VertexColors::kUse && !mesh.colors.empty();
    const auto only = entry.material ? entry.material : entry.default_material;
    return std::vector{only ? *only : obj_materials_.default_material(is_colored)};
  }
  std::vector<std::uint32_t> materials;
  materials.reserve(mesh.triangle_materials.size());
  for (const std::uint32_t index : mesh.triangle_materials) {
    if (index >= entry.materials.size())
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("{} has the material_index {}, but there are {} 'materials', counted from 0",
                              in_quotes(entry.file), index, entry.materials.size()));
    materials.push_back(entry.materials[index]);
  }
  return materials;
}

Result<MeshDescription> SceneAssembler::load_obj_mesh(const MeshEntry& entry) {
  const auto obj = cache_.obj(entry.file);
  if (!obj) return fail(obj.error());
  if (auto counted = count_triangles(entry.file, (*obj)->triangle_count()); !counted)
    return fail(counted.error());
  if (!warnings_.knows(entry.file)) {
    warnings_.of(entry.file) = (*obj)->text.warnings;
    tell_coarse_coordinates(**obj, warnings_.of(entry.file));
  }
  std::vector<std::uint32_t> materials;
  if (entry.material) {
    materials = {*entry.material};
  } else {
    auto own = obj_materials_.of_runs(entry.file, **obj, entry.default_material, entry.colors);
    if (!own) return fail(own.error());
    materials = std::move(*own);
  }
  auto mesh = build_mesh(**obj, entry.normals, entry.transform, materials, entry.colors);
  if (!mesh)
    return fail(mesh.error().code, fmt::format("{} {}", in_quotes(entry.file), mesh.error().message));
  obj_materials_.settle_bump_heights(*mesh);
  return mesh;
}

Status SceneAssembler::count_triangles(const std::string& path, std::size_t triangles) {
  triangles_ += triangles;
  const auto& [most, option] = limits_.triangles;
  if (triangles_ <= most) return {};
  return fail(ErrorCode::kResourceExhausted,
              fmt::format("with {} the scene has {} triangles, more than the {} that it may have here ({})",
                          in_quotes(path), triangles_, most, option));
}

}  // namespace

Result<SceneDescription> read_json_scene(AssetSource& assets, const std::string& scene_path,
                                         const std::string& display_path, const SceneLimits& limits) {
  const auto text = assets.read(scene_path);
  if (!text) return fail(text.error().within(display_path));
  Mistakes mistakes(display_path);
  SceneFile file = parse_scene_file(*text, display_path, mistakes);
  if (!mistakes.empty()) return fail(mistakes.error());
  SceneDescription scene = SceneAssembler(assets, mistakes, limits).assemble(std::move(file));
  if (!mistakes.empty()) return fail(mistakes.error());
  if (const Status flat = flatten_instances(scene); !flat) return fail(flat.error().within(display_path));
  if (const Status fit = check_lights(scene, limits.lights); !fit)
    return fail(fit.error().within(display_path));
  return scene;
}

}  // namespace tessera::core
