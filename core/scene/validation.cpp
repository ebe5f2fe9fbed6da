// SPDX-License-Identifier: Apache-2.0
#include "core/scene/validation.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/overloaded.hpp"
#include "core/geometry/placement.hpp"
#include "core/geometry/primitives.hpp"
#include "core/scene/analytic_shapes.hpp"
#include "core/scene/validate_materials.hpp"
#include "core/scene/validate_shapes.hpp"

namespace tessera::core {
namespace {

tl::unexpected<Error> invalid(std::string message) {
  return fail(ErrorCode::kInvalidArgument, std::move(message));
}

}  // namespace

Status validate_camera(const CameraDescription& camera) {
  if (!is_valid_point(camera.position) || !is_valid_point(camera.look_at) || !is_finite(camera.up))
    return invalid("camera: position, look_at and up must be finite numbers");
  const Vec3 view = camera.look_at - camera.position;
  if (!(length_squared(view) > 0)) return invalid("camera.look_at: must differ from camera.position");
  const Vec3 across = cross(normalize(view), camera.up);
  if (!(length_squared(across) > 0))
    return invalid("camera.up: must not be parallel to the viewing direction");
  if (camera.type == CameraType::kOrthographic &&
      !(camera.view_height > 0 && camera.view_height <= kMaxCoordinate))
    return invalid(fmt::format("camera.view_height: must be above 0 and at most {:g}, got {}", kMaxCoordinate,
                               camera.view_height));
  const auto is_shift = [](float shift) { return std::fabs(shift) <= kMaxLensShift; };
  if (!is_shift(camera.lens_shift.x) || !is_shift(camera.lens_shift.y))
    return invalid(fmt::format("camera.lens_shift: must be between -{0} and {0}, got [{1}, {2}]",
                               kMaxLensShift, camera.lens_shift.x, camera.lens_shift.y));
  if (!(camera.vertical_fov_degrees > 0 && camera.vertical_fov_degrees < 180))
    return invalid(fmt::format("camera.vertical_fov_degrees: must lie between 0 and 180, got {}",
                               camera.vertical_fov_degrees));
  if (!(camera.aperture_radius >= 0 && camera.aperture_radius <= kMaxCoordinate))
    return invalid(fmt::format("camera.aperture_radius: must be between 0 and {:g}, got {}", kMaxCoordinate,
                               camera.aperture_radius));
  const auto is_near_frame = [](float frames) { return std::fabs(frames) <= kMaxShutterFrames; };
  if (!is_near_frame(camera.shutter_open) || !is_near_frame(camera.shutter_close) ||
      camera.shutter_open > camera.shutter_close)
    return invalid(
        fmt::format("camera.shutter: must open before it closes, at most {} frames from the image, "
                    "got [{}, {}]",
                    kMaxShutterFrames, camera.shutter_open, camera.shutter_close));
  const int blades = camera.aperture_blades;
  if (blades != 0 && !(blades >= kMinApertureBlades && blades <= kMaxApertureBlades))
    return invalid(fmt::format("camera.aperture_blades: must be 0, or between {} and {}, got {}",
                               kMinApertureBlades, kMaxApertureBlades, blades));
  if (!(std::fabs(camera.aperture_rotation_degrees) <= 360))
    return invalid(fmt::format("camera.aperture_rotation_degrees: must be between -360 and 360, got {}",
                               camera.aperture_rotation_degrees));
  if (!(camera.focus_distance >= 0) || !std::isfinite(camera.focus_distance))
    return invalid(fmt::format("camera.focus_distance: must be above 0, got {}", camera.focus_distance));
  return {};
}

namespace {

bool is_emissive(const MediumDescription& medium) {
  return medium.scale > 0 && !is_black(medium.sigma_a * medium.emission);
}

// Whether the direction from one to the other can be computed.
bool are_apart(Vec3 from, Vec3 to) {
  const float distance2 = length_squared(to - from);
  return distance2 > 0 && std::isfinite(distance2);
}

// Or a reflection, to within rounding.
bool is_rotation(const Transform& t) {
  return std::fabs(uniform_scale(t, kEnvironmentTolerance) - 1) <= kEnvironmentTolerance;
}

// The index of the texture that multiplies a light's intensity; -1 if none does.
int texture_of(const LightDescription& light) {
  if (const auto* point = std::get_if<PointLightDescription>(&light)) return point->texture;
  const auto* spot = std::get_if<SpotLightDescription>(&light);
  return spot == nullptr ? -1 : spot->image.texture;
}

Status check_light_textures(const SceneDescription& scene) {
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const int texture = texture_of(scene.lights[i]);
    if (texture < -1 || texture >= static_cast<int>(scene.textures.size()))
      return invalid(fmt::format("lights[{}]: there is no such texture", i));
  }
  return {};
}

Status check_light(const LightDescription& light) {
  return std::visit(
      Overloaded{
          [](const PointLightDescription& d) -> Status {
            if (!is_valid_point(d.position)) return invalid("position must be finite numbers");
            if (!is_valid_radiance(d.intensity)) return invalid("intensity must be finite and not negative");
            if (!is_rotation(d.orientation))
              return invalid("the orientation must be a rotation or a reflection");
            return {};
          },
          [](const SpotLightDescription& d) -> Status {
            if (!is_valid_point(d.position) || !is_valid_point(d.look_at) ||
                !are_apart(d.position, d.look_at))
              return invalid("position and look_at must be two points");
            if (!is_valid_radiance(d.intensity)) return invalid("intensity must be finite and not negative");
            if (!(d.angle_degrees > 0 && d.angle_degrees <= 180))
              return invalid(
                  fmt::format("angle_degrees: must be above 0 and at most 180, got {}", d.angle_degrees));
            if (!(d.softness >= 0 && d.softness <= 1))
              return invalid(fmt::format("softness: must be between 0 and 1, got {}", d.softness));
            if (!are_apart({}, d.image.right) || !are_apart({}, d.image.up))
              return invalid("image: right and up must have lengths");
            return {};
          },
          [](const DirectionalLightDescription& d) -> Status {
            if (!are_apart({}, d.direction)) return invalid("direction must have a length");
            if (!is_valid_radiance(d.irradiance))
              return invalid("irradiance must be finite and not negative");
            return {};
          },
      },
      light);
}

Status check_environment(const EnvironmentDescription& environment, const std::vector<Texture>& textures) {
  if (!is_valid_radiance(environment.radiance.value))
    return invalid("environment: radiance must be finite and not negative");
  if (environment.radiance.texture >= static_cast<int>(textures.size()))
    return invalid("environment: there is no such texture");
  if (!is_valid_radiance(environment.radiance, textures))
    return invalid("environment: radiance times its image is too bright to be computed; lower it");
  if (!std::isfinite(environment.rotation_degrees))
    return invalid("environment: rotation_degrees must be a number");
  if (!is_rotation(environment.orientation))
    return invalid("environment: the orientation must be a rotation or a reflection");
  return {};
}

std::vector<Material> extreme_materials(const SceneDescription& scene, bool greatest) {
  std::vector<Material> materials = scene.materials;
  for (const auto& [index, tracks] : scene.animation.materials)
    materials[index] = extreme_values(materials[index], tracks, greatest);
  return materials;
}

// Values between two that are in range are in range. What shines brightest may be least opaque.
Status check_animated_materials(const SceneDescription& scene) {
  const std::vector<Material> least = extreme_materials(scene, false);
  std::vector<Material> greatest = extreme_materials(scene, true);
  for (const std::vector<Material>* materials : {&least, &std::as_const(greatest)})
    if (auto ok = check_materials(*materials, scene); !ok) return ok;
  for (std::size_t i = 0; i < greatest.size(); ++i) greatest[i].opacity = least[i].opacity;
  return check_materials(greatest, scene);
}

Status check_animated_parameters(const SceneDescription& scene) {
  const Animation& animation = scene.animation;
  if (!animation.materials.empty())
    if (auto ok = check_animated_materials(scene); !ok) return ok;
  for (const bool greatest : {false, true}) {
    for (const auto& [index, tracks] : animation.media)
      if (auto ok = check_medium(extreme_values(scene.media[index], tracks, greatest), scene); !ok) return ok;
    if (!scene.environment) continue;
    const auto environment = extreme_values(*scene.environment, animation.environment, greatest);
    if (auto ok = check_environment(environment, scene.textures); !ok) return ok;
  }
  return {};
}

Status check_animation(const SceneDescription& scene) {
  const Animation& animation = scene.animation;
  if (!is_sound(animation))
    return invalid("animation: the frames of keyframes must be numbers that increase");
  for (const LightAnimation& light : animation.lights)
    if (light.light >= scene.lights.size())
      return invalid(fmt::format("animation: there is no light {}", light.light));
  for (const InstanceMotion& motion : animation.instances)
    if (motion.shape >= scene.shapes.size() ||
        !std::holds_alternative<InstanceDescription>(scene.shapes[motion.shape]))
      return invalid(fmt::format("animation: there is no instance {}", motion.shape));
  for (const IndexedTracks& each : animation.materials)
    if (each.index >= scene.materials.size())
      return invalid(fmt::format("animation: there is no material {}", each.index));
  for (const IndexedTracks& each : animation.media)
    if (each.index >= scene.media.size())
      return invalid(fmt::format("animation: there is no medium {}", each.index));
  return check_animated_parameters(scene);
}

bool emits(const ShapeDescription& shape, const SceneDescription& scene) {
  const auto emissive = [&](std::uint32_t material) { return can_emit(material, scene); };
  return std::visit(Overloaded{[&](const MeshDescription& mesh) {
                                 return std::any_of(mesh.triangle_materials.begin(),
                                                    mesh.triangle_materials.end(), emissive);
                               },
                               [&](const SphereDescription& sphere) { return emissive(sphere.material); },
                               [&](const QuadDescription& quad) { return emissive(quad.material); },
                               [&](const DiskDescription& disk) { return emissive(disk.material); },
                               [&](const CylinderDescription& c) { return emissive(c.material); },
                               [&](const CurvesDescription&) { return false; },
                               [&](const InstanceDescription& instance) {
                                 if (instance.material) return emissive(*instance.material);
                                 const auto& shapes = scene.objects[instance.object].shapes;
                                 return std::any_of(
                                     shapes.begin(), shapes.end(),
                                     [&](const ShapeDescription& part) { return emits(part, scene); });
                               }},
                    shape);
}

Rgb color_of(const LightDescription& light) {
  return std::visit(Overloaded{[](const PointLightDescription& d) { return d.intensity; },
                               [](const SpotLightDescription& d) { return d.intensity; },
                               [](const DirectionalLightDescription& d) { return d.irradiance; }},
                    light);
}

}  // namespace

Status validate_lights(const std::vector<LightDescription>& lights) {
  for (std::size_t i = 0; i < lights.size(); ++i)
    if (auto ok = check_light(lights[i]); !ok) return fail(ok.error().within(fmt::format("lights[{}]", i)));
  return {};
}

Status validate_scene(const SceneDescription& scene) {
  if (auto ok = check_settings(scene.settings); !ok) return fail(ok.error().within("render"));
  // Jobs stored by earlier releases may exceed the limit.
  if (scene.settings.max_depth > kMaxDepth)
    return invalid(fmt::format("render: max_depth: must be between 0 and {}, got {}", kMaxDepth,
                               scene.settings.max_depth));
  if (auto ok = check_display(scene.display); !ok) return fail(ok.error().within("output"));
  if (auto ok = validate_camera(scene.camera); !ok) return ok;
  if (auto ok = check_media(scene); !ok) return ok;
  if (auto ok = check_materials(scene.materials, scene); !ok) return ok;
  if (auto ok = validate_lights(scene.lights); !ok) return ok;
  if (auto ok = check_light_textures(scene); !ok) return ok;
  if (scene.environment)
    if (auto ok = check_environment(*scene.environment, scene.textures); !ok) return ok;
  if (auto ok = check_all_shapes(scene); !ok) return ok;
  return check_animation(scene);
}

bool uses_media(const SceneDescription& scene) {
  return uses_media(scene.camera_medium, scene.materials);
}

bool uses_media(int camera_medium, const std::vector<Material>& materials) {
  return camera_medium != kNoMedium ||
         std::any_of(materials.begin(), materials.end(),
                     [](const Material& material) { return material.media.changes_medium(); });
}

bool gives_light(const SceneDescription& scene) {
  if (scene.environment && !is_black(scene.environment->radiance.value)) return true;
  for (const LightDescription& light : scene.lights)
    if (!is_black(color_of(light))) return true;
  // A light that is dark at frame 0 brightens later.
  for (const LightAnimation& light : scene.animation.lights)
    if (!light.color.empty()) return true;
  if (scene.environment && scene.animation.environment.color("radiance") != nullptr) return true;
  for (const auto& [index, tracks] : scene.animation.media)
    if (uses_media(scene) && is_emissive(extreme_values(scene.media[index], tracks, true))) return true;
  if (uses_media(scene) && std::any_of(scene.media.begin(), scene.media.end(), is_emissive)) return true;
  return std::any_of(scene.shapes.begin(), scene.shapes.end(),
                     [&](const ShapeDescription& shape) { return emits(shape, scene); });
}

}  // namespace tessera::core
