// SPDX-License-Identifier: Apache-2.0
#include "core/scene/validate_materials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <concepts>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/geometry/placement.hpp"
#include "core/scene/priorities.hpp"
#include "core/scene/tables/check.hpp"
#include "core/scene/tables/material_tables.hpp"
#include "core/scene/tables/medium_tables.hpp"
#include "core/scene/validate_textures.hpp"

namespace tessera::core {
namespace {

tl::unexpected<Error> invalid_part(std::string message) {
  return fail(ErrorCode::kInvalidArgument, std::move(message));
}

NameCounts counts_of(const SceneDescription& scene) {
  return {scene.textures.size(), scene.media.size(), scene.grids.size()};
}

std::optional<KeyMistake> mistake_in(const Material& material, const NameCounts& counts) {
  auto mistake = std::visit(
      [&]<typename Model>(const Model& model) { return find_mistake(kKeys<Model>, model, counts); },
      material.model);
  return mistake ? mistake : find_mistake(kKeys<Material>, material, counts);
}

// The key of a map of directions whose texture is no image.
std::optional<std::string_view> key_without_image(const Material& material,
                                                  const std::vector<Texture>& textures) {
  std::optional<std::string_view> found;
  visit_keys(material, [&]<typename Value>(const auto& key, const Value& value) {
    if constexpr (std::same_as<Value, NormalMap> || std::same_as<Value, TangentMap>)
      if (!is_image(value.texture, textures)) found = key.name;
  });
  return found;
}

std::string image_text(std::string_view key) {
  return fmt::format("{}: the texture must be an image", key);
}

Status check_material(const Material& material, const SceneDescription& scene) {
  if (const auto mistake = mistake_in(material, counts_of(scene))) return invalid_part(mistake->text());
  if (const auto key = key_without_image(material, scene.textures)) return invalid_part(image_text(*key));
  if (material.sampling == Sampling::kHalfVector && !std::holds_alternative<CookTorrance>(material.model))
    return invalid_part("only cook_torrance can be sampled by half-vectors");
  if (!is_valid_radiance(material.emission, scene.textures))
    return invalid_part("emission times its texture is too bright to be computed; lower it");
  return {};
}

// Whether the value changes. What is no number becomes the least.
bool clamp_value(float& value, const Domain& domain) {
  const auto min = static_cast<float>(domain.range.min), max = static_cast<float>(domain.range.max);
  const float clamped = value > min ? std::min(value, max) : min;
  return std::exchange(value, clamped) != clamped;
}
bool clamp_value(Rgb& value, const Domain& domain) {
  bool changes = false;
  for (float* channel : {&value.r, &value.g, &value.b}) changes |= clamp_value(*channel, domain);
  return changes;
}
template <typename Value>
bool clamp_value(Value& value, const Domain& domain) {
  if constexpr (HasTable<Value>) {
    bool changes = false;
    visit_members(kKeys<Value>, value,
                  [&](const auto& key, auto& member) { changes |= clamp_value(member, key.domain); });
    return changes;
  } else if constexpr (std::same_as<Value, ColorParameter> || std::same_as<Value, ScalarParameter>) {
    return value.texture < 0 && clamp_value(value.value, domain);
  } else {
    return false;
  }
}

bool is_medium(int medium, const SceneDescription& scene) {
  return medium >= kNoMedium && medium < static_cast<int>(scene.media.size());
}

// A blend's parts stand before it, which rules out cycles; `depths` are those of the materials before it.
Status check_blend(const Material& material, const Blend& blend, const std::vector<Material>& all,
                   std::vector<int>& depths) {
  if (std::max(blend.first, blend.second) >= depths.size() - 1)
    return invalid_part("a blend's materials must stand before the blend");
  depths.back() = 1 + std::max(depths[blend.first], depths[blend.second]);
  if (!is_black(material.emission.value) &&
      !(is_opaque(all[blend.first], all) && is_opaque(all[blend.second], all)))
    return invalid_part("a blend of what light passes through cannot emit");
  if (depths.back() <= kMaxBlendDepth) return {};
  return invalid_part(fmt::format("blends of blends may be {} deep", kMaxBlendDepth));
}

// The material that stands behind as many as there are depths.
Status check_next(const Material& material, const std::vector<Material>& all, const SceneDescription& scene,
                  std::vector<int>& blend_depths) {
  blend_depths.push_back(0);
  if (auto ok = check_material(material, scene); !ok) return ok;
  if (const auto* blend = std::get_if<Blend>(&material.model))
    if (auto ok = check_blend(material, *blend, all, blend_depths); !ok) return ok;
  return {};
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
         is_valid_radiance(color.value * textures[static_cast<std::size_t>(color.texture)].largest());
}

std::vector<std::string_view> clamp_to_ranges(Material& material) {
  std::vector<std::string_view> clamped;
  visit_keys(material, [&](const auto& key, auto& value) {
    if (clamp_value(value, key.domain)) clamped.push_back(key.name);
  });
  return clamped;
}

std::string clamped_text(std::string_view material, std::string_view key) {
  return fmt::format("material '{}': {} is out of range; it is clamped", material, key);
}

Status check_materials(const std::vector<Material>& materials, const SceneDescription& scene) {
  const auto named = [](const Material& material) { return fmt::format("material '{}'", material.name); };
  std::vector<int> blend_depths;
  for (const Material& material : materials)
    if (auto ok = check_next(material, materials, scene, blend_depths); !ok)
      return fail(ok.error().within(named(material)));
  if (const auto mistake = find_priority_mistake(materials))
    return invalid_part(fmt::format("{}: {}", named(materials[mistake->material]), mistake->what));
  return {};
}

void check_each_material(const SceneDescription& scene,
                         const std::function<void(std::size_t, const Error&)>& refuse) {
  std::vector<int> blend_depths;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const Status ok = check_next(scene.materials[i], scene.materials, scene, blend_depths);
    if (ok) continue;
    blend_depths.back() = 0;
    refuse(i, ok.error());
  }
}

Status check_medium(const MediumDescription& medium, const SceneDescription& scene) {
  const auto wrong = [&](std::string_view what) {
    return invalid_part(fmt::format("medium '{}': {}", medium.name, what));
  };
  if (const auto mistake = find_mistake(kKeys<MediumDescription>, medium, counts_of(scene)))
    return wrong(mistake->text());
  if (!is_valid_coefficient(medium.sigma_a * medium.scale, medium.absorption_grid, scene) ||
      !is_valid_coefficient(medium.sigma_s * medium.scale, medium.scattering_grid, scene))
    return wrong("sigma_a, sigma_s and scale must be from 0 to 1e18, also times the grid's values");
  if (!is_valid_coefficient(medium.emission, medium.emission_grid, scene))
    return wrong("emission must be from 0 to 1e18, also times the grid's values");
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
