// SPDX-License-Identifier: Apache-2.0
// What nodes place besides meshes: cameras and lights. Stateless; functions throw Refusals.
#pragma once

#include <optional>

#include "core/camera/camera_description.hpp"
#include "core/math/transform.hpp"
#include "core/scene/description.hpp"
#include "core/scene/gltf/document.hpp"

namespace tessera::core::gltf {

struct PlacedCamera {
  CameraDescription description;
  float aspect_ratio = 0;  // width divided by height; 0: not given
};

// A camera of the file; it looks along -z of its node.
PlacedCamera read_camera(const Value& camera, const Transform& to_world);

// A light of KHR_lights_punctual; nullopt for one of an unknown type, after a warning. Photometric units are
// taken as radiometric ones: a candela becomes a watt per steradian.
std::optional<LightDescription> read_light(const Value& light, const Transform& to_world,
                                           const Document& document);

}  // namespace tessera::core::gltf
