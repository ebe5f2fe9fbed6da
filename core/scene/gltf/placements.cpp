// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/placements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

LightDescription read_spot(const Value& light, Vec3 position, Vec3 direction, Rgb intensity,
                           const Document& document) {
  const Value spot = light["spot"];
  constexpr float kNarrowest = 1e-4f, kWidest = kPi / 2;
  const auto limited = [&](std::string_view key, float otherwise, float least) {
    const float angle = spot.number_or(key, otherwise), kept = std::clamp(angle, least, kWidest);
    if (std::fabs(kept - angle) > 1e-4f)
      document.warn(spot[key], "cone angle",
                    fmt::format("must lie between 0 and pi/2, got {:g}; it becomes {:g}", angle, kept));
    return kept;
  };
  const float outer = limited("outerConeAngle", kPi / 4, kNarrowest), inner = limited("innerConeAngle", 0, 0);
  SpotLightDescription description;
  description.position = position;
  description.look_at = position + direction * std::max(1.0f, length(position));
  description.intensity = intensity;
  description.angle_degrees = std::min(2 * outer * kDegreesPerRadian, 180.0f);
  description.softness = std::clamp(1 - inner / outer, 0.0f, 1.0f);
  description.falloff = lights::SpotFalloff::kSquared;
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
  description.mirrored = to_world.determinant() < 0;
  const std::string type = camera.text("type");
  if (type == "orthographic")
    read_orthographic(camera["orthographic"], result);
  else if (type == "perspective")
    read_perspective(camera["perspective"], result);
  else
    camera.refuse(fmt::format("there is no camera type {}", in_quotes(type)));
  return result;
}

std::optional<LightDescription> read_light(const Value& light, const Transform& to_world,
                                           const Document& document) {
  const Vec3 position = to_world.origin, direction = direction_of(to_world, {0, 0, -1});
  const Rgb intensity = light.color_or("color", Rgb::gray(1)) * light.number_or("intensity", 1);
  if (light["range"].exists())
    document.warn(light, "light range",
                  "the range of lights is ignored: they fall off with the square of distance");
  const std::string type = light.text("type");
  if (type == "directional") return DirectionalLightDescription{direction, intensity};
  if (type == "point") return PointLightDescription{position, intensity};
  if (type != "spot") {
    document.warn(light, "light type",
                  fmt::format("there is no light type {}; the light is left out", in_quotes(type)));
    return std::nullopt;
  }
  return read_spot(light, position, direction, intensity, document);
}

}  // namespace tessera::core::gltf
