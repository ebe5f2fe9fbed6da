// SPDX-License-Identifier: Apache-2.0
#include "core/scene/light_groups.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

namespace tessera::core {

std::vector<std::string> light_groups(const SceneDescription& scene) {
  std::set<std::string> names;
  for (const Material& material : scene.materials) names.insert(material.light_group);
  for (const LightDescription& light : scene.lights) names.insert(light_group_of(light));
  if (scene.environment) names.insert(scene.environment->light_group);
  names.erase("");
  return {names.begin(), names.end()};
}

std::uint32_t index_of_group(const std::vector<std::string>& groups, const std::string& name) {
  const auto found = std::lower_bound(groups.begin(), groups.end(), name);
  return found == groups.end() || *found != name ? kNoLightGroup
                                                 : static_cast<std::uint32_t>(found - groups.begin());
}

Status check_light_groups(const SceneDescription& scene) {
  const std::vector<std::string> groups = light_groups(scene);
  if (groups.size() > kMaxLightGroups)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("there are {} light groups, more than {}", groups.size(), kMaxLightGroups));
  return {};
}

Result<LayerSet> with_group_names(LayerSet layers, const std::vector<std::string>& groups) {
  for (const std::string& name : layers.groups)
    if (index_of_group(groups, name) == kNoLightGroup)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("layers: there is no light group '{}'; the scene has {}", name,
                              groups.empty() ? "none" : fmt::format("{}", fmt::join(groups, ", "))));
  std::vector<std::string> wanted;
  for (const std::string& name : groups)
    if (layers.light_groups || std::ranges::find(layers.groups, name) != layers.groups.end())
      wanted.push_back(name);
  layers.light_groups = false;
  layers.groups = std::move(wanted);
  return layers;
}

Result<RenderSettings> resolve_settings(const SceneDescription& scene, const RenderOverrides& overrides) {
  auto settings = resolve_settings(scene.settings, overrides);
  if (!settings) return settings;
  auto layers = with_group_names(std::move(settings->layers), light_groups(scene));
  if (!layers) return fail(layers.error());
  settings->layers = *std::move(layers);
  return settings;
}

}  // namespace tessera::core
