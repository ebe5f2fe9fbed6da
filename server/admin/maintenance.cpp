// SPDX-License-Identifier: Apache-2.0
#include "server/admin/maintenance.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

#include "core/base/printable.hpp"
#include "core/cli/parse.hpp"
#include "server/admin/backup.hpp"
#include "server/admin/state_check.hpp"

namespace tessera::admin {

namespace {

int print_error(const core::Error& error) {
  return cli::print_error("tessera-coordinator", error.message);
}

}  // namespace

int check(const std::filesystem::path& state) {
  const auto findings = check_state(state);
  if (!findings) return print_error(findings.error());
  fmt::print("{}", to_text(*findings));
  return findings->whole() ? EXIT_SUCCESS : EXIT_FAILURE;
}

int salvage(const std::filesystem::path& state) {
  const auto done = salvage_state(state);
  if (!done) return print_error(done.error());
  fmt::print("kept {} jobs with {} tiles; lost {} jobs, and {} tiles that are rendered again\n", done->jobs,
             done->tiles, done->lost_jobs, done->lost_tiles);
  if (done->tiles_lost_for_good > 0)
    fmt::print("lost for good: {} tiles of cancelled and failed jobs, whose images are black there\n",
               done->tiles_lost_for_good);
  fmt::print("the damaged database is now {}\n", done->set_aside.string());
  return EXIT_SUCCESS;
}

int back_up(const std::filesystem::path& state, const std::filesystem::path& backup) {
  const auto done = back_up_state(state, backup);
  if (!done) return print_error(done.error());
  fmt::print("the backup {} has {} jobs with {} files\n", backup.string(), done->jobs, done->files);
  for (const std::string& damage : done->damage)
    fmt::print(stderr, "tessera-coordinator: damaged in the state: {}\n", core::printable(damage));
  return done->damage.empty() ? EXIT_SUCCESS : EXIT_FAILURE;
}

int restore(const std::filesystem::path& backup, const std::filesystem::path& state) {
  const auto files = restore_state(backup, state);
  if (!files) return print_error(files.error());
  fmt::print("{} has the state of the backup, with {} files: start a coordinator with --state {}\n",
             state.string(), *files, state.string());
  return EXIT_SUCCESS;
}

}  // namespace tessera::admin
