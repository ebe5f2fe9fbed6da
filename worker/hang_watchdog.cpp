// SPDX-License-Identifier: Apache-2.0
#include "worker/hang_watchdog.hpp"

#include <algorithm>

namespace tessera::worker {
namespace {

constexpr Duration kMin = std::chrono::seconds(30);
constexpr int kLeaseTimes = 20;
constexpr int kTimesWanted = 2;
// The maximum of the coordinator's patience, in lease times.
constexpr int kMaxLeaseTimes = 360;

}  // namespace

Duration compute_hang_timeout(const UnwantedPiece& piece, int failed_restarts) {
  const Duration least = std::max(kMin, kLeaseTimes * piece.heartbeat_timeout);
  if (piece.stopping) return least;
  const Duration most = std::max(kMin, kMaxLeaseTimes * piece.heartbeat_timeout);
  Duration time = std::max(least, kTimesWanted * piece.wanted_for);
  for (int i = 0; piece.first && i < failed_restarts && time < most; ++i) time *= 2;
  return std::min(time, most);
}

}  // namespace tessera::worker
