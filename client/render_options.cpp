// SPDX-License-Identifier: Apache-2.0
#include "client/render_options.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <utility>

#include "client/console.hpp"
#include "client/duration.hpp"
#include "client/example_scenes.hpp"
#include "client/page/local_view.hpp"
#include "client/tev_connection.hpp"
#include "core/base/available_resources.hpp"
#include "core/base/host_port.hpp"
#include "core/common/number_range.hpp"

namespace tessera::client {
namespace {

const cli::HelpText kRenderHelp{
    .notes = R"(Options given here replace the values of the scene file.

The image is the same, byte for byte, with any number of threads, with interruptions (--resume) and on a
farm (tessera submit).

Ctrl-C and --time finish the samples under way and write the image of the samples so far, and the checkpoint
that --resume continues. A second Ctrl-C ends the program at once.)",
    .exit_statuses = {{kExitOk, "done, or stopped by --time"},
                      {kExitFailed, "failed"},
                      {kExitUsage, "wrong command line"},
                      {kExitInterrupted, "interrupted"}},
    .examples = {"tessera render scene.json -o image.png",
                 "tessera render scene.json -o out.exr -o out.png --spp 256 --size 1920x1080",
                 "tessera render scene.json -o quick.png --spp 4 --stats stats.json",
                 "tessera render scene.json -o out.exr --time 1h30m",
                 "tessera render scene.json -o out.exr --resume --spp 512",
                 "tessera render turntable -o out.####.exr --frames 1-48",
                 "tessera render scene.json -o red.png -D materials.clay.albedo=[0.8,0.1,0.1]"},
    .required_arguments = {"SCENE"}};

core::SampleId parse_sample(const std::string& text) {
  const std::size_t first = text.find(','), second = text.find(',', first + 1);
  if (first == std::string::npos || second == std::string::npos) {
    throw CLI::ValidationError("--sample",
                               fmt::format("must be X,Y,S: a pixel and a sample number; got '{}'", text));
  }
  constexpr int kMaxCoordinate = core::kMaxImageSidePx - 1;
  const auto number = [](const std::string& part, std::uint64_t most) {
    return parse_whole_number("--sample", part, 0, most);
  };
  return {.x = static_cast<int>(number(text.substr(0, first), kMaxCoordinate)),
          .y = static_cast<int>(number(text.substr(first + 1, second - first - 1), kMaxCoordinate)),
          .sample = static_cast<std::uint32_t>(number(text.substr(second + 1), core::kMaxSpp - 1))};
}

double duration(const std::string& text) {
  const std::optional<double> seconds = parse_duration(text);
  if (!seconds || *seconds == 0)
    throw CLI::ValidationError("--time",
                               fmt::format("must be a duration such as 90s, 10m or 1h30m; got '{}'", text));
  return *seconds;
}

void add_checkpoint_options(CLI::App& command, RenderOptions& options) {
  constexpr double kMinSeconds = 0.1, kMaxSeconds = 86400;
  command
      .add_option_function<std::string>(
          "--time", [&options](const std::string& text) { options.time_seconds = duration(text); },
          "Stop rendering after this time, such as 90s, 10m or 1h30m")
      ->type_name("DURATION");
  command
      .add_option(
          "--checkpoint", options.checkpoint_path,
          "File for the samples of an unfinished render; one that is named here is kept when the render "
          "is complete [default: the first image file's name with .tessera, removed then]")
      ->type_name("FILE");
  command
      .add_option("--checkpoint-every", options.checkpoint_seconds,
                  "Seconds between two checkpoints: what is lost if the program is killed")
      ->check(common::number_between(kMinSeconds, kMaxSeconds))
      ->type_name("SECONDS")
      ->capture_default_str();
  command
      .add_option_function<std::string>(
          "--resume", [&options](const std::string& file) { options.resume = file; },
          "Continue from the checkpoint, or from this one. --spp may be higher than before")
      ->expected(0, 1)
      ->type_name("[FILE]");
  command
      .add_option_function<double>(
          "--update-every", [&options](double seconds) { options.update_seconds = seconds; },
          "Write the image files every so many seconds while rendering")
      ->check(common::number_between(kMinSeconds, kMaxSeconds))
      ->type_name("SECONDS");
  add_tev_option(command, options.tev);
  command
      .add_option_function<std::string>(
          "--view",
          [&options](const std::string& text) { options.view = text.empty() ? kDefaultViewAddress : text; },
          "Show the image in the browser while it is rendered, and until Ctrl-C after that: serve the page "
          "at "
          "this address, or on a free port of this machine")
      ->expected(0, 1)
      ->type_name("[HOST:PORT]");
}

void add_local_options(CLI::App& command, RenderOptions& options) {
  add_thread_option(command, options.threads);
  command.add_option("--stats", options.stats_path, "Write counts, times and memory use to a JSON file")
      ->type_name("FILE");
  command
      .add_option("--scene-cache", options.scene_cache,
                  "Folder that keeps built scenes, so that they load faster the next time [default: none]")
      ->type_name("DIR");
  command
      .add_option("--scene-cache-gib", options.scene_cache_gib,
                  "Size limit of --scene-cache in GiB; scenes unused for longest are removed first")
      ->check(common::number_between(0.0, 1e6))
      ->type_name("N")
      ->capture_default_str();
  command.add_flag("-q,--quiet", options.quiet, "Print warnings and errors only");
  add_progress_json_option(command, options.json);
  command
      .add_option_function<std::string>(
          "--sample", [&options](const std::string& text) { options.sample = parse_sample(text); },
          "Print the radiance of sample S of pixel (X, Y), and render nothing else")
      ->excludes("--json")
      ->type_name("X,Y,S");
}

// What concerns one image alone cannot be said of several.
void check_frame_flags(const RenderOptions& options) {
  const std::size_t count = options.frames.frames.size();
  if (core::Status fit = check_frame_paths(options.scene.output_paths, count); !fit)
    throw CLI::ValidationError("-o", fit.error().message);
  if (count < 2) return;
  const std::pair<const char*, bool> of_one_image[] = {
      {"--sample", options.sample.has_value()},
      {"--stats", !options.stats_path.empty()},
      {"--time", options.time_seconds.has_value()},
      {"--checkpoint", !options.checkpoint_path.empty()},
      {"--resume FILE", options.resume && !options.resume->empty()},
      {"--view", options.view.has_value()}};
  for (const auto& [flag, is_given] : of_one_image)
    if (is_given) throw CLI::ValidationError(flag, "cannot be given with several --frames");
}

}  // namespace

void add_thread_option(CLI::App& command, int& threads) {
  constexpr std::uint64_t kMaxThreads = 1024;
  command
      .add_option_function<std::string>(
          "--threads",
          [&threads](const std::string& text) {
            threads = static_cast<int>(parse_whole_number("--threads", text, 1, kMaxThreads));
          },
          "Number of threads [default: one per processor that this process may use by control group and "
          "affinity mask, at most SLURM_CPUS_PER_TASK or, without that, OMP_NUM_THREADS]")
      ->type_name("N");
}

void add_progress_json_option(CLI::App& command, bool& json) {
  command.add_flag(
      "--json", json,
      "Print the progress as JSON, one line a second, each the job as 'tessera watch --json' prints it. "
      "The last one lists the files under \"written\"");
}

void add_render_options(CLI::App& command, RenderOptions& options) {
  options.threads = static_cast<int>(core::available_threads());
  add_scene_argument(command, options.scene);
  add_output_option(command, options.scene);
  add_frame_options(command, options.frames);
  add_parameter_option(command, options.scene.parameters);
  add_override_options(command, options.scene.overrides);
  add_display_options(command, options.scene.display);
  add_checkpoint_options(command, options);
  add_local_options(command, options);
  command.get_option("SCENE")->required(false);  // complete_render_options() requires it
  cli::set_help(command, kRenderHelp);
}

std::string checkpoint_path_of(const RenderOptions& options) {
  return options.checkpoint_path.empty() ? options.scene.output_paths.front() + ".tessera"
                                         : options.checkpoint_path;
}

void complete_render_options(RenderOptions& options) {
  std::string& scene = options.scene.scene_path;
  if (scene.empty() && options.view && !core::parse_host_port(*options.view))
    scene = find_scene(std::exchange(*options.view, kDefaultViewAddress));
  if (scene.empty()) scene = find_scene(take_argument(options.tev));
  if (scene.empty() && options.resume) scene = find_scene(std::exchange(*options.resume, ""));
  if (scene.empty()) throw CLI::RequiredError("SCENE");
  if (const std::string mistake = why_no_scene(scene); !mistake.empty())
    throw CLI::ValidationError("SCENE", mistake);
  if (options.scene.output_paths.empty() && !options.sample) throw CLI::RequiredError("-o FILE");
  check_frame_flags(options);
  if (const std::string address = take_argument(options.tev); !address.empty())
    throw CLI::ValidationError("--tev", fmt::format("must be HOST:PORT; got '{}'", address));
}

}  // namespace tessera::client
