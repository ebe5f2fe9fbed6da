#include <fmt/format.h>

#include <chrono>
#include <cstdio>
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
  fmt::print("{}", options.json ? to_json_line(*jobs) : jobs_table(*jobs, seconds_since_1970()));
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
  fmt::print("{}", options.json ? to_json_line(job) : job_description(job));
  return kExitOk;
}

int run_workers(const ListOptions& options) {
  const auto opened = Farm::open(options.farm);
  if (!opened) return print_error(opened.error());
  Farm& farm = **opened;
  const auto workers = farm.call(&Farm::Stub::ListWorkers, v1::ListWorkersRequest());
  if (!workers) return print_error(workers.error());
  fmt::print("{}", options.json ? to_json_line(*workers) : workers_table(*workers, seconds_since_1970()));
  return kExitOk;
}

using Run = int (*)(const ListOptions&);

std::pair<CLI::App*, std::shared_ptr<ListOptions>> add(CLI::App& app, int& exit_code, const std::string& name,
                                                       const std::string& what, Run run) {
  CLI::App* command = app.add_subcommand(name, what);
  const auto options = std::make_shared<ListOptions>();
  add_farm_options(*command, options->farm);
  command->add_flag("--json", options->json, "For programs: one line of JSON");
  command->callback([options, run, &exit_code] { exit_code = run(*options); });
  return {command, options};
}

}  // namespace

void add_list_commands(CLI::App& app, int& exit_code) {
  add(app, exit_code, "jobs", "List the farm's jobs, newest first", run_jobs);
  const auto [job, options] = add(app, exit_code, "job", "Tell everything about one job", run_job);
  job->add_option("job", options->job, "Its id, or the beginning of it")->required()->option_text("ID");
  add(app, exit_code, "workers", "List the farm's workers", run_workers);
}

}  // namespace tessera::client
