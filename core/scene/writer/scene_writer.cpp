// SPDX-License-Identifier: Apache-2.0
#include "core/scene/writer/scene_writer.hpp"
#include "core/scene/writer/curve_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "core/base/overloaded.hpp"
#include "core/scene/loader/scene_keys.hpp"
#include "core/scene/writer/json_text.hpp"
#include "core/scene/writer/material_text.hpp"
#include "core/scene/writer/motion_text.hpp"
#include "core/scene/writer/ply_writer.hpp"
#include "core/scene/writer/texture_writer.hpp"
#include "core/scene/writer/volume_writer.hpp"

namespace tessera::core {
namespace {

using json_text::Object;

std::string vec3_text(Vec3 v) {
  return json_text::vector(v);
}
std::string color_text(Rgb c) {
  return json_text::color(c);
}
std::string float_text(float v) {
  return json_text::number(v);
}
std::string integer_text(std::int64_t v) {
  return fmt::format("{}", v);
}

template <typename Words, typename Enum>
std::string choice_text(const Words& words, Enum value) {
  return json_text::text(words[static_cast<std::size_t>(value)]);
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
  static std::string grid_name(int grid) { return fmt::format("grid {}", grid); }
  static std::string medium_text(const MediumDescription& medium, const ParameterTracks& tracks);
  std::string projected_image_text(const ProjectedImage& image) const;
  std::string light_text(const LightDescription& light, const LightAnimation& animation) const;
  std::vector<std::string> light_texts() const;
  Result<std::vector<std::string>> shape_texts(const std::vector<ShapeDescription>& shapes,
                                               const std::map<std::uint32_t, const InstanceMotion*>& motions);
  Result<std::string> mesh_text(const MeshDescription& mesh);
  std::string instance_text(const InstanceDescription& instance, const InstanceMotion* motion) const;
  std::string disk_text(const DiskDescription& disk) const;
  std::string cylinder_text(const CylinderDescription& cylinder) const;
  Result<std::string> curves_text(const CurvesDescription& curves);
  Status add_objects(Object& objects);
  // Writes a file into the folder of files, and returns its path.
  Result<std::string> write_file(std::string_view kind, std::size_t number, std::string_view ending,
                                 std::string_view bytes) const;
  std::string material_name(std::uint32_t material) const {
    return json_text::text(names_.materials[material]);
  }

  const SceneDescription& scene_;
  const std::string& name_;
  const WriteSceneFile& write_;
  SceneNames names_;
  std::size_t meshes_ = 0, curves_ = 0;
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
  render.add_unless(choice_text(scene_keys::kIntegrators, standard.integrator), "integrator",
                    choice_text(scene_keys::kIntegrators, s.integrator));
  render.add_unless(choice_text(scene_keys::kHeuristics, standard.heuristic), "heuristic",
                    choice_text(scene_keys::kHeuristics, s.heuristic));
  render.add_unless("0", "max_depth", integer_text(s.max_depth));
  render.add_unless("0", "clamp_indirect", float_text(s.clamp_indirect));
  if (s.filter != standard.filter)
    render.add("filter", choice_text(scene_keys::kFilters, s.filter.kind))
        .add("filter_radius", float_text(s.filter.radius_px));
  if (s.crop)
    render.add("crop", json_text::list({integer_text(s.crop->x0), integer_text(s.crop->y0),
                                        integer_text(s.crop->x1), integer_text(s.crop->y1)}));
  if (!s.layers.empty()) {
    std::vector<std::string> names;
    for (const std::string_view name : layer_names(s.layers)) names.push_back(json_text::text(name));
    render.add("layers", json_text::list(names));
  }
  return render.on_one_line();
}

std::string SceneWriter::camera_text() const {
  const CameraDescription& c = scene_.camera;
  const CameraAnimation& a = scene_.animation.camera;
  Object camera;
  camera.add("position", animated_text(c.position, a.position, vec3_text));
  camera.add("look_at", animated_text(c.look_at, a.look_at, vec3_text));
  camera.add("up", animated_text(c.up, a.up, vec3_text));
  if (c.type == CameraType::kPerspective)
    camera.add("vertical_fov_degrees",
               animated_text(c.vertical_fov_degrees, a.vertical_fov_degrees, float_text));
  if (c.type == CameraType::kOrthographic)
    camera.add("type", json_text::text("orthographic"))
        .add("view_height", animated_text(c.view_height, a.view_height, float_text));
  if (c.type == CameraType::kPanoramic) camera.add("type", json_text::text("panoramic"));
  camera.add_unless(json_text::vector(Vec2{0, 0}), "lens_shift",
                    animated_text(c.lens_shift, a.lens_shift, [](Vec2 v) { return json_text::vector(v); }));
  if (c.mirrored) camera.add("mirror", json_text::boolean(true));
  camera.add_unless(json_text::vector(Vec2{0, 0}), "shutter",
                    json_text::vector(Vec2{c.shutter_open, c.shutter_close}));
  camera.add_unless("0", "aperture_radius", animated_text(c.aperture_radius, a.aperture_radius, float_text));
  camera.add_unless("0", "focus_distance", animated_text(c.focus_distance, a.focus_distance, float_text));
  camera.add_unless("0", "aperture_blades", integer_text(c.aperture_blades));
  camera.add_unless("0", "aperture_rotation_degrees",
                    animated_text(c.aperture_rotation_degrees, a.aperture_rotation_degrees, float_text));
  if (scene_.camera_medium >= 0)
    camera.add("medium", json_text::text(names_.media[static_cast<std::size_t>(scene_.camera_medium)]));
  return camera.on_lines(2);
}

std::string SceneWriter::output_text() const {
  Object output;
  output.add_unless("0", "exposure", float_text(scene_.display.exposure_stops));
  output.add_unless(choice_text(scene_keys::kToneCurves, DisplaySettings().tone_curve), "tone_curve",
                    choice_text(scene_keys::kToneCurves, scene_.display.tone_curve));
  return output.on_one_line();
}

// Textures of one image share its file.
Status SceneWriter::add_textures(Object& textures) {
  std::map<const TextureImage*, std::pair<std::string, std::string_view>> files;
  for (std::size_t i = 0; i < scene_.textures.size(); ++i) {
    const Texture& texture = scene_.textures[i];
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
    entry.add_unless(choice_text(scene_keys::kWraps, Wrap::kRepeat), "wrap",
                     choice_text(scene_keys::kWraps, texture.wrap));
    if (texture.wrap_v) entry.add("wrap_v", choice_text(scene_keys::kWraps, *texture.wrap_v));
    entry.add_unless(json_text::vector(Vec2{1, 1}), "scale", json_text::vector(texture.scale));
    entry.add_unless(json_text::vector(Vec2{0, 0}), "offset", json_text::vector(texture.offset));
    entry.add_unless(json_text::vector(Vec2{0, 0}), "shear", json_text::vector(texture.shear));
    names_.textures.push_back(fmt::format("texture {}", i));
    textures.add(names_.textures.back(), entry.on_one_line());
  }
  return {};
}

std::string SceneWriter::projected_image_text(const ProjectedImage& image) const {
  Object object;
  object.add("texture", json_text::text(names_.textures[static_cast<std::size_t>(image.texture)]));
  object.add("right", vec3_text(image.right));
  object.add("up", vec3_text(image.up));
  object.add_unless(json_text::boolean(false), "flat_field", json_text::boolean(image.flat_field));
  return object.on_one_line();
}

std::string SceneWriter::light_text(const LightDescription& light, const LightAnimation& a) const {
  Object object;
  object.add("type", choice_text(scene_keys::kLightTypes, light.index()));
  std::visit(Overloaded{
                 [&](const PointLightDescription& d) {
                   object.add("position", animated_text(d.position, a.position, vec3_text));
                   object.add("intensity", animated_text(d.intensity, a.color, color_text));
                   if (d.texture >= 0)
                     object.add("texture",
                                json_text::text(names_.textures[static_cast<std::size_t>(d.texture)]));
                   if (d.orientation != Transform()) object.add("orientation", transform_text(d.orientation));
                 },
                 [&](const SpotLightDescription& d) {
                   object.add("position", animated_text(d.position, a.position, vec3_text));
                   object.add("look_at", animated_text(d.look_at, a.look_at, vec3_text));
                   object.add("intensity", animated_text(d.intensity, a.color, color_text));
                   object.add("angle_degrees", animated_text(d.angle_degrees, a.angle_degrees, float_text));
                   object.add("softness", animated_text(d.softness, a.softness, float_text));
                   object.add_unless(choice_text(scene_keys::kSpotFalloffs, SpotFalloff::kSmooth), "falloff",
                                     choice_text(scene_keys::kSpotFalloffs, d.falloff));
                   if (d.image.texture >= 0) object.add("image", projected_image_text(d.image));
                 },
                 [&](const DirectionalLightDescription& d) {
                   object.add("direction", animated_text(d.direction, a.direction, vec3_text));
                   object.add("irradiance", animated_text(d.irradiance, a.color, color_text));
                 },
             },
             light);
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
  if (environment.radiance.texture >= 0)
    object.add("texture",
               json_text::text(names_.textures[static_cast<std::size_t>(environment.radiance.texture)]));
  const ParameterTracks& tracks = scene_.animation.environment;
  object.add("radiance",
             animated_text(environment.radiance.value, color_track(tracks, "radiance"), color_text));
  object.add_unless(
      "0", "rotation_degrees",
      animated_text(environment.rotation_degrees, number_track(tracks, "rotation_degrees"), float_text));
  if (environment.orientation != Transform())
    object.add("orientation", transform_text(environment.orientation));
  if (!environment.visible_to_camera) object.add("visible_to_camera", json_text::boolean(false));
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
    grids.add(grid_name(static_cast<int>(i)), entry.on_one_line());
  }
  return {};
}

std::string SceneWriter::medium_text(const MediumDescription& medium, const ParameterTracks& tracks) {
  Object object;
  const auto add_color = [&](std::string_view key, Rgb value) {
    object.add_unless("0", key, animated_text(value, color_track(tracks, key), color_text));
  };
  add_color("sigma_a", medium.sigma_a);
  add_color("sigma_s", medium.sigma_s);
  object.add_unless("1", "scale", animated_text(medium.scale, number_track(tracks, "scale"), float_text));
  object.add_unless("0", "g", animated_text(medium.g, number_track(tracks, "g"), float_text));
  add_color("emission", medium.emission);
  const auto add_grid = [&](std::string_view key, int grid) {
    if (grid >= 0) object.add(key, json_text::text(grid_name(grid)));
  };
  add_grid("absorption_grid", medium.absorption_grid);
  add_grid("scattering_grid", medium.scattering_grid);
  add_grid("emission_grid", medium.emission_grid);
  if (medium.has_grid() && medium.grid_to_world != Transform())
    object.add("transform", transform_text(medium.grid_to_world));
  return object.on_one_line();
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

Result<std::string> SceneWriter::mesh_text(const MeshDescription& mesh) {
  MeshMaterials materials = materials_of(mesh);
  const bool has_list = mesh.triangle_materials.size() > 1;
  if (!has_list) materials.of_triangles.clear();
  auto path = write_file("mesh", meshes_++, "ply", write_ply(mesh, materials.of_triangles));
  if (!path) return fail(path.error());
  Object object;
  object.add("type", json_text::text("mesh")).add("file", json_text::text(*path));
  if (has_list) {
    std::vector<std::string> names;
    for (const std::uint32_t material : materials.used) names.push_back(material_name(material));
    object.add("materials", json_text::list(names));
  } else {
    object.add("material", material_name(materials.used.front()));
  }
  if (!mesh.colors.empty()) object.add("vertex_colors", json_text::text("use"));
  if (mesh.normals.empty()) object.add("normals", json_text::text("flat"));
  return object.on_one_line();
}

std::string SceneWriter::instance_text(const InstanceDescription& instance,
                                       const InstanceMotion* motion) const {
  Object object;
  object.add("type", json_text::text("instance"));
  object.add("object", json_text::text(names_.objects[instance.object]));
  if (instance.material) object.add("material", material_name(*instance.material));
  if (motion != nullptr)
    object.add("transform", motion_text(motion->steps));
  else if (instance.to_world != Transform())
    object.add("transform", transform_text(instance.to_world));
  return object.on_one_line();
}

// The unit disk under a matrix, which keeps the radii exactly.
std::string SceneWriter::disk_text(const DiskDescription& disk) const {
  Object object;
  object.add("type", json_text::text("disk")).add("radius", "1");
  object.add_unless("0", "inner_radius", float_text(disk.inner));
  if (disk.flipped) object.add("flip_normal", json_text::boolean(true));
  object.add("material", material_name(disk.material));
  const Vec3 normal = cross(disk.radius_u, disk.radius_v);
  object.add("transform", transform_text({disk.radius_u, disk.radius_v, normal, disk.center}));
  return object.on_one_line();
}

std::string SceneWriter::cylinder_text(const CylinderDescription& cylinder) const {
  Object object;
  object.add("type", json_text::text("cylinder")).add("start", vec3_text({0, 0, 0}));
  object.add("end", vec3_text({0, 0, 1})).add("radius", "1");
  if (cylinder.flipped) object.add("flip_normal", json_text::boolean(true));
  object.add("material", material_name(cylinder.material));
  object.add("transform",
             transform_text({cylinder.radius_u, cylinder.radius_v, cylinder.axis, cylinder.start}));
  return object.on_one_line();
}

Result<std::string> SceneWriter::curves_text(const CurvesDescription& curves) {
  const CurveStrands& strands = curves.strands;
  auto path = write_file("curves", curves_++, "ply", write_curve_file(strands));
  if (!path) return fail(path.error());
  Object object;
  object.add("type", json_text::text("curves")).add("file", json_text::text(*path));
  object.add("basis", choice_text(scene_keys::kCurveBases, strands.basis));
  object.add("shape", choice_text(scene_keys::kCurveShapes, strands.shape));
  if (strands.radii.size() == 1) object.add("radius", float_text(strands.radii[0]));
  object.add("material", material_name(curves.material));
  return object.on_one_line();
}

Result<std::vector<std::string>> SceneWriter::shape_texts(
    const std::vector<ShapeDescription>& shapes,
    const std::map<std::uint32_t, const InstanceMotion*>& motions) {
  std::vector<std::string> texts;
  for (std::uint32_t i = 0; i < shapes.size(); ++i) {
    const auto motion = motions.find(i);
    Result<std::string> text =
        std::visit(Overloaded{
                       [&](const MeshDescription& mesh) { return mesh_text(mesh); },
                       [&](const SphereDescription& sphere) -> Result<std::string> {
                         return Object()
                             .add("type", json_text::text("sphere"))
                             .add("center", vec3_text(sphere.center))
                             .add("radius", float_text(sphere.radius))
                             .add("material", material_name(sphere.material))
                             .on_one_line();
                       },
                       [&](const QuadDescription& quad) -> Result<std::string> {
                         return Object()
                             .add("type", json_text::text("quad"))
                             .add("corner", vec3_text(quad.corner))
                             .add("edge_u", vec3_text(quad.edge_u))
                             .add("edge_v", vec3_text(quad.edge_v))
                             .add("material", material_name(quad.material))
                             .on_one_line();
                       },
                       [&](const DiskDescription& disk) -> Result<std::string> { return disk_text(disk); },
                       [&](const CylinderDescription& cylinder) -> Result<std::string> {
                         return cylinder_text(cylinder);
                       },
                       [&](const CurvesDescription& curves) { return curves_text(curves); },
                       [&](const InstanceDescription& instance) -> Result<std::string> {
                         return instance_text(instance, motion == motions.end() ? nullptr : motion->second);
                       },
                   },
                   shapes[i]);
    if (!text) return fail(text.error());
    texts.push_back(std::move(*text));
  }
  return texts;
}

Status SceneWriter::add_objects(Object& objects) {
  for (std::size_t i = 0; i < scene_.objects.size(); ++i) {
    const auto shapes = shape_texts(scene_.objects[i].shapes, {});
    if (!shapes) return fail(shapes.error());
    objects.add(names_.objects[i], Object().add("shapes", json_text::list_on_lines(*shapes, 6)).on_lines(4));
  }
  return {};
}

Status SceneWriter::write() {
  names_.materials = unique_names(scene_.materials, "material");
  names_.objects = unique_names(scene_.objects, "object");
  names_.media = unique_names(scene_.media, "medium");
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
  const auto shapes = shape_texts(scene_.shapes, motions);
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
