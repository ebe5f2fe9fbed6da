#include "tests/simulation/farm.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "tests/simulation/calm_farm.hpp"
#include "tests/simulation/coordinator.hpp"
#include "tests/simulation/liar.hpp"
#include "tests/simulation/worker.hpp"
#include "tests/simulation/world.hpp"

namespace tessera::simulation {

using namespace scheduler;

namespace {

// One farm of so many has no unrest at all.
constexpr std::uint64_t kCalmFarms = 100;
// Faults come, and users speak, until then.
constexpr double kUnrestSeconds = 40;
// A straggler is a hundred times slower than the first machine.
constexpr double kFirstSpeed = 60'000, kStragglerSpeed = 600;

// Two farms of five have audits, which must not change what happens in the others: their chances are drawn
// apart.
struct AuditedFarm {
  explicit AuditedFarm(std::uint64_t seed) : random(seed ^ 0xa0d17) {
    if (!random.chance(0.4)) return;
    options.audit_share = random.chance(0.6) ? 1 : random.real(0.01, 1);
    options.audit_patience = seconds(200);
  }
  bool any() const { return options.audit_share > 0; }

  Random random;
  scheduler::Options options;
};

class Farm {
 public:
  Farm(std::uint64_t seed, bool verbose)
      : world_(seed, verbose),
        slow_(seed ^ 0x510),
        audited_(seed),
        coordinator_(world_, audited_.options),
        liar_(world_, coordinator_) {}

  FarmReport run();

 private:
  // ---- Beginning and end ----
  void set_up();
  void add_machine(int number);
  void submit();
  void set_up_audits();
  void make_deadly(const JobId& id, const JobShape& shape);
  void make_endless(const JobId& id, const JobShape& shape);
  void start_anew_who_is_at_no_end();
  bool make_slow(WorkerMachine& machine);
  void make_unbuildable(const JobId& id);
  void calm_down();
  bool is_late() const;
  void check_failures();

  // ---- What goes wrong ----
  void fault();
  void machine_fault(WorkerMachine& machine, int kind);
  void get_stuck(WorkerMachine& machine);
  void coordinator_fault(int kind);
  void power_failure();

  // ---- What users do ----
  void user();
  bool command(const char* what, const Event& event);
  void resume_later(const JobId& id);
  void odd_command(const JobId& id);

  JobId any_job() { return {std::to_string(world_.random.integer(1, jobs_submitted_ + 1))}; }
  // Of workers; more often none.
  std::uint32_t any_limit() {
    return world_.random.chance(0.6) ? 0 : static_cast<std::uint32_t>(world_.random.integer(1, 4));
  }
  WorkerMachine& any_machine() {
    return *machines_[static_cast<std::size_t>(
        world_.random.integer(0, static_cast<int>(machines_.size()) - 1))];
  }
  double elapsed() const { return std::chrono::duration<double>(world_.now().time_since_epoch()).count(); }

  World world_;
  // What has to do with fetching and with samples without end is drawn apart as well.
  Random slow_;
  AuditedFarm audited_;
  Coordinator coordinator_;
  Liar liar_;
  std::vector<std::unique_ptr<WorkerMachine>> machines_;
  // Of those that render.
  std::set<std::string> names_;
  int jobs_submitted_ = 0;
  double pixel_samples_ = 0;
  // How long the scheduler's time may stand still.
  double set_back_seconds_ = 0;
  // How long what workers hold may lie there, of all that come to render nothing.
  double stuck_seconds_ = 0;
  bool stuck_for_good_ = false;
  // As many names as that may fail a job.
  std::set<std::string> stuck_names_;
  // Jobs with samples that every machine dies of, or comes to no end with; whose scenes no machine can build;
  // or some cannot.
  std::set<JobId> deadly_jobs_, endless_jobs_, unbuildable_jobs_, doubtful_jobs_;
  bool calm_ = false;
};

// ---- Beginning and end ----

void Farm::set_up() {
  Random& random = world_.random;
  const bool bad_network = random.chance(0.5);
  world_.make_network(bad_network ? 0.05 : 0, bad_network ? 0.05 : 0, bad_network ? 15 : 0.5);
  coordinator_.start();
  const int machines = std::max(random.integer(1, 5), audited_.any() ? 2 : 1);
  for (int m = 0; m < machines; ++m) add_machine(m);
  if (audited_.any()) set_up_audits();
  for (int j = random.integer(1, 3); j > 0; --j)
    world_.after(seconds(random.real(0, 15)), [this] { submit(); });
  for (int f = random.integer(0, 10); f > 0; --f)
    world_.after(seconds(random.real(0, kUnrestSeconds)), [this] { fault(); });
  for (int u = random.integer(0, 8); u > 0; --u)
    world_.after(seconds(random.real(1, kUnrestSeconds)), [this] { user(); });
  world_.after(seconds(kUnrestSeconds), [this] { calm_down(); });
}

// Speeds that differ up to a hundredfold; the first machine is quick enough to bring every farm to its end.
void Farm::add_machine(int number) {
  Random& random = world_.random;
  double speed = number == 0 ? kFirstSpeed : 1'500 * std::pow(100, random.real(0, 1));
  if (number > 0 && random.chance(0.15)) speed = kStragglerSpeed;
  const std::string host = fmt::format("m{}", number);
  std::string name = random.chance(0.1) ? "render" : host;
  if (audited_.any() && number < 2) {  // they are to bring it to its end together
    speed = kFirstSpeed;
    name = host;
  }
  machines_.push_back(std::make_unique<WorkerMachine>(world_, coordinator_, host, speed, name));
  const bool may_be_slow = number >= (audited_.any() ? 2 : 1);
  if (!may_be_slow || !make_slow(*machines_.back())) names_.insert(name);
  world_.after(seconds(random.real(0, 5)), [machine = machines_.back().get()] { machine->start(); });
}

// On a slow line, or one that says so for ever. Whether it is one that renders nothing at all.
bool Farm::make_slow(WorkerMachine& machine) {
  if (slow_.chance(0.8)) return false;
  stuck_seconds_ += 700;
  if (slow_.chance(0.2)) {
    world_.note(machine.name() + " feigns to fetch");
    machine.feign_fetching();
    return true;
  }
  const double fetch_seconds = std::pow(10, slow_.real(0, 3));
  world_.note(fmt::format("{} takes {:.0f} s to fetch a scene", machine.name(), fetch_seconds));
  machine.fetch_slowly(seconds(fetch_seconds));
  return false;
}

// The first two are honest, so that the others can be found out.
void Farm::set_up_audits() {
  world_.note(fmt::format("{:.0f} % of ranges are audited", 100 * audited_.options.audit_share));
  for (std::size_t m = 0; m < machines_.size(); ++m) {
    machines_[m]->split_ranges();
    if (m < 2 || !audited_.random.chance(0.6)) continue;
    const std::string host = fmt::format("m{}", m);
    world_.note(host + " lies");
    machines_[m]->lie(audited_.random.real(0.05, 1));
    coordinator_.expect_liar(host);
  }
}

void Farm::submit() {
  if (!coordinator_.up()) return world_.after(seconds(1), [this] { submit(); });
  Random& random = world_.random;
  const int x = random.integer(0, 100), y = random.integer(0, 100);
  const JobShape shape{{x, y, x + random.integer(1, 300), y + random.integer(1, 200)},
                       static_cast<std::uint32_t>(random.integer(1, 40))};
  const JobId id{std::to_string(jobs_submitted_ + 1)};
  if (coordinator_.disk().refuses()) {
    if (coordinator_.command(SubmitJob{id, shape, 0}))
      world_.fail("a job was taken that could not be stored");
    return world_.after(seconds(1), [this] { submit(); });
  }
  ++jobs_submitted_;
  world_.note(
      fmt::format("job {}: {}x{}, {} spp", id.value, shape.window.width(), shape.window.height(), shape.spp));
  pixel_samples_ += shape.grid().tile_count() * 4096.0 * shape.spp;
  // Where there are audits, machines that are put aside, or cannot build a scene, are none to count on.
  const bool enough_can_die = names_.size() >= kLossesUntilFailure && !stuck_for_good_;
  if (enough_can_die && random.chance(0.05) && !audited_.any()) {
    make_deadly(id, shape);
  } else if (random.chance(0.05) && !audited_.any()) {
    make_unbuildable(id);
  } else if (enough_can_die && slow_.chance(0.05) && !audited_.any()) {
    make_endless(id, shape);
  }
  if (!coordinator_.command(SubmitJob{id, shape, random.integer(0, 1), any_limit()}))
    world_.fail("a job was refused");
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

void Farm::make_endless(const JobId& id, const JobShape& shape) {
  const int tile = slow_.integer(0, shape.grid().tile_count() - 1);
  const auto first = static_cast<std::uint32_t>(slow_.integer(0, static_cast<int>(shape.spp) - 1));
  const auto count = static_cast<std::uint32_t>(slow_.integer(1, 8));
  world_.note(fmt::format("job {} never ends from sample {} of tile {} on", id.value, first, tile));
  for (const auto& machine : machines_)
    machine->never_ends(id, {tile, {first, std::min(first + count, shape.spp)}});
  if (endless_jobs_.empty()) start_anew_who_is_at_no_end();
  endless_jobs_.insert(id);
}

// Somebody looks at the machines from time to time; most often soon, else after more than an hour.
void Farm::start_anew_who_is_at_no_end() {
  world_.after(seconds(slow_.chance(0.7) ? slow_.real(150, 400) : 4200), [this] {
    for (const auto& machine : machines_) {
      if (!machine->is_at_no_end()) continue;
      machine->crash();
      machine->start();
    }
    start_anew_who_is_at_no_end();
  });
}

void Farm::make_unbuildable(const JobId& id) {
  const bool by_all = world_.random.chance(0.5);
  world_.note(fmt::format("job {} cannot be built by {}", id.value, by_all ? "anyone" : "the last machine"));
  for (const auto& machine : machines_) {
    if (by_all || machine == machines_.back()) machine->cannot_build(id);
  }
  (by_all || machines_.size() == 1 ? unbuildable_jobs_ : doubtful_jobs_).insert(id);
}

// From now on there are no faults. Whatever is down comes up, whatever is paused goes on, and jobs may have
// all workers: one with a limit might be left to the slowest.
void Farm::calm_down() {
  calm_ = true;
  world_.note("calm");
  world_.make_network(0, 0, 0.1);
  coordinator_.disk().refuse(Duration::zero());
  coordinator_.start();
  for (const JobView& job : coordinator_.jobs()) {
    if (job.state == JobState::kPaused) coordinator_.command(ResumeJob{job.id});
    if (job.max_workers > 0) coordinator_.command(UpdateJob{job.id, {}, 0});
  }
  for (const auto& machine : machines_) machine->start();
}

// The first machine alone, with time for every fault to pass, every lease to run out, and every deadly range
// to have its victims: three machines, of which chance may take one again and again.
bool Farm::is_late() const {
  double bound = kUnrestSeconds + 120 + set_back_seconds_ + stuck_seconds_ +
                 800 * static_cast<double>(deadly_jobs_.size()) +
                 40'000 * static_cast<double>(endless_jobs_.size()) + 1.5 * pixel_samples_ / kFirstSpeed;
  // Everything is rendered twice, and what was spoilt once more; or nobody comes for it.
  if (audited_.any()) bound += 200 + 6 * pixel_samples_ / kFirstSpeed;
  return elapsed() > bound;
}

// A job fails by itself if and only if it has samples that nobody survives, or comes to an end with, and
// nobody claims to have rendered, or its scene is said not to be buildable; or if chance made three machines
// stuck.
void Farm::check_failures() {
  for (const auto& [id, failure] : coordinator_.failures()) {
    const bool guilty = deadly_jobs_.contains(id) || endless_jobs_.contains(id) ||
                        unbuildable_jobs_.contains(id) || doubtful_jobs_.contains(id) ||
                        liar_.refused().contains(id) || stuck_names_.size() >= kLossesUntilFailure;
    if (!guilty) world_.fail(fmt::format("job {} failed, but nobody dies of it: {}", id.value, failure));
  }
  for (const JobView& job : coordinator_.jobs()) {
    const bool cannot_be_done =
        deadly_jobs_.contains(job.id) || endless_jobs_.contains(job.id) || unbuildable_jobs_.contains(job.id);
    if (cannot_be_done && job.state == JobState::kDone && !liar_.has_delivered())
      world_.fail(fmt::format("job {} is done, but nobody can have rendered it", job.id.value));
  }
}

// ---- What goes wrong ----

void Farm::fault() {
  const int kind = world_.random.integer(0, 19);
  if (kind < 7) return machine_fault(any_machine(), kind);
  if (kind < 15) return coordinator_fault(kind);
  if (kind == 15) return power_failure();
  if (kind >= 18) return get_stuck(any_machine());
  for (int i = 0; i < 5; ++i) liar_.speak(jobs_submitted_, any_machine().worker_id());
}

void Farm::machine_fault(WorkerMachine& machine, int kind) {
  Random& random = world_.random;
  const auto start_later = [&] {
    world_.after(seconds(random.real(0, 20)), [&machine] { machine.start(); });
  };
  switch (kind) {
    case 0:
    case 1:
      machine.crash();
      return start_later();
    case 2:
      return machine.hang(seconds(random.real(0, 40)));
    case 3:
      machine.stop();
      return start_later();
    case 4:
    case 5:
      return machine.slow_down(100, seconds(random.real(0, 40)));
    default:
      return machine.cut_off(seconds(random.real(0, 30)));
  }
}

// Most for good; but not those that are to bring the farm to its end, or to die for it.
void Farm::get_stuck(WorkerMachine& machine) {
  const bool needed = &machine == machines_[0].get() || (audited_.any() && &machine == machines_[1].get());
  const bool for_good = world_.random.chance(0.7) && !needed && deadly_jobs_.empty() && endless_jobs_.empty();
  stuck_names_.insert(machine.name());
  stuck_for_good_ |= for_good;
  const double longest = needed ? 60 : 300;
  const double stuck = for_good ? 1e6 : world_.random.real(0, longest);
  // Its leases end after ten lease durations, and it may be given others: after one bar, and another.
  stuck_seconds_ += needed ? longest : 700;
  machine.get_stuck(seconds(stuck));
}

void Farm::coordinator_fault(int kind) {
  Random& random = world_.random;
  switch (kind) {
    case 7:
    case 8:
    case 9:
      if (coordinator_.up()) coordinator_.crash();
      return world_.after(seconds(random.real(0, 15)), [this] { coordinator_.start(); });
    case 10:
      return coordinator_.stall(seconds(random.real(0, 25)));
    case 11:
      return coordinator_.clock_jumps(seconds(random.real(0.1, 600)));
    case 12: {
      const double back = random.real(0.1, 60);
      set_back_seconds_ += back;
      return coordinator_.clock_jumps(seconds(-back));
    }
    case 13:
      return coordinator_.disk().refuse(seconds(random.real(0, 20)));
    default:
      return coordinator_.dismiss_any();
  }
}

// Everything goes dark at once, and comes back one after the other.
void Farm::power_failure() {
  if (coordinator_.up()) coordinator_.crash();
  world_.after(seconds(world_.random.real(0, 10)), [this] { coordinator_.start(); });
  for (const auto& machine : machines_) {
    machine->crash();
    world_.after(seconds(world_.random.real(0, 10)), [machine = machine.get()] { machine->start(); });
  }
}

// ---- What users do ----

bool Farm::command(const char* what, const Event& event) {
  const bool taken = coordinator_.command(event);
  world_.note(fmt::format("user: {}{}", what, taken ? "" : " (refused, or not stored)"));
  return taken;
}

void Farm::resume_later(const JobId& id) {
  world_.after(seconds(world_.random.real(0, 10)), [this, id] {
    if (coordinator_.up()) command("resume", ResumeJob{id});
  });
}

void Farm::user() {
  if (!coordinator_.up()) return;
  Random& random = world_.random;
  const JobId id = any_job();
  switch (random.integer(0, 14)) {
    case 0:
      command("cancel", CancelJob{id});
      return;
    case 1:
      command("delete", DeleteJob{id});
      return;
    case 2:
      command("fail", FailJob{id, "it cannot be loaded"});
      return;
    case 3:
    case 4:
    case 5:
      command("pause", PauseJob{id});
      return resume_later(id);
    case 6:
      return submit();
    case 7:
      return odd_command(id);
    case 8:
      command("reprioritise", UpdateJob{id, random.integer(-2, 2), {}});
      return;
    case 9:
    case 10:
      command("limit", UpdateJob{id, {}, any_limit()});
      return;
    default:
      pixel_samples_ += 15 * 4096.0 * 60;
      command("extend", ExtendJob{id, static_cast<std::uint32_t>(random.integer(1, 60))});
  }
}

// What no picture has, or has already.
void Farm::odd_command(const JobId& id) {
  Random& random = world_.random;
  const JobShape empty{random.integer(-1, 0), 10, 1};
  if (coordinator_.command(SubmitJob{{"empty"}, empty, 0})) world_.fail("a picture of nothing was taken");
  for (const JobView& job : coordinator_.jobs()) {
    if (coordinator_.command(SubmitJob{job.id, job.shape, 0})) world_.fail("a job was taken twice");
  }
  command("extend", ExtendJob{id, 0});
  command("resume", ResumeJob{id});
}

FarmReport Farm::run() {
  set_up();
  FarmReport report;
  while (world_.step()) {
    ++report.events;
    if (calm_ && coordinator_.all_settled()) break;
    if (is_late()) world_.fail("jobs are not finished in time");
  }
  if (!world_.failure()) coordinator_.check_films();
  if (!world_.failure()) check_failures();
  if (world_.failure() && coordinator_.up()) world_.note("the farm:\n" + coordinator_.describe());
  report.failure = world_.failure();
  report.virtual_seconds = elapsed();
  return report;
}

}  // namespace

FarmReport simulate_farm(std::uint64_t seed, bool verbose) {
  if (seed % kCalmFarms == 0) return simulate_calm_farm(seed, verbose);
  return Farm(seed, verbose).run();
}

}  // namespace tessera::simulation
