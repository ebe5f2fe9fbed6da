// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <string>

#include "client/console.hpp"
#include "client/farm/farm.hpp"
#include "client/farm/job_lookup.hpp"
#include "client/farm/job_text.hpp"
#include "client/farm/single_commands.hpp"
#include "client/farm/watching.hpp"
#include "client/interrupt.hpp"

namespace tessera::client {
namespace {

struct WatchOptions {
  FarmOptions farm;
  std::string job;
  bool json = false;
};

core::Result<v1::Job> watch_for_programs(Farm& farm, const std::string& id) {
  return watch_job(
      farm, id,
      [](const v1::Job& job) {
        print_result(to_json_line(job));
        if (results_are_lost()) interrupt();
      },
      [](const std::string&) {});
}

int run_watch(const WatchOptions& options) {
  const auto opened = Farm::open(options.farm);
  if (!opened) return print_error(opened.error());
  Farm& farm = **opened;
  const auto found = find_job(farm, options.job);
  if (!found) return print_error(found.error());
  watch_for_interrupt();
  const auto job =
      options.json ? watch_for_programs(farm, found->id()) : watch_with_progress(farm, found->id());
  if (!job && results_are_lost()) return kExitOk;  // main() reports it
  if (!job) return interrupted() ? kExitInterrupted : print_error(job.error());
  if (!options.json)
    print_note(fmt::format("job {} ({}) is {}", short_id(job->id()), job->name(), state_name(job->state())));
  return report_end(*job);
}

}  // namespace

void add_watch_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("watch", "Follow a job until it ends");
  const auto options = std::make_shared<WatchOptions>();
  add_job_argument(*command, options->job);
  command->add_flag("--json", options->json, "Print the job as one line of JSON at every change");
  add_farm_options(*command, options->farm);
  cli::set_help(*command,
                {.notes = "Ctrl-C stops watching. The job goes on.",
                 .exit_statuses = {{kExitOk, "the job is done"},
                                   {kExitFailed, "the job failed or was cancelled, or the farm is lost"},
                                   {kExitUsage, "wrong command line"},
                                   {kExitInterrupted, "interrupted"}},
                 .examples = {"tessera watch 1f0c"}});
  command->callback([options, &exit_code] { exit_code = run_watch(*options); });
}

}  // namespace tessera::client
