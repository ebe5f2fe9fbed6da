// SPDX-License-Identifier: Apache-2.0
// The options of `tessera render`.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/frames.hpp"
#include "client/scene_flags.hpp"
#include "core/film/film.hpp"
#include "core/scene/cache/scene_store.hpp"
#include "core/scene/render_record.hpp"

namespace tessera::client {

struct RenderOptions {
  SceneFlags scene;  // what to render, and where to put it
  FrameFlags frames;
  std::vector<std::int32_t> frames_left{};  // of several: the one that is rendered, and those after it
  int threads = 1;
  std::string stats_path;   // empty: none
  std::string scene_cache;  // a folder; empty: none
  double scene_cache_gib = core::kDefaultSceneCacheGib;
  std::optional<double> time_seconds;    // the render stops after so long
  std::string checkpoint_path;           // empty: beside the first output
  double checkpoint_seconds = 45;        // between two checkpoints
  std::optional<std::string> resume;     // continue this checkpoint; empty: that at checkpoint_path
  std::optional<double> update_seconds;  // between two updates of the outputs; absent: none before the end
  std::optional<std::string> tev;        // HOST:PORT of a viewer
  std::optional<std::string> view;       // HOST:PORT where the page is served
  std::optional<core::SampleId> sample;  // replay this one instead of rendering
  std::optional<core::RenderRecord> record{};  // render as this says; the scene must be the same
  bool quiet = false;                          // no progress and no summary; warnings remain
  bool json = false;                           // the progress as JSON on stdout, and no summary
};

// Adds the options of `render` and its help. Values are stored in `options` while the command line is parsed;
// `options` must live until then.
void add_render_options(CLI::App& command, RenderOptions& options);

// Adds --threads.
void add_thread_option(CLI::App& command, int& threads);

// Adds --json of commands that render here.
void add_progress_json_option(CLI::App& command, bool& json);

// Renders as the options say. The exit status.
int run_render(const RenderOptions& options);

// Where checkpoints are written.
std::string checkpoint_path_of(const RenderOptions& options);

// Sorts out what the command line leaves open, after it is parsed: a scene that was taken for the value of
// --resume or --tev. Throws an exception of CLI11 if an argument is missing.
void complete_render_options(RenderOptions& options);

}  // namespace tessera::client
