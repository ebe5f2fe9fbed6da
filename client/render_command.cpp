// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "client/commands.hpp"
#include "client/console.hpp"
#include "client/interrupt.hpp"
#include "client/local_render.hpp"
#include "client/picture_files.hpp"
#include "client/render_options.hpp"
#include "client/render_stats.hpp"
#include "core/base/thread_check.hpp"
#include "core/image/file_io.hpp"
#include "core/integrators/render.hpp"
#include "core/scene/loader/loader.hpp"

namespace tessera::client {
namespace {

using core::Result;
using core::Status;

struct LoadedScene {
  core::Scene scene;
  core::DisplaySettings display;
  RenderStats stats;
};

Status check_paths(const RenderOptions& options) {
  if (Status status = check_picture_paths(options.scene.output_paths); !status) return status;
  return options.stats_path.empty() ? Status{} : core::check_can_write(options.stats_path);
}

// An image that does not fit into memory is rejected now instead of being killed later.
Status check_memory(const core::RenderSettings& settings) {
  constexpr double kBytesPerPixel = 2 * 3 * 8 + 3 * 4;  // the film's two sums and the developed image
  const core::PixelRect window = settings.window();
  const double needed = kBytesPerPixel * static_cast<double>(window.pixel_count());
  const double present =
      static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
  if (needed <= present) return {};
  return core::fail(
      core::ErrorCode::kResourceExhausted,
      fmt::format("an image of {}x{} pixels needs {:.0f} GiB of memory, and this machine has {:.0f}: "
                  "choose a smaller --size, or parts of it with --crop",
                  window.width(), window.height(), needed / (1 << 30), present / (1 << 30)));
}

Result<std::optional<core::SceneStore>> open_scene_store(const RenderOptions& options) {
  if (options.scene_cache.empty()) return std::nullopt;
  const auto bytes = static_cast<std::uint64_t>(options.scene_cache_gib * (1 << 30));
  auto store = core::SceneStore::open(options.scene_cache, bytes, print_warning);
  if (!store) return core::fail(store.error().within("--scene-cache"));
  return std::move(*store);
}

Result<core::PreparedScene> prepare(const std::optional<core::SceneStore>& store,
                                    const RenderOptions& options) {
  if (store) return store->prepare_file(options.scene.scene_path, options.threads);
  Result<core::SceneDescription> description = core::load_scene_file(options.scene.scene_path);
  if (!description) return core::fail(description.error());
  return core::PreparedScene{std::move(*description)};
}

Result<LoadedScene> load(const RenderOptions& options) {
  const double start = steady_seconds();
  const auto store = open_scene_store(options);
  if (!store) return core::fail(store.error());
  Result<core::PreparedScene> prepared = prepare(*store, options);
  if (!prepared) return core::fail(prepared.error());
  const core::SceneDescription& description = prepared->description;
  print_warnings(description.warnings);
  const auto settings = core::resolve_settings(description.settings, options.scene.overrides);
  if (!settings) return core::fail(settings.error().within(options.scene.scene_path));
  const auto display = core::resolve_display(description.display, options.scene.display);
  if (!display) return core::fail(display.error().within(options.scene.scene_path));
  if (Status status = check_memory(*settings); !status) return core::fail(status.error());
  Status fits = check_picture_size(options.scene.output_paths, *settings);
  if (!fits) return core::fail(fits.error());
  const double loaded = steady_seconds();
  if (Status threads = core::check_threads(options.threads); !threads)
    return core::fail(threads.error().within("--threads"));
  Result<core::Scene> scene = core::build_scene(std::move(*prepared), options.threads);
  if (!scene) return core::fail(scene.error().within(options.scene.scene_path));
  RenderStats stats;
  stats.settings = *settings;
  stats.threads = options.threads;
  stats.load_seconds = loaded - start;
  stats.build_seconds = steady_seconds() - loaded;
  return LoadedScene{std::move(*scene), *display, stats};
}

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

void warn_about_blackness(const core::Image& image) {
  if (std::all_of(image.pixels.begin(), image.pixels.end(),
                  [](core::Rgb color) { return core::is_black(color); })) {
    print_warning(
        "the image is black: no light reaches the camera; is it inside something, or does it look away?");
  }
}

Status write_results(const RenderOptions& options, const LoadedScene& loaded, const core::Image& image) {
  if (Status status = write_pictures(options.scene.output_paths, image, loaded.display); !status)
    return status;
  if (options.stats_path.empty()) return {};
  return core::write_file_atomically(options.stats_path, to_json(loaded.stats, peak_memory_bytes()));
}

void print_summary(const RenderOptions& options, const RenderStats& stats) {
  const double speed = static_cast<double>(stats.counters.samples) / std::max(stats.render_seconds, 1e-9);
  const core::PixelRect window = stats.settings.window();
  print_note(fmt::format("wrote {} ({}x{} pixels, {} spp) in {:.2f} s, {} samples/s",
                         fmt::join(options.scene.output_paths, ", "), window.width(), window.height(),
                         stats.settings.spp, stats.render_seconds, format_count(speed)));
}

int render_picture(const RenderOptions& options, LoadedScene& loaded) {
  RenderStats& stats = loaded.stats;
  if (Status threads = core::check_threads(options.threads); !threads)
    return print_error(threads.error().within("--threads"));
  ProgressLine progress(options.quiet ? no_progress_output() : stderr_progress_output(), steady_seconds());
  watch_for_interrupt();
  const LocalRender rendered =
      render_locally(loaded.scene, stats.settings, options.threads, progress, interrupted);
  progress.erase();
  if (!rendered.complete || interrupted()) {
    print_error("interrupted; no image was written");
    return kExitInterrupted;
  }
  stats.counters = rendered.counters;
  stats.render_seconds = rendered.seconds;
  stats.render_core_seconds = rendered.core_seconds;
  warn_about_samples(options.scene.scene_path, stats);
  warn_about_saturation(options.scene.scene_path, rendered.film);
  const core::Image image = rendered.film.develop();
  // For a scene without lights, a warning has been printed before.
  if (!loaded.scene.lights().empty()) warn_about_blackness(image);
  if (Status status = write_results(options, loaded, image); !status) return print_error(status.error());
  if (!options.quiet) print_summary(options, stats);
  return kExitOk;
}

int print_sample(const core::Scene& scene, const core::RenderSettings& settings, core::SampleId id) {
  if (id.x >= settings.width_px || id.y >= settings.height_px) {
    print_error(fmt::format("--sample: pixel ({}, {}) is outside the image of {}x{} pixels", id.x, id.y,
                            settings.width_px, settings.height_px));
    return kExitUsage;
  }
  const core::Rgb radiance = core::render_sample(scene, settings, id);
  print_result(fmt::format("pixel ({}, {}) sample {}: radiance {:.9g} {:.9g} {:.9g}\n", id.x, id.y, id.sample,
                           radiance.r, radiance.g, radiance.b));
  return kExitOk;
}

int run_render(const RenderOptions& options) {
  if (Status status = check_paths(options); !status) return print_error(status.error());
  warn_about_idle_display(options.scene.output_paths, options.scene.display);
  Result<LoadedScene> loaded = load(options);
  if (!loaded) return print_error(loaded.error());
  if (loaded->scene.lights().empty()) warn_about_darkness(options.scene.scene_path);
  if (options.sample) return print_sample(loaded->scene, loaded->stats.settings, *options.sample);
  return render_picture(options, *loaded);
}

}  // namespace

void add_render_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("render", "Render a scene on this machine");
  const auto options = std::make_shared<RenderOptions>();
  add_render_options(*command, *options);
  command->callback([options, &exit_code] {
    if (options->scene.output_paths.empty() && !options->sample) throw CLI::RequiredError("-o FILE");
    exit_code = run_render(*options);
  });
}

}  // namespace tessera::client
