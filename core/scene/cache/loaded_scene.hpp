// SPDX-License-Identifier: Apache-2.0
// Passes a scene from a process that loads it to one that builds it, through files that both have open. The
// loading process reads files of strangers and may have been taken over by one: nothing that it writes is
// trusted. Both processes are of one build.
#pragma once

#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/open_file.hpp"
#include "core/scene/description.hpp"

namespace tessera::core {

// The files of a bundle by their names, and which of them is the scene.
struct LoadRequest {
  std::string scene_path;
  std::vector<std::string> names;
};

// For the building process: writes the request to an empty file.
Status write_load_request(OpenFile file, const LoadRequest& request);
// For the loading process. FAILED_PRECONDITION if the file is of another build.
Result<LoadRequest> read_load_request(OpenFile file);

// For the loading process: writes the scene, or why there is none, to an empty file.
Status write_loaded(OpenFile file, const Result<SceneDescription>& loaded);
// For the building process: what write_loaded() was given. Whatever the file contains, the result is a
// description that Scene::build takes or refuses, or an error with a printable message of at most 16 KiB.
// INTERNAL for a damaged file; FAILED_PRECONDITION for one of another build. Throws std::bad_alloc.
Result<SceneDescription> read_loaded(OpenFile file, int threads);

}  // namespace tessera::core
