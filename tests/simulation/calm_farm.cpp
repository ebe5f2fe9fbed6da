// SPDX-License-Identifier: Apache-2.0
#include "tests/simulation/calm_farm.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "tests/simulation/coordinator.hpp"
#include "tests/simulation/worker.hpp"
#include "tests/simulation/world.hpp"

namespace tessera::simulation {

using namespace scheduler;

namespace {

// No job of this shape is done before the end, however fast the machines are.
const JobShape kShape{320, 256, 3000};
constexpr double kSeconds = 240;
// Jobs of equal priority get at least this part of an equal share. Samples that machines hold at the end do
// not count yet: up to three leases each, possibly all of one job.
constexpr double kMinShare = 0.85;
// The minimum utilisation of the machines.
constexpr double kMinUse = 0.8;
// The policy aims at two seconds. Renders take up to 1.3 times the nominal time, and the speed may be
// measured where they took 0.8 times that. The first lease of a machine of unknown speed has a fixed number
// of samples. Either may be exceeded by one sample of one tile.
constexpr double kSlowest = 1.3;
constexpr double kLongestLeaseSeconds = 2.0 * kSlowest / 0.8;
constexpr double kFirstLeaseSamples = 12'500;

class CalmFarm {
 public:
  CalmFarm(std::uint64_t seed, bool verbose) : world_(seed, verbose), coordinator_(world_) {}

  FarmReport run();

 private:
  void set_up();
  void check_shares();
  void check_use();
  void check_leases();
  double elapsed() const { return std::chrono::duration<double>(world_.now().time_since_epoch()).count(); }

  World world_;
  Coordinator coordinator_;
  std::vector<std::unique_ptr<WorkerMachine>> machines_;
};

void CalmFarm::set_up() {
  Random& random = world_.random;
  world_.make_network(0, 0, 0.02);
  coordinator_.start();
  for (int m = random.integer(1, 6); m > 0; --m) {
    const double speed = 3'000 * std::pow(50, random.real(0, 1));
    machines_.push_back(
        std::make_unique<WorkerMachine>(world_, coordinator_, fmt::format("m{}", machines_.size()), speed));
    world_.after(seconds(random.real(0, 1)), [machine = machines_.back().get()] { machine->start(); });
  }
  const bool equal = random.chance(0.7);
  const int jobs = random.integer(2, 4);
  for (int j = 1; j <= jobs; ++j)
    coordinator_.command(SubmitJob{{std::to_string(j)}, kShape, equal ? 0 : random.integer(0, 1)});
}

void CalmFarm::check_shares() {
  const std::vector<JobView> jobs = coordinator_.jobs();
  const auto lower = [](const JobView& a, const JobView& b) { return a.priority < b.priority; };
  const int highest = std::max_element(jobs.begin(), jobs.end(), lower)->priority;
  double all = 0, sharers = 0;
  for (const JobView& job : jobs) {
    world_.note(fmt::format("job {}, priority {}: {} samples", job.id.value, job.priority, job.samples_done));
    if (job.priority < highest && job.samples_done > 0)
      world_.fail(fmt::format("job {} was rendered before one of higher priority", job.id.value));
    if (job.priority == highest) all += static_cast<double>(job.samples_done), ++sharers;
  }
  for (const JobView& job : jobs) {
    const double share = static_cast<double>(job.samples_done) / (all / sharers);
    if (job.priority == highest && share < kMinShare)
      world_.fail(fmt::format("job {} has {:.2f} of an equal share", job.id.value, share));
  }
}

void CalmFarm::check_use() {
  double done = 0, possible = 0;
  for (const JobView& job : coordinator_.jobs()) done += static_cast<double>(job.samples_done);
  for (const auto& machine : machines_) possible += machine->samples_per_second() * kSeconds;
  world_.note(fmt::format("{:.2f} of what is possible is done", done / possible));
  if (done < kMinUse * possible)
    world_.fail(fmt::format("only {:.2f} of what is possible is done", done / possible));
}

void CalmFarm::check_leases() {
  for (const auto& machine : machines_) {
    const double slow = machine->samples_per_second() / kSlowest;
    const double most =
        std::max(kLongestLeaseSeconds, kFirstLeaseSamples / slow) + core::kTilePx * core::kTilePx / slow;
    world_.note(fmt::format("longest lease: {:.2f} s of {:.2f}", machine->longest_lease_seconds(), most));
    if (machine->longest_lease_seconds() > most)
      world_.fail(
          fmt::format("{} had a lease of {:.2f} s", machine->name(), machine->longest_lease_seconds()));
  }
}

FarmReport CalmFarm::run() {
  set_up();
  FarmReport report;
  while (elapsed() < kSeconds && world_.step()) ++report.events;
  if (!world_.failure()) check_shares();
  if (!world_.failure()) check_use();
  if (!world_.failure()) check_leases();
  report.failure = world_.failure();
  report.virtual_seconds = elapsed();
  report.digest = coordinator_.digest();
  return report;
}

}  // namespace

FarmReport simulate_calm_farm(std::uint64_t seed, bool verbose) {
  return CalmFarm(seed, verbose).run();
}

}  // namespace tessera::simulation
