// SPDX-License-Identifier: Apache-2.0
// The state that the directives of a scene file change, and that AttributeBegin saves.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/scene/pbrt/animated_matrix.hpp"
#include "core/scene/pbrt/lights.hpp"
#include "core/scene/pbrt/parameters.hpp"

namespace tessera::core::pbrt {

// What the directive Attribute gives default parameters to.
enum class AttributeTarget { kShape, kLight, kMaterial, kMedium, kTexture };
inline constexpr std::size_t kAttributeTargets = 5;

inline std::optional<AttributeTarget> attribute_target(std::string_view name) {
  constexpr std::string_view kNames[kAttributeTargets] = {"shape", "light", "material", "medium", "texture"};
  for (std::size_t i = 0; i < kAttributeTargets; ++i)
    if (name == kNames[i]) return static_cast<AttributeTarget>(i);
  return std::nullopt;
}

struct GraphicsState {
  AnimatedMatrix transform{};
  bool is_start_active = true, is_end_active = true;  // ActiveTransform: which of them directives change
  bool reverse_orientation = false;
  std::optional<int> material{};  // of Materials; nullopt: the default
  std::shared_ptr<const AreaLight> area_light{};
  std::string inside_medium{}, outside_medium{};
  std::string color_space = "srgb";
  std::array<std::shared_ptr<const Parameters>, kAttributeTargets> defaults{};

  const std::shared_ptr<const Parameters>& defaults_of(AttributeTarget target) const {
    return defaults[static_cast<std::size_t>(target)];
  }
};

}  // namespace tessera::core::pbrt
