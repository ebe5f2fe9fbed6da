// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/light_limit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/scene/light_count.hpp"

namespace tessera::core {

// Light indices have 32 bits, and one value is reserved.
Status check_lights(const SceneDescription& scene, const SceneLimit& limit) {
  constexpr std::uint64_t kMaxLights = std::numeric_limits<std::uint32_t>::max() - 1;
  const std::uint64_t lights = count_area_lights(scene) + scene.lights.size();
  const std::uint64_t most = std::min(limit.most, kMaxLights);
  if (lights <= most) return {};
  return fail(
      ErrorCode::kResourceExhausted,
      fmt::format("the scene has {} lights (emissive triangles and other shapes, again for every instance), "
                  "more than the {} that it may have here{}: give large or repeated meshes a material "
                  "without emission",
                  lights, most, limit.option.empty() ? "" : fmt::format(" ({})", limit.option)));
}

}  // namespace tessera::core
