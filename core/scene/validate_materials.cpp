// SPDX-License-Identifier: Apache-2.0
#include "core/scene/validate_materials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "core/geometry/placement.hpp"

namespace tessera::core {
namespace {

tl::unexpected<Error> invalid_part(std::string message) {
  return fail(ErrorCode::kInvalidArgument, std::move(message));
}

bool is_in_range(std::string_view, const ColorParameter& color) {
  return is_valid_radiance(color.value);
}

bool is_in_range(std::string_view key, const ScalarParameter& scalar) {
  if (key.ends_with("ior")) return scalar.value > 0 && std::isfinite(scalar.value);
  return scalar.value >= 0 && std::isfinite(scalar.value);
}

Status check_material(const Material& material, const std::vector<Texture>& textures) {
  const auto texture_count = static_cast<int>(textures.size());
  const auto wrong = [&](std::string_view what) {
    return invalid_part(fmt::format("material '{}': {}", material.name, what));
  };
  std::string_view mistaken;
  visit_parameters(material.model, [&](std::string_view key, const auto& parameter) {
    if (parameter.texture >= texture_count || !is_in_range(key, parameter)) mistaken = key;
  });
  if (!mistaken.empty()) return wrong(fmt::format("{} is out of range, or its texture", mistaken));
  if (material.normal_map.texture >= texture_count || !std::isfinite(material.normal_map.strength))
    return wrong("the normal map's texture or its strength is out of range");
  if (material.bump.texture >= texture_count || !std::isfinite(material.bump.height))
    return wrong("the bump map's texture or its height is out of range");
  const ScalarParameter& opacity = material.opacity;
  if (opacity.texture >= texture_count || !(opacity.value >= 0 && opacity.value <= 1))
    return wrong("opacity must be between 0 and 1, or its texture is out of range");
  if (material.sampling == Sampling::kHalfVector && !std::holds_alternative<CookTorrance>(material.model))
    return wrong("only cook_torrance can be sampled by half-vectors");
  if (const auto* hair = std::get_if<Hair>(&material.model))
    if (!(std::fabs(hair->tilt_degrees) <= kMaxHairTiltDegrees))
      return wrong(fmt::format("tilt_degrees must be between -{0} and {0}", kMaxHairTiltDegrees));
  if (!is_valid_radiance(material.emission.value)) return wrong("emission must be finite and not negative");
  if (std::holds_alternative<Null>(material.model) && !is_black(material.emission.value))
    return wrong("a null material cannot emit");
  if (material.emission.texture >= texture_count) return wrong("emission: there is no such texture");
  if (!is_valid_radiance(material.emission, textures))
    return wrong("emission times its texture is too bright to be computed; lower it");
  return {};
}

bool is_medium(int medium, const SceneDescription& scene) {
  return medium >= kNoMedium && medium < static_cast<int>(scene.media.size());
}

// A blend's parts stand before it, which rules out cycles; `depths` are those of the materials before it.
Status check_blend(const Material& material, const Blend& blend, const std::vector<Material>& all,
                   std::vector<int>& depths) {
  if (std::max(blend.first, blend.second) >= depths.size() - 1)
    return invalid_part(
        fmt::format("material '{}': a blend's materials must stand before the blend", material.name));
  depths.back() = 1 + std::max(depths[blend.first], depths[blend.second]);
  if (!is_black(material.emission.value) &&
      !(is_opaque(all[blend.first], all) && is_opaque(all[blend.second], all)))
    return invalid_part(
        fmt::format("material '{}': a blend of what light passes through cannot emit", material.name));
  if (depths.back() <= kMaxBlendDepth) return {};
  return invalid_part(
      fmt::format("material '{}': blends of blends may be {} deep", material.name, kMaxBlendDepth));
}

// Whether the coefficients and the products with the grid's values can be computed.
bool is_valid_coefficient(Rgb value, int grid, const SceneDescription& scene) {
  const auto is_valid = [](Rgb v) {
    return is_valid_radiance(v) && max_component(v) <= kMaxMediumCoefficient;
  };
  if (!is_valid(value)) return false;
  if (grid < 0) return true;
  const auto& values = scene.grids[static_cast<std::size_t>(grid)].values;
  return is_valid(value * *std::max_element(values.begin(), values.end()));
}

}  // namespace

bool is_valid_radiance(Rgb c) {
  return is_finite(c) && c.r >= 0 && c.g >= 0 && c.b >= 0;
}

bool is_valid_radiance(const ColorParameter& color, const std::vector<Texture>& textures) {
  if (!is_valid_radiance(color.value)) return false;
  return color.texture < 0 ||
         is_valid_radiance(color.value * textures[static_cast<std::size_t>(color.texture)].image->largest());
}

Status check_materials(const std::vector<Material>& materials, const SceneDescription& scene) {
  std::vector<int> blend_depths;
  for (const Material& material : materials) {
    blend_depths.push_back(0);
    if (auto ok = check_material(material, scene.textures); !ok) return ok;
    if (const auto* blend = std::get_if<Blend>(&material.model))
      if (auto ok = check_blend(material, *blend, materials, blend_depths); !ok) return ok;
    if (!is_medium(material.media.interior, scene) || !is_medium(material.media.exterior, scene))
      return invalid_part(fmt::format("material '{}': there is no such medium", material.name));
  }
  return {};
}

Status check_medium(const MediumDescription& medium, const SceneDescription& scene) {
  const auto wrong = [&](std::string_view what) {
    return invalid_part(fmt::format("medium '{}': {}", medium.name, what));
  };
  for (const int grid : {medium.absorption_grid, medium.scattering_grid, medium.emission_grid})
    if (grid < -1 || grid >= static_cast<int>(scene.grids.size())) return wrong("there is no such grid");
  if (!(medium.scale >= 0) ||
      !is_valid_coefficient(medium.sigma_a * medium.scale, medium.absorption_grid, scene) ||
      !is_valid_coefficient(medium.sigma_s * medium.scale, medium.scattering_grid, scene))
    return wrong("sigma_a, sigma_s and scale must be from 0 to 1e18, also times the grid's values");
  if (!is_valid_coefficient(medium.emission, medium.emission_grid, scene))
    return wrong("emission must be from 0 to 1e18, also times the grid's values");
  if (!(medium.g > -1 && medium.g < 1)) return wrong("g must be above -1 and below 1");
  if (medium.has_grid() && !Placement::can_place(medium.grid_to_world))
    return wrong("the transform flattens the grid, or scales or moves it too far to be computed");
  return {};
}

Status check_media(const SceneDescription& scene) {
  for (std::size_t i = 0; i < scene.grids.size(); ++i)
    if (!is_sound(scene.grids[i]))
      return invalid_part(
          fmt::format("grid {}: needs one or three finite values that are not negative for each voxel, and 1 "
                      "to {} voxels "
                      "a side",
                      i, kMaxGridSide));
  for (const MediumDescription& medium : scene.media)
    if (auto ok = check_medium(medium, scene); !ok) return ok;
  if (!is_medium(scene.camera_medium, scene)) return invalid_part("camera: there is no such medium");
  return {};
}

}  // namespace tessera::core
