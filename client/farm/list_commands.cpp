// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
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
#include "core/base/suggestion.hpp"
#include "core/common/number_range.hpp"

namespace tessera::client {
namespace {

struct ListOptions {
  FarmOptions farm;
  std::string job;
  Labels labels;
  std::vector<std::string> states;  // of jobs or workers to list
  std::optional<std::string> owner, principal;
  std::string since, seen_within, unseen_for;
  std::size_t limit = 1'000'000;
  bool json = false;
};

double seconds_since_1970() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

// What tables show for running jobs that wait for workers.
constexpr const char* kQueued = "queued";

// Accepts the names of states, and this further one.
template <typename State>
CLI::Validator a_state(const std::map<std::string, State>& states, const std::string& further = {}) {
  std::vector<std::string> known;
  for (const auto& [name, state] : states) known.push_back(name);
  if (!further.empty()) known.push_back(further);
  return {[known](const std::string& text) -> std::string {
            if (std::ranges::count(known, text) > 0) return "";
            return "there is no state " + core::in_quotes(text) +
                   core::suggestion(text, {known.begin(), known.end()});
          },
          ""};
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

// Empty if the text is.
std::optional<google::protobuf::Timestamp> before_now(const std::string& text) {
  const auto seconds = seconds_of_time(text);
  if (!seconds) return std::nullopt;
  google::protobuf::Timestamp time;
  time.set_seconds(static_cast<std::int64_t>(seconds_since_1970()) - *seconds);
  return time;
}

v1::ListJobsRequest jobs_request(const ListOptions& options) {
  v1::ListJobsRequest request;
  for (const std::string& state : options.states)
    state == kQueued ? request.set_queued(true) : request.add_states(proto::job_states_by_name().at(state));
  if (options.owner) request.set_owner(*options.owner);
  if (const auto time = before_now(options.since)) *request.mutable_created_from() = *time;
  request.mutable_labels()->insert(options.labels.begin(), options.labels.end());
  return request;
}

v1::ListWorkersRequest workers_request(const ListOptions& options) {
  v1::ListWorkersRequest request;
  for (const std::string& state : options.states)
    request.add_states(proto::worker_states_by_name().at(state));
  if (options.principal) request.set_principal(*options.principal);
  if (const auto time = before_now(options.seen_within)) *request.mutable_seen_from() = *time;
  if (const auto time = before_now(options.unseen_for)) *request.mutable_seen_before() = *time;
  return request;
}

// A coordinator of an earlier release would ignore the filter, and list everything.
core::Status expect_filter(Farm& farm, bool is_used, std::string_view feature) {
  if (!is_used) return {};
  const auto has = has_feature(farm, feature);
  if (!has) return core::fail(has.error());
  if (*has) return {};
  return core::fail(core::ErrorCode::kFailedPrecondition,
                    fmt::format("the coordinator at {} is of an earlier release, which does not filter so: "
                                "update it, or list without these options",
                                farm.address()));
}

int run_jobs(const ListOptions& options) {
  const auto opened = Farm::open(options.farm);
  if (!opened) return print_error(opened.error());
  Farm& farm = **opened;
  const v1::ListJobsRequest request = jobs_request(options);
  if (auto known = expect_filter(farm, request.queued(), "queued-jobs"); !known)
    return print_error(known.error());
  const auto jobs = list_jobs(farm, request, options.limit);
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
  print_result(options.json ? to_json_line(job) : job_description(job, seconds_since_1970(), stdout_style()));
  return kExitOk;
}

int run_workers(const ListOptions& options) {
  const auto opened = Farm::open(options.farm);
  if (!opened) return print_error(opened.error());
  Farm& farm = **opened;
  const v1::ListWorkersRequest request = workers_request(options);
  if (auto known = expect_filter(farm, request.ByteSizeLong() > 0, "worker-filters"); !known)
    return print_error(known.error());
  const auto workers = list_workers(farm, request);
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
  print_result(options.json ? to_json_line(*info)
                            : server_description(*info, farm.address(), stdout_style()));
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
  jobs->add_option(
          "--state", options->states,
          "Only jobs in this state, as the table shows it; repeat it for several. running: with those "
          "that are queued")
      ->check(a_state(proto::job_states_by_name(), kQueued))
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

void add_workers_command(CLI::App& app, int& exit_code) {
  const auto [workers, options] = add(app, exit_code, "workers", "List the workers", run_workers,
                                      "tessera workers --state silent --unseen-for 1h");
  workers
      ->add_option("--state", options->states,
                   "Only workers in this state, as the table shows it; repeat it for several")
      ->check(a_state(proto::worker_states_by_name()))
      ->type_name("STATE")
      ->allow_extra_args(false);
  workers->add_option("--principal", options->principal, "Only workers that call as this principal")
      ->type_name("NAME");
  workers
      ->add_option("--seen-within", options->seen_within,
                   "Only workers seen in the last so much time, such as 5m")
      ->check(CLI::Validator(is_time, ""))
      ->type_name("TIME");
  workers
      ->add_option("--unseen-for", options->unseen_for, "Only workers not seen for so much time, such as 1h")
      ->check(CLI::Validator(is_time, ""))
      ->type_name("TIME");
}

}  // namespace

void add_list_commands(CLI::App& app, int& exit_code) {
  add_jobs_command(app, exit_code);
  const auto [job, options] = add(app, exit_code, "job", "Show one job in full", run_job, "tessera job 1f0c");
  add_job_argument(*job, options->job);
  add_workers_command(app, exit_code);
  add(app, exit_code, "server", "Show the coordinator's release and limits, and the caller's role",
      run_server, "tessera server");
}

}  // namespace tessera::client
