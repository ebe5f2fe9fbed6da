// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "client/console.hpp"
#include "client/farm/farm.hpp"
#include "client/farm/job_lookup.hpp"
#include "client/farm/job_text.hpp"
#include "client/farm/picture_download.hpp"
#include "client/farm/single_commands.hpp"
#include "client/picture_files.hpp"
#include "client/scene_flags.hpp"

namespace tessera::client {
namespace {

struct ImageOptions {
  FarmOptions farm;
  std::string job;
  std::uint32_t image = 0;
  SceneFlags scene;  // its output paths and display options alone
  std::optional<core::PixelRect> region;
  bool json = false;
};

int run_image(const ImageOptions& options) {
  const auto& paths = options.scene.output_paths;
  if (core::Status writable = check_picture_paths(paths); !writable) return print_error(writable.error());
  warn_about_idle_display(paths, options.scene.display);
  const auto opened = Farm::open(options.farm);
  if (!opened) return print_error(opened.error());
  Farm& farm = **opened;
  const auto found = find_job(farm, options.job);
  if (!found) return print_error(found.error());
  const auto job =
      download_pictures(farm, found->id(), paths,
                        {.display = options.scene.display, .region = options.region, .image = options.image});
  if (!job) return print_error(job.error());
  if (options.json) {
    auto json = proto::to_json(*job);
    json["written"] = paths;
    print_result(proto::to_line(json) + "\n");
  }
  print_note(fmt::format("wrote {}: job {} ({}) is {}, {} of {} samples", fmt::join(paths, ", "),
                         short_id(job->id()), job->name(), state_name(job->state()), job->samples_done(),
                         job->samples_total()));
  return kExitOk;
}

}  // namespace

void add_image_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("image", "Download a job's image, finished or not");
  const auto options = std::make_shared<ImageOptions>();
  add_job_argument(*command, options->job);
  command->add_option("--image", options->image, "Number of the image, of a job with several: 0 is the first")
      ->type_name("N")
      ->capture_default_str();
  add_output_option(*command, options->scene);
  command
      ->add_option_function<std::string>(
          "--region", [options](const std::string& text) { options->region = parse_rect("--region", text); },
          "Write only the pixels from (X0, Y0) at the top left to (X1, Y1), which is excluded")
      ->type_name("X0,Y0,X1,Y1");
  add_display_options(*command, options->scene.display);
  command->add_flag("--json", options->json,
                    "Print the job as one line of JSON, with the files as \"written\"");
  add_farm_options(*command, options->farm);
  cli::set_help(*command, {.notes = "An unfinished image has the samples that have been taken so far.",
                           .exit_statuses = kUsualExitStatuses,
                           .examples = {"tessera image 1f0c -o draft.png", "tessera image 1f0c -o final.exr",
                                        "tessera image 1f0c -o part.exr --region 100,40,164,72"}});
  command->callback([options, &exit_code] {
    if (options->scene.output_paths.empty()) throw CLI::RequiredError("-o FILE");
    exit_code = run_image(*options);
  });
}

}  // namespace tessera::client
