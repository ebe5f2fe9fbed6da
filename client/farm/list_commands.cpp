// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <string>

#include "client/console.hpp"
#include "client/farm/farm.hpp"
#include "client/farm/job_lookup.hpp"
#include "client/farm/job_text.hpp"
#include "client/farm/single_commands.hpp"

namespace tessera::client {
namespace {

struct ListOptions {
  FarmOptions farm;
  std::string job;
  bool json = false;
};

double seconds_since_1970() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

int run_jobs(const ListOptions& options) {
  const auto opened = Farm::open(options.farm);
  if (!opened) return print_error(opened.error());
  Farm& farm = **opened;
  const auto jobs = farm.call(&Farm::Stub::ListJobs, v1::ListJobsRequest());
  if (!jobs) return print_error(jobs.error());
  print_result(options.json ? to_json_line(*jobs) : jobs_table(*jobs, seconds_since_1970()));
  return kExitOk;
}

int run_job(const ListOptions& options) {
  const auto opened = Farm::open(options.farm);
  if (!opened) return print_error(opened.error());
  Farm& farm = **opened;
  const auto listed = find_job(farm, options.job);
  if (!listed) return print_error(listed.error());
  v1::GetJobRequest request;
  request.set_job_id(listed->id());
  const auto response = farm.call(&Farm::Stub::GetJob, request);
  if (!response) return print_error(response.error());
  const v1::Job& job = response->job();
  print_result(options.json ? to_json_line(job) : job_description(job));
  return kExitOk;
}

int run_workers(const ListOptions& options) {
  const auto opened = Farm::open(options.farm);
  if (!opened) return print_error(opened.error());
  Farm& farm = **opened;
  const auto workers = farm.call(&Farm::Stub::ListWorkers, v1::ListWorkersRequest());
  if (!workers) return print_error(workers.error());
  print_result(options.json ? to_json_line(*workers) : workers_table(*workers, seconds_since_1970()));
  return kExitOk;
}

using Run = int (*)(const ListOptions&);

std::pair<CLI::App*, std::shared_ptr<ListOptions>> add(CLI::App& app, int& exit_code, const std::string& name,
                                                       const std::string& what, Run run,
                                                       std::string example) {
  CLI::App* command = app.add_subcommand(name, what);
  const auto options = std::make_shared<ListOptions>();
  add_farm_options(*command, options->farm);
  command->add_flag("--json", options->json, "Print one line of JSON");
  cli::set_help(*command, {.exit_statuses = kUsualExitStatuses, .examples = {std::move(example)}});
  command->callback([options, run, &exit_code] { exit_code = run(*options); });
  return {command, options};
}

}  // namespace

void add_list_commands(CLI::App& app, int& exit_code) {
  add(app, exit_code, "jobs", "List the jobs, newest first", run_jobs, "tessera jobs");
  const auto [job, options] = add(app, exit_code, "job", "Show one job in full", run_job, "tessera job 1f0c");
  add_job_argument(*job, options->job);
  add(app, exit_code, "workers", "List the workers", run_workers, "tessera workers");
}

}  // namespace tessera::client
