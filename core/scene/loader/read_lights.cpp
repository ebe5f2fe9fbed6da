// SPDX-License-Identifier: Apache-2.0
// Reads delta lights and the environment of a scene file.
#include <fmt/format.h>

#include <cmath>

#include "core/geometry/placement.hpp"
#include "core/scene/loader/scene_file.hpp"
#include "core/scene/validation.hpp"

namespace tessera::core {
namespace {

using scene_keys::kLightTypes;

constexpr Bounds kConeAngle{[](double v) { return v > 0 && v <= 180; }, "greater than 0 and at most 180"};

bool has_direction(Vec3 v) {
  return length_squared(v) > 0 && std::isfinite(length_squared(v));
}

// The identity after a mistake.
Transform read_orientation(const Field& field) {
  const std::size_t mistakes_before = field.mistakes().count();
  const TransformEntry steps = read_transform(field);
  if (field.mistakes().count() > mistakes_before) return {};
  if (!steps.motion.empty()) {
    field.mistake("an orientation cannot be animated");
    return {};
  }
  if (!(std::fabs(uniform_scale(steps.transform, kEnvironmentTolerance) - 1) <= kEnvironmentTolerance)) {
    field.mistake("the steps together must be a rotation or a reflection, which keep all lengths");
    return {};
  }
  return steps.transform;
}

// The index of a texture of which only the image is used.
int read_whole_image(const Field& name, const std::vector<TextureEntry>& textures, std::string_view user) {
  const int index = read_texture_name(name, textures);
  if (index < 0) return index;
  const TextureEntry& texture = textures[static_cast<std::size_t>(index)];
  if (texture.scale != Vec2{1, 1} || texture.offset != Vec2{0, 0} || texture.wrap != Wrap::kRepeat ||
      texture.wrap_v || texture.shear != Vec2{})
    name.mistake(
        fmt::format("{} is one whole image: leave out the texture's 'scale', 'offset', 'shear' and 'wrap'; "
                    "{} turns it",
                    user, user == "the environment" ? "'rotation_degrees'" : "'orientation'"));
  return index;
}

PointLightDescription read_point(const Field& field, const std::vector<TextureEntry>& textures,
                                 LightAnimation& a) {
  const ObjectReader object(field, scene_keys::kPointLight);
  PointLightDescription light;
  light.position =
      read_animated_or(object, "position", light.position, a.position, read_vec3, bounds::kCoordinate);
  light.intensity =
      read_animated_or(object, "intensity", light.intensity, a.color, read_color, bounds::kNotNegative);
  if (const auto name = object.find("texture"))
    light.texture = read_whole_image(*name, textures, "the light's distribution");
  if (const auto orientation = object.find("orientation")) light.orientation = read_orientation(*orientation);
  return light;
}

// A vector from the middle of an image to an edge.
Vec3 read_edge(const Field& field) {
  const std::size_t mistakes_before = field.mistakes().count();
  const Vec3 edge = read_vec3(field, bounds::kCoordinate);
  if (field.mistakes().count() == mistakes_before && !has_direction(edge))
    field.mistake("must have a length that is greater than 0 and can be computed");
  return edge;
}

SpotFalloff read_falloff(const Field& field) {
  return static_cast<SpotFalloff>(read_choice(field, scene_keys::kSpotFalloffs));
}

ProjectedImage read_projected_image(const Field& field, const std::vector<TextureEntry>& textures) {
  const ObjectReader object(field, scene_keys::kProjectedImage);
  ProjectedImage image;
  image.texture = read_or(object, "texture", image.texture, read_texture_name, textures);
  image.right = read_or(object, "right", image.right, read_edge);
  image.up = read_or(object, "up", image.up, read_edge);
  image.flat_field = read_or(object, "flat_field", image.flat_field, read_bool);
  return image;
}

SpotLightDescription read_spot(const Field& field, const std::vector<TextureEntry>& textures,
                               LightAnimation& a) {
  const std::size_t mistakes_before = field.mistakes().count();
  const ObjectReader object(field, scene_keys::kSpotLight);
  SpotLightDescription light;
  light.position =
      read_animated_or(object, "position", light.position, a.position, read_vec3, bounds::kCoordinate);
  light.look_at =
      read_animated_or(object, "look_at", light.look_at, a.look_at, read_vec3, bounds::kCoordinate);
  light.intensity =
      read_animated_or(object, "intensity", light.intensity, a.color, read_color, bounds::kNotNegative);
  light.angle_degrees =
      read_animated_or(object, "angle_degrees", light.angle_degrees, a.angle_degrees, read_float, kConeAngle);
  light.softness =
      read_animated_or(object, "softness", light.softness, a.softness, read_float, bounds::kUnit);
  light.falloff = read_or(object, "falloff", light.falloff, read_falloff);
  light.image = read_or(object, "image", light.image, read_projected_image, textures);
  if (field.mistakes().count() == mistakes_before && !has_direction(light.look_at - light.position))
    field.mistake("'look_at' must be another point than 'position', and not too near it to be computed");
  return light;
}

DirectionalLightDescription read_directional(const Field& field, LightAnimation& a) {
  const std::size_t mistakes_before = field.mistakes().count();
  const ObjectReader object(field, scene_keys::kDirectionalLight);
  DirectionalLightDescription light;
  light.direction =
      read_animated_or(object, "direction", light.direction, a.direction, read_vec3, bounds::kAny);
  light.irradiance =
      read_animated_or(object, "irradiance", light.irradiance, a.color, read_color, bounds::kNotNegative);
  if (field.mistakes().count() == mistakes_before && !has_direction(light.direction))
    field.mistake("'direction' must have a length that is greater than 0 and can be computed");
  return light;
}

bool is_animated(const LightAnimation& a) {
  return !(a.position.empty() && a.look_at.empty() && a.direction.empty() && a.color.empty() &&
           a.angle_degrees.empty() && a.softness.empty());
}

LightDescription read_light(const Field& field, std::size_t type, const std::vector<TextureEntry>& textures,
                            LightAnimation& animation) {
  if (type == 0) return read_point(field, textures, animation);
  if (type == 1) return read_spot(field, textures, animation);
  return read_directional(field, animation);
}

// Unlike an emission, it has its texture in a separate key.
Rgb read_environment_radiance(const Field& field) {
  if (field.value().get_if<JsonValue::Number>() || field.value().get_if<JsonValue::Array>())
    return read_color(field, bounds::kNotNegative);
  field.mistake(
      fmt::format("must be a number or a list of 3 numbers, got {}; the texture is a key of its own: "
                  "\"texture\": \"NAME\"",
                  field.value().describe()));
  return {};
}

}  // namespace

std::vector<LightDescription> read_lights(const Field& field, const std::vector<TextureEntry>& textures,
                                          std::vector<LightAnimation>& animations) {
  const auto* items = field.value().get_if<JsonValue::Array>();
  if (items == nullptr) {
    field.must_be("a list of lights in brackets");
    return {};
  }
  std::vector<LightDescription> lights;
  for (std::size_t i = 0; i < items->size(); ++i) {
    const Field entry = field.element(i);
    const auto type = read_type(entry, kLightTypes, "light");
    if (!type) continue;
    LightAnimation animation{.light = static_cast<std::uint32_t>(lights.size())};
    lights.push_back(read_light(entry, *type, textures, animation));
    if (is_animated(animation)) animations.push_back(std::move(animation));
  }
  return lights;
}

EnvironmentDescription read_environment(const Field& field, const std::vector<TextureEntry>& textures,
                                        ParameterTracks& tracks) {
  const ObjectReader object(field, scene_keys::kEnvironment);
  EnvironmentDescription environment;
  environment.radiance.value =
      read_animated_or(object, "radiance", environment.radiance.value, tracks, read_environment_radiance);
  environment.rotation_degrees = read_animated_or(object, "rotation_degrees", environment.rotation_degrees,
                                                  tracks, read_float, bounds::kDegrees);
  if (const auto orientation = object.find("orientation"))
    environment.orientation = read_orientation(*orientation);
  environment.visible_to_camera =
      read_or(object, "visible_to_camera", environment.visible_to_camera, read_bool);
  if (const auto name = object.find("texture"))
    environment.radiance.texture = read_whole_image(*name, textures, "the environment");
  return environment;
}

}  // namespace tessera::core
