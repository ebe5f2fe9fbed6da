// SPDX-License-Identifier: Apache-2.0
#include "scenes/modelling/lathe.hpp"

#include "core/math/elementary.hpp"

namespace tessera::modelling {

Vec3 revolve(Vec2 profile_point, float u) {
  const float angle = 2 * core::kPi * u;
  return {profile_point.x * core::sin(angle), profile_point.y, profile_point.x * core::cos(angle)};
}

MeshDescription lathe_mesh(const Profile& profile, int segments, int rings) {
  return grid_mesh({uniform_lines(segments), uniform_lines(rings), true},
                   [&](float u, float v) { return revolve(profile.at(v), u); });
}

}  // namespace tessera::modelling
