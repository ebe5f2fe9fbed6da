// SPDX-License-Identifier: Apache-2.0
// The one entry point that the command line, the worker and the benchmarks call.
#pragma once

#include "core/film/film.hpp"
#include "core/scene/scene.hpp"
#include "core/scene/settings.hpp"

namespace tessera::core {

// Renders samples `range` of the pixels of `rect` with `threads` OpenMP threads. Sample s of pixel (x, y) is
// a pure function of the scene, the settings (but not their spp), and (x, y, s): the film is the same bit for
// bit however a picture is cut into calls, and for any number of threads. `rect` lies within the picture.
FilmTile render(const Scene& scene, const RenderSettings& settings, PixelRect rect, SampleRange range,
                int threads);

// One sample by itself: its radiance before it reaches the film, for replaying what counters report.
Rgb render_sample(const Scene& scene, const RenderSettings& settings, SampleId id);

}  // namespace tessera::core
