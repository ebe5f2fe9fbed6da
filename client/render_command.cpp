// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "client/commands.hpp"
#include "client/console.hpp"
#include "client/image_files.hpp"
#include "client/render_checkpoint.hpp"
#include "client/render_options.hpp"
#include "client/render_stats.hpp"
#include "client/render_to_files.hpp"
#include "core/base/available_resources.hpp"
#include "core/base/thread_check.hpp"
#include "core/image/file_io.hpp"
#include "core/integrators/render.hpp"
#include "core/scene/light_groups.hpp"
#include "core/scene/loader/loader.hpp"
#include "core/scene/pose.hpp"

namespace tessera::client {
namespace {

namespace fs = std::filesystem;
using core::Result;
using core::Status;

// A pipe would get the image once more with each update.
Status check_updates(const RenderOptions& options) {
  if (!options.update_seconds) return {};
  std::error_code ignored;
  for (const std::string& path : options.scene.output_paths) {
    if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored))
      return core::fail(core::ErrorCode::kInvalidArgument,
                        fmt::format("--update-every: '{}' is no regular file", path));
  }
  return {};
}

// A mistyped name must not cost another file.
Status check_checkpoint(const RenderOptions& options) {
  const std::string path = checkpoint_path_of(options);
  if (Status status = core::check_can_write(path); !status) return status;
  if (Status once = check_given_once(path, options.scene.output_paths); !once) return once;
  std::error_code ignored;
  if (options.checkpoint_path.empty() || !fs::exists(path, ignored) || read_checkpoint_header(path))
    return {};
  return core::fail(
      core::ErrorCode::kAlreadyExists,
      fmt::format("--checkpoint: '{}' exists and is no checkpoint of this release: remove it, or "
                  "name another file",
                  path));
}

Status check_paths(const RenderOptions& options) {
  if (Status status = check_image_paths(options.scene.output_paths); !status) return status;
  if (Status status = check_updates(options); !status) return status;
  if (!options.sample) {
    if (Status status = check_checkpoint(options); !status) return status;
  }
  if (options.stats_path.empty()) return {};
  std::vector<std::string> others = options.scene.output_paths;
  others.push_back(options.scene.scene_path);
  if (!options.sample) others.push_back(checkpoint_path_of(options));
  if (Status once = check_given_once(options.stats_path, others); !once) return once;
  return core::check_can_write(options.stats_path);
}

// An image that does not fit into memory is rejected now instead of being killed later.
Status check_memory(const core::RenderSettings& settings) {
  constexpr double kBytesPerPixel = 2 * 3 * 8 + 3 * 4;  // the film's two sums and the developed image
  constexpr double kBytesPerPlane = 2 * 8;  // of the film, and of the samples that are added to it
  const core::PixelRect window = settings.window();
  const auto planes = static_cast<double>(core::film_layout(settings.layers).planes());
  const double needed =
      (kBytesPerPixel + kBytesPerPlane * planes) * static_cast<double>(window.pixel_count());
  const auto present = static_cast<double>(core::available_memory_bytes());
  if (needed <= present) return {};
  return core::fail(
      core::ErrorCode::kResourceExhausted,
      fmt::format("an image of {}x{} pixels needs {:.0f} GiB of memory, and this process may use {:.0f}: "
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
  // A store knows scenes by their files.
  if (store && options.scene.parameters.empty())
    return store->prepare_file(options.scene.scene_path, options.threads);
  Result<core::SceneDescription> description =
      core::load_scene_file(options.scene.scene_path, options.scene.parameters);
  if (!description) return core::fail(description.error());
  return core::PreparedScene{std::move(*description)};
}

Result<core::RenderSettings> settings_of(const RenderOptions& options,
                                         const core::SceneDescription& description) {
  if (!options.record) return core::resolve_settings(description, options.scene.overrides);
  return options.record->settings;
}

// Whether the scene is that of the record, if there is one.
Status check_scene(const RenderOptions& options, const core::SceneDescription& description,
                   const core::SceneDigest& digest) {
  if (!options.record) return {};
  const core::SceneDigest shown = core::digest_at_frame(digest, description.animation, options.record->frame);
  if (core::digest_text(shown) == options.record->scene) return {};
  return core::fail(core::ErrorCode::kFailedPrecondition,
                    fmt::format("{}: is not the scene that the image was rendered from: it has changed, or "
                                "parameters of it were replaced (-D)",
                                options.scene.scene_path));
}

Result<LoadedScene> load(const RenderOptions& options) {
  const double start = steady_seconds();
  const auto store = open_scene_store(options);
  if (!store) return core::fail(store.error());
  Result<core::PreparedScene> prepared = prepare(*store, options);
  if (!prepared) return core::fail(prepared.error());
  const core::SceneDescription& description = prepared->description;
  print_warnings(description.warnings);
  const auto settings = settings_of(options, description);
  if (!settings) return core::fail(settings.error().within(options.scene.scene_path));
  const auto display = core::resolve_display(description.display, options.scene.display);
  if (!display) return core::fail(display.error().within(options.scene.scene_path));
  if (Status status = check_memory(*settings); !status) return core::fail(status.error());
  Status fits = check_image_size(options.scene.output_paths, *settings);
  if (!fits) return core::fail(fits.error());
  if (Status possible = core::validate_frames(description, options.frames.frames); !possible)
    return core::fail(possible.error().within(options.scene.scene_path));
  if (options.frames.frames.size() > 1 && !core::frames_differ(description))
    warn_about_still_frames(options.scene.scene_path);
  const core::SceneDigest digest = options.sample ? core::SceneDigest{} : core::digest_of(description);
  if (Status same = check_scene(options, description, digest); !same) return core::fail(same.error());
  const core::LayerSet mattes = core::LayerSet{}
                                    .with(core::Layer::kCryptoObject)
                                    .with(core::Layer::kCryptoMaterial)
                                    .with(core::Layer::kCryptoAsset);
  core::CryptoNames names;
  if (settings->layers.intersects(mattes)) names = core::crypto_names(description);
  warn_about_idle_layers(options.scene.output_paths, settings->layers);
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
  return LoadedScene{std::move(*scene), *display, digest, std::move(names), stats};
}

int print_sample(const core::Scene& scene, const core::RenderSettings& settings, core::SampleId id,
                 int threads) {
  if (id.x >= settings.width_px || id.y >= settings.height_px) {
    print_error(fmt::format("--sample: pixel ({}, {}) is outside the image of {}x{} pixels", id.x, id.y,
                            settings.width_px, settings.height_px));
    return kExitUsage;
  }
  const core::Rgb radiance =
      core::integrators::render_sample(core::integrators::prepare(scene, settings, threads), id);
  print_result(fmt::format("pixel ({}, {}) sample {}: radiance {:.9g} {:.9g} {:.9g}\n", id.x, id.y, id.sample,
                           radiance.r, radiance.g, radiance.b));
  return kExitOk;
}

// The options for one frame.
RenderOptions options_of_frame(const RenderOptions& options, std::span<const std::int32_t> frames_left) {
  RenderOptions of_frame = options;
  if (options.frames.frames.empty()) return of_frame;
  of_frame.scene.output_paths = paths_of_frame(options.scene.output_paths, frames_left.front());
  if (options.frames.frames.size() > 1) of_frame.frames_left.assign(frames_left.begin(), frames_left.end());
  return of_frame;
}

// Renders one frame after the other, of one scene in memory. Returns the exit status.
int render_frames(const RenderOptions& options, const std::vector<std::int32_t>& frames,
                  LoadedScene& loaded) {
  const core::SceneDigest digest = loaded.digest;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const RenderOptions of_frame = options_of_frame(options, std::span(frames).subspan(i));
    if (Status status = check_paths(of_frame); !status) return print_error(status.error());
    if (Status shown = loaded.scene.set_frame(frames[i], options.threads); !shown)
      return print_error(shown.error().within(options.scene.scene_path));
    if (i == 0 && !loaded.scene.gives_light()) warn_about_darkness(options.scene.scene_path);
    if (i == 0 && loaded.scene.has_media() && loaded.stats.settings.integrator == core::Integrator::kWhitted)
      warn_about_ignored_media(options.scene.scene_path);
    if (options.sample)
      return print_sample(loaded.scene, loaded.stats.settings, *options.sample, options.threads);
    loaded.digest = core::digest_at_frame(digest, loaded.scene.animation(), frames[i]);
    if (const int status = render_to_files(of_frame, loaded); status != kExitOk) return status;
  }
  return kExitOk;
}

}  // namespace

int run_render(const RenderOptions& options) {
  const std::vector<std::int32_t> frames =
      options.frames.frames.empty() ? std::vector<std::int32_t>{0} : render_order(options.frames);
  if (Status status = check_paths(options_of_frame(options, frames)); !status)
    return print_error(status.error());
  warn_about_idle_display(options.scene.output_paths, options.scene.display);
  Result<LoadedScene> loaded = load(options);
  if (!loaded) return print_error(loaded.error());
  if (Status threads =
          core::check_threads(options.threads + kBackgroundThreads + (options.view ? kViewThreads : 0));
      !threads)
    return print_error(threads.error().within("--threads"));
  return render_frames(options, frames, *loaded);
}

void add_render_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("render", "Render a scene on this machine");
  const auto options = std::make_shared<RenderOptions>();
  add_render_options(*command, *options);
  command->callback([options, &exit_code] {
    complete_render_options(*options);
    exit_code = run_render(*options);
  });
}

}  // namespace tessera::client
