// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>

#include "client/console.hpp"
#include "client/farm/farm.hpp"
#include "client/farm/job_lookup.hpp"
#include "client/farm/job_text.hpp"
#include "client/farm/single_commands.hpp"
#include "client/farm/tev_watch.hpp"
#include "client/farm/watching.hpp"
#include "client/interrupt.hpp"
#include "client/tev_connection.hpp"

namespace tessera::client {
namespace {

struct WatchOptions {
  FarmOptions farm;
  std::string job;
  std::optional<std::string> tev;  // HOST:PORT
  bool json = false;
};

int run_watch(const WatchOptions& options) {
  const auto opened = Farm::open(options.farm);
  if (!opened) return print_error(opened.error());
  Farm& farm = **opened;
  const auto found = find_job(farm, options.job);
  if (!found) return print_error(found.error());
  watch_for_interrupt();
  Notices notices;
  std::optional<TevWatch> tev;
  if (options.tev) tev.emplace(farm, found->id(), *options.tev, notices);
  const auto job = options.json ? watch_with_lines(farm, found->id(), notices)
                                : watch_with_progress(farm, found->id(), notices);
  if (tev) tev->finish(job.has_value());
  print_warnings(notices.take());
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
  command->add_flag("--json", options->json, "Print JSON, one line at every change");
  add_tev_option(*command, options->tev);
  add_farm_options(*command, options->farm);
  cli::set_help(*command,
                {.notes = "Ctrl-C stops watching. The job goes on.",
                 .exit_statuses = {{kExitOk, "the job is done"},
                                   {kExitFailed, "the job failed or was cancelled, or the farm is lost"},
                                   {kExitUsage, "wrong command line"},
                                   {kExitInterrupted, "interrupted"}},
                 .examples = {"tessera watch 1f0c", "tessera watch 1f0c --tev"}});
  command->callback([options, &exit_code] {
    if (const std::string address = take_argument(options->tev); !address.empty())
      throw CLI::ValidationError("--tev", fmt::format("must be HOST:PORT; got '{}'", address));
    exit_code = run_watch(*options);
  });
}

}  // namespace tessera::client
