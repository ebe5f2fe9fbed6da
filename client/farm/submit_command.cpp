// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "client/console.hpp"
#include "client/farm/bundle.hpp"
#include "client/farm/farm.hpp"
#include "client/farm/image_download.hpp"
#include "client/farm/job_text.hpp"
#include "client/farm/label_option.hpp"
#include "client/farm/service_options.hpp"
#include "client/farm/single_commands.hpp"
#include "client/farm/submission.hpp"
#include "client/farm/watching.hpp"
#include "client/frames.hpp"
#include "client/image_files.hpp"
#include "client/interrupt.hpp"
#include "client/scene_flags.hpp"
#include "core/base/printable.hpp"
#include "proto/text.hpp"

namespace tessera::client {
namespace {

using Clock = std::chrono::steady_clock;

const cli::HelpText kSubmitHelp{
    .notes = R"(Prints the job's id. Options given here replace the values of the scene file.

The image is the same, byte for byte, as that of tessera render, whatever machines render it.

Ctrl-C while waiting leaves the job running and writes no file.)",
    .exit_statuses = {{kExitOk, "submitted; with --wait: done"},
                      {kExitFailed, "failed"},
                      {kExitUsage, "wrong command line"},
                      {kExitInterrupted, "interrupted"}},
    .examples = {"tessera submit scene.json",
                 "tessera submit scene.json --wait -o out.exr -o out.png --spp 1024",
                 "tessera submit turntable --frames 1-48 --preview-first --wait -o out.####.exr"}};

struct SubmitOptions {
  FarmOptions farm;
  SceneFlags scene;
  FrameFlags frames;
  std::string name;
  ServiceOptions service;
  Labels labels;
  bool wait = false;
  bool json = false;
};

int report_interrupt(const v1::Job& job) {
  const std::string id = short_id(job.id());
  print_error(
      fmt::format("interrupted; no image was written, and the job goes on: tessera watch {} follows it, "
                  "tessera cancel {} stops it",
                  id, id));
  return kExitInterrupted;
}

// Downloads all images of a job that was DONE. Returns the job when the last one was taken, or when it was no
// longer DONE. `written` are the files.
core::Result<v1::Job> download_frames(Farm& farm, const SubmitOptions& options, const std::string& id,
                                      std::vector<std::string>& written) {
  const auto& paths = options.scene.output_paths;
  const std::vector<std::int32_t> frames = render_order(options.frames);
  written = paths;
  if (frames.empty()) return download_finished_images(farm, id, paths);
  written.clear();
  v1::Job job;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::vector<std::string> of_frame = paths_of_frame(paths, frames[i]);
    auto got = download_finished_images(farm, id, of_frame, static_cast<std::uint32_t>(i));
    if (!got || got->state() != v1::JOB_STATE_DONE) return got;
    written.insert(written.end(), of_frame.begin(), of_frame.end());
    job = *std::move(got);
  }
  return job;
}

int wait_and_fetch(Farm& farm, const SubmitOptions& options, const v1::Job& submitted,
                   Clock::time_point since) {
  watch_for_interrupt();
  while (true) {
    const auto job = watch_with_progress(farm, submitted.id());
    if (!job && interrupted()) return report_interrupt(submitted);
    if (!job) return print_error(job.error());
    if (const int status = report_end(*job); status != kExitOk) return status;
    const std::chrono::duration<double> taken = Clock::now() - since;
    const auto& paths = options.scene.output_paths;
    if (paths.empty()) {
      if (options.json) print_result(to_json_line(*job));
      return kExitOk;
    }
    std::vector<std::string> written;
    const auto downloaded = download_frames(farm, options, job->id(), written);
    if (!downloaded) {
      print_error(downloaded.error());
      print_hint(fmt::format("tessera image {} -o FILE", short_id(job->id())));
      return interrupted() ? kExitInterrupted : kExitFailed;
    }
    if (downloaded->state() == v1::JOB_STATE_DONE) {
      if (options.json) print_result(to_json_line(*downloaded));
      print_note(written_text(*downloaded, written, taken.count()));
      return kExitOk;
    }
    print_warning("the job is not done any more; waiting for it");
  }
}

int run_submit(const SubmitOptions& options) {
  const auto& paths = options.scene.output_paths;
  const std::vector<std::int32_t> frames = render_order(options.frames);
  const auto first_paths = frames.empty() ? paths : paths_of_frame(paths, frames.front());
  if (core::Status writable = check_image_paths(first_paths); !writable) return print_error(writable.error());
  const auto local = bundle_scene(
      options.scene.scene_path,
      {.overrides = options.scene.overrides, .parameters = options.scene.parameters, .frames = frames});
  if (!local) return print_error(local.error());
  core::Status fits = check_image_size(paths, local->settings);
  if (!fits) return print_error(fits.error());
  print_warnings(local->warnings);
  warn_about_idle_layers(paths, local->settings.layers);
  if (!local->gives_light) warn_about_darkness(options.scene.scene_path);
  if (frames.size() > 1 && !local->frames_differ) warn_about_still_frames(options.scene.scene_path);
  if (local->ignores_media) warn_about_ignored_media(options.scene.scene_path);

  FarmOptions farm_options = options.farm;
  // A client that waits for the image also waits for a coordinator that restarts.
  if (options.wait) farm_options.start_patience = farm_options.patience;
  const auto opened = Farm::open(farm_options);
  if (!opened) return print_error(opened.error());
  Farm& farm = **opened;
  if (core::Status known = check_features(farm, local->settings); !known) return print_error(known.error());
  const Submission submission{.overrides = options.scene.overrides,
                              .display = options.scene.display,
                              .name = options.name,
                              .service = options.service,
                              .labels = options.labels,
                              .frames = frames};
  const auto since = Clock::now();
  const auto job = submit_job(farm, submission, *local);
  if (!job) return print_error(job.error());
  print_result(options.json ? to_json_line(*job) : core::printable(job->id()) + "\n");
  if (const std::string lack = lack_of_workers(farm, local->settings); !lack.empty()) print_note(lack);
  return options.wait ? wait_and_fetch(farm, options, *job, since) : kExitOk;
}

}  // namespace

void add_submit_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("submit", "Submit a scene to a farm");
  const auto options = std::make_shared<SubmitOptions>();
  add_scene_argument(*command, options->scene);
  command->add_flag("--wait", options->wait, "Wait until the job is done, then write the images");
  add_output_option(*command, options->scene);
  add_frame_options(*command, options->frames);
  add_parameter_option(*command, options->scene.parameters);
  add_override_options(*command, options->scene.overrides);
  add_display_options(*command, options->scene.display);
  command
      ->add_option("--name", options->name,
                   "Name of the job [default: the scene file's name without its ending, or the name of "
                   "its folder if the file is scene.json]")
      ->type_name("NAME");
  add_service_options(*command, "0", options->service);
  add_label_option(*command, "Label of the job, to find it by; can be repeated", options->labels);
  command->add_flag(
      "--json", options->json,
      "Print the job as one line of JSON instead of its id; with --wait, again when it is done");
  add_farm_options(*command, options->farm);
  cli::set_help(*command, kSubmitHelp);
  command->callback([options, &exit_code] {
    if (core::Status fit = proto::check_text("--name", options->name); !fit)
      throw CLI::ValidationError(fit.error().message);
    if (!options->scene.output_paths.empty() && !options->wait)
      throw CLI::RequiredError("-o writes the finished image, so --wait");
    if (core::Status fit = check_frame_paths(options->scene.output_paths, options->frames.frames.size());
        !fit)
      throw CLI::ValidationError("-o", fit.error().message);
    exit_code = run_submit(*options);
  });
}

}  // namespace tessera::client
