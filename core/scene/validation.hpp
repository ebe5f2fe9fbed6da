// SPDX-License-Identifier: Apache-2.0
// Validates a scene without building it.
#pragma once

#include <vector>

#include "core/base/error.hpp"
#include "core/geometry/aabb.hpp"
#include "core/scene/description.hpp"

namespace tessera::core {

// The largest deviation of the axes of EnvironmentDescription::orientation from unit length and right angles.
inline constexpr float kEnvironmentTolerance = 1e-4f;

// What the placement of an object in the world must be like.
struct PlacementLimits {
  Aabb object_bounds;            // in the object's space
  bool must_stay_round = false;  // the object has a sphere that emits
};

// Those of an instance. Both must be valid otherwise. Takes time in proportion to the object's size.
PlacementLimits placement_limits(const SceneDescription& scene, const InstanceDescription& instance);

// Parts of validate_scene(), with its errors.
Status validate_camera(const CameraDescription& camera);
Status validate_light(const LightDescription& light);
// Whether its intensity is 0.
bool is_dark(const LightDescription& light);
Status validate_environment(const EnvironmentDescription& environment, const std::vector<Texture>& textures);
Status validate_lights(const std::vector<LightDescription>& lights);
Status validate_placement(const Transform& to_world, const PlacementLimits& limits);

// Checks that Scene::build will accept `scene`. Errors (INVALID_ARGUMENT) name the invalid shape, material
// or field.
Status validate_scene(const SceneDescription& scene);

// Whether rays can be in a medium of a valid scene.
bool uses_media(const SceneDescription& scene);
bool uses_media(int camera_medium, const std::vector<Material>& materials);

// Whether a valid scene has a light, an environment, or a shape or medium that emits. Otherwise its image is
// black, which is seldom intended.
bool gives_light(const SceneDescription& scene);

}  // namespace tessera::core
