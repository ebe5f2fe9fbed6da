// SPDX-License-Identifier: Apache-2.0
#include "client/render_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <thread>

#include "client/console.hpp"
#include "core/common/number_range.hpp"

namespace tessera::client {
namespace {

const cli::HelpText kRenderHelp{
    .notes = R"(Options given here replace the values of the scene file.

The image is the same, byte for byte, with any number of threads and on a farm (tessera submit). Ctrl-C
writes no file.)",
    .exit_statuses = {{kExitOk, "done"},
                      {kExitFailed, "failed"},
                      {kExitUsage, "wrong command line"},
                      {kExitInterrupted, "interrupted"}},
    .examples = {"tessera render scene.json -o image.png",
                 "tessera render scene.json -o out.exr -o out.png --spp 256 --size 1920x1080",
                 "tessera render scene.json -o quick.png --spp 4 --stats stats.json"}};

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

void add_local_options(CLI::App& command, RenderOptions& options) {
  constexpr std::uint64_t kMaxThreads = 1024;
  command
      .add_option_function<std::string>(
          "--threads",
          [&options](const std::string& text) {
            options.threads = static_cast<int>(parse_whole_number("--threads", text, 1, kMaxThreads));
          },
          "Number of threads [default: one per processor]")
      ->type_name("N");
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
  command
      .add_option_function<std::string>(
          "--sample", [&options](const std::string& text) { options.sample = parse_sample(text); },
          "Print the radiance of sample S of pixel (X, Y), and render nothing else")
      ->type_name("X,Y,S");
}

}  // namespace

void add_render_options(CLI::App& command, RenderOptions& options) {
  options.threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  add_scene_argument(command, options.scene);
  add_output_option(command, options.scene);
  add_override_options(command, options.scene.overrides);
  add_display_options(command, options.scene.display);
  add_local_options(command, options);
  cli::set_help(command, kRenderHelp);
}

}  // namespace tessera::client
