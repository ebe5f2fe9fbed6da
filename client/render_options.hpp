// SPDX-License-Identifier: Apache-2.0
// The options of `tessera render`.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "client/scene_flags.hpp"
#include "core/film/film.hpp"
#include "core/scene/cache/scene_store.hpp"

namespace tessera::client {

struct RenderOptions {
  SceneFlags scene;  // what to render, and where to put it
  int threads = 1;
  std::string stats_path;   // empty: none
  std::string scene_cache;  // a folder; empty: none
  double scene_cache_gib = core::kDefaultSceneCacheGib;
  std::optional<core::SampleId> sample;  // replay this one instead of rendering
  bool quiet = false;                    // no progress and no summary; warnings remain
};

// Adds the options of `render` and its help. Values are stored in `options` while the command line is parsed;
// `options` must live until then.
void add_render_options(CLI::App& command, RenderOptions& options);

}  // namespace tessera::client
