// SPDX-License-Identifier: Apache-2.0
// The wavelengths by which vertices of paths may disperse light (core/materials/dispersion.hpp). Stateless;
// thread-safe.
#pragma once

#include <optional>

#include "core/materials/dispersion.hpp"
#include "core/math/lane_array.hpp"
#include "core/sampling/sampler.hpp"
#include "core/scene/scene.hpp"
#include "core/spectra/wavelength_sampling.hpp"

namespace tessera::core::integrators {

// That of the path, or, if it has none (0), the one for u in [0, 1).
inline Wavelength wavelength_at(float path_nm, float u) {
  if (path_nm > 0) return {path_nm, false, Rgb::gray(1)};
  const spectra::WavelengthSample chosen = spectra::sample_wavelength(u);
  return {chosen.nm, true, chosen.weight};
}
// The same in each lane.
inline WavelengthOf<FloatN> wavelengths_at(FloatN path_nm, FloatN u) {
  const FloatLanes of_paths(path_nm), numbers(u);
  FloatLanes nm;
  RgbLanes weight;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const Wavelength of_lane = wavelength_at(of_paths[lane], numbers[lane]);
    nm.set(lane, of_lane.nm);
    weight.set(lane, of_lane.weight);
  }
  return {nm.all(), !(path_nm > 0), weight.all()};
}

// For a vertex whose number is the first of the pad; nothing if no material of the scene disperses light.
inline std::optional<Wavelength> wavelength_in(const Scene& scene, float path_nm,
                                               const sampling::Sampler& sampler, std::uint32_t pad) {
  if (!scene.has_dispersion()) return std::nullopt;
  return wavelength_at(path_nm, sampler.pad(pad)[0]);
}

}  // namespace tessera::core::integrators
