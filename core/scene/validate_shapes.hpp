// SPDX-License-Identifier: Apache-2.0
// Parts of validate_scene() (validation.hpp), with its errors: points and shapes. Stateless; thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "core/base/error.hpp"
#include "core/scene/description.hpp"

namespace tessera::core {

// Whether the coordinates are finite and small enough to be computed with.
bool is_valid_point(Vec3 point);

// Whether the material, one of the scene's, emits at any frame.
bool can_emit(std::uint32_t material, const SceneDescription& scene);

// Checks a shape of the scene or of an object, whose materials must be valid; of an instance, whether its
// transform can be inverted.
Status validate_shape(const ShapeDescription& shape, const SceneDescription& scene);

// Calls refuse(i, error) for each of the scene's shapes that is an instance and cannot be where it is. All
// other shapes must be valid.
void check_instances(const SceneDescription& scene,
                     const std::function<void(std::size_t, const Error&)>& refuse);

// Checks all objects and shapes, whose materials must be valid.
Status check_all_shapes(const SceneDescription& scene);

}  // namespace tessera::core
