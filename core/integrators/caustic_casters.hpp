// SPDX-License-Identifier: Apache-2.0
// The surfaces of a scene that focus light into caustics: mirrors, glass and polished metal. Immutable,
// shared by all threads.
#pragma once

#include <cstdint>
#include <vector>

#include "core/sampling/distribution.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core {

class CausticCasters {
 public:
  explicit CausticCasters(const Scene& scene);

  // Whether sample() has no primitives to sample from.
  bool empty() const { return primitives_.empty(); }
  double area() const { return area_; }
  bool contain(const Hit& hit) const { return casts_[scene_.primitives().material(hit)]; }

  // A point on a caster outside all instances, uniform over their area. Requires !empty().
  struct Place {
    std::uint32_t primitive;
    Vec3 position;
  };
  Place sample(double u_choice, Vec2 u) const;

 private:
  const Scene& scene_;
  std::vector<bool> casts_;  // for each material
  std::vector<std::uint32_t> primitives_;
  DiscreteDistribution by_area_;  // of primitives_, in proportion to area
  double area_ = 0;
};

}  // namespace tessera::core
