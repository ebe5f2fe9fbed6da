// SPDX-License-Identifier: Apache-2.0
// The surfaces of a scene that focus light into caustics: mirrors, glass and polished metal, inside and
// outside instances. Immutable, shared by all threads.
#pragma once

#include <cstdint>
#include <vector>

#include "core/sampling/distribution.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core::integrators {

class CausticCasters {
 public:
  explicit CausticCasters(const Scene& scene);

  // Whether sample() has no primitives to sample from.
  bool empty() const { return groups_.empty(); }
  bool contain(const Hit& hit) const { return casts_[scene_.primitives().material(hit)]; }

  // A point on a caster, uniform over their area but for instances that scale it unevenly. Requires
  // !empty().
  struct Place {
    std::uint32_t primitive, instance;  // as of a Hit
    Vec3 position;
    double inverse_density;  // 1 / probability per area
  };
  Place sample(double u_choice, Vec2 u) const;

 private:
  // The casters of the scene's own shapes, or of an object. Instances that show the same share a list.
  struct List {
    const Primitives* shapes;
    std::vector<std::uint32_t> primitives{};
    sampling::DiscreteDistribution by_area{};  // of `primitives`, in proportion to area
    double area = 0;
  };
  struct Group {
    std::uint32_t instance;  // or kNoInstance
    std::uint32_t list;
    double weight;  // about the area of the list's casters in the scene
  };
  std::uint32_t add_list(const Primitives& shapes, std::uint32_t shown);

  const Scene& scene_;
  std::vector<bool> casts_;  // for each material
  std::vector<List> lists_;
  std::vector<Group> groups_;
  sampling::DiscreteDistribution by_weight_;  // of groups_
  double weight_ = 0;                         // of all groups
};

}  // namespace tessera::core::integrators
