// SPDX-License-Identifier: Apache-2.0
// Loading scenes as a worker does by default: by tessera-scene-loader beside the test's program.
#pragma once

#include "worker/confined_loader.hpp"
#include "worker/scene_cache.hpp"

namespace tessera::worker {

inline LoadScene confined(LoaderOptions options = {}) {
  return [options](const SceneFiles& files, int threads, const std::stop_token& stop) {
    return load_confined(options, files, threads, stop);
  };
}

}  // namespace tessera::worker
