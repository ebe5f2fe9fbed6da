// SPDX-License-Identifier: Apache-2.0
// What painters of textures share. Stateless; thread-safe.
#pragma once

#include <functional>

#include "core/image/image.hpp"
#include "scenes/modelling/curve.hpp"
#include "scenes/modelling/files.hpp"

namespace tessera::modelling {

// 0 below `begin`, 1 above `end`, smooth between.
float smooth_step(float begin, float end, float x);

core::Rgb blend(core::Rgb a, core::Rgb b, float t);

// Round specks, 1 where they are and 0 elsewhere; p in centimetres, `per_cm` of them to a centimetre.
float specks(core::Vec3 p, float per_cm);

// The texture of a turned thing from the colour of each point of its surface.
core::Image paint_on(const Profile& profile, int width, int height,
                     const std::function<core::Rgb(core::Vec3 p, float u, float v)>& color);

}  // namespace tessera::modelling
