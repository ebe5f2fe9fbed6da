// SPDX-License-Identifier: Apache-2.0
// The lights of a scene, of all types, as sources that can be sampled. Immutable, shared by all threads.
// Densities are per solid angle at the reference point.
//
// To add a type: write a class with sample(), power() and bounds() in its own file, add it to the
// alternatives of Light, and create it in Scene::build. A type that rays can hit also needs pdf(), for
// multiple importance sampling.
#pragma once

#include <array>
#include <optional>
#include <variant>
#include <vector>

#include "core/lights/area_light.hpp"
#include "core/lights/delta_lights.hpp"
#include "core/lights/environment.hpp"
#include "core/lights/light_bounds.hpp"
#include "core/lights/light_sample_context.hpp"
#include "core/lights/moving_area_light.hpp"

namespace tessera::core::lights {

using Light = std::variant<AreaLight, MovingAreaLight, PointLight, SpotLight, DirectionalLight, Environment>;
static_assert(sizeof(Light) <= 128, "there may be a hundred thousand of them");

// Samples a direction from the point to the light, at a time from 0, when the shutter opens, to 1, when it
// closes. Returns nothing if the light cannot be sampled from
// there, or emits nothing along the sampled direction.
std::optional<LightSample> sample_light(const Light& light, const std::vector<Texture>& textures,
                                        const LightSampleContext& lit, Vec2 u,
                                        MisCompensation compensation = MisCompensation::kOff, float time = 0);

// Samples a light in each lane; each lane equals sample_light(). Null pointers are allowed. All environments
// among them must be the same.
LightSamples sample_lights(const std::array<const Light*, 8>& lights, const std::vector<Texture>& textures,
                           const LightSampleContexts& lit, Vec2Of<FloatN> u,
                           MisCompensation compensation = MisCompensation::kOff, FloatN time = 0.0f);

// Whether only light sampling finds the light, because it has no extent that a ray could hit.
bool is_delta(const Light& light);

// Watts, averaged over the channels. For lights at infinity, the power that reaches a disk of the scene's
// radius.
double power(const Light& light, double scene_radius);

// Spatial and directional bounds of the light; nothing for lights at infinity.
std::optional<LightBounds> bounds(const Light& light);

}  // namespace tessera::core::lights
