// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/sensor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "core/base/suggestion.hpp"
#include "core/geometry/primitives.hpp"
#include "core/math/elementary.hpp"
#include "core/scene/mitsuba/parse_values.hpp"

namespace tessera::core::mitsuba {
namespace {

constexpr float kDegree = kPi / 180;
constexpr float kFarClip = 1e4f;  // Mitsuba's default

float tangent_of_half(float degrees) {
  const float half = degrees * (kDegree / 2);
  return sin(half) / cos(half);
}

float degrees_of_half_tangent(float tangent) {
  return 2 * atan2(tangent, 1.0f) / kDegree;
}

// The ratio of an image's half width to its distance, by the length of the lens for a film of 36 x 24 mm.
float tangent_of_lens(const Plugin& sensor, float aspect) {
  std::string text = sensor.text("focal_length").value_or("50mm");
  if (text.ends_with("mm")) text.resize(text.size() - 2);
  auto length = parse_number(text);
  if (!length || *length <= 0) {
    sensor.warn("'focal_length' is no length like '50mm'; that one is used");
    length = 50;
  }
  const float diagonal = std::sqrt(36.0f * 36 + 24.0f * 24) / 2 / static_cast<float>(*length);
  return diagonal * aspect / std::sqrt(1 + aspect * aspect);
}

// The same by an angle along an axis of the image.
float tangent_of_angle(const Plugin& sensor, float aspect) {
  constexpr float kNarrowest = 1e-3f, kWidest = 179.9f;
  const float tangent = tangent_of_half(sensor.real_in("fov", 50, kNarrowest, kWidest));
  std::string axis = sensor.text("fov_axis").value_or("x");
  if (axis == "smaller") axis = aspect > 1 ? "y" : "x";
  if (axis == "larger") axis = aspect > 1 ? "x" : "y";
  if (axis == "y") return tangent * aspect;
  if (axis == "diagonal") return tangent * aspect / std::sqrt(1 + aspect * aspect);
  if (axis != "x") sensor.warn(fmt::format("the fov_axis {} is not known; 'x' replaces it", in_quotes(axis)));
  return tangent;
}

int side_of(const Plugin& film, std::string_view name, std::int64_t otherwise) {
  const std::int64_t side = film.integer(name, otherwise);
  if (side >= 1 && side <= kMaxImageSidePx) return static_cast<int>(side);
  film.warn(fmt::format("'{}' is no usable number of pixels; {} replaces it", name, otherwise));
  return static_cast<int>(otherwise);
}

PixelFilter filter_of(const Plugin& film) {
  constexpr float kDeviations = 3;  // where the Gaussian ends, in standard deviations
  const PixelFilter gaussian{FilterKind::kGaussian, kDeviations * 0.5f};
  const auto filter = film.first_child(Kind::kFilter);
  if (!filter) return gaussian;
  constexpr float kMinRadiusPx = 0.01f;
  const std::string& type = filter->type();
  if (type == "box")
    return {FilterKind::kBox, filter->real_in("radius", 0.5f, kMinRadiusPx, kMaxFilterRadiusPx)};
  if (type == "tent")
    return {FilterKind::kTent, filter->real_in("radius", 1, kMinRadiusPx, kMaxFilterRadiusPx)};
  if (type == "gaussian")
    return {FilterKind::kGaussian, kDeviations * filter->real_in("stddev", 0.5f, kMinRadiusPx / kDeviations,
                                                                 kMaxFilterRadiusPx / kDeviations)};
  const bool has_lobes = type == "mitchell" || type == "catmullrom" || type == "lanczos";
  filter->warn(fmt::format("{}; a Gaussian of standard deviation 0.5, as wide as its middle, replaces it",
                           has_lobes
                               ? "this filter has negative lobes, which a sum of equal samples cannot have"
                               : "this filter is not supported"));
  filter->ignore_all();
  return gaussian;
}

void set_film(RenderSettings& settings, const Plugin& film) {
  if (film.type() != "hdrfilm") film.warn("is treated as 'hdrfilm'");
  settings.width_px = side_of(film, "width", 768);
  settings.height_px = side_of(film, "height", 576);
  settings.filter = filter_of(film);
  film.ignore({"pixel_format", "component_format", "file_format", "sample_border", "compensate", "banner",
               "high_quality_edges", "gamma", "exposure"});
  const auto pixels = [&](std::string_view name, int otherwise) {
    return static_cast<int>(film.integer_in(name, otherwise, 0, kMaxImageSidePx));
  };
  const int x = pixels("crop_offset_x", 0), y = pixels("crop_offset_y", 0);
  const PixelRect crop{x, y, x + pixels("crop_width", settings.width_px - x),
                       y + pixels("crop_height", settings.height_px - y)};
  const PixelRect all{0, 0, settings.width_px, settings.height_px};
  if (crop == all) return;
  if (crop.empty() || !all.contains(crop))
    film.warn("the crop window is not inside of the image; the whole image is rendered");
  else
    settings.crop = crop;
}

void set_sampler(RenderSettings& settings, const Plugin& sampler) {
  settings.spp = static_cast<std::uint32_t>(sampler.integer_in("sample_count", 4, 1, kMaxSpp));
  settings.seed =
      static_cast<std::uint64_t>(sampler.integer_in("seed", 0, 0, std::numeric_limits<std::int64_t>::max()));
  sampler.ignore({"jitter", "wavefront_size"});
}

CameraDescription camera_of(const Plugin& sensor, const Transform& to_world, float aspect) {
  CameraDescription camera;
  camera.position = to_world.origin;
  camera.look_at = to_world.origin + normalize(to_world.z_axis);
  camera.up = to_world.y_axis;
  camera.mirrored = to_world.determinant() < 0;
  const auto shift = [&](std::string_view name) {
    return sensor.real_in(name, 0, -kMaxLensShift, kMaxLensShift);
  };
  camera.lens_shift = {shift("principal_point_offset_x"), -shift("principal_point_offset_y")};
  if (sensor.type() == "orthographic") {
    camera.type = CameraType::kOrthographic;
    const Vec3 scales = to_world.scales();
    camera.view_height = 2 * scales.x / aspect;
    if (std::fabs(scales.x - scales.y) > 1e-3f * scales.x)
      sensor.warn("the image has the scale of its x axis in y, too");
    return camera;
  }
  const float tangent = half_width_of(sensor, aspect);
  camera.vertical_fov_degrees = degrees_of_half_tangent(tangent / aspect);
  if (sensor.type() == "thinlens") {
    camera.aperture_radius = sensor.real_in("aperture_radius", 0, 0, kMaxCoordinate);
    camera.focus_distance =
        sensor.real_in("focus_distance", sensor.real("far_clip", kFarClip), 0, kMaxCoordinate);
  }
  return camera;
}

}  // namespace

float half_width_of(const Plugin& plugin, float aspect) {
  if (plugin.has("fov")) return tangent_of_angle(plugin, aspect);
  plugin.ignore({"fov_axis"});
  return tangent_of_lens(plugin, aspect);
}

void set_sensor(Conversion& conversion, const Plugin& sensor) {
  RenderSettings& settings = conversion.builder.scene().settings;
  settings.width_px = 768;
  settings.height_px = 576;
  settings.spp = 4;
  settings.filter = {FilterKind::kGaussian, 1.5f};
  if (const auto film = sensor.first_child(Kind::kFilm)) set_film(settings, *film);
  if (const auto sampler = sensor.first_child(Kind::kSampler)) set_sampler(settings, *sampler);
  conversion.near_clip = sensor.real("near_clip", 0.01f);
  conversion.far_clip = sensor.real("far_clip", kFarClip);
  sensor.ignore({"srf", "focus_distance"});
  conversion.shutter_open = sensor.real("shutter_open", 0);
  const float shutter_close = sensor.real("shutter_close", 0);
  const std::string& type = sensor.type();
  if (type != "perspective" && type != "thinlens" && type != "orthographic") {
    sensor.warn("this sensor is not supported; a camera that sees the whole scene replaces it");
    sensor.ignore_all();
    return;
  }
  const float aspect = static_cast<float>(settings.width_px) / static_cast<float>(settings.height_px);
  const auto* keys = sensor.animation("to_world");
  CameraDescription camera =
      camera_of(sensor, keys == nullptr ? sensor.transform("to_world") : keys->front().transform, aspect);
  if (keys != nullptr && keys->size() > 1 &&
      !animate_camera(conversion.in_frames(*keys), camera, conversion.builder.scene().animation.camera))
    sensor.warn("does not move; the first keyframe of 'to_world' counts");
  if (!(shutter_close - conversion.shutter_open >= 0 &&
        shutter_close - conversion.shutter_open <= kMaxShutterFrames))
    sensor.warn(fmt::format("'shutter_close' must be from 'shutter_open' to {} later; the nearest is used",
                            kMaxShutterFrames));
  conversion.shutter_frames = std::clamp(shutter_close - conversion.shutter_open, 0.0f, kMaxShutterFrames);
  camera.shutter_close = conversion.shutter_frames;
  if (is_finite(camera.look_at) && camera.look_at != camera.position && is_finite(camera.up))
    conversion.builder.set_camera(camera);
  else
    sensor.warn("'to_world' has no direction; a camera that sees the whole scene replaces the sensor");
}

void set_integrator(Conversion& conversion, const Plugin& integrator) {
  const std::string& type = integrator.type();
  if (const auto inner = integrator.first_child(Kind::kIntegrator)) {
    if (type != "moment")
      integrator.warn("the image of the integrator inside of it is rendered, without what this one adds");
    integrator.ignore_all();
    return set_integrator(conversion, *inner);
  }
  if (type != "path" && type != "direct" && type != "volpath" && type != "volpathmis")
    integrator.warn("path tracing replaces this integrator");
  integrator.ignore({"rr_depth", "emitter_samples", "bsdf_samples", "shading_samples", "samples_per_pass",
                     "block_size", "timeout", "use_nee", "max_null"});
  // Mitsuba counts the camera's segment, and the settings those after it; 0 means no limit there.
  const std::int64_t depth = integrator.integer("max_depth", type == "direct" ? 2 : -1);
  if (depth == 0) integrator.warn("a 'max_depth' of 1 replaces 0, so that something is seen");
  conversion.emission_only = depth == 0 || depth == 1;
  if (depth > kMaxDepth + 1) integrator.warn(fmt::format("'max_depth' is limited to {}", kMaxDepth + 1));
  conversion.builder.scene().settings.max_depth =
      depth < 0 ? 0 : static_cast<int>(std::clamp<std::int64_t>(depth - 1, 1, kMaxDepth));
  conversion.counts_passing = depth >= 0 && !type.starts_with("volpath");
  conversion.hides_emitters = integrator.flag("hide_emitters", false);
}

}  // namespace tessera::core::mitsuba
