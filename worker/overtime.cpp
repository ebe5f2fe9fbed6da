#include "worker/overtime.hpp"

#include <algorithm>

namespace tessera::worker {
namespace {

constexpr Duration kLeast = std::chrono::seconds(30);
constexpr int kLeaseTimes = 20;
constexpr int kTimesWanted = 2;
// After which the coordinator takes nothing for honest.
constexpr int kMostLeaseTimes = 360;

}  // namespace

Duration longest_overtime(const UnwantedPiece& piece, int barren_starts) {
  const Duration least = std::max(kLeast, kLeaseTimes * piece.heard_within);
  if (piece.stopping) return least;
  const Duration most = std::max(kLeast, kMostLeaseTimes * piece.heard_within);
  Duration time = std::max(least, kTimesWanted * piece.wanted_for);
  for (int i = 0; piece.first && i < barren_starts && time < most; ++i) time *= 2;
  return std::min(time, most);
}

}  // namespace tessera::worker
