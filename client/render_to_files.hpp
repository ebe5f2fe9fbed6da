// SPDX-License-Identifier: Apache-2.0
// The part of `tessera render` behind the loaded scene: takes the samples, and writes image files, statistics
// and checkpoints.
#pragma once

#include "client/render_options.hpp"
#include "client/render_stats.hpp"
#include "core/image/display.hpp"
#include "core/scene/cache/scene_digest.hpp"
#include "core/scene/scene.hpp"

namespace tessera::client {

struct LoadedScene {
  core::Scene scene;
  core::DisplaySettings display;
  core::SceneDigest digest;
  core::CryptoNames names;  // if a layer needs them
  RenderStats stats;        // so far; it has the settings
};

// The threads that it may start besides those that render.
inline constexpr int kBackgroundThreads = 3;
// With --view.
inline constexpr int kViewThreads = 4;

// Blocks until the render is complete, interrupted or out of time, and its files are written. Returns the
// exit status.
int render_to_files(const RenderOptions& options, LoadedScene& loaded);

}  // namespace tessera::client
