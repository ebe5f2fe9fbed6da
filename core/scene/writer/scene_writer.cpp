// SPDX-License-Identifier: Apache-2.0
#include "core/scene/writer/scene_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "core/scene/loader/scene_keys.hpp"
#include "core/scene/tables/camera_tables.hpp"
#include "core/scene/tables/light_tables.hpp"
#include "core/scene/tables/medium_tables.hpp"
#include "core/scene/writer/json_text.hpp"
#include "core/scene/writer/material_text.hpp"
#include "core/scene/writer/motion_text.hpp"
#include "core/scene/writer/pattern_text.hpp"
#include "core/scene/writer/shape_writer.hpp"
#include "core/scene/writer/texture_writer.hpp"
#include "core/scene/writer/volume_writer.hpp"

namespace tessera::core {
namespace {

using json_text::Object;

std::string float_text(float v) {
  return json_text::number(v);
}
std::string integer_text(std::int64_t v) {
  return fmt::format("{}", v);
}

std::string name_of_texture(std::size_t index) {
  return fmt::format("texture {}", index);
}

// Adds a number to names that are empty or were used before.
template <typename List>
std::vector<std::string> unique_names(const List& list, std::string_view kind) {
  std::set<std::string> used;
  std::map<std::string, int> next;  // the number to try first
  std::vector<std::string> names;
  for (const auto& entry : list) {
    const std::string base = entry.name.empty() ? fmt::format("{} {}", kind, names.size()) : entry.name;
    std::string name = base;
    int& number = next.try_emplace(base, 2).first->second;
    while (!used.insert(name).second) name = fmt::format("{} {}", base, number++);
    names.push_back(std::move(name));
  }
  return names;
}

// Those of the material or medium of the index; empty without keyframes.
const ParameterTracks& tracks_of(const std::vector<IndexedTracks>& animations, std::size_t index) {
  static const ParameterTracks kNone;
  const auto found = std::ranges::find(animations, index, &IndexedTracks::index);
  return found == animations.end() ? kNone : found->tracks;
}

class SceneWriter {
 public:
  SceneWriter(const SceneDescription& scene, const std::string& name, const WriteSceneFile& write)
      : scene_(scene), name_(name), write_(write) {}

  Status write();

 private:
  std::string settings_text() const;
  std::string camera_text() const;
  std::string output_text() const;
  std::string environment_text() const;
  Status add_textures(Object& textures);
  Status add_grids(Object& grids);
  std::string medium_text(const MediumDescription& medium, const ParameterTracks& tracks) const;
  std::string light_text(const LightDescription& light, const LightAnimation& animation) const;
  std::vector<std::string> light_texts() const;
  Status add_objects(Object& objects);
  // Writes a file into the folder of files, and returns its path.
  Result<std::string> write_file(std::string_view kind, std::size_t number, std::string_view ending,
                                 std::string_view bytes) const;

  const SceneDescription& scene_;
  const std::string& name_;
  const WriteSceneFile& write_;
  SceneNames names_;
  ShapeWriter shapes_{names_, [this](const auto&... file) { return write_file(file...); }};
};

Result<std::string> SceneWriter::write_file(std::string_view kind, std::size_t number,
                                            std::string_view ending, std::string_view bytes) const {
  std::string path = fmt::format("{}.files/{}_{:04}.{}", name_, kind, number, ending);
  if (auto written = write_(path, bytes); !written) return fail(written.error());
  return path;
}

std::string SceneWriter::settings_text() const {
  const RenderSettings& s = scene_.settings;
  const RenderSettings standard;
  Object render;
  render.add("width", integer_text(s.width_px)).add("height", integer_text(s.height_px));
  render.add("spp", integer_text(s.spp));
  render.add_unless("0", "seed", json_text::number(s.seed));
  render.add_unless(json_text::word(scene_keys::kIntegrators, standard.integrator), "integrator",
                    json_text::word(scene_keys::kIntegrators, s.integrator));
  render.add_unless(json_text::word(scene_keys::kHeuristics, standard.heuristic), "heuristic",
                    json_text::word(scene_keys::kHeuristics, s.heuristic));
  render.add_unless("0", "max_depth", integer_text(s.max_depth));
  render.add_unless("0", "clamp_indirect", float_text(s.clamp_indirect));
  if (s.filter != standard.filter)
    render.add("filter", json_text::word(scene_keys::kFilters, s.filter.kind))
        .add("filter_radius", float_text(s.filter.radius_px));
  if (s.crop)
    render.add("crop", json_text::list({integer_text(s.crop->x0), integer_text(s.crop->y0),
                                        integer_text(s.crop->x1), integer_text(s.crop->y1)}));
  if (!s.layers.empty()) {
    std::vector<std::string> names;
    for (const std::string& name : layer_names(s.layers)) names.push_back(json_text::text(name));
    render.add("layers", json_text::list(names));
  }
  return render.on_one_line();
}

// The angle of view is that of perspective cameras alone.
std::string SceneWriter::camera_text() const {
  const CameraDescription& c = scene_.camera;
  Object camera;
  TableWriter(names_, camera)
      .write(kKeys<CameraDescription>, c, scene_.animation.camera, [&](std::string_view key) {
        if (key == "vertical_fov_degrees") return c.type == CameraType::kPerspective;
        if (key == "view_height") return c.type == CameraType::kOrthographic;
        return key != "focus_distance" || c.focus_distance > 0 ||
               !scene_.animation.camera.focus_distance.empty();
      });
  camera.add_unless(json_text::vector(Vec2{0, 0}), "shutter",
                    json_text::vector(Vec2{c.shutter_open, c.shutter_close}));
  if (scene_.camera_medium >= 0)
    camera.add("medium", json_text::text(names_.media[static_cast<std::size_t>(scene_.camera_medium)]));
  return camera.on_lines(2);
}

std::string SceneWriter::output_text() const {
  Object output;
  output.add_unless("0", "exposure", float_text(scene_.display.exposure_stops));
  output.add_unless(json_text::word(scene_keys::kToneCurves, DisplaySettings().tone_curve), "tone_curve",
                    json_text::word(scene_keys::kToneCurves, scene_.display.tone_curve));
  return output.on_one_line();
}

// Textures of one image share its file.
Status SceneWriter::add_textures(Object& textures) {
  std::map<const TextureImage*, std::pair<std::string, std::string_view>> files;
  for (std::size_t i = 0; i < scene_.textures.size(); ++i) {
    const Texture& texture = scene_.textures[i];
    if (texture.procedural) {
      textures.add(name_of_texture(i), pattern_text(texture, names_));
      names_.textures.push_back(name_of_texture(i));
      continue;
    }
    const auto [known, is_new] = files.try_emplace(texture.image.get());
    if (is_new) {
      auto file = write_texture(*texture.image);
      if (!file) return fail(file.error());
      auto path = write_file("texture", files.size() - 1, file->ending, file->bytes);
      if (!path) return fail(path.error());
      known->second = {std::move(*path), file->color_space};
    }
    const auto& [path, color_space] = known->second;
    Object entry;
    entry.add("file", json_text::text(path));
    if (!color_space.empty()) entry.add("color_space", json_text::text(color_space));
    entry.add_unless(json_text::word(scene_keys::kWraps, Wrap::kRepeat), "wrap",
                     json_text::word(scene_keys::kWraps, texture.wrap));
    if (texture.wrap_v) entry.add("wrap_v", json_text::word(scene_keys::kWraps, *texture.wrap_v));
    entry.add_unless(json_text::vector(Vec2{1, 1}), "scale", json_text::vector(texture.scale));
    entry.add_unless(json_text::vector(Vec2{0, 0}), "offset", json_text::vector(texture.offset));
    entry.add_unless(json_text::vector(Vec2{0, 0}), "shear", json_text::vector(texture.shear));
    entry.add_unless(json_text::word(scene_keys::kUvSets, UvSet::kFirst), "uv_set",
                     json_text::word(scene_keys::kUvSets, texture.uv_set));
    if (texture.filter == TextureFilter::kNearest)
      entry.add("filter", json_text::word(scene_keys::kTextureFilters, texture.filter));
    names_.textures.push_back(name_of_texture(i));
    textures.add(names_.textures.back(), entry.on_one_line());
  }
  return {};
}

std::string SceneWriter::light_text(const LightDescription& light, const LightAnimation& animation) const {
  Object object;
  object.add("type", json_text::word(scene_keys::kLightTypes, light.index()));
  std::visit(
      [&]<typename Light>(const Light& description) {
        TableWriter(names_, object).write(kKeys<Light>, description, animation);
      },
      light);
  if (const auto* point = std::get_if<PointLightDescription>(&light))
    if (point->orientation != Transform()) object.add("orientation", transform_text(point->orientation));
  return object.on_one_line();
}

std::vector<std::string> SceneWriter::light_texts() const {
  const auto& animations = scene_.animation.lights;
  std::vector<std::string> texts;
  for (std::uint32_t i = 0; i < scene_.lights.size(); ++i) {
    const auto found = std::ranges::find(animations, i, &LightAnimation::light);
    texts.push_back(light_text(scene_.lights[i], found == animations.end() ? LightAnimation() : *found));
  }
  return texts;
}

std::string SceneWriter::environment_text() const {
  const EnvironmentDescription& environment = *scene_.environment;
  Object object;
  TableWriter(names_, object).write(kKeys<EnvironmentDescription>, environment, scene_.animation.environment);
  if (environment.orientation != Transform())
    object.add("orientation", transform_text(environment.orientation));
  return object.on_one_line();
}

Status SceneWriter::add_grids(Object& grids) {
  for (std::size_t i = 0; i < scene_.grids.size(); ++i) {
    const VoxelGrid& grid = scene_.grids[i];
    const auto path = write_file("grid", i, "vol", write_volume(grid));
    if (!path) return fail(path.error());
    Object entry;
    entry.add("file", json_text::text(*path));
    if (grid.filter == GridFilter::kNearest) entry.add("filter", json_text::text("nearest"));
    if (grid.border == GridBorder::kZero) entry.add("border", json_text::text("zero"));
    grids.add(names_.grids[i], entry.on_one_line());
  }
  return {};
}

std::string SceneWriter::medium_text(const MediumDescription& medium, const ParameterTracks& tracks) const {
  Object object;
  TableWriter(names_, object).write(kKeys<MediumDescription>, medium, tracks);
  if (medium.has_grid() && medium.grid_to_world != Transform())
    object.add("transform", transform_text(medium.grid_to_world));
  return object.on_one_line();
}

Status SceneWriter::add_objects(Object& objects) {
  for (std::size_t i = 0; i < scene_.objects.size(); ++i) {
    const auto shapes = shapes_.texts(scene_.objects[i].shapes, scene_.objects[i].shape_names, {});
    if (!shapes) return fail(shapes.error());
    objects.add(names_.objects[i], Object().add("shapes", json_text::list_on_lines(*shapes, 6)).on_lines(4));
  }
  return {};
}

Status SceneWriter::write() {
  names_.materials = unique_names(scene_.materials, "material");
  names_.objects = unique_names(scene_.objects, "object");
  names_.media = unique_names(scene_.media, "medium");
  for (std::size_t i = 0; i < scene_.grids.size(); ++i) names_.grids.push_back(fmt::format("grid {}", i));
  Object textures, grids, media, materials, objects;
  if (auto added = add_textures(textures); !added) return added;
  if (auto added = add_grids(grids); !added) return added;
  for (std::size_t i = 0; i < scene_.media.size(); ++i)
    media.add(names_.media[i], medium_text(scene_.media[i], tracks_of(scene_.animation.media, i)));
  for (std::size_t i = 0; i < scene_.materials.size(); ++i)
    materials.add(names_.materials[i],
                  material_text(scene_.materials[i], names_, tracks_of(scene_.animation.materials, i)));
  if (auto added = add_objects(objects); !added) return added;
  std::map<std::uint32_t, const InstanceMotion*> motions;
  for (const InstanceMotion& motion : scene_.animation.instances) motions[motion.shape] = &motion;
  const auto shapes = shapes_.texts(scene_.shapes, scene_.shape_names, motions);
  if (!shapes) return fail(shapes.error());

  Object root;
  root.add("render", settings_text()).add("camera", camera_text());
  root.add_unless("{}", "output", output_text());
  if (!textures.empty()) root.add("textures", textures.on_lines(2));
  if (!grids.empty()) root.add("grids", grids.on_lines(2));
  if (!media.empty()) root.add("media", media.on_lines(2));
  if (!materials.empty()) root.add("materials", materials.on_lines(2));
  if (!objects.empty()) root.add("objects", objects.on_lines(2));
  root.add("shapes", json_text::list_on_lines(*shapes, 2));
  if (!scene_.lights.empty()) root.add("lights", json_text::list_on_lines(light_texts(), 2));
  if (scene_.environment) root.add("environment", environment_text());
  return write_(name_ + ".json", root.on_lines(0) + "\n");
}

}  // namespace

Status write_scene(const SceneDescription& scene, const std::string& name, const WriteSceneFile& write) {
  try {
    return SceneWriter(scene, name, write).write();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kResourceExhausted, "the scene does not fit into memory");
  }
}

}  // namespace tessera::core
