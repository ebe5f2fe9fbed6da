// SPDX-License-Identifier: Apache-2.0
// The compound lenses of the camera "realistic", as thick lenses by paraxial ray tracing (Pharr et al. 2023,
// section 5.4, "Realistic Cameras"). Lengths are in millimetres. Stateless; thread-safe.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace tessera::core::pbrt {

// A surface between two media, or a stop if it has no curvature.
struct LensSurface {
  double radius = 0;     // of curvature; positive if the surface is convex towards the scene, 0 for a stop
  double thickness = 0;  // the distance to the next surface
  double index = 1;      // of refraction, of the medium behind the surface
  double diameter = 0;   // of the opening
};

// A lens from the scene to the film.
using LensSystem = std::vector<LensSurface>;

// A lens that is focused. A point of the film at the distance h from the axis sees the direction whose
// tangent is `field` * h, from the centre of the entrance pupil.
struct FocusedLens {
  double focal_length = 0;
  double pupil_distance = 0;  // from the film to the entrance pupil
  double pupil_radius = 0;    // of the entrance pupil
  double focus_distance = 0;  // from the entrance pupil to the plane in focus
  double field = 0;
  double irradiance = 0;  // in the centre of the film, under a radiance of 1
};

// Four numbers for each surface: radius, thickness, index and diameter; '#' begins a comment. Empty if it is
// anything else.
LensSystem parse_lens(std::string_view text);

// The lens is moved until it shows the plane at `distance` from the film. nullopt if it cannot, because the
// distance is too short, or the lens does not converge or lets no light through.
std::optional<FocusedLens> focused(const LensSystem& lens, double distance);

}  // namespace tessera::core::pbrt
