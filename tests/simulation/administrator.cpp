// SPDX-License-Identifier: Apache-2.0
#include "tests/simulation/administrator.hpp"

namespace tessera::simulation {

using namespace scheduler;

namespace {

constexpr double kLongestDrainSeconds = 30, kLongestReleasePauseSeconds = 4;
// Longer than the time after which a worker without progress loses its leases.
constexpr double kLongestOutageSeconds = 300;
// A tile with the most samples, rendered by the first machine.
constexpr double kSecondsPerTile = 10;

}  // namespace

void Administrator::begin(double unrest_seconds, bool audited) {
  if (!random_.chance(0.4)) return;
  const auto some_time = [&] { return seconds(random_.real(0, unrest_seconds)); };
  for (int drains = random_.integer(0, 3); drains > 0; --drains)
    world_.after(some_time(), [this] { drain(); });
  if (random_.chance(0.3)) {
    delay_seconds_ += kLongestOutageSeconds;
    world_.after(some_time(),
                 [this] { coordinator_.films_lack_memory(seconds(random_.real(0, kLongestOutageSeconds))); });
  }
  for (int lifts = audited ? random_.integer(0, 3) : 0; lifts > 0; --lifts)
    world_.after(some_time(), [this] { lift(); });
  if (audited) return;
  for (int losses = random_.integer(0, 3); losses > 0; --losses)
    world_.after(some_time(), [this] { lose_tile(); });
  if (random_.chance(0.5)) release();
}

void Administrator::calm_down() {
  calm_ = true;
  coordinator_.undo_drains();
}

void Administrator::drain() {
  if (calm_ || !coordinator_.up()) return;
  coordinator_.drain_any(random_);
  world_.after(seconds(random_.real(0, kLongestDrainSeconds)), [this] {
    if (coordinator_.up()) coordinator_.undo_drains();
  });
}

void Administrator::lift() {
  if (coordinator_.up() && coordinator_.lift_any(random_)) ++lifts_;
}

void Administrator::lose_tile() {
  if (!coordinator_.up()) return;
  delay_seconds_ += kSecondsPerTile;
  coordinator_.lose_a_tile(random_);
}

void Administrator::release() {
  if (coordinator_.up()) coordinator_.release_any(random_);
  world_.after(seconds(random_.real(0, kLongestReleasePauseSeconds)), [this] { release(); });
}

}  // namespace tessera::simulation
