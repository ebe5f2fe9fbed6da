// SPDX-License-Identifier: Apache-2.0
// Light groups: names that lights, emissive materials and the environment may have. The light of each can be
// a layer of its own (core/film/layers.hpp). Pure functions.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/scene/description.hpp"
#include "core/scene/settings.hpp"

namespace tessera::core {

// The index of light of no group.
inline constexpr std::uint32_t kNoLightGroup = std::numeric_limits<std::uint32_t>::max();

// The names that a scene uses, sorted, each once.
std::vector<std::string> light_groups(const SceneDescription& scene);
// The index among names; kNoLightGroup for an empty name.
std::uint32_t index_of_group(const std::vector<std::string>& groups, const std::string& name);
// INVALID_ARGUMENT if there are more than kMaxLightGroups.
Status check_light_groups(const SceneDescription& scene);

// `layers` with the names of all groups, where all are asked for, in the order of `groups`.
// INVALID_ARGUMENT if one is not among them.
Result<LayerSet> with_group_names(LayerSet layers, const std::vector<std::string>& groups);

// As resolve_settings() of the scene's settings, with the names of its light groups.
Result<RenderSettings> resolve_settings(const SceneDescription& scene, const RenderOverrides& overrides);

}  // namespace tessera::core
