// SPDX-License-Identifier: Apache-2.0
// The paths that are shaded together, a lane each. For the files of PathTracer.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "core/integrators/path.hpp"
#include "core/integrators/path_wavelength.hpp"
#include "core/math/lane_array.hpp"

namespace tessera::core::integrators {

// With fewer than kLaneCount paths, the other lanes repeat the first.
struct PathTracer::Paths {
  Paths(ColumnsView<const PathState> batch, ColumnsView<const Hit> all_hits, const ShadingBins& bins,
        std::span<const std::uint32_t> slots)
      : count(slots.size()),
        continuing((1u << slots.size()) - 1),
        states(batch, rows_of(slots)),
        rays(batch.field(&PathState::ray), rows_of(slots)),
        hits(all_hits, rows_of(slots)),
        path(states.all(&PathState::path)),
        throughput(states.all(&PathState::throughput)),
        eta_scale(states.all(&PathState::eta_scale)),
        guiding_pdf_ratio(states.all(&PathState::guiding_pdf_ratio)) {
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      const std::uint32_t slot = states.row(lane);
      materials[lane] = bins.material(slot);
      emissive_lanes |= (lane < slots.size() && bins.is_emissive(slot) ? 1u : 0u) << lane;
    }
  }

  // The lanes whose materials disperse light.
  unsigned dispersive_lanes() const {
    unsigned lanes = 0;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane)
      lanes |= (disperses(materials[lane]->model) ? 1u : 0u) << lane;
    return lanes;
  }

  // Ends the paths that have reached the maximum depth.
  void limit(std::span<const std::uint16_t> depths, int max_depth) {
    for (std::size_t lane = 0; lane < count; ++lane)
      if (depths[path[lane]] >= max_depth) continuing &= ~(1u << lane);
  }

  std::array<const sampling::Sampler*, kLaneCount> of(std::span<const sampling::Sampler> samplers) const {
    std::array<const sampling::Sampler*, kLaneCount> of_lanes;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) of_lanes[lane] = &samplers[path[lane]];
    return of_lanes;
  }

  static WordLanes rows_of(std::span<const std::uint32_t> slots) {
    // A vector that is written at once can be read before the writes are through.
    if (slots.size() == kLaneCount) return WordLanes(U32xN::load(slots.data()));
    WordLanes rows;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane)
      rows.set(lane, slots[lane < slots.size() ? lane : 0]);
    return rows;
  }

  std::size_t count;
  unsigned continuing;          // bit i for lane i: may have further vertices
  unsigned emissive_lanes = 0;  // bit i for lane i: the hit may be emissive
  RowLanes<PathState> states;
  RayRows rays;
  HitRows hits;
  WordLanes path;
  SurfaceBatch::Materials materials;
  bool plain_triangles = false;  // in all lanes
  RgbOf<FloatN> throughput;
  FloatN eta_scale, guiding_pdf_ratio;
  std::optional<WavelengthOf<FloatN>> light;  // if any of the materials disperses it
  MaskN disperses_light = false;
};

}  // namespace tessera::core::integrators
