// SPDX-License-Identifier: Apache-2.0
// The directives before WorldBegin that say how to render: camera, film, filter, sampler and integrator. They
// may come in any order, so they are converted together. Not thread-safe.
#pragma once

#include <optional>
#include <string>

#include "core/base/error.hpp"
#include "core/scene/import/scene_builder.hpp"
#include "core/scene/pbrt/exposure.hpp"
#include "core/scene/pbrt/matrix.hpp"
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
  Matrix world_from_camera{};
};

// Sets the camera and the settings of the scene, and returns the exposure of its film. Unsupported parameters
// are told.
Exposure convert_view(const ViewDirectives& directives, SceneBuilder& builder, const Report& report);

}  // namespace tessera::core::pbrt
