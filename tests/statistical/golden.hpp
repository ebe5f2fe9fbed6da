// SPDX-License-Identifier: Apache-2.0
// Golden images: small references of every shipped scene, each with the variance of a render, so that a
// change of what a scene looks like is told apart from a change of its noise.
//
// They lie in tests/golden; `tessera_make_golden NAME...` makes them anew, after a change that is meant.
#pragma once

#include <string>

#include "core/image/image.hpp"
#include "core/scene/scene.hpp"

namespace tessera::test {

inline constexpr int kGoldenWidthPx = 48, kGoldenHeightPx = 32;
inline constexpr std::uint32_t kGoldenSpp = 64;  // of one batch

// Mean and variance of the radiance of a batch: a render of the scene at the size and spp above.
struct Golden {
  core::Image mean, variance;  // of `batches` batches
  int batches = 0;
};

// Renders `batches` batches with the integrator that the scene asks for, seeds `first_seed` and on.
Golden render_golden(const core::Scene& scene, std::uint64_t first_seed, int batches);

// How many batches a reference is made of.
inline constexpr int kReferenceBatches = 48;

// tests/golden/NAME.exr and NAME_variance.exr.
std::string golden_mean_path(const std::string& name);
std::string golden_variance_path(const std::string& name);

}  // namespace tessera::test
