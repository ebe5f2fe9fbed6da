#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>

#include "client/console.hpp"
#include "client/farm/farm.hpp"
#include "client/farm/job_lookup.hpp"
#include "client/farm/job_text.hpp"
#include "client/farm/single_commands.hpp"
#include "client/farm/watching.hpp"
#include "client/interrupt.hpp"
#include "core/base/printable.hpp"

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
        fmt::print("{}", to_json_line(job));
        std::fflush(stdout);
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
  if (!job) return interrupted() ? kExitInterrupted : print_error(job.error());
  if (!options.json)
    fmt::print(stderr, "job {} ({}) is {}\n", short_id(job->id()), core::printable(job->name()),
               state_name(job->state()));
  return report_end(*job);
}

}  // namespace

void add_watch_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("watch", "Follow a job until it is over; Ctrl-C leaves it running");
  const auto options = std::make_shared<WatchOptions>();
  command->add_option("job", options->job, "Its id, or the beginning of it")->required()->option_text("ID");
  command->add_flag("--json", options->json, "For programs: the job as a line of JSON at every change");
  add_farm_options(*command, options->farm);
  command->callback([options, &exit_code] { exit_code = run_watch(*options); });
}

}  // namespace tessera::client
