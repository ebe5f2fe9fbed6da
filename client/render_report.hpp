// SPDX-License-Identifier: Apache-2.0
// What a local render says on stderr when it has ended: warnings about its samples, and a summary.
#pragma once

#include <string>
#include <vector>

#include "client/render_stats.hpp"
#include "core/film/film.hpp"
#include "core/image/image.hpp"

namespace tessera::client {

// Warns of samples that are not finite numbers, with the command that replays one, and of those too bright.
void warn_about_samples(const std::string& scene_path, const RenderStats& stats);
// Warns of pixels that have gathered more light than the film holds.
void warn_about_saturation(const std::string& scene_path, const core::Film& film);
// Warns of an image without light.
void warn_about_blackness(const core::Film& film);

// "58.3% (37 of 64 samples per pixel)", and how many tiles are still black.
std::string progress_text(const core::Film& film, const RenderStats& stats);

// Which files were written, and how fast it went.
void print_summary(const std::vector<std::string>& paths, const RenderStats& stats);

}  // namespace tessera::client
