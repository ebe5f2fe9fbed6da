// SPDX-License-Identifier: Apache-2.0
// The camera and the light of files that have none. Stateless; thread-safe.
#pragma once

#include "core/camera/camera_description.hpp"
#include "core/geometry/aabb.hpp"
#include "core/scene/import/scene_builder.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

// A camera that sees the whole box from the front, a little from the side and from above. `aspect` is the
// image's width divided by its height.
CameraDescription default_camera(const Aabb& bounds, float aspect, const SceneDefaults& axes);

// An equirectangular environment for products and scans: a gray gradient, brighter from above, with a broad
// soft light at the upper left behind a camera that looks along -`front`, and a weaker one at the right.
TextureImage studio_environment(const SceneDefaults& axes);

}  // namespace tessera::core
