// SPDX-License-Identifier: Apache-2.0
// The lens of the camera "realistic", from its parameters. Not thread-safe.
#pragma once

#include "core/scene/import/scene_builder.hpp"
#include "core/scene/pbrt/lens_system.hpp"
#include "core/scene/pbrt/parameters.hpp"
#include "core/scene/pbrt/report.hpp"

namespace tessera::core::pbrt {

// Lens files are in millimetres, and the camera's space is in metres.
inline constexpr double kMetresPerMm = 1e-3;

// The lens of the file at the aperture and focus of the camera. What cannot be read or used is told, and
// replaced: the lens by a thin one of 50 mm, too short a distance by infinity.
FocusedLens realistic_lens(const Parameters& p, SceneBuilder& builder, const Report& report);

}  // namespace tessera::core::pbrt
