// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/placements.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/math/elementary.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core::gltf {
namespace {

constexpr float kDegreesPerRadian = 180 / kPi;

// The unit direction of `axis` in the world; `axis` itself if the map has none.
Vec3 direction_of(const Transform& to_world, Vec3 axis) {
  const Vec3 direction = normalize(to_world.direction(axis));
  return is_finite(direction) ? direction : axis;
}

float aspect_ratio_of(const Value& projection) {
  const float ratio = projection.number_or("aspectRatio", 0);
  if (ratio < 0) projection["aspectRatio"].refuse("must be above 0");
  return ratio;
}

void read_perspective(const Value& projection, PlacedCamera& camera) {
  const float fov = projection.number_or("yfov", 0);
  if (!(fov > 0 && fov < kPi)) projection.refuse(fmt::format("yfov must lie between 0 and pi, got {}", fov));
  camera.description.vertical_fov_degrees = fov * kDegreesPerRadian;
  camera.aspect_ratio = aspect_ratio_of(projection);
}

void read_orthographic(const Value& projection, PlacedCamera& camera) {
  const float half_width = projection.number_or("xmag", 0), half_height = projection.number_or("ymag", 0);
  if (!(half_width > 0) || !(half_height > 0)) projection.refuse("xmag and ymag must be above 0");
  camera.description.type = CameraType::kOrthographic;
  camera.description.view_height = 2 * half_height;
  camera.aspect_ratio = half_width / half_height;
}

LightDescription read_spot(const Value& light, Vec3 position, Vec3 direction, Rgb intensity) {
  const Value spot = light["spot"];
  const float outer = spot.number_or("outerConeAngle", kPi / 4), inner = spot.number_or("innerConeAngle", 0);
  if (!(outer > 0 && outer <= kPi / 2 * 1.0001f) || !(inner >= 0))
    light.refuse("its cone angles must lie between 0 and pi/2");
  SpotLightDescription description;
  description.position = position;
  description.look_at = position + direction * std::max(1.0f, length(position));
  description.intensity = intensity;
  description.angle_degrees = std::min(2 * outer * kDegreesPerRadian, 180.0f);
  description.softness = std::clamp(1 - inner / outer, 0.0f, 1.0f);
  return description;
}

}  // namespace

PlacedCamera read_camera(const Value& camera, const Transform& to_world) {
  PlacedCamera result;
  CameraDescription& description = result.description;
  description.position = to_world.origin;
  const float reach = std::max(1.0f, length(to_world.origin));
  description.look_at = to_world.origin + direction_of(to_world, {0, 0, -1}) * reach;
  description.up = direction_of(to_world, {0, 1, 0});
  const std::string type = camera.text("type");
  if (type == "orthographic")
    read_orthographic(camera["orthographic"], result);
  else if (type == "perspective")
    read_perspective(camera["perspective"], result);
  else
    camera.refuse(fmt::format("there is no camera type {}", in_quotes(type)));
  return result;
}

LightDescription read_light(const Value& light, const Transform& to_world, const Document& document) {
  const Vec3 position = to_world.origin, direction = direction_of(to_world, {0, 0, -1});
  const Rgb intensity = light.color_or("color", Rgb::gray(1)) * light.number_or("intensity", 1);
  if (!(std::min({intensity.r, intensity.g, intensity.b}) >= 0) || !is_finite(intensity))
    light.refuse("its intensity must be finite and not negative");
  if (light["range"].exists())
    document.warn(light, "light range",
                  "the range of lights is ignored: they fall off with the square of distance");
  const std::string type = light.text("type");
  if (type == "directional") return DirectionalLightDescription{direction, intensity};
  if (type == "point") return PointLightDescription{position, intensity};
  if (type != "spot") light.refuse(fmt::format("there is no light type {}", in_quotes(type)));
  document.warn(light, "spot falloff", "the falloff of spot lights at their edge is approximated");
  return read_spot(light, position, direction, intensity);
}

}  // namespace tessera::core::gltf
