// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "client/console.hpp"
#include "client/farm/bundle.hpp"
#include "client/farm/farm.hpp"
#include "client/farm/job_text.hpp"
#include "client/farm/label_option.hpp"
#include "client/farm/picture_download.hpp"
#include "client/farm/service_options.hpp"
#include "client/farm/single_commands.hpp"
#include "client/farm/upload.hpp"
#include "client/farm/watching.hpp"
#include "client/interrupt.hpp"
#include "client/picture_files.hpp"
#include "client/scene_flags.hpp"
#include "core/base/printable.hpp"
#include "proto/convert.hpp"
#include "proto/convert_display.hpp"
#include "proto/error_reasons.hpp"
#include "proto/text.hpp"

namespace tessera::client {
namespace {

const cli::HelpText kSubmitHelp{
    .notes = R"(Prints the job's id. Options given here replace the values of the scene file.

The image is the same, byte for byte, as that of tessera render, whatever machines render it.

Ctrl-C while waiting leaves the job running and writes no file.)",
    .exit_statuses = {{kExitOk, "submitted; with --wait: done"},
                      {kExitFailed, "failed"},
                      {kExitUsage, "wrong command line"},
                      {kExitInterrupted, "interrupted"}},
    .examples = {"tessera submit scene.json",
                 "tessera submit scene.json --wait -o out.exr -o out.png --spp 1024"}};

// How long a submission is repeated while too many scenes wait to be validated.
constexpr std::chrono::minutes kSubmitPatience{30};

struct SubmitOptions {
  FarmOptions farm;
  SceneFlags scene;
  std::string name;
  ServiceOptions service;
  Labels labels;
  bool wait = false;
  bool json = false;
};

// A submission keeps its request id, so that repeating it after a lost response does not create two jobs.
v1::SubmitJobRequest make_request(const SubmitOptions& options, const LocalBundle& local) {
  v1::SubmitJobRequest request;
  request.set_request_id(fmt::format("{:016x}{:016x}", proto::random_seed(), proto::random_seed()));
  request.set_name(options.name);
  *request.mutable_bundle() = local.bundle;
  *request.mutable_overrides() = proto::to_proto(options.scene.overrides);
  request.set_priority(options.service.priority.value_or(0));
  request.set_max_workers(options.service.max_workers.value_or(0));
  *request.mutable_display() = proto::to_proto(options.scene.display);
  for (const auto& [key, value] : options.labels) (*request.mutable_labels())[key] = value;
  return request;
}

// Submits the job, and returns it when its scene is validated.
core::Result<v1::Job> submit_once(Farm& farm, const SubmitOptions& options, const LocalBundle& local) {
  if (core::Status uploaded = upload_missing(farm, local); !uploaded) return core::fail(uploaded.error());
  const v1::SubmitJobRequest request = make_request(options, local);
  const auto call = [&] {
    return patiently<v1::SubmitJobResponse>(
        farm, [&](bool&) { return farm.call(&Farm::Stub::SubmitJob, request, kSubmitPatience); });
  };
  auto response = call();
  // The coordinator has just removed a file.
  if (!response && core::details_of(response.error()).reason == proto::kMissingBlobs) {
    const std::vector<std::string> missing = core::details_of(response.error()).missing;
    if (core::Status uploaded = upload_named(farm, local, missing); !uploaded)
      return core::fail(uploaded.error());
    response = call();
  }
  if (!response) return core::fail(response.error());
  return wait_until_validated(farm, response->job(), print_warning);
}

core::Result<v1::Job> submit(Farm& farm, const SubmitOptions& options, const LocalBundle& local) {
  auto job = submit_once(farm, options, local);
  // The coordinator found a file damaged, and has removed it.
  if (job && job->failure_details().reason() == v1::Failure::REASON_FILE_LOST)
    job = submit_once(farm, options, local);
  if (!job) return job;
  if (job->state() == v1::JOB_STATE_FAILED)
    return core::fail(core::ErrorCode::kInvalidArgument, job->failure());
  // Most warnings were printed before anything was sent.
  for (const std::string& warning : job->warnings())
    if (std::find(local.warnings.begin(), local.warnings.end(), warning) == local.warnings.end())
      print_warning(warning);
  return job;
}

int report_interrupt(const v1::Job& job) {
  const std::string id = short_id(job.id());
  print_error(
      fmt::format("interrupted; no image was written, and the job goes on: tessera watch {} follows it, "
                  "tessera cancel {} stops it",
                  id, id));
  return kExitInterrupted;
}

void print_summary(const v1::Job& job, const std::vector<std::string>& paths) {
  const double seconds = std::max(seconds_taken(job), 1e-3);
  print_note(fmt::format("wrote {} ({} pixels, {} spp) in {:.2f} s, {} samples/s", fmt::join(paths, ", "),
                         size_text(job.settings()), job.settings().spp(), seconds,
                         format_count(static_cast<double>(job.samples_done()) / seconds)));
}

int wait_and_fetch(Farm& farm, const SubmitOptions& options, const v1::Job& submitted) {
  watch_for_interrupt();
  while (true) {
    const auto job = watch_with_progress(farm, submitted.id());
    if (!job && interrupted()) return report_interrupt(submitted);
    if (!job) return print_error(job.error());
    if (const int status = report_end(*job); status != kExitOk) return status;
    const auto& paths = options.scene.output_paths;
    if (paths.empty()) return kExitOk;
    const auto pictured = download_finished_pictures(farm, job->id(), paths);
    if (!pictured) {
      print_error(pictured.error());
      print_hint(fmt::format("tessera image {} -o FILE", short_id(job->id())));
      return interrupted() ? kExitInterrupted : kExitFailed;
    }
    if (pictured->state() == v1::JOB_STATE_DONE) {
      print_summary(*pictured, paths);
      return kExitOk;
    }
    print_warning("the job is not done any more; waiting for it");
  }
}

int run_submit(const SubmitOptions& options) {
  if (core::Status fit = proto::check_text("--name", options.name); !fit) return print_error(fit.error());
  const auto& paths = options.scene.output_paths;
  if (core::Status writable = check_picture_paths(paths); !writable) return print_error(writable.error());
  const auto local = bundle_scene(options.scene.scene_path, options.scene.overrides);
  if (!local) return print_error(local.error());
  core::Status fits = check_picture_size(paths, local->settings);
  if (!fits) return print_error(fits.error());
  print_warnings(local->warnings);
  if (!local->gives_light) warn_about_darkness(options.scene.scene_path);

  FarmOptions farm_options = options.farm;
  // A client that waits for the image also waits for a coordinator that restarts.
  if (options.wait) farm_options.start_patience = farm_options.patience;
  const auto opened = Farm::open(farm_options);
  if (!opened) return print_error(opened.error());
  Farm& farm = **opened;
  const auto job = submit(farm, options, *local);
  if (!job) return print_error(job.error());
  print_result(options.json ? to_json_line(*job) : core::printable(job->id()) + "\n");
  return options.wait ? wait_and_fetch(farm, options, *job) : kExitOk;
}

}  // namespace

void add_submit_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("submit", "Submit a scene to a farm");
  const auto options = std::make_shared<SubmitOptions>();
  add_scene_argument(*command, options->scene);
  command->add_flag("--wait", options->wait, "Wait until the job is done, then write the images");
  add_output_option(*command, options->scene);
  add_override_options(*command, options->scene.overrides);
  add_display_options(*command, options->scene.display);
  command->add_option("--name", options->name, "Name of the job [default: the scene file's name]")
      ->type_name("NAME");
  add_service_options(*command, "0", options->service);
  add_label_option(*command, "Label of the job, to find it by; can be repeated", options->labels);
  command->add_flag("--json", options->json, "Print the job as one line of JSON instead of its id");
  add_farm_options(*command, options->farm);
  cli::set_help(*command, kSubmitHelp);
  command->callback([options, &exit_code] {
    if (!options->scene.output_paths.empty() && !options->wait)
      throw CLI::RequiredError("-o writes the finished image, so --wait");
    exit_code = run_submit(*options);
  });
}

}  // namespace tessera::client
