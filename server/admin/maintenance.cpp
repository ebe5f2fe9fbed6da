// SPDX-License-Identifier: Apache-2.0
#include "server/admin/maintenance.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

#include "core/base/printable.hpp"
#include "server/admin/state_check.hpp"

namespace tessera::admin {

namespace {

int print_error(const core::Error& error) {
  fmt::print(stderr, "tessera-coordinator: error: {}\n", core::printable_lines(error.message));
  return EXIT_FAILURE;
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

}  // namespace tessera::admin
