// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/console.hpp"
#include "client/farm/farm.hpp"
#include "client/farm/fleet_text.hpp"
#include "client/farm/job_lookup.hpp"
#include "client/farm/job_text.hpp"
#include "client/farm/label_option.hpp"
#include "client/farm/single_commands.hpp"
#include "client/farm/worker_list.hpp"
#include "core/common/number_range.hpp"

namespace tessera::client {
namespace {

struct ListOptions {
  FarmOptions farm;
  std::string job;
  Labels labels;
  std::vector<std::string> states;  // of jobs to list
  std::optional<std::string> owner;
  std::string since;
  std::size_t limit = 1'000'000;
  bool json = false;
};

double seconds_since_1970() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

// The names of the states that jobs can have.
std::map<std::string, v1::JobState> states_by_name() {
  std::map<std::string, v1::JobState> states;
  for (int state = v1::JobState_MIN + 1; state <= v1::JobState_MAX; ++state)
    states[state_name(static_cast<v1::JobState>(state))] = static_cast<v1::JobState>(state);
  return states;
}

// The error message; empty if the text is the name of a state.
std::string is_state(const std::string& text) {
  std::string names;
  for (const auto& [name, state] : states_by_name()) {
    if (name == text) return "";
    names += (names.empty() ? "" : ", ") + name;
  }
  return "must be one of " + names;
}

// The seconds of a time such as "90m", "12h" or "7d"; empty for other texts.
std::optional<std::int64_t> seconds_of_time(const std::string& text) {
  static const std::map<std::string, std::int64_t> kUnits{{"s", 1}, {"m", 60}, {"h", 3600}, {"d", 86400}};
  constexpr std::int64_t kMax = 1'000'000;
  std::int64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  const auto unit = kUnits.find(std::string(rest, end));
  if (error != std::errc() || number < 0 || number > kMax || unit == kUnits.end()) return std::nullopt;
  return number * unit->second;
}

// The error message; empty if the text is a time.
std::string is_time(const std::string& text) {
  return seconds_of_time(text) ? "" : "must be a time such as 90m, 12h or 7d";
}

v1::ListJobsRequest request_of(const ListOptions& options) {
  v1::ListJobsRequest request;
  for (const std::string& state : options.states) request.add_states(states_by_name().at(state));
  if (options.owner) request.set_owner(*options.owner);
  if (const auto seconds = seconds_of_time(options.since))
    request.mutable_created_from()->set_seconds(static_cast<std::int64_t>(seconds_since_1970()) - *seconds);
  request.mutable_labels()->insert(options.labels.begin(), options.labels.end());
  return request;
}

int run_jobs(const ListOptions& options) {
  const auto opened = Farm::open(options.farm);
  if (!opened) return print_error(opened.error());
  Farm& farm = **opened;
  const auto jobs = list_jobs(farm, request_of(options), options.limit);
  if (!jobs) return print_error(jobs.error());
  print_result(options.json ? to_json_lines(jobs->jobs())
                            : jobs_table(*jobs, seconds_since_1970(), stdout_style()));
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
  print_result(options.json ? to_json_line(job) : job_description(job, seconds_since_1970()));
  return kExitOk;
}

int run_workers(const ListOptions& options) {
  const auto opened = Farm::open(options.farm);
  if (!opened) return print_error(opened.error());
  Farm& farm = **opened;
  const auto workers = list_workers(farm);
  if (!workers) return print_error(workers.error());
  print_result(options.json ? to_json_lines(workers->workers())
                            : workers_table(*workers, seconds_since_1970(), stdout_style()));
  return kExitOk;
}

int run_server(const ListOptions& options) {
  const auto opened = Farm::open(options.farm);
  if (!opened) return print_error(opened.error());
  Farm& farm = **opened;
  const auto info = farm.call(&Farm::Stub::GetServerInfo, v1::GetServerInfoRequest());
  if (!info) return print_error(info.error());
  print_result(options.json ? to_json_line(*info) : server_description(*info, farm.address()));
  return kExitOk;
}

using Run = int (*)(const ListOptions&);

std::pair<CLI::App*, std::shared_ptr<ListOptions>> add(CLI::App& app, int& exit_code, const std::string& name,
                                                       const std::string& what, Run run,
                                                       std::string example) {
  CLI::App* command = app.add_subcommand(name, what);
  const auto options = std::make_shared<ListOptions>();
  add_farm_options(*command, options->farm);
  command->add_flag("--json", options->json, "Print JSON, one object a line");
  cli::set_help(*command, {.exit_statuses = kUsualExitStatuses, .examples = {std::move(example)}});
  command->callback([options, run, &exit_code] { exit_code = run(*options); });
  return {command, options};
}

void add_jobs_command(CLI::App& app, int& exit_code) {
  const auto [jobs, options] = add(app, exit_code, "jobs", "List the jobs, newest first", run_jobs,
                                   "tessera jobs --state running --state paused --since 7d");
  jobs->add_option("--state", options->states, "Only jobs in this state; repeat it for several")
      ->check(CLI::Validator(is_state, ""))
      ->type_name("STATE")
      ->allow_extra_args(false);
  add_label_option(*jobs, "Only jobs with this label; repeated, only those with all of them",
                   options->labels);
  jobs->add_option("--owner", options->owner, "Only jobs of this owner")->type_name("NAME");
  jobs->add_option("--since", options->since, "Only jobs of the last so much time, such as 12h or 7d")
      ->check(CLI::Validator(is_time, ""))
      ->type_name("TIME");
  jobs->add_option("--limit", options->limit, "At most so many jobs, the newest ones")
      ->check(common::number_between(std::size_t{1}, std::size_t{1'000'000}))
      ->type_name("N");
}

}  // namespace

void add_list_commands(CLI::App& app, int& exit_code) {
  add_jobs_command(app, exit_code);
  const auto [job, options] = add(app, exit_code, "job", "Show one job in full", run_job, "tessera job 1f0c");
  add_job_argument(*job, options->job);
  add(app, exit_code, "workers", "List the workers", run_workers, "tessera workers");
  add(app, exit_code, "server", "Show the coordinator's release and limits, and the caller's role",
      run_server, "tessera server");
}

}  // namespace tessera::client
