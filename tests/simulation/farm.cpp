#include "tests/simulation/farm.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "tests/simulation/coordinator.hpp"
#include "tests/simulation/worker.hpp"
#include "tests/simulation/world.hpp"

namespace tessera::simulation {

using namespace scheduler;

namespace {

class Farm {
 public:
  Farm(std::uint64_t seed, bool verbose) : world_(seed, verbose), coordinator_(world_) {}

  FarmReport run();

 private:
  void set_up();
  void submit(int number);
  void fault();
  void user();
  void garbage();
  void make_deadly(const JobId& id, const JobShape& shape);
  void check_failures();
  void calm_down();
  void bring_up_coordinator();
  JobId any_job() { return {std::to_string(world_.random.integer(1, jobs_submitted_ + 1))}; }
  WorkItem any_item();
  WorkerMachine& any_machine() {
    return *machines_[static_cast<std::size_t>(
        world_.random.integer(0, static_cast<int>(machines_.size()) - 1))];
  }

  World world_;
  Coordinator coordinator_;
  std::vector<std::unique_ptr<WorkerMachine>> machines_;
  int jobs_submitted_ = 0;
  double pixel_samples_ = 0;
  // Jobs with samples that every machine dies of.
  std::set<JobId> deadly_jobs_;
  // Somebody has delivered results at random, which may be of deadly samples.
  bool lied_ = false;
  bool calm_ = false;
};

void Farm::set_up() {
  Random& random = world_.random;
  const bool bad_network = random.chance(0.5);
  world_.make_network(bad_network ? 0.05 : 0, bad_network ? 0.05 : 0, bad_network ? 15 : 0.5);
  coordinator_.start();
  // Speeds that differ up to a hundredfold; the first machine is quick enough to bring every farm to its end.
  const int machines = random.integer(1, 5);
  for (int m = 0; m < machines; ++m) {
    const double speed = m == 0 ? 60'000 : 1'500 * std::pow(100, random.real(0, 1));
    machines_.push_back(std::make_unique<WorkerMachine>(world_, coordinator_, fmt::format("m{}", m), speed));
    world_.after(seconds(random.real(0, 5)), [this, m] { machines_[static_cast<std::size_t>(m)]->start(); });
  }
  for (int j = 0; j < random.integer(1, 3); ++j)
    world_.after(seconds(random.real(0, 15)), [=, this] { submit(j); });
  for (int f = 0; f < random.integer(0, 8); ++f)
    world_.after(seconds(random.real(0, 40)), [this] { fault(); });
  for (int u = 0; u < random.integer(0, 6); ++u)
    world_.after(seconds(random.real(1, 40)), [this] { user(); });
  world_.after(seconds(40), [this] { calm_down(); });
}

void Farm::submit(int number) {
  if (!coordinator_.up()) return world_.after(seconds(1), [=, this] { submit(number); });
  Random& random = world_.random;
  const JobShape shape{random.integer(1, 300), random.integer(1, 200),
                       static_cast<std::uint32_t>(random.integer(1, 40))};
  const JobId id{std::to_string(++jobs_submitted_)};
  world_.note(fmt::format("job {}: {}x{}, {} spp", id.value, shape.width_px, shape.height_px, shape.spp));
  pixel_samples_ += shape.grid().tile_count() * 4096.0 * shape.spp;
  if (machines_.size() >= scheduler::kDeathsUntilFailure && random.chance(0.05)) make_deadly(id, shape);
  if (!coordinator_.command(SubmitJob{id, shape, random.integer(0, 1)})) world_.fail("a job was refused");
}

void Farm::make_deadly(const JobId& id, const JobShape& shape) {
  const int tile = world_.random.integer(0, shape.grid().tile_count() - 1);
  const auto first = static_cast<std::uint32_t>(world_.random.integer(0, static_cast<int>(shape.spp) - 1));
  const auto count = static_cast<std::uint32_t>(world_.random.integer(1, 8));
  world_.note(fmt::format("job {} is deadly from sample {} of tile {} on", id.value, first, tile));
  for (const auto& machine : machines_)
    machine->die_of(id, {tile, {first, std::min(first + count, shape.spp)}});
  deadly_jobs_.insert(id);
}

// A job fails by itself if and only if it has deadly samples that nobody claims to have rendered.
void Farm::check_failures() {
  for (const auto& [id, failure] : coordinator_.failures()) {
    if (!deadly_jobs_.contains(id))
      world_.fail(fmt::format("job {} failed, but nobody dies of it: {}", id.value, failure));
  }
  for (const JobView& job : coordinator_.jobs()) {
    if (deadly_jobs_.contains(job.id) && job.state == JobState::kDone && !lied_)
      world_.fail(fmt::format("job {} is done, but whoever renders it dies", job.id.value));
  }
}

void Farm::fault() {
  Random& random = world_.random;
  WorkerMachine& machine = any_machine();
  switch (random.integer(0, 7)) {
    case 0:
      machine.crash();
      world_.after(seconds(random.real(0, 20)), [&machine] { machine.start(); });
      break;
    case 1:
      machine.hang(seconds(random.real(0, 40)));
      break;
    case 2:
      machine.stop();
      world_.after(seconds(random.real(0, 20)), [&machine] { machine.start(); });
      break;
    case 3:
    case 4:
      if (!coordinator_.up()) break;
      coordinator_.crash();
      world_.after(seconds(random.real(0, 15)), [this] { coordinator_.start(); });
      break;
    case 5:
      coordinator_.stall(seconds(random.real(0, 25)));
      break;
    default:
      for (int i = 0; i < 5; ++i) garbage();
  }
}

WorkItem Farm::any_item() {
  const auto begin = static_cast<std::uint32_t>(world_.random.integer(0, 20));
  return {world_.random.integer(-1, 8), {begin, static_cast<std::uint32_t>(world_.random.integer(0, 25))}};
}

// Messages that no honest worker sends. Well-formed results among them count like any other.
void Farm::garbage() {
  Random& random = world_.random;
  std::vector<WorkItem> items;
  for (int i = random.integer(0, 3); i > 0; --i) items.push_back(any_item());
  const LeaseId lease{(static_cast<std::uint64_t>(random.integer(0, 3)) << 40) +
                      static_cast<std::uint64_t>(random.integer(0, 30))};
  if (random.chance(0.5)) {
    lied_ = true;
    coordinator_.submit_result({{"liar"}, any_job(), lease, items, random.real(-1, 1), random.chance(0.5)},
                               [] {});
  } else {
    coordinator_.synchronize({{{"liar"}, "liar", "", random.integer(-1, 4)},
                              {{lease, any_job(), items}, {lease, any_job(), items}},
                              random.integer(-1, 9),
                              random.chance(0.2)},
                             [](const Reply&) {});
  }
}

void Farm::user() {
  if (!coordinator_.up()) return;
  Random& random = world_.random;
  const JobId id = any_job();
  const auto command = [&](const char* what, const Event& event) {
    const bool taken = coordinator_.command(event);
    world_.note(fmt::format("user: {} {}{}", what, id.value, taken ? "" : " (refused)"));
    return taken;
  };
  const auto resume = [this, id] {
    if (coordinator_.up()) coordinator_.command(ResumeJob{id});
  };
  switch (random.integer(0, 9)) {
    case 0:
      command("cancel", CancelJob{id});
      break;
    case 1:
      command("delete", DeleteJob{id});
      break;
    case 2:
      command("fail", FailJob{id, "it cannot be loaded"});
      break;
    case 3:
    case 4:
    case 5:
      command("pause", PauseJob{id});
      world_.after(seconds(random.real(0, 10)), resume);
      break;
    default:
      if (command("extend", ExtendJob{id, static_cast<std::uint32_t>(random.integer(1, 60))})) {
        pixel_samples_ += 15 * 4096.0 * 60;
      }
  }
}

// From now on there are no faults. Whatever is down comes up, whatever is paused goes on.
void Farm::calm_down() {
  calm_ = true;
  world_.note("calm");
  world_.make_network(0, 0, 0.1);
  bring_up_coordinator();
}

void Farm::bring_up_coordinator() {
  coordinator_.start();
  for (const JobView& job : coordinator_.jobs()) {
    if (job.state == JobState::kPaused) coordinator_.command(ResumeJob{job.id});
  }
  for (const auto& machine : machines_) machine->start();
}

FarmReport Farm::run() {
  set_up();
  FarmReport report;
  // The first machine alone, with time for every fault to pass, every lease to run out, and every deadly
  // range to have its victims: three machines, of which chance may take one again and again.
  const auto bound = [&] {
    return 40 + 120 + 800 * static_cast<double>(deadly_jobs_.size()) +
           1.5 * pixel_samples_ / machines_[0]->samples_per_second();
  };
  const auto elapsed = [&] { return std::chrono::duration<double>(world_.now().time_since_epoch()).count(); };
  while (world_.step()) {
    ++report.events;
    if (calm_ && coordinator_.all_settled()) break;
    if (elapsed() > bound()) world_.fail("jobs are not finished in time");
  }
  if (!world_.failure()) coordinator_.check_films();
  if (!world_.failure()) check_failures();
  report.failure = world_.failure();
  report.virtual_seconds = elapsed();
  return report;
}

}  // namespace

FarmReport simulate_farm(std::uint64_t seed, bool verbose) {
  return Farm(seed, verbose).run();
}

}  // namespace tessera::simulation
