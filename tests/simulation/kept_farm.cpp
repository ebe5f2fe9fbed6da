// SPDX-License-Identifier: Apache-2.0
#include "tests/simulation/kept_farm.hpp"

#include <algorithm>
#include <memory>
#include <vector>

#include "tests/simulation/coordinator.hpp"
#include "tests/simulation/ordinary_job.hpp"
#include "tests/simulation/worker.hpp"
#include "tests/simulation/world.hpp"

namespace tessera::simulation {

using namespace scheduler;

namespace {

// By this time every machine has delivered something.
constexpr double kShownSeconds = 5;
// A hundred seconds for each of three machines in succession, and the rendering before.
constexpr double kLongestSeconds = 600;
// Three machines count as losses, and near a job's end an idle one may have a copy of the third's lease.
constexpr int kMaxKept = 4;

class KeptFarm {
 public:
  KeptFarm(std::uint64_t seed, bool verbose) : world_(seed, verbose), coordinator_(world_) {}

  FarmReport run();

 private:
  void set_up();
  void submit_endless();
  bool is_over() const;
  void check();
  double elapsed() const { return std::chrono::duration<double>(world_.now().time_since_epoch()).count(); }

  World world_;
  Coordinator coordinator_;
  std::vector<std::unique_ptr<WorkerMachine>> machines_;
  WorkItem endless_;
};

void KeptFarm::set_up() {
  Random& random = world_.random;
  world_.make_network(0, 0, 0.02);
  coordinator_.start();
  for (int m = random.integer(6, 9); m > 0; --m) {
    const double speed = random.real(20'000, 60'000);
    machines_.push_back(
        std::make_unique<WorkerMachine>(world_, coordinator_, fmt::format("m{}", machines_.size()), speed));
    machines_.back()->start();
  }
  coordinator_.command(SubmitJob{{"other"}, kJob});
  world_.after(seconds(kShownSeconds), [this] { submit_endless(); });
}

void KeptFarm::submit_endless() {
  const int tile = world_.random.integer(0, kJob.grid().tile_count() - 1);
  const auto sample = static_cast<std::uint32_t>(world_.random.integer(0, static_cast<int>(kJob.spp) - 1));
  endless_ = {tile, {sample, sample + 1}};
  world_.note(fmt::format("sample {} of tile {} never ends", sample, tile));
  for (const auto& machine : machines_) machine->never_ends({"endless"}, endless_);
  coordinator_.command(SubmitJob{{"endless"}, kJob});
}

bool KeptFarm::is_over() const {
  return elapsed() > kLongestSeconds || (elapsed() > kShownSeconds && coordinator_.all_settled());
}

void KeptFarm::check() {
  const auto kept =
      std::ranges::count_if(machines_, [](const auto& machine) { return machine->has_been_at_no_end(); });
  if (kept > kMaxKept) world_.fail(fmt::format("{} machines were kept by what never ends", kept));
  const std::string endless =
      fmt::format("samples [{}, {}) of tile {}", endless_.samples.begin, endless_.samples.end, endless_.tile);
  for (const JobView& job : coordinator_.jobs()) {
    const JobState expected = job.id == JobId{"other"} ? JobState::kDone : JobState::kFailed;
    if (job.state != expected)
      world_.fail(
          fmt::format("job {} is {} after {:.0f} s", job.id.value, job_state_name(job.state), elapsed()));
    if (expected == JobState::kFailed && job.failure.find(endless) == std::string::npos)
      world_.fail(fmt::format("job {} failed, but not for {}: {}", job.id.value, endless, job.failure));
  }
}

FarmReport KeptFarm::run() {
  set_up();
  FarmReport report;
  while (!is_over() && world_.step()) ++report.events;
  if (!world_.failure()) check();
  report.failure = world_.failure();
  report.virtual_seconds = elapsed();
  report.digest = coordinator_.digest();
  return report;
}

}  // namespace

FarmReport simulate_kept_farm(std::uint64_t seed, bool verbose) {
  return KeptFarm(seed, verbose).run();
}

}  // namespace tessera::simulation
