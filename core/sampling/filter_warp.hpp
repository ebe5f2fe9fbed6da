// SPDX-License-Identifier: Apache-2.0
// Warps of a number in [0, 1) to a position along one axis of a pixel filter. All are increasing, which
// preserves stratification, and symmetric around 0. Stateless; thread-safe.
#pragma once

namespace tessera::core::sampling {

// Uniform between -radius and radius.
float sample_box(float u, float radius);

// Density (1 - |x| / radius) / radius.
float sample_tent(float u, float radius);

// The normal distribution with standard deviation radius / 3, truncated at `radius`. Its cumulative
// distribution is inverted to within 1e-6 of the radius.
float sample_truncated_normal(float u, float radius);

}  // namespace tessera::core::sampling
