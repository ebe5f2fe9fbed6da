// SPDX-License-Identifier: Apache-2.0
// Jobs of a rough farm, and the faults of some of them.
#include <algorithm>
#include <utility>

#include "tests/simulation/rough_farm.hpp"

namespace tessera::simulation {

using namespace scheduler;

void RoughFarm::submit() {
  if (!coordinator_.up()) return world_.after(seconds(1), [this] { submit(); });
  Random& random = world_.random;
  const int x = random.integer(0, 100), y = random.integer(0, 100);
  JobShape shape{{x, y, x + random.integer(1, 300), y + random.integer(1, 200)},
                 static_cast<std::uint32_t>(random.integer(1, 40))};
  vary(shape);
  const JobId id{std::to_string(jobs_submitted_ + 1)};
  if (coordinator_.disk().refuses()) {
    if (coordinator_.command(SubmitJob{id, shape, 0}))
      world_.fail("a job was taken that could not be stored");
    return world_.after(seconds(1), [this] { submit(); });
  }
  ++jobs_submitted_;
  world_.note(fmt::format("job {}: {} of {}x{}, {} spp but for {} tiles", id.value, shape.images,
                          shape.window.width(), shape.window.height(), shape.spp,
                          shape.targets.all().size()));
  for (int tile = 0; tile < shape.grid().tile_count(); ++tile)
    pixel_samples_ += 4096.0 * std::max(shape.spp, shape.target(tile));
  // With audits, machines that are quarantined or cannot build a scene do not count.
  const bool enough_can_die = names_.size() >= kLossesUntilFailure && !stuck_for_good_;
  if (enough_can_die && random.chance(0.05) && !audited_.any()) {
    make_deadly(id, shape);
  } else if (random.chance(0.05) && !audited_.any()) {
    make_unbuildable(id);
  } else if (enough_can_die && slow_.chance(0.05) && !audited_.any()) {
    make_endless(id, shape);
  }
  // A job that is to fail needs enough machines that may have it.
  const bool is_faulty = deadly_jobs_.contains(id) || endless_jobs_.contains(id) ||
                         unbuildable_jobs_.contains(id) || doubtful_jobs_.contains(id);
  shape.has_layers = layers_.chance(0.4) && !is_faulty;
  if (!coordinator_.command(SubmitJob{id, shape, random.integer(0, 1), any_limit()}))
    world_.fail("a job was refused");
}

void RoughFarm::vary(JobShape& shape) {
  if (images_.chance(0.4)) shape.images = images_.integer(2, 3);
  if (!images_.chance(0.4)) return;
  TileTargets::ByTile targets;
  for (int i = images_.integer(1, 4); i > 0; --i) {
    const auto spp = static_cast<std::uint32_t>(images_.integer(1, 60));
    targets.push_back({images_.integer(0, shape.grid().tile_count() - 1), spp});
  }
  shape.targets = TileTargets(std::move(targets));
}

void RoughFarm::make_deadly(const JobId& id, const JobShape& shape) {
  const int tile = world_.random.integer(0, shape.grid().tile_count() - 1);
  const std::uint32_t target = shape.target(tile);
  const auto first = static_cast<std::uint32_t>(world_.random.integer(0, static_cast<int>(target) - 1));
  const auto count = static_cast<std::uint32_t>(world_.random.integer(1, 8));
  world_.note(fmt::format("job {} is deadly from sample {} of tile {} on", id.value, first, tile));
  for (const auto& machine : machines_) machine->die_of(id, {tile, {first, std::min(first + count, target)}});
  deadly_jobs_.insert(id);
}

void RoughFarm::make_endless(const JobId& id, const JobShape& shape) {
  const int tile = slow_.integer(0, shape.grid().tile_count() - 1);
  const std::uint32_t target = shape.target(tile);
  const auto first = static_cast<std::uint32_t>(slow_.integer(0, static_cast<int>(target) - 1));
  const auto count = static_cast<std::uint32_t>(slow_.integer(1, 8));
  world_.note(fmt::format("job {} never ends from sample {} of tile {} on", id.value, first, tile));
  for (const auto& machine : machines_)
    machine->never_ends(id, {tile, {first, std::min(first + count, target)}});
  if (endless_jobs_.empty()) restart_hung_workers();
  endless_jobs_.insert(id);
}

// An operator checks the machines from time to time: usually soon, otherwise after more than an hour.
void RoughFarm::restart_hung_workers() {
  world_.after(seconds(slow_.chance(0.7) ? slow_.real(150, 400) : 4200), [this] {
    for (const auto& machine : machines_) {
      if (!machine->is_at_no_end()) continue;
      machine->crash();
      machine->start();
    }
    restart_hung_workers();
  });
}

void RoughFarm::make_unbuildable(const JobId& id) {
  const bool by_all = world_.random.chance(0.5);
  world_.note(fmt::format("job {} cannot be built by {}", id.value, by_all ? "anyone" : "the last machine"));
  for (const auto& machine : machines_) {
    if (by_all || machine == machines_.back()) machine->decline_reason(id);
  }
  (by_all || machines_.size() == 1 ? unbuildable_jobs_ : doubtful_jobs_).insert(id);
}

}  // namespace tessera::simulation
