// SPDX-License-Identifier: Apache-2.0
// The camera's parameters as scene files give them.
#pragma once

#include "core/math/vec3.hpp"

namespace tessera::core {

inline constexpr int kMinApertureBlades = 3, kMaxApertureBlades = 64;
inline constexpr float kMaxLensShift = 1000;
inline constexpr float kMaxShutterFrames = 1000;

enum class CameraType {
  kPerspective,   // a thin lens; a pinhole where aperture_radius is 0
  kOrthographic,  // parallel rays; blurred away from the focus distance where aperture_radius is not 0
  kPanoramic,     // all directions, equirectangular: look_at is in the centre, longitude grows to the right
};

// World units.
struct CameraDescription {
  Vec3 position{0, 0, 0};
  Vec3 look_at{0, 0, -1};
  Vec3 up{0, 1, 0};
  float vertical_fov_degrees = 40;  // full angle
  float aperture_radius = 0;        // of the disk, or of the polygon's circumscribed circle
  float focus_distance = 0;         // along the viewing axis; 0: the distance of look_at
  // The number of corners of the aperture; 0 is a disk. The first corner points up, rotated
  // counter-clockwise in the image.
  int aperture_blades = 0;
  float aperture_rotation_degrees = 0;
  CameraType type = CameraType::kPerspective;
  float view_height = 0;  // orthographic: the height of the image in the world
  // The offset of the image from the line of sight to the right and upwards, in widths and heights of the
  // image: at (0.5, 0), look_at is on the left edge. Not for panoramic cameras.
  Vec2 lens_shift{0, 0};
  bool mirrored = false;  // the image is exchanged left to right, as in a mirror
  // When the shutter opens and closes, in frames from the frame that is rendered. If these are equal, nothing
  // moves while it is open.
  float shutter_open = 0, shutter_close = 0;
};

}  // namespace tessera::core
