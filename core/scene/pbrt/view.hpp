// SPDX-License-Identifier: Apache-2.0
// The directives before WorldBegin that say how to render: camera, film, filter, sampler and integrator. They
// may come in any order, so they are converted together. Not thread-safe.
#pragma once

#include <optional>
#include <string>

#include "core/base/error.hpp"
#include "core/scene/import/scene_builder.hpp"
#include "core/scene/pbrt/animated_matrix.hpp"
#include "core/scene/pbrt/exposure.hpp"
#include "core/scene/pbrt/parameters.hpp"
#include "core/scene/pbrt/report.hpp"

namespace tessera::core::pbrt {

// A directive with its kind: Camera "perspective".
struct KindAndParameters {
  std::string kind;
  Parameters parameters;
};

struct ViewDirectives {
  std::optional<KindAndParameters> camera{}, film{}, filter{}, sampler{}, integrator{};
  AnimatedMatrix world_from_camera{};
  TransformTimes times{};
};

// Whether the maximum depth is that of light that nothing scatters.
bool shows_emission_only(const ViewDirectives& directives);
// When the shutter opens: frame 0, with a frame for each second.
float shutter_open_s(const ViewDirectives& directives);
// Lets the camera, which is set already, expose for the time of the directives: something moves.
void open_shutter(const ViewDirectives& directives, SceneBuilder& builder);

// Sets the camera and the settings of the scene, and returns the exposure of its film. Unsupported parameters
// are told.
Exposure convert_view(const ViewDirectives& directives, SceneBuilder& builder, const Report& report);

}  // namespace tessera::core::pbrt
