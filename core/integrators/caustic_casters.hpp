// SPDX-License-Identifier: Apache-2.0
// The surfaces of a scene that reflect or refract light so concentrated that it makes caustics: mirrors,
// glass and polished metal. Immutable, shared by all threads.
#pragma once

#include <cstdint>
#include <vector>

#include "core/sampling/distribution.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core {

class CausticCasters {
 public:
  explicit CausticCasters(const Scene& scene);

  // Whether sample() has nothing to choose from.
  bool empty() const { return primitives_.empty(); }
  double area() const { return area_; }
  bool contain(const Hit& hit) const { return casts_[scene_.primitives().material(hit)]; }

  // A point on one of them that is in no instance, uniformly over their area. There are some.
  struct Place {
    std::uint32_t primitive;
    Vec3 position;
  };
  Place sample(double u_choice, Vec2 u) const;

 private:
  const Scene& scene_;
  std::vector<bool> casts_;  // each material
  std::vector<std::uint32_t> primitives_;
  DiscreteDistribution by_area_;  // of primitives_
  double area_ = 0;
};

}  // namespace tessera::core
