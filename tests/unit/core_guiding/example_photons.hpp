// SPDX-License-Identifier: Apache-2.0
// Photons for tests of guides.
#pragma once

#include <vector>

#include "core/guiding/light_guide.hpp"
#include "core/sampling/sampler.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::test {

// On the unit square of the floor, most of them from near one point above it, the others from all around.
inline std::vector<core::guiding::Photon> photons_on_floor(std::uint32_t count) {
  std::vector<core::guiding::Photon> photons;
  for (std::uint32_t i = 0; i < count; ++i) {
    const core::sampling::Sampler sampler(7, 0, 0, i);
    const auto u = sampler.pad(0), v = sampler.pad(1);
    const core::Vec3 position{u[0], 0, u[1]};
    const core::Vec3 origin = core::Vec3{0.4f, 1, 0.6f} + core::sampling::sample_sphere({v[0], v[1]}) * 0.1f;
    const core::Vec3 around = core::sampling::sample_cosine_hemisphere({v[0], v[1]});
    const core::Vec3 wi =
        u[2] < 0.7f ? normalize(origin - position) : core::Vec3{around.x, around.z, around.y};
    photons.push_back({position, {0, 1, 0}, wi, 1, 0.5f + u[3], u[2] < 0.7f ? 10.0f : 0.0f});
  }
  return photons;
}

}  // namespace tessera::test
