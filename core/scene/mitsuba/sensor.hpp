// SPDX-License-Identifier: Apache-2.0
// Converts Mitsuba's sensors, films, samplers and integrators. Not thread-safe.
#pragma once

#include "core/scene/mitsuba/plugin.hpp"

namespace tessera::core::mitsuba {

// Sets the camera and the settings of its film and sampler.
void set_sensor(Conversion& conversion, const Plugin& sensor);

// The ratio of an image's half width to its distance, by 'fov' or 'focal_length'. `aspect` is width over
// height.
float half_width_of(const Plugin& plugin, float aspect);

// Sets the path length, and whether emitters are hidden from the camera.
void set_integrator(Conversion& conversion, const Plugin& integrator);

}  // namespace tessera::core::mitsuba
