// SPDX-License-Identifier: Apache-2.0
#include "core/scene/priorities.hpp"

#include <fmt/format.h>

namespace tessera::core {

float priority_of(const MaterialModel& model) {
  if (const auto* glass = std::get_if<Glass>(&model)) return glass->priority;
  const auto* solid = std::get_if<Principled>(&model);
  return solid != nullptr && transmits_light(model) && !solid->geometry_thin_walled ? solid->priority : 0;
}

std::optional<PriorityMistake> find_priority_mistake(const std::vector<Material>& materials) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const Material& material = materials[i];
    const auto has_priority = [&](std::uint32_t part) { return priority_of(materials[part].model) > 0; };
    if (const auto* blend = std::get_if<Blend>(&material.model))
      if (has_priority(blend->first) || has_priority(blend->second))
        return PriorityMistake{i, "the materials of a blend cannot have a priority"};
    if (!(priority_of(material.model) > 0)) continue;
    if (index_in(material.model)->texture >= 0)
      return PriorityMistake{i, "with a priority, the index of refraction cannot be a texture"};
    if (!is_black(material.emission.value))
      return PriorityMistake{i, "what emits light cannot have a priority"};
    if (++count > kMaxNestedDielectrics)
      return PriorityMistake{i,
                             fmt::format("at most {} materials can have a priority", kMaxNestedDielectrics)};
  }
  return std::nullopt;
}

}  // namespace tessera::core
