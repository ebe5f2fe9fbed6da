// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import/scene_builder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "core/image/codecs.hpp"
#include "core/scene/import/deforming_mesh.hpp"
#include "core/scene/import/empty_objects.hpp"
#include "core/scene/import/mesh_repair.hpp"
#include "core/scene/import/scene_bounds.hpp"
#include "core/scene/import/scene_defaults.hpp"
#include "core/scene/import/scene_repair.hpp"
#include "core/scene/loader/coordinate_grid.hpp"
#include "core/scene/loader/light_limit.hpp"
#include "core/scene/loader/wording.hpp"
#include "core/scene/tables/effective_keys.hpp"
#include "core/scene/tables/material_tables.hpp"
#include "core/scene/validate_materials.hpp"
#include "core/scene/validate_shapes.hpp"
#include "core/scene/validation.hpp"

namespace tessera::core {
namespace {

// A map without a texture is none.
template <typename Value>
Value effective(Value value) {
  if constexpr (HasTable<Value>)
    if (value.texture < 0) return {};
  return value;
}

// With the defaults of the keys that the model does not have or that have no effect: they cannot be written.
Material with_effective_keys(Material material) {
  Material kept;
  std::visit(
      [&]<typename Model>(Model& model) {
        visit_members(kCommonKeys<Model>, material,
                      [&](const auto& key, auto& value) { key.of(kept) = effective(std::move(value)); });
        visit_members(kKeys<Model>, model, [&](const auto& key, auto& value) {
          value = has_effect(model, key.name) ? effective(std::move(value)) : key.of(Model{});
        });
      },
      material.model);
  kept.name = std::move(material.name);
  kept.model = std::move(material.model);
  return kept;
}

// Meshes in objects have coordinates of their own, which are rarely large.
void tell_coarse_meshes(const SceneDescription& scene, FileWarnings& warnings) {
  const CoordinateGrid grid(scene_bounds(scene));
  if (grid.is_fine()) return;
  std::size_t coarse = 0;
  for (const ShapeDescription& shape : scene.shapes)
    if (const auto* mesh = std::get_if<MeshDescription>(&shape))
      coarse += static_cast<std::size_t>(std::ranges::count_if(mesh->triangles, [&](const auto& t) {
        const auto& p = mesh->positions;
        return grid.is_too_coarse_for(p[t[0]], p[t[1]], p[t[2]]);
      }));
  grid.tell(coarse, warnings);
}

}  // namespace

SceneBuilder::SceneBuilder(AssetSource& assets, std::string scene_path, std::string display_path,
                           const SceneLimits& limits)
    : assets_(assets),
      scene_path_(std::move(scene_path)),
      display_path_(std::move(display_path)),
      limits_(limits),
      warnings_(limits.warnings),
      cache_(assets, limits, warnings_) {}

std::string SceneBuilder::shown(const std::string& path) const {
  return path == scene_path_ ? display_path_ : path;
}

ImageUse use_of_channel(ColorSpace color_space, const std::string& channel) {
  constexpr std::pair<std::string_view, TextureChannel> kNames[] = {
      {"", TextureChannel::kColor},  {"rgb", TextureChannel::kColor}, {"r", TextureChannel::kRed},
      {"g", TextureChannel::kGreen}, {"b", TextureChannel::kBlue},    {"a", TextureChannel::kAlpha}};
  for (const auto& [name, known] : kNames)
    if (name == channel) return {color_space, known, {}};
  return {color_space, TextureChannel::kColor, channel};
}

Result<SceneBuilder::Image> SceneBuilder::image_file(const std::string& path, const ImageUse& use) {
  return cache_.image(path, use.color_space, use.channel, FloatFiles::kAlwaysLinear, use.layer);
}

Result<SceneBuilder::Image> SceneBuilder::image_bytes(const std::string& name, std::string_view bytes,
                                                      const ImageUse& use) {
  return cache_.image_in_memory(name, bytes, use.color_space, use.channel);
}

std::optional<std::string> SceneBuilder::find(const std::string& written,
                                              const std::vector<std::string>& beside,
                                              const FilePlace& place) {
  auto found = cache_.find(written, beside);
  const auto is_found = [&](const std::string& file) { return path_beside(file, written) == found; };
  if (found && std::none_of(beside.begin(), beside.end(), is_found) && told_names_.insert(written).second)
    warn(place.file, place.line, "other name " + written,
         [&] { return fmt::format("{} does not exist; {} is used", in_quotes(written), in_quotes(*found)); });
  return found;
}

Result<SceneBuilder::Image> SceneBuilder::image_pixels(const std::string& name, TextureImage image) {
  return image_pixels(name, {image.width(), image.height()}, [&] { return std::move(image); });
}

Result<SceneBuilder::Image> SceneBuilder::image_pixels(const std::string& name, TextureSize size,
                                                       const std::function<TextureImage()>& make) {
  if (auto counted = cache_.count_pixels(name, size); !counted) return fail(counted.error());
  auto image = std::make_shared<const TextureImage>(make());
  assert(image->width() == size.width && image->height() == size.height);
  return image;
}

int SceneBuilder::add_texture(const Texture& texture) {
  auto& textures = scene_.textures;
  const auto known = std::find(textures.begin(), textures.end(), texture);
  if (known != textures.end()) return static_cast<int>(known - textures.begin());
  textures.push_back(texture);
  return static_cast<int>(textures.size()) - 1;
}

Result<int> SceneBuilder::add_texture(const std::string& path, const ImageUse& use) {
  auto image = image_file(path, use);
  if (!image) return fail(image.error());
  Texture texture;
  texture.image = std::move(*image);
  return add_texture(texture);
}

// The parts of a blend have sides of their own.
std::uint32_t SceneBuilder::add_material(Material material) {
  scene_.materials.push_back(with_effective_keys(std::move(material)));
  return static_cast<std::uint32_t>(scene_.materials.size()) - 1;
}

std::uint32_t SceneBuilder::default_material() {
  if (!default_material_) {
    Material material;
    material.name = "default";
    default_material_ = add_material(std::move(material));
  }
  return *default_material_;
}

std::uint32_t SceneBuilder::add_object(std::string name) {
  ObjectDescription object;
  object.name = std::move(name);
  scene_.objects.push_back(std::move(object));
  return static_cast<std::uint32_t>(scene_.objects.size()) - 1;
}

Status SceneBuilder::check_triangles(const std::string& path, std::uint64_t more) const {
  const auto& [most, option] = limits_.triangles;
  if (more <= most && triangles_ <= most - more) return {};
  return fail(ErrorCode::kResourceExhausted,
              fmt::format("with {} the scene has {} triangles, more than the {} that it may have here ({})",
                          in_quotes(path), triangles_ + more, most, option));
}

Status SceneBuilder::count_triangles(const std::string& path, std::uint64_t more) {
  auto fits = check_triangles(path, more);
  if (fits) triangles_ += more;
  return fits;
}

Status SceneBuilder::add_mesh(MeshDescription mesh, std::string name, std::optional<std::uint32_t> object,
                              const std::string& file, int line) {
  const std::uint64_t steps = std::max<std::uint64_t>(mesh.steps.size(), 1);
  if (auto fits = check_triangles(file, steps * mesh.triangles.size()); !fits) return fits;
  tell_repairs(repair_mesh(mesh), line, warnings_.of(shown(file)));
  if (mesh.triangles.empty()) {
    warn(file, line, "empty mesh", "a mesh without a triangle that has an area is left out");
    return {};
  }
  triangles_ += steps * mesh.triangles.size();
  if (!mesh.steps.empty()) {
    set_rest(mesh);
    scene_.animation.deforms = true;
  }
  append_shape(std::move(mesh), std::move(name), object);
  return {};
}

Status SceneBuilder::add_curves(CurvesDescription curves, std::string name,
                                std::optional<std::uint32_t> object, const FilePlace& place) {
  ShapeDescription shape = std::move(curves);
  if (!can_be_rendered(shape, place)) return {};
  const auto& added = std::get<CurvesDescription>(shape);
  const CurveStrands& strands = added.strands;
  if (auto fits = count_triangles(place.file, kMaxCurveParts * segment_count(strands)); !fits) return fits;
  auto& shapes = object ? scene_.objects[*object].shapes : scene_.shapes;
  auto* last = shapes.empty() ? nullptr : std::get_if<CurvesDescription>(&shapes.back());
  const auto has_own_radii = [](const CurveStrands& all) { return all.radii.size() == all.points.size(); };
  if (last == nullptr || last->material != added.material || last->strands.basis != strands.basis ||
      last->strands.shape != strands.shape || !has_own_radii(last->strands) || !has_own_radii(strands)) {
    append_shape(std::move(shape), std::move(name), object);
    return {};
  }
  const auto append = [](auto& all, const auto& more) { all.insert(all.end(), more.begin(), more.end()); };
  append(last->strands.points, strands.points);
  append(last->strands.radii, strands.radii);
  append(last->strands.counts, strands.counts);
  append(last->strands.normals, strands.normals);
  return {};
}

void SceneBuilder::append_shape(ShapeDescription shape, std::string name,
                                std::optional<std::uint32_t> object) {
  auto& shapes = object ? scene_.objects[*object].shapes : scene_.shapes;
  auto& names = object ? scene_.objects[*object].shape_names : scene_.shape_names;
  shapes.push_back(std::move(shape));
  names.push_back(std::move(name));
}

bool SceneBuilder::can_be_rendered(const ShapeDescription& shape, const FilePlace& place) {
  const Status valid = validate_shape(shape, scene_);
  if (!valid)
    warn(place.file, place.line, "shape that cannot be rendered",
         fmt::format("a shape is left out: {}", valid.error().message));
  return valid.has_value();
}

bool SceneBuilder::add_shape(ShapeDescription shape, std::string name, std::optional<std::uint32_t> object,
                             const FilePlace& place) {
  if (!can_be_rendered(shape, place)) return false;
  append_shape(std::move(shape), std::move(name), object);
  return true;
}

bool SceneBuilder::add_instance(std::uint32_t object, const Transform& to_world, std::string name,
                                const FilePlace& place, std::optional<std::uint32_t> material) {
  InstanceDescription instance;
  instance.object = object;
  instance.to_world = to_world;
  instance.material = material;
  return add_shape(std::move(instance), std::move(name), std::nullopt, place);
}

void SceneBuilder::add_light(LightDescription light, const FilePlace& place) {
  if (const Status valid = validate_light(light); !valid) {
    warn(place.file, place.line, "light that cannot be computed",
         fmt::format("a light is left out: {}", valid.error().message));
  } else if (is_dark(light)) {
    warn(place.file, place.line, "dark light", "a light without power is left out");
  } else {
    scene_.lights.push_back(std::move(light));
  }
}

void SceneBuilder::set_camera(const CameraDescription& camera) {
  scene_.camera = camera;
  has_camera_ = true;
}

// With the first warnings, which say why.
Error SceneBuilder::nothing_to_render() const {
  constexpr std::size_t kMaxReasons = 10;
  std::string message = display_path_ + ": has no shape that can be rendered";
  const std::vector<std::string> reasons = warnings_.messages();
  for (std::size_t i = 0; i < std::min(reasons.size(), kMaxReasons); ++i) message += '\n' + reasons[i];
  return {ErrorCode::kInvalidArgument, std::move(message)};
}

// Other programs accept what no surface can have.
void SceneBuilder::clamp_materials() {
  for (Material& material : scene_.materials)
    for (const std::string_view key : clamp_to_ranges(material))
      warn(scene_path_, 0, key, [&] { return clamped_text(material.name, key); });
}

Result<SceneDescription> SceneBuilder::finish(const SceneDefaults& defaults) {
  clamp_materials();
  remove_empty_objects(scene_);
  leave_out_invalid_parts(scene_, warnings_.of(shown(scene_path_)));
  if (has_camera_ && !is_valid_view(scene_, warnings_.of(shown(scene_path_)))) has_camera_ = false;
  if (scene_.shapes.empty()) return fail(nothing_to_render());
  tell_coarse_meshes(scene_, warnings_.of(shown(scene_path_)));
  if (!has_camera_ && defaults.camera) {
    const auto [width, height] = std::pair(scene_.settings.width_px, scene_.settings.height_px);
    const float aspect = static_cast<float>(width) / static_cast<float>(height);
    CameraDescription camera = default_camera(scene_bounds(scene_), aspect, defaults);
    camera.shutter_open = scene_.camera.shutter_open;
    camera.shutter_close = scene_.camera.shutter_close;
    set_camera(camera);
  }
  if (scene_.lights.empty() && !scene_.environment && defaults.studio_light) {
    Texture studio;
    studio.image = std::make_shared<const TextureImage>(studio_environment(defaults));
    EnvironmentDescription environment;
    environment.radiance.texture = add_texture(studio);
    set_environment(std::move(environment));
  }
  if (const Status fit = check_lights(scene_, limits_.lights); !fit)
    return fail(fit.error().within(display_path_));
  scene_.warnings = warnings_.messages();
  return std::move(scene_);
}

}  // namespace tessera::core
