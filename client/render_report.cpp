// SPDX-License-Identifier: Apache-2.0
#include "client/render_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "client/console.hpp"
#include "client/progress.hpp"
#include "client/shared_film.hpp"

namespace tessera::client {
namespace {

// The command that reproduces a sample of this render.
std::string replay_command(const std::string& scene_path, const core::RenderSettings& settings,
                           core::SampleId id) {
  return fmt::format(
      "tessera render '{}' --size {}x{} --integrator {} --heuristic {} --clamp-indirect {} --seed {} "
      "--sample {},{},{}",
      scene_path, settings.width_px, settings.height_px, core::integrator_name(settings.integrator),
      core::heuristic_name(settings.heuristic), settings.clamp_indirect, settings.seed, id.x, id.y,
      id.sample);
}

}  // namespace

void warn_about_samples(const std::string& scene_path, const RenderStats& stats) {
  const core::RenderCounters& counters = stats.counters;
  if (counters.non_finite_samples > 0) {
    std::string message =
        fmt::format("{} samples were not finite numbers and count as black; please report it",
                    counters.non_finite_samples);
    if (counters.first_non_finite) {
      message += fmt::format(". To replay the first: {}",
                             replay_command(scene_path, stats.settings, *counters.first_non_finite));
    }
    print_warning(message);
  }
  if (counters.saturated_samples > 0) {
    print_warning(
        fmt::format("{} samples were too bright for the film and were cut off: scale the lights of '{}' down",
                    counters.saturated_samples, scene_path));
  }
}

void warn_about_saturation(const std::string& scene_path, const core::Film& film) {
  if (const std::uint64_t pixels = film.saturated_pixels(); pixels > 0) {
    print_warning(
        fmt::format("{} pixels have gathered more light than the film holds and come out too dark: scale the "
                    "lights of '{}' down",
                    pixels, scene_path));
  }
}

void warn_about_blackness(const core::Film& film) {
  for (int tile = 0; tile < film.grid().tile_count(); ++tile) {
    const std::vector<std::uint64_t> sums = film.tile(tile).sums;
    if (std::any_of(sums.begin(), sums.end(), [](std::uint64_t sum) { return sum > 0; })) return;
  }
  print_warning(
      "the image is black: no light above 1e-8 reaches the camera; is it inside something, or does it look "
      "away?");
}

std::string progress_text(const core::Film& film, const RenderStats& stats) {
  const std::vector<std::uint32_t> samples = samples_of_tiles(film);
  const auto [least, most] = std::minmax_element(samples.begin(), samples.end());
  const double total =
      static_cast<double>(film.grid().window().pixel_count()) * static_cast<double>(stats.settings.spp);
  const double percent = 100 * static_cast<double>(stats.counters.samples) / total;
  const std::string range =
      *least == *most ? fmt::format("{}", *least) : fmt::format("{} to {}", *least, *most);
  std::string text = fmt::format("{:.1f}% ({} of {} samples per pixel)", percent, range, stats.settings.spp);
  if (*least == 0)
    text += fmt::format("; {} of {} tiles have none yet and are black",
                        std::count(samples.begin(), samples.end(), 0u), samples.size());
  return text;
}

void print_summary(const std::vector<std::string>& paths, const RenderStats& stats) {
  const double speed = static_cast<double>(stats.counters.samples) / std::max(stats.render_seconds, 1e-9);
  const core::PixelRect window = stats.settings.window();
  print_note(fmt::format("wrote {} ({}x{} pixels, {} spp) in {:.2f} s, {} samples/s", fmt::join(paths, ", "),
                         window.width(), window.height(), stats.settings.spp, stats.render_seconds,
                         format_count(speed)));
}

}  // namespace tessera::client
