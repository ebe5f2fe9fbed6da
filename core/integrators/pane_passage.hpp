// SPDX-License-Identifier: Apache-2.0
// Which ways through panes count as straight (panes.hpp).
#pragma once

#include <cstdint>

namespace tessera::core::integrators {

// How light, or a path against it, has passed panes so far.
struct PanePassage {
  // After that, little of the light is left.
  static constexpr std::uint32_t kMaxSurfaces = 32, kMaxReflections = 2;

  // Whether what is scattered at a further surface of pane glass may become straight: what is refracted, or
  // reflected within the glass, there and back. `inside`: it has arrived at the surface within the glass.
  bool may_continue(bool refracted, bool inside) const {
    if (surfaces == kMaxSurfaces) return false;
    return refracted ? reflections % 2 == 0 : inside && reflections < kMaxReflections;
  }
  PanePassage beyond(bool refracted) const { return {surfaces + 1, reflections + (refracted ? 0 : 1)}; }

  std::uint32_t surfaces = 0, reflections = 0;
};

}  // namespace tessera::core::integrators
