// SPDX-License-Identifier: Apache-2.0
// The priorities of dielectrics that overlap (nested_dielectrics.hpp). Stateless; thread-safe.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/materials/material.hpp"

namespace tessera::core {

// The largest number of materials with a priority in a scene.
inline constexpr std::size_t kMaxNestedDielectrics = 64;

// The priority of a solid dielectric; 0 if it has none.
float priority_of(const MaterialModel& model);

// The index of refraction of a model with a priority.
template <typename Model>
auto* index_in(Model& model) {
  if (auto* glass = std::get_if<Glass>(&model)) return &glass->ior;
  return &std::get_if<Principled>(&model)->specular_ior;
}

struct PriorityMistake {
  std::size_t material;  // its index
  std::string what;
};

// The first mistake in the priorities of materials that are valid apart from that.
std::optional<PriorityMistake> find_priority_mistake(const std::vector<Material>& materials);

}  // namespace tessera::core
