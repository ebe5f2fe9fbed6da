// SPDX-License-Identifier: Apache-2.0
#include "core/scene/validation.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/overloaded.hpp"
#include "core/geometry/placement.hpp"
#include "core/geometry/primitives.hpp"
#include "core/scene/analytic_shapes.hpp"
#include "core/scene/light_groups.hpp"
#include "core/scene/tables/camera_tables.hpp"
#include "core/scene/tables/check.hpp"
#include "core/scene/tables/light_tables.hpp"
#include "core/scene/validate_materials.hpp"
#include "core/scene/validate_shapes.hpp"
#include "core/scene/validate_textures.hpp"

namespace tessera::core {
namespace {

tl::unexpected<Error> invalid(std::string message) {
  return fail(ErrorCode::kInvalidArgument, std::move(message));
}

}  // namespace

Status validate_camera(const CameraDescription& camera) {
  if (const auto mistake = find_mistake(kKeys<CameraDescription>, camera, NameCounts{}))
    return invalid(fmt::format("camera.{}: {}", mistake->key, mistake->what));
  const Vec3 view = camera.look_at - camera.position;
  if (!(length_squared(view) > 0)) return invalid("camera.look_at: must differ from camera.position");
  const Vec3 across = cross(normalize(view), camera.up);
  if (!(length_squared(across) > 0))
    return invalid("camera.up: must not be parallel to the viewing direction");
  if (camera.type == CameraType::kOrthographic && !(camera.view_height > 0))
    return invalid(fmt::format("camera.view_height: must be above 0, got {}", camera.view_height));
  const auto is_near_frame = [](float frames) { return std::fabs(frames) <= kMaxShutterFrames; };
  if (!is_near_frame(camera.shutter_open) || !is_near_frame(camera.shutter_close) ||
      camera.shutter_open > camera.shutter_close)
    return invalid(
        fmt::format("camera.shutter: must open before it closes, at most {} frames from the image, "
                    "got [{}, {}]",
                    kMaxShutterFrames, camera.shutter_open, camera.shutter_close));
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
    if (!is_image(texture, scene.textures))
      return invalid(fmt::format("lights[{}]: the texture must be an image", i));
  }
  return {};
}

// What no key alone can tell.
std::string_view mistake_of(const PointLightDescription& light) {
  return is_rotation(light.orientation) ? "" : "the orientation must be a rotation or a reflection";
}
std::string_view mistake_of(const SpotLightDescription& light) {
  if (!are_apart(light.position, light.look_at)) return "position and look_at must be two points";
  const bool has_lengths = are_apart({}, light.image.right) && are_apart({}, light.image.up);
  return has_lengths ? "" : "image: right and up must have lengths";
}
std::string_view mistake_of(const DirectionalLightDescription& light) {
  return are_apart({}, light.direction) ? "" : "direction must have a length";
}

// Textures are checked by check_light_textures().
Status check_light(const LightDescription& light) {
  return std::visit(
      []<typename T>(const T& description) -> Status {
        if (const auto mistake = find_mistake(kKeys<T>, description, {.textures = kUnknownCount}))
          return invalid(mistake->text());
        const std::string_view mistake = mistake_of(description);
        return mistake.empty() ? Status() : invalid(std::string(mistake));
      },
      light);
}

Status check_environment(const EnvironmentDescription& environment, const std::vector<Texture>& textures) {
  if (const auto mistake =
          find_mistake(kKeys<EnvironmentDescription>, environment, {.textures = textures.size()}))
    return invalid("environment: " + mistake->text());
  if (!is_image(environment.radiance.texture, textures))
    return invalid("environment: the texture of radiance must be an image");
  if (!is_valid_radiance(environment.radiance, textures))
    return invalid("environment: radiance times its image is too bright to be computed; lower it");
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

// Values between two that are in range are in range. The brightest emission may be the least opaque.
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

bool has_deforming_meshes(const SceneDescription& scene) {
  const auto any_deforms = [](const std::vector<ShapeDescription>& shapes) {
    return std::any_of(shapes.begin(), shapes.end(), deforms);
  };
  return any_deforms(scene.shapes) ||
         std::any_of(scene.objects.begin(), scene.objects.end(),
                     [&](const ObjectDescription& object) { return any_deforms(object.shapes); });
}

Status check_animation(const SceneDescription& scene) {
  const Animation& animation = scene.animation;
  if (!is_sound(animation))
    return invalid("animation: the frames of keyframes must be numbers that increase");
  if (animation.deforms != has_deforming_meshes(scene))
    return invalid("animation: 'deforms' must be true if and only if a mesh has steps");
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
                                 const std::set<std::uint32_t> materials(mesh.triangle_materials.begin(),
                                                                         mesh.triangle_materials.end());
                                 return std::any_of(materials.begin(), materials.end(), emissive);
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

Status validate_light(const LightDescription& light) {
  return check_light(light);
}

bool is_dark(const LightDescription& light) {
  return is_black(color_of(light));
}

Status validate_environment(const EnvironmentDescription& environment, const std::vector<Texture>& textures) {
  return check_environment(environment, textures);
}

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
  if (auto ok = check_textures(scene.textures); !ok) return ok;
  if (auto ok = check_media(scene); !ok) return ok;
  if (auto ok = check_materials(scene.materials, scene); !ok) return ok;
  if (auto ok = validate_lights(scene.lights); !ok) return ok;
  if (auto ok = check_light_textures(scene); !ok) return ok;
  if (scene.environment)
    if (auto ok = check_environment(*scene.environment, scene.textures); !ok) return ok;
  if (auto ok = check_light_groups(scene); !ok) return ok;
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
    if (!is_dark(light)) return true;
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
