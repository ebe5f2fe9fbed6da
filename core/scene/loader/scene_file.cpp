// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/scene_file.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/scene/loader/table_reader.hpp"
#include "core/scene/tables/camera_tables.hpp"

namespace tessera::core {
namespace {

constexpr Range kFilterRadius{
    .min = 0, .max = double{kMaxFilterRadiusPx}, .excludes_min = true, .unit = "pixels"};
constexpr Range kExposure{
    .min = -double{kMaxExposureStops}, .max = double{kMaxExposureStops}, .unit = "stops"};

void read_shutter(const Field& field, CameraDescription& camera) {
  const std::size_t mistakes_before = field.mistakes().count();
  const auto [open, close] = read_vec2(field, domains::kShutter.range);
  if (field.mistakes().count() != mistakes_before) return;
  if (open > close) field.mistake("the shutter must open before it closes: write [open, close]");
  camera.shutter_open = open;
  camera.shutter_close = close;
}

bool are_parallel(Vec3 a, Vec3 b) {
  const Vec3 u = normalize(a), v = normalize(b);
  return length(cross(u, v)) < 1e-4f;
}

void check_viewing_direction(const CameraDescription& camera, const Field& field) {
  const Vec3 direction = camera.look_at - camera.position;
  const float distance = length(direction);
  if (!(distance > 0) || !std::isfinite(distance)) {
    field.mistake("'look_at' must be another point than 'position', and not too far from it to be computed");
  } else if (!(length(camera.up) > 0) || !std::isfinite(length(camera.up))) {
    field.mistake("'up' must have a length that is greater than 0 and can be computed");
  } else if (are_parallel(direction, camera.up)) {
    field.mistake("'up' must not point along the line from 'position' to 'look_at'");
  }
}

// Reports keys that cameras of the type do not have.
void check_camera_keys(CameraType type, const TableReader& camera) {
  struct Rule {
    std::string_view key;
    bool known;
  };
  const bool has_lens = type != CameraType::kPanoramic;
  const bool is_orthographic = type == CameraType::kOrthographic;
  for (const auto& [key, known] :
       {Rule{"vertical_fov_degrees", type == CameraType::kPerspective}, Rule{"view_height", is_orthographic},
        Rule{"lens_shift", has_lens}, Rule{"aperture_radius", has_lens}, Rule{"focus_distance", has_lens},
        Rule{"aperture_blades", has_lens}, Rule{"aperture_rotation_degrees", has_lens}})
    if (const auto found = camera.find(key); found && !known)
      found->mistake(fmt::format("a camera of the type '{}' does not have this key",
                                 scene_keys::kCameraTypes[static_cast<std::size_t>(type)]));
  if (is_orthographic && !camera.find("view_height"))
    camera.field().mistake("an orthographic camera needs the key 'view_height'");
}

// 0 means no limit.
int read_max_depth(const Field& field) {
  const auto* number = field.value().get_if<JsonValue::Number>();
  const auto depth = number == nullptr ? std::nullopt : number->whole;
  if (depth && *depth <= std::uint64_t{kMaxDepth}) return static_cast<int>(*depth);
  field.must_be(
      fmt::format("a whole number between 1 and {}, or 0 for {} with whitted and no limit otherwise",
                  kMaxDepth, kWhittedDepth));
  return 0;
}

PixelFilter read_filter(const ObjectReader& render) {
  const auto kind = read_or(render, "filter", FilterKind::kBox, read_choice,
                            std::span<const std::string_view>(scene_keys::kFilters));
  PixelFilter filter = default_filter(kind);
  filter.radius_px = read_or(render, "filter_radius", filter.radius_px, read_float, kFilterRadius);
  return filter;
}

PixelRect read_crop(const Field& field) {
  constexpr std::size_t kCount = 4;
  const auto* items = field.value().get_if<JsonValue::Array>();
  if (items == nullptr || items->size() != kCount) {
    field.must_be("a list of 4 whole numbers, [x0, y0, x1, y1]");
    return {};
  }
  std::array<int, kCount> numbers{};
  for (std::size_t i = 0; i < kCount; ++i)
    numbers[i] = static_cast<int>(read_whole_number(field.element(i), 0, kMaxImageSidePx));
  return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

// A word, or "group.NAME".
void add_layer(const Field& field, LayerSet& layers) {
  const auto* text = field.value().get_if<std::string>();
  if (text != nullptr && std::string_view(*text).starts_with("group.")) {
    const auto named = parse_layers(*text);
    if (!named || named->groups.size() != 1)
      field.mistake("the name of a light group " + std::string(kGroupNameRule));
    else if (!layers.has_group(named->groups.front()))
      layers.groups.push_back(named->groups.front());
    return;
  }
  const std::size_t word = read_choice(field, scene_keys::kLayers);
  if (word < kLayerCount) layers = layers.with(static_cast<Layer>(word));
  if (word == kLayerCount) layers.bits = kAllLayers.bits;
  if (word >= kLayerCount) layers.light_groups = true;
}

LayerSet read_layers(const Field& field) {
  const auto* items = field.value().get_if<JsonValue::Array>();
  if (items == nullptr) {
    field.must_be("a list of layers, such as [\"alpha\", \"normal\"]");
    return {};
  }
  LayerSet layers;
  for (std::size_t i = 0; i < items->size(); ++i) add_layer(field.element(i), layers);
  return layers;
}

// Reports nothing if the size or the window could not be read.
void check_crop_fits(const Field& field, const RenderSettings& settings, std::size_t mistakes_before) {
  if (field.mistakes().count() != mistakes_before) return;
  const Status fits = check_crop(*settings.crop, settings.width_px, settings.height_px);
  if (!fits) field.mistake(fits.error().message);
}

}  // namespace

RenderSettings read_render(const Field& field) {
  const std::size_t mistakes_before = field.mistakes().count();
  const ObjectReader object(field, scene_keys::kRender);
  RenderSettings settings;
  const auto read_side = [](const Field& side) { return read_whole_number(side, 1, kMaxImageSidePx); };
  settings.width_px = read_or(object, "width", settings.width_px, read_side);
  settings.height_px = read_or(object, "height", settings.height_px, read_side);
  settings.spp =
      read_or(object, "spp", settings.spp, read_whole_number, std::uint64_t{1}, std::uint64_t{kMaxSpp});
  settings.seed =
      read_or(object, "seed", settings.seed, read_whole_number, std::uint64_t{0}, ~std::uint64_t{0});
  settings.max_depth = read_or(object, "max_depth", settings.max_depth, read_max_depth);
  settings.clamp_indirect =
      read_or(object, "clamp_indirect", settings.clamp_indirect, read_float, ranges::kNotNegative);
  settings.integrator = read_or(object, "integrator", settings.integrator, read_choice,
                                std::span<const std::string_view>(scene_keys::kIntegrators));
  settings.filter = read_filter(object);
  settings.heuristic = read_or(object, "heuristic", settings.heuristic, read_choice,
                               std::span<const std::string_view>(scene_keys::kHeuristics));
  if (std::int64_t{settings.width_px} * settings.height_px > kMaxImagePixels)
    field.mistake(fmt::format("{} x {} pixels are more than the {} that an image may have", settings.width_px,
                              settings.height_px, kMaxImagePixels));
  settings.layers = read_or(object, "layers", settings.layers, read_layers);
  if (const auto crop = object.find("crop")) {
    settings.crop = read_crop(*crop);
    check_crop_fits(*crop, settings, mistakes_before);
  }
  return settings;
}

CameraDescription read_camera(const Field& field, CameraAnimation& animation) {
  const std::size_t mistakes_before = field.mistakes().count();
  const TableReader read(field, "camera", rules_of(kKeys<CameraDescription>), {});
  CameraDescription camera;
  read.read(kKeys<CameraDescription>, camera, animation);
  if (const auto shutter = read.find("shutter")) read_shutter(*shutter, camera);
  check_camera_keys(camera.type, read);
  if (field.mistakes().count() == mistakes_before) check_viewing_direction(camera, field);
  return camera;
}

DisplaySettings read_output(const Field& field) {
  const ObjectReader object(field, scene_keys::kOutput);
  DisplaySettings display;
  display.exposure_stops = read_or(object, "exposure", display.exposure_stops, read_float, kExposure);
  display.tone_curve = read_or(object, "tone_curve", display.tone_curve, read_choice,
                               std::span<const std::string_view>(scene_keys::kToneCurves));
  return display;
}

SceneFile parse_scene_file(std::string_view text, const std::string& display_path, Mistakes& mistakes) {
  const auto root = parse_json(text, display_path, mistakes);
  if (!root) {
    mistakes.add_whole(root.error());
    return {};
  }
  const Field field(*root, "", mistakes);
  const ObjectReader object(field, scene_keys::kScene);
  SceneFile scene;
  if (const auto schema = object.find("$schema")) read_text(*schema);
  if (const auto render = object.find("render")) scene.settings = read_render(*render);
  if (const auto grids = object.find("grids")) scene.grids = read_grids(*grids);
  if (const auto media = object.find("media"))
    scene.media = read_media(*media, scene.grids, scene.media_animations);
  if (const auto camera = object.find("camera")) {
    scene.camera = read_camera(*camera, scene.camera_animation);
    if (const auto medium = find_member_field(*camera, "medium"))
      scene.camera_medium = read_medium_name(*medium, scene.media);
  }
  if (const auto output = object.find("output")) scene.display = read_output(*output);
  if (const auto textures = object.find("textures")) scene.textures = read_textures(*textures);
  if (const auto materials = object.find("materials"))
    scene.materials = read_materials(*materials, scene.textures, scene.media);
  if (const auto objects = object.find("objects")) scene.objects = read_objects(*objects, scene.materials);
  if (const auto shapes = object.find("shapes")) {
    scene.shapes = read_shapes(*shapes, scene.materials, scene.objects, ShapeOwner::kScene);
    scene.shapes_place = shapes->place();
  }
  if (const auto lights = object.find("lights"))
    scene.lights = read_lights(*lights, scene.textures, scene.light_animations);
  if (const auto environment = object.find("environment"))
    scene.environment = read_environment(*environment, scene.textures, scene.environment_animation);
  settle_color_spaces(scene);
  return scene;
}

}  // namespace tessera::core
