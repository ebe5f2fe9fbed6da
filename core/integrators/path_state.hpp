// SPDX-License-Identifier: Apache-2.0
// What is known of a path before its next ray. Paths that wait are rows of Columns<PathState>, which
// traversal and shading read, and scattering writes, column by column: this is the one list of the fields. A
// further one is a column, and takes time only in renders that write it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/geometry/ray.hpp"
#include "core/integrators/pane_passage.hpp"
#include "core/lights/light_sample_context.hpp"
#include "core/math/rgb.hpp"

namespace tessera::core::integrators {

// The number of paths that advance together: enough for full ray groups, few enough for the caches.
inline constexpr std::size_t kBatchPaths = 512;

// The density of a direction that only one technique can sample.
inline constexpr float kDeltaPdf = std::numeric_limits<float>::infinity();

struct PathState {
  Ray ray;                            // the next one; its time is written only if something moves
  std::uint32_t path = 0;             // the index passed to PathTracer::begin
  Rgb throughput = Rgb::gray(1);      // product of the BSDF weights, which multiplies radiance found
  float eta_scale = 1;                // undoes the compression of radiance by refraction in `throughput`
  float last_pdf = kDeltaPdf;         // of the ray's direction, per solid angle; kDeltaPdf also at the camera
  lights::LightSampleContext last{};  // where the ray was scattered; of a camera ray, where it is in focus
  float emitter_mis_scale = 1;        // scales emission that the ray hits; 0 for guided rays
  float guiding_pdf_ratio = 1;        // product of mixture density / BSDF density, for roulette
  // Written only if light samples pass panes. Where the path has passed panes alone since its last other
  // vertex, these, `last` and emitter_mis_scale are of that vertex.
  Vec3 straight{};         // the direction in which the path left it; zero if there is none
  float straight_pdf = 0;  // of that direction, as last_pdf
  PanePassage panes{};
  float wavelength_nm = 0;  // 0 for all; written only if some material disperses light
};

}  // namespace tessera::core::integrators
