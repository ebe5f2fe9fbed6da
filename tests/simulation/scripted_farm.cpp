// SPDX-License-Identifier: Apache-2.0
#include "tests/simulation/scripted_farm.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/simulation/coordinator.hpp"
#include "tests/simulation/model_sums.hpp"
#include "tests/simulation/world.hpp"

namespace tessera::simulation {

using namespace scheduler;

namespace {

// Workers call three times in a lease time.
constexpr double kHeartbeatSeconds = 3;
// After this time without a call a worker is lost.
constexpr double kSilenceSeconds = 12;
// By this time a checkpoint has stored everything.
constexpr double kStoredSeconds = 4;
// By this time a done job whose samples must be verified runs again.
constexpr double kReopenedSeconds = 2.5;
constexpr int kMaxRounds = 1000;
// The bits in which wrong sums differ.
constexpr std::uint64_t kLie = 0x5a5a00;

// A worker whose every step is told.
class Puppet {
 public:
  Puppet(Coordinator& coordinator, const std::string& host, const std::string& principal, int wanted = 1)
      : coordinator_(coordinator), wanted_(wanted) {
    info_.id = {"1." + host + ".1"};
    info_.name = host;
    info_.version = "0.1.0";
    info_.machine = host;
    info_.origin = info_.principal = principal;
    info_.individual = !principal.empty();
    coordinator_.introduce(info_);
  }

  const WorkerInfo& info() const { return info_; }
  void want(int leases) { wanted_ = leases; }
  bool holds_any() const { return !held_.empty(); }

  // Reports its leases, and takes those that it is given.
  void call() {
    coordinator_.synchronize({.worker = info_, .held = held_, .wanted_leases = wanted_},
                             [this](const Reply& reply) { held_ = reply.leases; });
  }
  // Delivers all that it holds, and keeps what the coordinator does not take. With `lie`, all sums are wrong.
  void deliver(bool lie = false) {
    for (const LeaseDescription& lease : std::vector<LeaseDescription>(held_)) {
      SubmitResult result{info_.id, lease.job, lease.id, lease.items, 1, true, "", {}, {}, lease.token};
      for (const WorkItem& item : lease.items)
        result.fingerprints.push_back(wrong_sums(lease.job, item, lie ? kLie : 0));
      result.principal = info_.principal;
      coordinator_.submit_result(result, [this, id = lease.id](const std::optional<Reply>&) {
        std::erase_if(held_, [id](const LeaseDescription& held) { return held.id == id; });
      });
    }
  }
  // Its process starts again and has lost everything.
  void forget() { held_.clear(); }

 private:
  Coordinator& coordinator_;
  WorkerInfo info_;
  int wanted_;
  std::vector<LeaseDescription> held_;
};

Options options_of(double audit_share) {
  Options options;
  options.audit_share = audit_share;
  return options;
}

class ScriptedFarm {
 public:
  ScriptedFarm(std::uint64_t seed, bool verbose, double audit_share)
      : world_(seed, verbose), coordinator_(world_, options_of(audit_share)) {
    coordinator_.start();
  }

  FarmReport report() {
    if (!world_.failure()) coordinator_.check_films();
    return {world_.failure(), elapsed(), events_, coordinator_.digest()};
  }

  void presumed_dead_and_alive();
  void the_last_auditor_leaves();
  void a_principal_is_quarantined();
  void a_result_comes_before_its_worker();
  void a_crash_follows_a_quarantine();
  void results_wait_for_long();

 private:
  double elapsed() const { return std::chrono::duration<double>(world_.now().time_since_epoch()).count(); }
  // Lets the time pass. `present` call meanwhile.
  void pass(double duration, const std::vector<Puppet*>& present = {});
  JobView job(const std::string& id) const;
  JobShape small_job();
  void expect_state(const std::string& id, JobState state);
  // These render and deliver until the job is over.
  void finish(const std::string& id, const std::vector<Puppet*>& workers);
  // A job of which `liar` has delivered one lease, with wrong sums.
  void begin_with_lie(Puppet& liar);

  World world_;
  Coordinator coordinator_;
  std::uint64_t events_ = 0;
};

void ScriptedFarm::pass(double duration, const std::vector<Puppet*>& present) {
  const double end = elapsed() + duration;
  while (elapsed() < end && !world_.failure()) {
    for (Puppet* const each : present) each->call();
    bool is_over = false;
    world_.after(seconds(std::min(kHeartbeatSeconds, end - elapsed() + 0.001)), [&] { is_over = true; });
    while (!is_over && world_.step()) ++events_;
  }
}

JobView ScriptedFarm::job(const std::string& id) const {
  for (const JobView& view : coordinator_.jobs())
    if (view.id == JobId{id}) return view;
  return {};
}

JobShape ScriptedFarm::small_job() {
  const int side_px = world_.random.integer(20, 90);
  return {side_px, side_px, static_cast<std::uint32_t>(world_.random.integer(2, 6))};
}

void ScriptedFarm::expect_state(const std::string& id, JobState state) {
  if (world_.failure()) return;
  const JobView view = job(id);
  if (view.state != state)
    world_.fail(
        fmt::format("job {} is {} instead of {}", id, job_state_name(view.state), job_state_name(state)));
}

void ScriptedFarm::finish(const std::string& id, const std::vector<Puppet*>& workers) {
  pass(kReopenedSeconds);
  for (int round = 0; job(id).state == JobState::kRunning && !world_.failure(); ++round) {
    if (round == kMaxRounds) return world_.fail(fmt::format("job {} is not finished in time", id));
    for (Puppet* const worker : workers) {
      worker->call();
      worker->deliver();
    }
    pass(0.1);
  }
}

// Three workers in succession take the same samples, are silent for too long, and return: nobody has died.
void ScriptedFarm::presumed_dead_and_alive() {
  coordinator_.command(SubmitJob{{"1"}, small_job()});
  std::vector<Puppet> workers;
  for (int i = 0; i < 4; ++i)
    workers.emplace_back(coordinator_, fmt::format("m{}", i), fmt::format("p{}", i));
  Puppet& witness = workers.back();
  witness.want(0);
  for (int i = 0; i < 3; ++i) {
    Puppet& absent = workers[static_cast<std::size_t>(i)];
    absent.call();
    absent.call();  // it has its leases
    pass(kSilenceSeconds, {&witness});
    absent.forget();
    absent.want(0);
    absent.call();
    witness.call();
  }
  expect_state("1", JobState::kRunning);
  witness.want(1);
  finish("1", {&witness});
  expect_state("1", JobState::kDone);
}

// Only one worker could audit, and it is busy elsewhere when its machine fails.
void ScriptedFarm::the_last_auditor_leaves() {
  Puppet producer(coordinator_, "m0", "p0"), auditor(coordinator_, "m1", "p1");
  coordinator_.command(SubmitJob{{"large"}, {512, 512, 64}});
  auditor.call();
  auditor.call();
  coordinator_.command(SubmitJob{{"1"}, small_job(), 5});
  for (int round = 0; round < kMaxRounds && job("1").samples_done < job("1").samples_total; ++round) {
    producer.call();
    producer.deliver();
    auditor.call();
    pass(0.1);
  }
  producer.want(0);
  expect_state("1", JobState::kRunning);
  pass(kSilenceSeconds, {&producer});
  pass(std::chrono::duration<double>(Options().audit_patience).count() + kHeartbeatSeconds, {&producer});
  expect_state("1", JobState::kDone);
}

void ScriptedFarm::begin_with_lie(Puppet& liar) {
  coordinator_.expect_liar(liar.info().name);
  coordinator_.command(SubmitJob{{"1"}, small_job()});
  liar.call();
  liar.call();
  if (!liar.holds_any()) world_.fail("a worker was given nothing");
}

// A worker is quarantined: what another one of its principal has rendered must be verified.
void ScriptedFarm::a_principal_is_quarantined() {
  Puppet liar(coordinator_, "m0", "shared"), accused(coordinator_, "m1", "shared");
  Puppet first(coordinator_, "m2", "p2"), second(coordinator_, "m3", "p3");
  begin_with_lie(liar);
  liar.deliver(true);
  accused.want(0);
  accused.call();
  coordinator_.quarantined(producer_of(accused.info()));
  finish("1", {&first, &second});
  expect_state("1", JobState::kDone);
}

// After a restart a result is counted before its worker has called; then its principal is quarantined.
void ScriptedFarm::a_result_comes_before_its_worker() {
  Puppet liar(coordinator_, "m0", "shared"), accused(coordinator_, "m1", "shared");
  Puppet first(coordinator_, "m2", "p2"), second(coordinator_, "m3", "p3");
  begin_with_lie(liar);
  pass(kStoredSeconds, {&liar});
  coordinator_.crash();
  coordinator_.start();
  liar.deliver(true);
  accused.want(0);
  accused.call();
  coordinator_.quarantined(producer_of(accused.info()));
  finish("1", {&first, &second});
  expect_state("1", JobState::kDone);
}

// The quarantine is stored, and no tile since: what the worker has rendered must still be verified.
void ScriptedFarm::a_crash_follows_a_quarantine() {
  Puppet liar(coordinator_, "m0", "p0"), first(coordinator_, "m2", "p2"), second(coordinator_, "m3", "p3");
  begin_with_lie(liar);
  liar.deliver(true);
  pass(kStoredSeconds, {&first, &second});
  coordinator_.quarantined(producer_of(liar.info()));
  coordinator_.save_fleet();
  coordinator_.crash();
  coordinator_.start();
  first.forget();
  second.forget();
  finish("1", {&first, &second});
  expect_state("1", JobState::kDone);
}

// For longer than a worker may hold leases without progress.
void ScriptedFarm::results_wait_for_long() {
  Puppet worker(coordinator_, "m0", "p0");
  coordinator_.command(SubmitJob{{"1"}, small_job()});
  worker.call();
  worker.call();
  const Duration wait = 3 * patience(Options().lease_duration, 0);
  coordinator_.films_lack_memory(wait);
  const double end = elapsed() + std::chrono::duration<double>(wait).count();
  while (elapsed() + kHeartbeatSeconds < end && !world_.failure()) {
    worker.deliver();
    pass(kHeartbeatSeconds, {&worker});
    if (!worker.holds_any()) world_.fail("a worker has lost its leases while its results had to wait");
  }
  pass(kHeartbeatSeconds, {&worker});
  finish("1", {&worker});
  expect_state("1", JobState::kDone);
}

}  // namespace

FarmReport simulate_scripted_farm(std::uint64_t seed, bool verbose) {
  struct Script {
    void (ScriptedFarm::*run)();
    double audit_share;
  };
  // So small a share chooses nothing by lot.
  constexpr double kHardlyAny = 1e-12;
  static constexpr std::array<Script, kScripts> kAll{{
      {&ScriptedFarm::presumed_dead_and_alive, 0},
      {&ScriptedFarm::the_last_auditor_leaves, 1},
      {&ScriptedFarm::a_principal_is_quarantined, kHardlyAny},
      {&ScriptedFarm::a_result_comes_before_its_worker, kHardlyAny},
      {&ScriptedFarm::a_crash_follows_a_quarantine, kHardlyAny},
      {&ScriptedFarm::results_wait_for_long, 0},
  }};
  const Script& script = kAll[seed / 100 % kScripts];
  ScriptedFarm farm(seed, verbose, script.audit_share);
  (farm.*script.run)();
  return farm.report();
}

}  // namespace tessera::simulation
