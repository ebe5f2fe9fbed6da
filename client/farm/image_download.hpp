// SPDX-License-Identifier: Apache-2.0
// Downloads images of jobs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/farm/farm.hpp"
#include "core/film/region.hpp"
#include "core/image/display.hpp"

namespace tessera::client {

// What is fetched of an image, and how PNG files show it.
struct ImageView {
  core::DisplayOverrides display{};
  std::optional<core::PixelRect> region{};  // pixels of the whole image; empty: all that are rendered
  std::uint32_t image = 0;                  // its number in the job
  std::string layer{};                      // the name of the one that is wanted; empty: the beauty, and
                                            // all layers where the format has them
};

// Fetches an image of the job once for each path, in the format of its extension, and writes it atomically.
// PNG files use the job's display settings with the overrides applied. Returns the job when the last image
// was taken. Errors name the path.
core::Result<v1::Job> download_images(Farm& farm, const std::string& job_id,
                                      const std::vector<std::string>& paths, const ImageView& view);

// The same for an image of a job that was DONE. If it is no longer DONE, writes nothing and
// returns the job: a coordinator that crashed with a full disk, or that quarantines a worker, may run it
// again.
core::Result<v1::Job> download_finished_images(Farm& farm, const std::string& job_id,
                                               const std::vector<std::string>& paths,
                                               std::uint32_t image = 0);

}  // namespace tessera::client
