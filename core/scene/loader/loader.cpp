#include "core/scene/loader/loader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <new>

#include "core/scene/loader/asset_cache.hpp"
#include "core/scene/loader/mesh_builder.hpp"
#include "core/scene/loader/plausibility.hpp"
#include "core/scene/loader/scene_file.hpp"
#include "core/scene/loader/text_lines.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

constexpr std::string_view kMaterialAdvice = "give the shape a \"material\" in the scene file";

// Adds assets to what the scene file says. What is wrong is added to the Mistakes at the place that names the
// asset.
class SceneAssembler {
 public:
  SceneAssembler(AssetSource& assets, Mistakes& mistakes, const SceneLimits& limits)
      : cache_(assets, limits), mistakes_(mistakes), limits_(limits) {}

  SceneDescription assemble(SceneFile file);

 private:
  using MaterialNames = std::map<std::string, std::uint32_t, std::less<>>;

  void add_texture(const TextureEntry& entry);
  // To the scene or to an object of it. `name` is what messages call the shape.
  template <typename Owner>
  void add_shape(ShapeEntry entry, std::string name, Owner& owner);
  void add_object(ObjectEntry entry);
  Result<MeshDescription> load_mesh(const MeshEntry& entry);
  // Adds a file's triangles to those of the scene, if the limits allow it.
  Status count_triangles(const std::string& path, std::size_t triangles);
  Result<MaterialNames> load_libraries(const std::string& obj_path, const ObjFile& obj);
  Result<std::vector<std::uint32_t>> own_materials(const std::string& obj_path, const ObjFile& obj);
  Result<std::uint32_t> add_library_material(const std::string& library_path, const MtlMaterial& material);
  Result<int> library_texture(const std::string& library_path, const MtlMaterial& material);

  AssetCache cache_;
  Mistakes& mistakes_;
  const SceneLimits& limits_;
  std::uint64_t triangles_ = 0;
  SceneDescription scene_;
  std::map<std::pair<std::string, std::string>, std::uint32_t> library_materials_;  // by library and name
};

SceneDescription SceneAssembler::assemble(SceneFile file) {
  scene_.settings = file.settings;
  scene_.camera = file.camera;
  scene_.display = file.display;
  scene_.lights = std::move(file.lights);
  scene_.environment = file.environment;
  for (const auto& texture : file.textures) add_texture(texture);
  std::vector<Place> material_places;
  for (auto& entry : file.materials) {
    scene_.materials.push_back(std::move(entry.material));
    material_places.push_back(std::move(entry.place));
  }
  for (auto& object : file.objects) add_object(std::move(object));
  for (std::size_t i = 0; i < file.shapes.size(); ++i)
    add_shape(std::move(file.shapes[i]), fmt::format("shapes[{}]", i), scene_);
  if (mistakes_.empty()) check_plausibility(scene_, material_places, file.shapes_place, mistakes_);
  return std::move(scene_);
}

void SceneAssembler::add_texture(const TextureEntry& entry) {
  auto image = cache_.image(entry.file, entry.color_space);
  if (!image) mistakes_.add(entry.file_place, image.error().message, image.error().code);
  scene_.textures.push_back({image ? *image : nullptr, entry.wrap, entry.scale, entry.offset});
}

void SceneAssembler::add_object(ObjectEntry entry) {
  ObjectDescription object;
  object.name = std::move(entry.name);
  for (std::size_t i = 0; i < entry.shapes.size(); ++i)
    add_shape(std::move(entry.shapes[i]), fmt::format("shapes[{}]", i), object);
  scene_.objects.push_back(std::move(object));
}

template <typename Owner>
void SceneAssembler::add_shape(ShapeEntry entry, std::string name, Owner& owner) {
  if (auto* shape = std::get_if<ShapeDescription>(&entry.shape)) {
    owner.shapes.push_back(std::move(*shape));
    owner.shape_names.push_back(std::move(name));
    return;
  }
  const auto& mesh_entry = *std::get_if<MeshEntry>(&entry.shape);
  auto mesh = load_mesh(mesh_entry);
  if (!mesh) return mistakes_.add(mesh_entry.file_place, mesh.error().message, mesh.error().code);
  owner.shapes.emplace_back(std::move(*mesh));
  owner.shape_names.push_back(fmt::format("{} ({})", name, mesh_entry.file));
}

Result<MeshDescription> SceneAssembler::load_mesh(const MeshEntry& entry) {
  const auto obj = cache_.obj(entry.file);
  if (!obj) return fail(obj.error());
  if (auto counted = count_triangles(entry.file, (*obj)->triangle_count()); !counted)
    return fail(counted.error());
  std::vector<std::uint32_t> materials;
  if (entry.material) {
    materials = {*entry.material};
  } else {
    auto own = own_materials(entry.file, **obj);
    if (!own) return fail(own.error());
    materials = std::move(*own);
  }
  auto mesh = build_mesh(**obj, entry.normals, entry.transform, materials);
  if (!mesh)
    return fail(mesh.error().code, fmt::format("{} {}", in_quotes(entry.file), mesh.error().message));
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

// The scene's materials for the OBJ file's material names.
Result<std::vector<std::uint32_t>> SceneAssembler::own_materials(const std::string& obj_path,
                                                                 const ObjFile& obj) {
  if (obj.runs.front().material == kNoMaterialName)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}:{}: a face has no material (no 'usemtl' comes before it); {}", obj_path,
                            obj.text.first_face_line, kMaterialAdvice));
  const auto known = load_libraries(obj_path, obj);
  if (!known) return fail(known.error());
  std::vector<std::string_view> names;
  for (const auto& [name, index] : *known) names.push_back(name);
  std::vector<std::uint32_t> materials;
  for (std::size_t i = 0; i < obj.material_names.size(); ++i) {
    const std::string& name = obj.material_names[i];
    auto found = known->find(name);
    if (found == known->end()) found = known->find(name_without_comment(name));
    if (found == known->end())
      return fail(
          ErrorCode::kNotFound,
          fmt::format("{}:{}: the 'mtllib' files have no material {}{}; mend it, or {}", obj_path,
                      obj.material_lines[i], in_quotes(name), suggestion(name, names), kMaterialAdvice));
    materials.push_back(found->second);
  }
  return materials;
}

// The scene's materials by the names in the OBJ file's libraries; of equal names the first counts. A name
// that may end with a comment stands for itself first, and without the comment where nothing else has that
// name.
Result<SceneAssembler::MaterialNames> SceneAssembler::load_libraries(const std::string& obj_path,
                                                                     const ObjFile& obj) {
  MaterialNames known, without_comments;
  for (const auto& line : obj.text.libraries) {
    const auto libraries = cache_.libraries(obj_path, line.name);
    if (!libraries)
      return fail(libraries.error().code, fmt::format("{}:{}: {}; mend it, or {}", obj_path, line.line,
                                                      libraries.error().message, kMaterialAdvice));
    for (const auto& library : *libraries)
      for (const auto& material : library.materials) {
        const auto index = add_library_material(library.path, material);
        if (!index) return fail(index.error());
        known.emplace(material.material.name, *index);
        without_comments.emplace(name_without_comment(material.material.name), *index);
      }
  }
  known.merge(without_comments);
  return known;
}

Result<std::uint32_t> SceneAssembler::add_library_material(const std::string& library_path,
                                                           const MtlMaterial& material) {
  const auto [known, is_new] = library_materials_.emplace(
      std::pair(library_path, material.material.name), static_cast<std::uint32_t>(scene_.materials.size()));
  if (!is_new) return known->second;
  Material added = material.material;
  added.name = library_path + ": " + added.name;
  if (!material.albedo_file.empty()) {
    const auto texture = library_texture(library_path, material);
    if (!texture) return fail(texture.error());
    if (auto* lambert = std::get_if<Lambert>(&added.model)) lambert->albedo.texture = *texture;
    if (auto* phong = std::get_if<Phong>(&added.model)) phong->diffuse.texture = *texture;
  }
  scene_.materials.push_back(std::move(added));
  return known->second;
}

Result<int> SceneAssembler::library_texture(const std::string& library_path, const MtlMaterial& material) {
  auto image = cache_.image(path_beside(library_path, material.albedo_file), std::nullopt);
  const std::string without_comment(name_without_comment(material.albedo_file));
  if (!image && image.error().code == ErrorCode::kNotFound && without_comment != material.albedo_file)
    image = cache_.image(path_beside(library_path, without_comment), std::nullopt);
  if (!image)
    return fail(image.error().within(fmt::format("{}:{}: map_Kd", library_path, material.albedo_line)));
  scene_.textures.push_back({std::move(*image), material.wrap, material.scale, material.offset});
  return static_cast<int>(scene_.textures.size()) - 1;
}

Result<SceneDescription> load(AssetSource& assets, const std::string& scene_path,
                              const std::string& display_path, const SceneLimits& limits) {
  const auto text = assets.read(scene_path);
  if (!text) return fail(text.error().within(display_path));
  Mistakes mistakes(display_path);
  SceneFile file = parse_scene_file(*text, display_path, mistakes);
  if (!mistakes.empty()) return fail(mistakes.error());
  SceneDescription scene = SceneAssembler(assets, mistakes, limits).assemble(std::move(file));
  if (!mistakes.empty()) return fail(mistakes.error());
  return scene;
}

}  // namespace

Result<SceneDescription> load_scene(AssetSource& assets, const std::string& scene_path,
                                    const std::string& display_path, const SceneLimits& limits) {
  try {
    return load(assets, scene_path, display_path, limits);
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kResourceExhausted, display_path + ": the scene does not fit into memory");
  }
}

Result<SceneDescription> load_scene_file(const std::string& path) {
  const std::filesystem::path file(path);
  FolderAssets assets(file.parent_path().string());
  return load_scene(assets, file.filename().string(), path);
}

}  // namespace tessera::core
