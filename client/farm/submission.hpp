// SPDX-License-Identifier: Apache-2.0
// Submits a bundled scene to a farm. Blocks, and retries while the coordinator restarts or asks to wait.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/farm/bundle.hpp"
#include "client/farm/farm.hpp"
#include "client/farm/label_option.hpp"
#include "client/farm/service_options.hpp"
#include "core/image/display.hpp"
#include "core/scene/settings.hpp"

namespace tessera::client {

struct Submission {
  core::RenderOverrides overrides{};
  core::DisplayOverrides display{};
  std::string name{};  // empty: the scene's
  ServiceOptions service{};
  Labels labels{};
  std::vector<std::int32_t> frames{};  // an image for each, in this order; empty: one of frame 0
};

// Uploads what the farm lacks, submits the job, and returns it when its scene is validated. Prints the
// warnings about the scene that are not among the bundle's. INVALID_ARGUMENT: the farm rejects the scene.
core::Result<v1::Job> submit_job(Farm& farm, const Submission& submission, const LocalBundle& local);

// FAILED_PRECONDITION: the coordinator does not know what a job with these settings needs.
core::Status check_features(Farm& farm, const core::RenderSettings& settings);

// Why no connected worker can render a job with these settings, and what to do. Empty if one can, or if that
// is not known.
std::string lack_of_workers(Farm& farm, const core::RenderSettings& settings);

}  // namespace tessera::client
