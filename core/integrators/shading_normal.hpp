// What keeps surfaces shaded with other normals than their own (interpolated, or bent by a map) from going
// black or letting light through. docs/materials.md says why. All vectors are of unit length; `side` is the
// surface's true normal on the side of the viewer, who looks along -wo.
#pragma once

#include "core/math/vec3.hpp"

namespace tessera::core {

// `normal`, bent just far enough that wo is above it.
Vec3 bend_toward_viewer(Vec3 normal, Vec3 wo);

// Bent just far enough that the mirror direction of wo is above the true surface (Keller et al. 2017).
Vec3 bend_for_reflection(Vec3 normal, Vec3 side, Vec3 wo);

// A direction that should be on the true surface's side `side`, bent to graze it if it is not.
Vec3 bend_above(Vec3 wi, Vec3 side);

// What reflected light is multiplied by, from 0 where wi sinks below the true surface to 1 where its
// elevation is that above the shading normal's plane (Chiang, Li and Burley 2019).
float smooth_terminator(Vec3 normal, Vec3 side, Vec3 wi);

}  // namespace tessera::core
