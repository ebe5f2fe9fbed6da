// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import/scene_repair.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/import/empty_objects.hpp"
#include "core/scene/validate_materials.hpp"
#include "core/scene/validate_shapes.hpp"
#include "core/scene/validation.hpp"

namespace tessera::core {
namespace {

void tell_part(FileWarnings& warnings, std::string_view kind, const std::string& what) {
  warnings.add(kind, 0, [&] { return what; });
}

// Products with the texels of an image are finite unless the factor is large: images are searched only then.
bool is_usable_light(const ColorParameter& color, const std::vector<Texture>& textures) {
  if (!is_valid_radiance(color.value)) return false;
  return max_component(color.value) <= 1 || is_valid_radiance(color, textures);
}

void repair_emission(SceneDescription& scene, FileWarnings& warnings) {
  for (Material& material : scene.materials) {
    if (is_usable_light(material.emission, scene.textures)) continue;
    material.emission = {Rgb{}, -1};
    tell_part(warnings, "emission",
              fmt::format("the emission of the material '{}' is negative or too bright to be computed; it "
                          "does not emit",
                          material.name));
  }
}

void repair_environment(SceneDescription& scene, FileWarnings& warnings) {
  if (!scene.environment) return;
  EnvironmentDescription searched = *scene.environment;
  if (is_usable_light(searched.radiance, scene.textures)) searched.radiance = {Rgb{}, -1};
  const Status valid = validate_environment(searched, scene.textures);
  if (valid) return;
  tell_part(warnings, "environment", fmt::format("{}; it is left out", valid.error().message));
  scene.environment.reset();
}

void repair_materials(SceneDescription& scene, FileWarnings& warnings) {
  repair_emission(scene, warnings);
  std::vector<std::size_t> invalid;
  check_each_material(scene, [&](std::size_t i, const Error& error) {
    invalid.push_back(i);
    tell_part(warnings, "material",
              fmt::format("material '{}': {}; a gray diffuse one replaces it", scene.materials[i].name,
                          error.message));
  });
  for (const std::size_t i : invalid) {
    Material gray;
    gray.name = std::move(scene.materials[i].name);
    scene.materials[i] = std::move(gray);
  }
}

void repair_media(SceneDescription& scene, FileWarnings& warnings) {
  for (MediumDescription& medium : scene.media) {
    const Status valid = check_medium(medium, scene);
    if (valid) continue;
    tell_part(warnings, "medium", fmt::format("{}; vacuum replaces it", valid.error().message));
    MediumDescription vacuum;
    vacuum.name = std::move(medium.name);
    vacuum.sigma_a = vacuum.sigma_s = Rgb{};
    medium = std::move(vacuum);
  }
}

}  // namespace

void leave_out_invalid_parts(SceneDescription& scene, FileWarnings& warnings) {
  repair_media(scene, warnings);
  repair_materials(scene, warnings);
  std::vector<std::size_t> misplaced;
  check_instances(scene, [&](std::size_t i, const Error& error) {
    misplaced.push_back(i);
    tell_part(warnings, "instance", fmt::format("{} is left out: {}", scene.shape_names[i], error.message));
  });
  remove_shapes(scene, misplaced);
  repair_environment(scene, warnings);
}

bool is_valid_view(SceneDescription& scene, FileWarnings& warnings) {
  const Status valid = validate_camera(scene.camera);
  if (valid) return true;
  tell_part(warnings, "camera",
            fmt::format("{}; a camera that sees the whole scene replaces it", valid.error().message));
  CameraDescription with_shutter;
  with_shutter.shutter_open = scene.camera.shutter_open;
  with_shutter.shutter_close = scene.camera.shutter_close;
  scene.camera = validate_camera(with_shutter) ? with_shutter : CameraDescription();
  scene.animation.camera = {};
  return false;
}

}  // namespace tessera::core
