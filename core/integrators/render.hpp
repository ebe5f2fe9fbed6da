// SPDX-License-Identifier: Apache-2.0
// The entry point of rendering for the command line, the worker and the benchmarks.
#pragma once

#include "core/film/film.hpp"
#include "core/integrators/render_plan.hpp"

namespace tessera::core::integrators {

// Renders samples `range` of the pixels of `rect` with `threads` OpenMP threads. Sample s of pixel (x, y)
// is a pure function of the scene, the settings (except their spp), and (x, y, s): the film is
// bit-identical however an image is divided into calls, and for any number of threads. `rect` must lie
// within the image, and the plan be current.
FilmTile render(const RenderPlan& plan, PixelRect rect, SampleRange range, int threads);

// Renders one sample and returns its radiance before it reaches the film, to reproduce samples that
// counters report.
Rgb render_sample(const RenderPlan& plan, SampleId id);

}  // namespace tessera::core::integrators
