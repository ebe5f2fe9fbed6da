// SPDX-License-Identifier: Apache-2.0
// The radiance of one sample, divided into the layers of an image. Integrators fill it in beside the
// radiance, which it does not change.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "core/math/rgb.hpp"

namespace tessera::core::integrators {

struct LightParts {
  // Where light that reaches the camera without being scattered comes from.
  enum class Source { kEmission, kEnvironment };

  Rgb emission{}, environment{};  // seen by the camera
  Rgb direct{}, indirect{};       // scattered once, and more often
  bool escaped = false;           // the camera ray met nothing
  std::span<Rgb> groups{};        // of each light group; empty if they are not divided

  // Begins anew.
  void clear() {
    std::fill(groups.begin(), groups.end(), Rgb{});
    *this = {.groups = groups};
  }
  // Adds light that was scattered this many times. `group` may be kNoLightGroup.
  void add(Rgb radiance, int scatterings, Source source, std::uint32_t group) {
    if (group < groups.size()) groups[group] += radiance;
    Rgb& part = scatterings > 1               ? indirect
                : scatterings == 1            ? direct
                : source == Source::kEmission ? emission
                                              : environment;
    part += radiance;
  }
};

}  // namespace tessera::core::integrators
