// SPDX-License-Identifier: Apache-2.0
// The lights of a scene, of every kind: what emits, as sources that can be sampled. Immutable, shared by all
// threads. Densities are per solid angle at the point that is lit.
//
// How to add a kind: a type with sample(), power() and bounds() in a file of its own, an alternative of
// Light, and where Scene::build finds it. A kind that rays can meet also has a pdf(), for multiple importance
// sampling.
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

namespace tessera::core {

using Light = std::variant<AreaLight, PointLight, SpotLight, DirectionalLight, Environment>;
static_assert(sizeof(Light) <= 128, "there may be a hundred thousand of them");

// A direction from the point to the light. Nothing where the light cannot be sampled from there, or sends
// nothing along the direction found.
std::optional<LightSample> sample_light(const Light& light, const std::vector<Texture>& textures,
                                        const LightSampleContext& lit, Vec2 u);

// Eight lights, each lane as sample_light() does. Null for none. No two of them are different environments.
LightSamples sample_lights(const std::array<const Light*, 8>& lights, const std::vector<Texture>& textures,
                           const LightSampleContexts& lit, Vec2Of<Float8> u);

// Whether only sampling finds the light: it has no extent that a ray could meet.
bool is_delta(const Light& light);

// Watts, the mean of the channels. Of lights at infinity, what falls on a disk of the scene's radius.
double power(const Light& light, double scene_radius);

// Where the light is and which way it shines. Nothing of lights at infinity.
std::optional<LightBounds> bounds(const Light& light);

}  // namespace tessera::core
