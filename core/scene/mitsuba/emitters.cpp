// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/emitters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/math/elementary.hpp"
#include "core/math/motion.hpp"
#include "core/scene/import/keyed_transforms.hpp"
#include "core/scene/mitsuba/sensor.hpp"
#include "core/scene/validate_textures.hpp"

namespace tessera::core::mitsuba {
namespace {

// The rotation of a map, without its scale and offset. Its axes are orthogonal.
Transform rotation_of(const Transform& t) {
  const Vec3 x = normalize(t.x_axis);
  const Vec3 y = normalize(t.y_axis - x * dot(x, t.y_axis));
  const Vec3 z = cross(x, y);
  return {x, y, dot(z, t.z_axis) < 0 ? -z : z, {}};
}

bool is_orthonormal(const Transform& t) {
  constexpr float kTolerance = 1e-3f;
  const Transform r = rotation_of(t);
  const auto same = [&](Vec3 a, Vec3 b) { return length(a - b) <= kTolerance; };
  return same(t.x_axis, r.x_axis) && same(t.y_axis, r.y_axis) && same(t.z_axis, r.z_axis);
}

constexpr float kMaxScale = 1e30f;

constexpr const char* kFlat = "has a 'to_world' that flattens its image; it is left out";

// Images cannot be wider.
constexpr float kWidestImage = 89.9f;

float tangent_of_degrees(float angle) {
  const SinCos half = sin_cos_turns(angle / 360);
  return half.sin / half.cos;
}

// Whether the image that a light projects has an area.
bool has_area(const lights::ProjectedImage& image) {
  return length_squared(image.right) > 0 && length_squared(image.up) > 0;
}

void aim(SpotLightDescription& light, const Transform& to_world) {
  light.position = to_world.origin;
  light.look_at = to_world.origin + normalize(to_world.z_axis);
}

bool has_finite_axes(const Transform& t) {
  return core::is_finite(t.x_axis) && core::is_finite(t.y_axis) && core::is_finite(t.z_axis);
}

}  // namespace

void EmitterConverter::add(const Plugin& emitter) {
  emitter.ignore({"sampling_weight"});
  const std::string& type = emitter.type();
  if (type == "point") return add_point(emitter);
  if (type == "spot") return add_spot(emitter);
  if (type == "projector") return add_projector(emitter);
  if (type == "directional") return add_directional(emitter);
  if (type == "constant") return set_constant(emitter);
  if (type == "envmap") return set_image(emitter);
  emitter.warn("this emitter is not supported here; it is left out");
  emitter.ignore_all();
}

Rgb EmitterConverter::color(const Plugin& emitter, std::string_view name) {
  const ColorParameter found = image(emitter, name);
  return found.texture < 0 ? found.value : mean_of(emitter, name, found);
}

Rgb EmitterConverter::mean_of(const Plugin& emitter, std::string_view name, const ColorParameter& textured) {
  emitter.warn(fmt::format("the mean replaces the texture of '{}'", name));
  const auto& textures = conversion_.builder.scene().textures;
  return textured.value * textures[static_cast<std::size_t>(textured.texture)].mean(textures);
}

ColorParameter EmitterConverter::image(const Plugin& emitter, std::string_view name) {
  const ColorParameter found =
      textures_.color(emitter, name, Rgb::gray(1), {}, std::numeric_limits<float>::max());
  if (is_image(found.texture, conversion_.builder.scene().textures)) return found;
  return {mean_of(emitter, name, found), -1};
}

std::vector<Transform> EmitterConverter::placements(const Plugin& emitter) {
  const auto* keys = emitter.animation("to_world");
  if (keys == nullptr || keys->size() < 2) return {emitter.transform("to_world")};
  const auto motion = motion_through(conversion_.in_frames(*keys));
  if (!motion || !motion->is_exact) return {emitter.transform("to_world")};
  constexpr int kPlaces = 32;
  const float frames = conversion_.shutter_frames;
  if (frames == 0) return {transform_at(motion->steps, 0)};
  emitter.warn(fmt::format("moves; {} lights along its way replace it", kPlaces));
  std::vector<Transform> places;
  for (int i = 0; i < kPlaces; ++i)
    places.push_back(transform_at(motion->steps, (static_cast<float>(i) + 0.5f) / kPlaces * frames));
  return places;
}

template <typename Light, typename Place>
void EmitterConverter::add_placed(const Plugin& emitter, const Light& light, const Place& place) {
  const std::vector<Transform> places = placements(emitter);
  for (const Transform& to_world : places) {
    Light placed = light;
    placed.intensity *= 1 / static_cast<float>(places.size());
    place(placed, to_world);
    if constexpr (requires { placed.image; })
      if (!has_area(placed.image)) return emitter.warn(kFlat);
    conversion_.builder.add_light(std::move(placed), emitter.place());
  }
}

void EmitterConverter::add_point(const Plugin& emitter) {
  const auto position = emitter.vector("position");
  PointLightDescription light;
  light.intensity = color(emitter, "intensity");
  if (position) {  // whatever its to_world
    light.position = *position;
    return conversion_.builder.add_light(light, emitter.place());
  }
  add_placed(emitter, light, [](PointLightDescription& placed, const Transform& to_world) {
    placed.position = to_world.origin;
  });
}

void EmitterConverter::add_spot(const Plugin& emitter) {
  constexpr float kWidest = 90, kNarrowest = 0.01f;  // half angles, in degrees
  const float cutoff = emitter.real_in("cutoff_angle", 20, kNarrowest, kWidest);
  const float beam = emitter.real_in("beam_width", cutoff * 0.75f, 0, cutoff);
  SpotLightDescription light;
  light.intensity = color(emitter, "intensity");
  light.angle_degrees = 2 * cutoff;
  light.softness = (cutoff - beam) / cutoff;
  light.falloff = lights::SpotFalloff::kLinear;
  const ColorParameter picture = image(emitter, "texture");
  light.intensity *= picture.value;
  const float half_width = tangent_of_degrees(std::min(cutoff, kWidestImage));
  add_placed(emitter, light, [&](SpotLightDescription& placed, const Transform& to_world) {
    aim(placed, to_world);
    if (picture.texture >= 0)
      placed.image = {picture.texture, normalize(to_world.x_axis) * half_width,
                      normalize(to_world.y_axis) * half_width, false};
  });
}

// The image is mirrored, as that of a camera. Its texels are irradiances of a plane at a distance of 1, over
// pi.
void EmitterConverter::add_projector(const Plugin& emitter) {
  const ColorParameter irradiance = image(emitter, "irradiance");
  int texture = irradiance.texture;
  if (texture < 0) {
    auto white = conversion_.builder.image_pixels("white", TextureImage(1, 1, std::vector<float>{1, 1, 1}));
    if (!white) return conversion_.check(fail(white.error()));
    texture = conversion_.builder.add_texture(Texture{std::move(*white)});
  }
  const TextureImage& slide = *conversion_.builder.scene().textures[static_cast<std::size_t>(texture)].image;
  const float aspect = static_cast<float>(slide.width()) / static_cast<float>(slide.height());
  const float across = half_width_of(emitter, aspect), upward = across / aspect;
  constexpr float kMargin = 1.0001f;
  const float half_angle = atan2(std::sqrt(across * across + upward * upward), 1.0f) * (180 / kPi);
  SpotLightDescription light;
  light.intensity = irradiance.value * (kPi * emitter.real_in("scale", 1, 0, kMaxScale));
  light.angle_degrees = std::min(2 * half_angle * kMargin, 180.0f);
  light.softness = 0;
  add_placed(emitter, light, [&](SpotLightDescription& placed, const Transform& to_world) {
    aim(placed, to_world);
    placed.image = {texture, normalize(to_world.x_axis) * -across, normalize(to_world.y_axis) * -upward,
                    true};
  });
}

void EmitterConverter::add_directional(const Plugin& emitter) {
  DirectionalLightDescription light;
  light.direction = emitter.vector("direction").value_or(emitter.transform("to_world").z_axis);
  light.irradiance = color(emitter, "irradiance");
  if (light.direction == Vec3{}) {
    emitter.warn("its direction is 0; it is left out");
    return;
  }
  conversion_.builder.add_light(light, emitter.place());
}

void EmitterConverter::set_constant(const Plugin& emitter) {
  EnvironmentDescription environment;
  environment.radiance = {color(emitter, "radiance"), -1};
  if (is_black(environment.radiance.value)) emitter.warn("emits no light");
  set_environment(emitter, std::move(environment));
}

// Mitsuba's maps have -z at their left edge; those here have it in the centre.
void EmitterConverter::set_image(const Plugin& emitter) {
  emitter.ignore({"mis_compensation"});
  const auto image = textures_.environment_image(emitter);
  const float scale = emitter.real_in("scale", 1, 0, kMaxScale);
  Transform to_world = emitter.transform("to_world");
  if (!image) return;
  if (!is_orthonormal(to_world)) {
    emitter.warn("'to_world' is no rotation; the nearest one replaces it");
    to_world = rotation_of(to_world);
    if (!has_finite_axes(to_world)) to_world = {};
  }
  EnvironmentDescription environment;
  environment.radiance = {Rgb::gray(scale), conversion_.builder.add_texture(*image)};
  environment.rotation_degrees = 180;
  environment.orientation = rotation_of(to_world);
  set_environment(emitter, std::move(environment));
}

void EmitterConverter::set_environment(const Plugin& emitter, EnvironmentDescription environment) {
  if (conversion_.builder.scene().environment) {
    emitter.warn("the scene has an environment already, which is kept");
    return;
  }
  environment.visible_to_camera = !conversion_.hides_emitters;
  conversion_.builder.set_environment(std::move(environment));
}

}  // namespace tessera::core::mitsuba
