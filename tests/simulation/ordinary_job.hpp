// SPDX-License-Identifier: Apache-2.0
// The job of the scenarios, and the time that it may take.
#pragma once

#include "server/scheduler/types.hpp"

namespace tessera::simulation {

// 256x256 pixels with 32 spp: 2.1 million samples.
inline const scheduler::JobShape kJob{256, 256, 32};
inline constexpr double kJobSamples = 256.0 * 256 * 32;
// Renders take up to 1.3 times the nominal time, and messages take some.
inline constexpr double kSlack = 1.3;

}  // namespace tessera::simulation
