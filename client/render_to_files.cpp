// SPDX-License-Identifier: Apache-2.0
#include "client/render_to_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/background_task.hpp"
#include "client/checkpoint_keeper.hpp"
#include "client/console.hpp"
#include "client/image_files.hpp"
#include "client/interrupt.hpp"
#include "client/local_render.hpp"
#include "client/notices.hpp"
#include "client/page/local_view.hpp"
#include "client/page/progress_lines.hpp"
#include "client/render_report.hpp"
#include "client/scene_flags.hpp"
#include "client/tev_observer.hpp"
#include "core/base/determinism_fingerprint.hpp"
#include "core/base/version.hpp"
#include "core/film/cryptomatte.hpp"
#include "core/image/file_io.hpp"
#include "core/scene/render_record.hpp"

namespace tessera::client {
namespace {

using core::Result;
using core::Status;

// An empty film, or that of the checkpoint.
Result<std::unique_ptr<SharedFilm>> first_film(const RenderOptions& options, const RenderIdentity& render) {
  auto empty = std::make_unique<SharedFilm>(core::TileGrid(render.settings.window(), core::kTilePx),
                                            render.settings.layers);
  if (!options.resume) return empty;
  const bool is_named = !options.resume->empty();
  auto checkpoint = read_checkpoint(is_named ? *options.resume : checkpoint_path_of(options), render);
  if (checkpoint) return std::make_unique<SharedFilm>(std::move(checkpoint->film), checkpoint->header.totals);
  if (is_named || checkpoint.error().code != core::ErrorCode::kNotFound)
    return core::fail(checkpoint.error().within("--resume"));
  // Of several frames, one alone was interrupted.
  if (options.frames_left.empty()) print_warning(checkpoint.error().message + ": rendering from the start");
  return empty;
}

CheckpointPlan plan_of(const RenderOptions& options) {
  const std::string path = checkpoint_path_of(options);
  const bool continues = options.resume && (options.resume->empty() || *options.resume == path);
  return {path, options.checkpoint_seconds, !options.checkpoint_path.empty(), continues};
}

// Whether every pixel has all of its samples.
bool has_all_samples(const SharedFilm& film, std::uint32_t spp) {
  const std::vector<std::uint32_t> samples = film.samples();
  return std::all_of(samples.begin(), samples.end(), [&](std::uint32_t of_tile) { return of_tile == spp; });
}

// An image that is rendered again says what it said before: compatible versions give the same bytes.
core::RenderRecord record_of(const RenderOptions& options, const LoadedScene& loaded) {
  return {.version = options.record ? options.record->version : std::string(core::version()),
          .fingerprint = std::string(core::kDeterminismFingerprint),
          .scene = core::digest_text(loaded.digest),
          .settings = loaded.stats.settings,
          .frame = loaded.scene.frame()};
}

core::TextAttributes attributes_of_image(const RenderOptions& options, const LoadedScene& loaded,
                                         const SharedFilm& film) {
  core::RenderRecord record = record_of(options, loaded);
  record.complete = has_all_samples(film, record.settings.spp);
  core::TextAttributes attributes = core::attributes_of(record);
  for (auto& attribute : core::crypto_attributes(record.settings.layers, loaded.names))
    attributes.push_back(std::move(attribute));
  return attributes;
}

// Writes the image files of what there is.
Status write_images(const RenderOptions& options, const LoadedScene& loaded, const SharedFilm& film) {
  const core::RenderSettings& settings = loaded.stats.settings;
  if (settings.layers.empty())
    return write_image_files(options.scene.output_paths, film.develop(), settings, loaded.display,
                             attributes_of_image(options, loaded, film));
  const LayerImage image{settings, [&](int tile) -> Result<core::Film::TileSums> { return film.tile(tile); },
                         attributes_of_image(options, loaded, film)};
  return write_layers(options.scene.output_paths, image, loaded.display);
}

// Writes the image files every so often, where that is wanted.
std::unique_ptr<BackgroundTask> image_updates(const RenderOptions& options, const LoadedScene& loaded,
                                              const SharedFilm& film, Notices& notices) {
  if (!options.update_seconds) return nullptr;
  const auto update = [&options, &loaded, &film, seen = film.totals().counters.samples]() mutable -> Status {
    const std::uint64_t samples = film.totals().counters.samples;
    if (samples == std::exchange(seen, samples)) return {};
    return write_images(options, loaded, film);
  };
  return std::make_unique<BackgroundTask>(
      *options.update_seconds, update,
      [&notices](const std::string& message) { notices.add("--update-every: " + message); });
}

// Without the progress and the summary for people.
bool is_silent(const RenderOptions& options) {
  return options.quiet || options.json;
}

void print_notices(Notices& notices, ProgressLine& progress) {
  for (const std::string& notice : notices.take()) {
    progress.erase();
    print_warning(notice);
  }
}

// Null without --view.
Result<std::unique_ptr<LocalView>> start_view(const RenderOptions& options, const LoadedScene& loaded) {
  if (!options.view) return nullptr;
  ImageHeader header{record_of(options, loaded),
                     core::crypto_attributes(loaded.stats.settings.layers, loaded.names)};
  auto view = LocalView::start(*options.view, scene_name(options.scene.scene_path), std::move(header),
                               loaded.display);
  if (!view) return core::fail(view.error());
  if ((*view)->is_public()) print_warning("--view: everybody who reaches this address can see the image");
  print_note("the page is at " + (*view)->url());
  open_in_browser((*view)->url());
  return view;
}

// Shows the image until Ctrl-C. Returns the exit status.
int stay(LocalView& view, const SharedFilm& film) {
  view.show(film.film());
  print_note(fmt::format("the page stays at {} until Ctrl-C", view.url()));
  view.stay(interrupted);
  return kExitOk;
}

// Renders with everything around it that runs meanwhile. Returns whether the film is complete.
bool take_samples(const RenderOptions& options, const LoadedScene& loaded, SharedFilm& film,
                  std::vector<RenderObserver*> observers, Notices& notices) {
  const double start = steady_seconds();
  ProgressLine progress(is_silent(options) ? no_progress_output() : stderr_progress_output(), start);
  std::optional<TevObserver> tev;
  LocalRender render{loaded.scene, loaded.stats.settings, options.threads, std::move(observers)};
  if (options.tev) {
    const auto& outputs = options.scene.output_paths;
    tev.emplace(*options.tev, outputs.front(), notices);
    render.observers.push_back(&*tev);
  }
  const auto updates = image_updates(options, loaded, film, notices);
  const bool complete = render_locally(render, film, progress, [&] {
    print_notices(notices, progress);
    return interrupted() || (options.time_seconds && steady_seconds() - start >= *options.time_seconds);
  });
  progress.erase();
  return complete;
}

Status write_results(const RenderOptions& options, const LoadedScene& loaded, const SharedFilm& film) {
  if (Status status = write_images(options, loaded, film); !status) return status;
  if (options.stats_path.empty()) return {};
  return core::write_file_atomically(options.stats_path, to_json(loaded.stats, peak_memory_bytes()));
}

// Prints the progress of a render that was stopped.
void report_stop(const RenderOptions& options, const std::string& progress, bool has_checkpoint) {
  const std::string what = fmt::format(
      "{} at {}; wrote {}{}", interrupted() ? "interrupted" : "stopped by --time", progress,
      fmt::join(options.scene.output_paths, ", "),
      has_checkpoint
          ? fmt::format(
                " and {}. To go on, give the same command with {}--resume", checkpoint_path_of(options),
                options.frames_left.empty() ? ""
                                            : fmt::format("--frames {} ", frames_text(options.frames_left)))
          : "");
  if (interrupted()) return print_warning(what);
  if (!is_silent(options)) print_note(what);
}

// Brings the checkpoint to its final state. Failures are warned of: the image is not affected.
bool keep(CheckpointKeeper& keeper, bool complete) {
  const Status kept = keeper.finish(complete);
  if (!kept) print_warning(kept.error().message);
  return kept.has_value();
}

int stop_before_first_sample() {
  print_error("stopped before the first sample; no image was written");
  return interrupted() ? kExitInterrupted : kExitOk;
}

}  // namespace

int render_to_files(const RenderOptions& options, LoadedScene& loaded) {
  RenderStats& stats = loaded.stats;
  const std::string& scene_path = options.scene.scene_path;
  const RenderIdentity render = identity_of(stats.settings, loaded.digest);
  const auto film = first_film(options, render);
  if (!film) return print_error(film.error());
  Notices notices;
  CheckpointKeeper keeper(plan_of(options), render, **film, notices);
  const auto view = start_view(options, loaded);
  if (!view) return print_error(view.error());
  std::optional<ProgressLines> lines;
  if (options.json) lines.emplace(scene_name(scene_path), stats.settings, loaded.display);
  std::vector<RenderObserver*> observers;
  if (lines) observers.push_back(&*lines);
  if (*view) observers.push_back(view->get());
  watch_for_interrupt();
  stats.is_complete = take_samples(options, loaded, **film, std::move(observers), notices);
  const RenderTotals totals = (*film)->totals();
  stats.counters = totals.counters;
  stats.render_seconds = totals.seconds;
  stats.render_core_seconds = totals.core_seconds;
  // Of an unfinished render, the film is worth most.
  const bool is_saved = stats.is_complete || keep(keeper, false);
  print_warnings(notices.take());
  if (stats.counters.samples == 0) return stop_before_first_sample();
  warn_about_samples(scene_path, stats);
  warn_about_saturation(scene_path, (*film)->film());
  // For a scene without lights, a warning has been printed before.
  if (!loaded.scene.lights().empty()) warn_about_blackness((*film)->film());
  if (Status status = write_results(options, loaded, **film); !status) return print_error(status.error());
  if (lines) lines->finish(options.scene.output_paths);
  if (stats.is_complete) {
    keep(keeper, true);
    if (!is_silent(options)) print_summary(options.scene.output_paths, stats);
  } else {
    report_stop(options, progress_text((*film)->film(), stats), is_saved);
    if (interrupted()) return kExitInterrupted;
  }
  return *view ? stay(**view, **film) : kExitOk;
}

}  // namespace tessera::client
