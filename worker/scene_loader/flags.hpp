// SPDX-License-Identifier: Apache-2.0
// What the worker and tessera-scene-loader agree on, besides the files between them
// (core/scene/cache/loaded_scene.hpp).
#pragma once

namespace tessera::worker {

inline constexpr const char* kSceneLoaderName = "tessera-scene-loader";

// Limits of the worker's command line have the same names.
inline constexpr const char* kSceneMemoryFlag = "--scene-mib";
inline constexpr const char* kSceneSecondsFlag = "--scene-seconds";

// The exit status of a loader whose memory does not suffice to write the scene.
inline constexpr int kExitNoMemory = 3;

}  // namespace tessera::worker
