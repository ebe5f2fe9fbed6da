// SPDX-License-Identifier: Apache-2.0
// What a camera is told, as scene files say it.
#pragma once

#include "core/math/vec3.hpp"

namespace tessera::core {

inline constexpr int kMinApertureBlades = 3, kMaxApertureBlades = 64;

// A thin-lens camera; a pinhole where aperture_radius is 0. World units.
struct CameraDescription {
  Vec3 position{0, 0, 0};
  Vec3 look_at{0, 0, -1};
  Vec3 up{0, 1, 0};
  float vertical_fov_degrees = 40;  // full angle
  float aperture_radius = 0;        // of the opening, or of the circle around it
  float focus_distance = 0;         // along the viewing axis; 0 for the distance of look_at
  // The opening is round where there are no blades, else a regular polygon of so many corners. The first
  // corner points up, turned counter-clockwise in the picture.
  int aperture_blades = 0;
  float aperture_rotation_degrees = 0;
};

}  // namespace tessera::core
