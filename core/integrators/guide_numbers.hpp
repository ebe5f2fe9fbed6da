// SPDX-License-Identifier: Apache-2.0
// What the guides' builders share: their random numbers come from sampler positions that nothing else uses.
#pragma once

#include <cstdint>

namespace tessera::core::integrators {

// Of the samplers of all guides, whose x is 0.
inline constexpr std::uint64_t kGuideSeed = 0;
// Their y.
inline constexpr int kPhotonRow = 0, kOtherLightRow = 1, kCameraPathRow = 2, kLookRow = 3, kCellRow = 4;

// Guides are built for the middle of the time that the shutter is open. They choose among directions whose
// light is estimated without bias at any time.
inline constexpr float kGuideTime = 0.5f;

}  // namespace tessera::core::integrators
