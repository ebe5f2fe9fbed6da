// SPDX-License-Identifier: Apache-2.0
#include "worker/self_restart.hpp"

#include <omp.h>
#include <sched.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "core/common/log.hpp"
#include "worker/hang_watchdog.hpp"

namespace tessera::worker {
namespace {

// The number of starts in a row, up to this one, whose predecessor rendered nothing and restarted itself.
constexpr const char* kFailedRestarts = "TESSERA_WORKER_FAILED_RESTARTS";
constexpr int kMaxFailedRestarts = 100;

// With OMP_PROC_BIND every thread is bound to some processors, and the new program would inherit them.
void spread_over_all_places() {
  cpu_set_t all;
  CPU_ZERO(&all);
  for (int place = 0; place < omp_get_num_places(); ++place) {
    std::vector<int> processors(static_cast<std::size_t>(omp_get_place_num_procs(place)));
    omp_get_place_proc_ids(place, processors.data());
    for (const int processor : processors) CPU_SET(static_cast<std::size_t>(processor), &all);
  }
  if (CPU_COUNT(&all) > 0) sched_setaffinity(0, sizeof all, &all);
}

int failed_restarts() {
  const char* const text = std::getenv(kFailedRestarts);
  return text == nullptr ? 0 : std::clamp(std::atoi(text), 0, kMaxFailedRestarts);
}

[[noreturn]] void self_restart(char** arguments, int failed_restarts) {
  setenv(kFailedRestarts, std::to_string(failed_restarts).c_str(), 1);
  spread_over_all_places();
  spdlog::info("restarting, since threads that render for ever cannot be ended in another way");
  common::flush_log();
  execv("/proc/self/exe", arguments);
  spdlog::critical("cannot restart: {}", std::strerror(errno));
  common::flush_log();
  _exit(EXIT_FAILURE);
}

}  // namespace

Worker::Options with_self_restart(char** arguments, StopSignals& signals) {
  const int failed = failed_restarts();
  return {
      .hang_timeout = [failed](const UnwantedPiece& piece) { return compute_hang_timeout(piece, failed); },
      .self_restart =
          [=, &signals](const UnwantedPiece& piece, bool must_end) {
            signals.leave_pending();
            if (must_end || signals.token().stop_requested()) {
              common::flush_log();
              _exit(EXIT_SUCCESS);
            }
            self_restart(arguments, piece.first ? failed + 1 : 0);
          }};
}

void keep_program_name() {
  prctl(PR_SET_NAME, program_invocation_short_name);
}

}  // namespace tessera::worker
