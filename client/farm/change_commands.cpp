// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <string>

#include "client/console.hpp"
#include "client/farm/farm.hpp"
#include "client/farm/job_lookup.hpp"
#include "client/farm/job_text.hpp"
#include "client/farm/service_options.hpp"
#include "client/farm/single_commands.hpp"
#include "client/scene_flags.hpp"
#include "core/base/printable.hpp"
#include "core/scene/settings.hpp"

namespace tessera::client {
namespace {

struct ChangeOptions {
  FarmOptions farm;
  std::string job;
  std::uint32_t spp = 0;   // for extend
  ServiceOptions service;  // for update
  bool json = false;
};

using Change = core::Result<v1::Job> (*)(Farm& farm, const std::string& id, const ChangeOptions& options);

// The job returned by a call whose only parameter is its id.
template <typename Request, typename Response>
core::Result<v1::Job> change(Farm& farm,
                             grpc::Status (Farm::Stub::*method)(grpc::ClientContext*, const Request&,
                                                                Response*),
                             const std::string& id) {
  Request request;
  request.set_job_id(id);
  const auto response = farm.call(method, request);
  if (!response) return core::fail(response.error());
  return response->job();
}

core::Result<v1::Job> cancel(Farm& farm, const std::string& id, const ChangeOptions&) {
  return change(farm, &Farm::Stub::CancelJob, id);
}
core::Result<v1::Job> pause(Farm& farm, const std::string& id, const ChangeOptions&) {
  return change(farm, &Farm::Stub::PauseJob, id);
}
core::Result<v1::Job> resume(Farm& farm, const std::string& id, const ChangeOptions&) {
  return change(farm, &Farm::Stub::ResumeJob, id);
}
core::Result<v1::Job> extend(Farm& farm, const std::string& id, const ChangeOptions& options) {
  v1::ExtendJobRequest request;
  request.set_job_id(id);
  request.set_spp(options.spp);
  const auto response = farm.call(&Farm::Stub::ExtendJob, request);
  if (!response) return core::fail(response.error());
  return response->job();
}

core::Result<v1::Job> update(Farm& farm, const std::string& id, const ChangeOptions& options) {
  v1::UpdateJobRequest request;
  request.set_job_id(id);
  if (options.service.priority) request.set_priority(*options.service.priority);
  if (options.service.max_workers) request.set_max_workers(*options.service.max_workers);
  const auto response = farm.call(&Farm::Stub::UpdateJob, request);
  if (!response) return core::fail(response.error());
  return response->job();
}

// Describes a change of the service options, if there was one.
std::string service_text(const v1::Job& job, const ServiceOptions& changed) {
  if (!changed.priority && !changed.max_workers) return "";
  const std::string limit = job.max_workers() == 0   ? "any number of workers"
                            : job.max_workers() == 1 ? "at most 1 worker"
                                                     : fmt::format("at most {} workers", job.max_workers());
  return fmt::format(", priority {}, {}", job.priority(), limit);
}

int run_change(const ChangeOptions& options, Change change) {
  const auto opened = Farm::open(options.farm);
  if (!opened) return print_error(opened.error());
  Farm& farm = **opened;
  const auto found = find_job(farm, options.job);
  if (!found) return print_error(found.error());
  const auto job = change(farm, found->id(), options);
  if (!job) return print_error(job.error());
  if (options.json)
    print_result(to_json_line(*job));
  else
    print_result(fmt::format("job {} ({}) is {}, {} spp{}\n", short_id(job->id()),
                             core::printable(job->name()), state_name(job->state()), job->settings().spp(),
                             service_text(*job, options.service)));
  return kExitOk;
}

int run_delete(const ChangeOptions& options) {
  const auto opened = Farm::open(options.farm);
  if (!opened) return print_error(opened.error());
  Farm& farm = **opened;
  const auto found = find_job(farm, options.job);
  if (!found) return print_error(found.error());
  v1::DeleteJobRequest request;
  request.set_job_id(found->id());
  const auto response = farm.call(&Farm::Stub::DeleteJob, request);
  if (!response) return print_error(response.error());
  if (options.json)
    print_result(proto::to_line({{"id", found->id()}, {"name", found->name()}, {"deleted", true}}) + "\n");
  else
    print_result(
        fmt::format("job {} ({}) is deleted\n", short_id(found->id()), core::printable(found->name())));
  return kExitOk;
}

std::pair<CLI::App*, std::shared_ptr<ChangeOptions>> add(CLI::App& app, const std::string& name,
                                                         const std::string& what, std::string example) {
  CLI::App* command = app.add_subcommand(name, what);
  const auto options = std::make_shared<ChangeOptions>();
  add_job_argument(*command, options->job);
  add_farm_options(*command, options->farm);
  command->add_flag("--json", options->json, "Print one line of JSON");
  cli::set_help(*command, {.exit_statuses = kUsualExitStatuses, .examples = {std::move(example)}});
  return {command, options};
}

std::pair<CLI::App*, std::shared_ptr<ChangeOptions>> add_change(CLI::App& app, int& exit_code,
                                                                const std::string& name,
                                                                const std::string& what, std::string example,
                                                                Change change) {
  const auto [command, options] = add(app, name, what, std::move(example));
  command->callback([options = options, change, &exit_code] { exit_code = run_change(*options, change); });
  return {command, options};
}

}  // namespace

void add_change_commands(CLI::App& app, int& exit_code) {
  add_change(app, exit_code, "pause", "Stop rendering a job until it is resumed", "tessera pause 1f0c",
             pause);
  add_change(app, exit_code, "resume", "Continue a paused job", "tessera resume 1f0c", resume);
  add_change(app, exit_code, "cancel", "End a job and keep its image so far", "tessera cancel 1f0c", cancel);

  const auto [extend_command, extend_options] =
      add_change(app, exit_code, "extend", "Render more samples of a job, even if it is done",
                 "tessera extend 1f0c --spp 4096", extend);
  extend_command
      ->add_option_function<std::string>(
          "--spp",
          [options = extend_options](const std::string& text) {
            options->spp = static_cast<std::uint32_t>(parse_whole_number("--spp", text, 1, core::kMaxSpp));
          },
          "Samples per pixel in all, those already taken included")
      ->required()
      ->type_name("N");

  const auto [update_command, update_options] =
      add_change(app, exit_code, "update", "Change a job's priority or number of workers",
                 "tessera update 1f0c --priority 5 --max-workers 8", update);
  add_service_options(*update_command, "unchanged", update_options->service);
  update_command->callback([options = update_options, &exit_code] {
    if (!options->service.priority && !options->service.max_workers)
      throw CLI::RequiredError("--priority or --max-workers");
    exit_code = run_change(*options, update);
  });

  const auto [delete_command, delete_options] =
      add(app, "delete", "Delete a job and its image", "tessera delete 1f0c");
  delete_command->callback([options = delete_options, &exit_code] { exit_code = run_delete(*options); });
}

}  // namespace tessera::client
