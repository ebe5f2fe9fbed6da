// SPDX-License-Identifier: Apache-2.0
// Commands of administrators: quarantine and drain.
#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "client/console.hpp"
#include "client/farm/farm.hpp"
#include "client/farm/fleet_text.hpp"
#include "client/farm/job_text.hpp"
#include "client/farm/single_commands.hpp"
#include "core/base/printable.hpp"

namespace tessera::client {
namespace {

constexpr const char* kList = "list";
constexpr const char* kLift = "lift";

struct QuarantineOptions {
  FarmOptions farm;
  std::string action = kList;
  std::string entry;
  bool json = false;
};

struct DrainOptions {
  FarmOptions farm;
  std::string worker;
  bool undo = false, stop = false, json = false;
};

// All pages.
core::Result<v1::ListQuarantineResponse> whole_quarantine(Farm& farm) {
  v1::ListQuarantineResponse all;
  v1::ListQuarantineRequest request;
  do {
    const auto page = farm.call(&Farm::AdminStub::ListQuarantine, request);
    if (!page) return core::fail(page.error());
    all.mutable_entries()->MergeFrom(page->entries());
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  return all;
}

int list_quarantine(Farm& farm, bool json) {
  const auto quarantine = whole_quarantine(farm);
  if (!quarantine) return print_error(quarantine.error());
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  print_result(
      json ? to_json_lines(quarantine->entries())
           : quarantine_table(*quarantine, std::chrono::duration<double>(now).count(), stdout_style()));
  return kExitOk;
}

// The entry with this id, or the only one whose id starts with it.
core::Result<v1::QuarantineEntry> find_entry(Farm& farm, const std::string& id_or_prefix) {
  const auto quarantine = whole_quarantine(farm);
  if (!quarantine) return core::fail(quarantine.error());
  std::vector<v1::QuarantineEntry> matches;
  for (const v1::QuarantineEntry& entry : quarantine->entries())
    if (entry.id().starts_with(id_or_prefix)) matches.push_back(entry);
  if (matches.empty())
    return core::fail(
        core::ErrorCode::kNotFound,
        fmt::format("the quarantine has no entry '{}': tessera quarantine lists those it has", id_or_prefix));
  if (matches.size() > 1)
    return core::fail(core::ErrorCode::kInvalidArgument,
                      fmt::format("'{}' could be entry {} or entry {}: give more of its digits", id_or_prefix,
                                  short_id(matches[0].id()), short_id(matches[1].id())));
  return matches[0];
}

int lift_quarantine(Farm& farm, const std::string& id_or_prefix, bool json) {
  const auto entry = find_entry(farm, id_or_prefix);
  if (!entry) return print_error(entry.error());
  v1::LiftQuarantineRequest request;
  request.set_id(entry->id());
  const auto response = farm.call(&Farm::AdminStub::LiftQuarantine, request);
  if (!response) return print_error(response.error());
  print_result(json ? to_json_line(*entry)
                    : fmt::format("the quarantine of worker {} ({}) is lifted\n",
                                  core::printable(entry->worker_name()), short_id(entry->id())));
  return kExitOk;
}

int run_quarantine(const QuarantineOptions& options) {
  const auto opened = Farm::open(options.farm);
  if (!opened) return print_error(opened.error());
  return options.action == kLift ? lift_quarantine(**opened, options.entry, options.json)
                                 : list_quarantine(**opened, options.json);
}

int run_drain(const DrainOptions& options) {
  const auto opened = Farm::open(options.farm);
  if (!opened) return print_error(opened.error());
  v1::DrainWorkerRequest request;
  request.set_worker(options.worker);
  request.set_undo(options.undo);
  request.set_stop(options.stop);
  const auto response = (*opened)->call(&Farm::AdminStub::DrainWorker, request);
  if (!response) return print_error(response.error());
  const char* what = options.undo   ? "may take leases again"
                     : options.stop ? "takes no more leases, and stops"
                                    : "takes no more leases";
  const nlohmann::ordered_json json = {
      {"id", response->worker_id()}, {"drain", !options.undo}, {"stop", options.stop}};
  print_result(options.json ? proto::to_line(json) + "\n"
                            : fmt::format("worker {} {}\n", short_id(response->worker_id()), what));
  return kExitOk;
}

void add_quarantine_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("quarantine", "List or lift the quarantine of workers");
  const auto options = std::make_shared<QuarantineOptions>();
  command->add_option("ACTION", options->action, "list or lift")
      ->check(CLI::IsMember({kList, kLift}))
      ->capture_default_str();
  command->add_option("ENTRY", options->entry, "Id of the entry to lift, or its first digits");
  add_farm_options(*command, options->farm);
  command->add_flag("--json", options->json, "Print JSON, one entry a line");
  cli::set_help(*command, {.exit_statuses = kUsualExitStatuses,
                           .examples = {"tessera quarantine", "tessera quarantine lift 3f2a"}});
  command->callback([options, &exit_code] {
    if (options->action == kLift && options->entry.empty()) throw CLI::RequiredError("ENTRY");
    if (options->action == kList && !options->entry.empty()) throw CLI::ExtrasError({options->entry});
    exit_code = run_quarantine(*options);
  });
}

void add_drain_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("drain", "Let a worker finish its leases and take no more, or end");
  const auto options = std::make_shared<DrainOptions>();
  command->add_option("WORKER", options->worker, "Id of the worker, its first digits, or its name")
      ->required();
  add_farm_options(*command, options->farm);
  CLI::Option* undo = command->add_flag("--undo", options->undo, "Let it take leases again");
  command
      ->add_flag("--stop", options->stop, "Also end its process when it has delivered what it has rendered")
      ->excludes(undo);
  command->add_flag("--json", options->json, "Print one line of JSON");
  cli::set_help(*command, {.exit_statuses = kUsualExitStatuses,
                           .examples = {"tessera drain render-07", "tessera drain render-07 --undo"}});
  command->callback([options, &exit_code] { exit_code = run_drain(*options); });
}

}  // namespace

void add_fleet_commands(CLI::App& app, int& exit_code) {
  add_quarantine_command(app, exit_code);
  add_drain_command(app, exit_code);
}

}  // namespace tessera::client
