// SPDX-License-Identifier: Apache-2.0
#include "tests/simulation/rough_farm.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tessera::simulation {

using namespace scheduler;

namespace {

// Faults and user commands end at this time.
constexpr double kUnrestSeconds = 40;
// A straggler is a hundred times slower than the first machine.
constexpr double kFirstSpeed = 60'000, kStragglerSpeed = 600;
// A machine that comes and goes after the faults: each absence is shorter than the patience for auditors,
// also after an earlier one, but all of them together are longer.
constexpr int kAbsences = 3;
constexpr double kShortestAbsenceSeconds = 80, kLongestAbsenceSeconds = 150, kLongestVisitSeconds = 6;
static_assert(kUnrestSeconds + kLongestAbsenceSeconds < kAuditPatienceSeconds);
static_assert(kAbsences * kShortestAbsenceSeconds > kAuditPatienceSeconds);

}  // namespace

void RoughFarm::set_up() {
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
  administrator_.begin(kUnrestSeconds, audited_.any());
  world_.after(seconds(kUnrestSeconds), [this] { calm_down(); });
}

// Speeds differ by up to a factor of a hundred; the first machine is fast enough to complete every farm.
void RoughFarm::add_machine(int number) {
  Random& random = world_.random;
  double speed = number == 0 ? kFirstSpeed : 1'500 * std::pow(100, random.real(0, 1));
  if (number > 0 && random.chance(0.15)) speed = kStragglerSpeed;
  const std::string host = fmt::format("m{}", number);
  std::string name = random.chance(0.1) ? "render" : host;
  if (audited_.any() && number < 2) {  // these two must complete the farm together
    speed = kFirstSpeed;
    name = host;
  }
  machines_.push_back(std::make_unique<WorkerMachine>(world_, coordinator_, host, speed, name));
  const bool may_be_slow = number >= (audited_.any() ? 2 : 1);
  if (!may_be_slow || !make_slow(*machines_.back())) names_.insert(name);
  if (may_be_slow && layers_.chance(0.2)) {
    world_.note(host + " renders no layers");
    machines_.back()->lack_layers();
  }
  world_.after(seconds(random.real(0, 5)), [machine = machines_.back().get()] { machine->start(); });
}

// It has a slow line, or reports for ever that it fetches. Returns whether it is one that renders nothing at
// all.
bool RoughFarm::make_slow(WorkerMachine& machine) {
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

// The first two machines are honest, so that the others can be detected.
void RoughFarm::set_up_audits() {
  world_.note(fmt::format("{:.0f} % of ranges are audited", 100 * audited_.options.audit_share));
  for (std::size_t m = 0; m < machines_.size(); ++m) {
    machines_[m]->split_ranges();
    if (m < 2 || !audited_.random.chance(0.6)) continue;
    const std::string host = fmt::format("m{}", m);
    world_.note(host + " lies");
    machines_[m]->lie(audited_.random.real(0.05, 1));
    coordinator_.expect_liar(host);
  }
  if (audited_.random.chance(0.2)) absences_ = kAbsences;
  if (principals_.chance(0.5)) set_up_principals();
}

// The first two machines have credentials of their own, so that they are not quarantined with others.
void RoughFarm::set_up_principals() {
  for (std::size_t m = 0; m < machines_.size(); ++m) {
    const bool shares = m >= 2 && principals_.chance(0.6);
    const std::string principal = shares ? "studio" : fmt::format("owner of m{}", m);
    world_.note(fmt::format("m{} has the credentials of {}", m, principal));
    machines_[m]->belong_to(principal);
  }
}

// Ends all faults: starts what is down, resumes what is paused, and removes limits on workers, since a
// limited job might be left to the slowest machine. In some farms a machine still comes and goes.
void RoughFarm::calm_down() {
  calm_ = true;
  world_.note("calm");
  world_.make_network(0, 0, 0.1);
  coordinator_.disk().refuse(Duration::zero());
  coordinator_.start();
  for (const JobView& job : coordinator_.jobs()) {
    if (job.state == JobState::kPaused) coordinator_.command(ResumeJob{job.id});
    if (job.max_workers > 0) coordinator_.command(UpdateJob{job.id, {}, 0});
  }
  administrator_.calm_down();
  for (const auto& machine : machines_) machine->start();
  if (absences_ > 0) leave_for_a_while(*machines_[1], absences_);
}

// Repeats after a short presence.
void RoughFarm::leave_for_a_while(WorkerMachine& machine, int times) {
  machine.stop();
  world_.after(seconds(audited_.random.real(kShortestAbsenceSeconds, kLongestAbsenceSeconds)),
               [this, &machine, times] {
                 machine.start();
                 if (times == 1) return;
                 world_.after(seconds(audited_.random.real(1, kLongestVisitSeconds)),
                              [this, &machine, times] { leave_for_a_while(machine, times - 1); });
               });
}

// The time of the first machine alone, plus the time for all faults to pass, all leases to expire, and every
// deadly range to have its victims: three machines, of which chance may take one repeatedly.
bool RoughFarm::is_late() const {
  double bound = kUnrestSeconds + 120 + set_back_seconds_ + stuck_seconds_ +
                 800 * static_cast<double>(deadly_jobs_.size()) +
                 40'000 * static_cast<double>(endless_jobs_.size()) + 1.5 * pixel_samples_ / kFirstSpeed;
  // Everything is rendered twice, and wrong tiles once more; or there is no auditor.
  if (audited_.any())
    bound += kAuditPatienceSeconds + (6 + 3 * administrator_.lifts()) * pixel_samples_ / kFirstSpeed;
  bound += administrator_.delay_seconds();
  bound += absences_ * (kLongestAbsenceSeconds + kLongestVisitSeconds);
  return elapsed() > bound;
}

// A job fails by itself if and only if it has samples that kill or hang workers and that no hostile worker
// claims to have rendered, or its scene is reported as unbuildable, or chance made three machines hang.
void RoughFarm::check_failures() {
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

FarmReport RoughFarm::run() {
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
  report.digest = coordinator_.digest();
  return report;
}

}  // namespace tessera::simulation
