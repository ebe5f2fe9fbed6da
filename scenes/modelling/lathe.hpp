// SPDX-License-Identifier: Apache-2.0
// Turned things: vases, bowls, bottles, glasses, and whatever else is round about the y axis.
#pragma once

#include <functional>

#include "scenes/modelling/curve.hpp"
#include "scenes/modelling/surface.hpp"

namespace tessera::modelling {

// The point of a profile (radius, height) at u turns about the y axis, counter-clockwise seen from above.
Vec3 revolve(Vec2 profile_point, float u);

// A profile turned about the y axis; it runs so that the outside lies on its right (up along an outer wall,
// down along an inner one). Closed where it starts and ends with radius 0. uv = (turn, fraction of the
// length).
MeshDescription lathe_mesh(const Profile& profile, int segments, int rings);

}  // namespace tessera::modelling
