// SPDX-License-Identifier: Apache-2.0
// Surfaces that do not stop every ray, such as leaves that are cut out of squares by a texture. A packet says
// whether its primitives have such materials; only where they do, traversal asks for the opacity of each hit.
#pragma once

#include <cstdint>

#include "core/geometry/ray.hpp"

namespace tessera::core::accel {

// What is known of a material at once. A packet has the greatest of its materials.
enum class MaterialOpacity : std::uint32_t {
  kOpaque,   // stops every ray
  kPartial,  // may let a part of the light pass
  kCutOut    // may be transparent, so that closest hits are asked for as well
};

enum class Opacity {
  kTransparent,  // as if there were no surface: the hit is refused
  kPartial,      // anything else
  kOpaque        // stops every ray
};

// The opacity of surfaces where they are hit: a pure function of the hit. Of primitives other than triangles,
// which a ray may meet twice, all or nothing is transparent: traversal asks for the nearest hit only.
// Thread-safe.
class HitOpacity {
 public:
  // The hit has everything but a meaningful t.
  virtual Opacity at(const Hit& hit) const = 0;

 protected:
  ~HitOpacity() = default;
};

}  // namespace tessera::core::accel
