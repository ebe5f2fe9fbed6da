// SPDX-License-Identifier: Apache-2.0
// A farm with random faults, followed by a time without faults in which every job must complete. A
// deterministic function of the seed.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "tests/simulation/administrator.hpp"
#include "tests/simulation/coordinator.hpp"
#include "tests/simulation/farm.hpp"
#include "tests/simulation/liar.hpp"
#include "tests/simulation/worker.hpp"
#include "tests/simulation/world.hpp"

namespace tessera::simulation {

// The patience for auditors.
inline constexpr double kAuditPatienceSeconds = 200;

// Two of five farms have audits. They use a random generator of their own, so that the other farms stay the
// same.
struct AuditedFarm {
  explicit AuditedFarm(std::uint64_t seed) : random(seed ^ 0xa0d17) {
    if (!random.chance(0.4)) return;
    options.audit_share = random.chance(0.6) ? 1 : random.real(0.01, 1);
    options.audit_patience = seconds(kAuditPatienceSeconds);
  }
  bool any() const { return options.audit_share > 0; }

  Random random;
  scheduler::Options options;
};

// In one of four farms an event does as little as it can of what can wait, so that what is left of others is
// seen in small farms as well.
inline scheduler::Options with_little_work_per_event(std::uint64_t seed, scheduler::Options options) {
  if (Random(seed ^ 0x11771e).chance(0.25)) options.per_event = {1, 1, 1, 1, 1, 1};
  return options;
}

class RoughFarm {
 public:
  RoughFarm(std::uint64_t seed, bool verbose)
      : world_(seed, verbose),
        slow_(seed ^ 0x510),
        images_(seed ^ 0x1a6e5),
        principals_(seed ^ 0x9a1c),
        layers_(seed ^ 0x1a7e5),
        audited_(seed),
        coordinator_(world_, with_little_work_per_event(seed, audited_.options)),
        liar_(world_, coordinator_),
        administrator_(world_, coordinator_, seed) {}

  FarmReport run();

 private:
  // ---- Start and end ----
  void set_up();
  void add_machine(int number);
  bool make_slow(WorkerMachine& machine);
  void set_up_audits();
  void set_up_principals();
  void calm_down();
  void leave_for_a_while(WorkerMachine& machine, int times);
  bool is_late() const;
  void check_failures();

  // ---- Jobs ----
  void submit();
  // Several images, and targets of single tiles, in some jobs.
  void vary(scheduler::JobShape& shape);
  void make_deadly(const scheduler::JobId& id, const scheduler::JobShape& shape);
  void make_endless(const scheduler::JobId& id, const scheduler::JobShape& shape);
  void restart_hung_workers();
  void make_unbuildable(const scheduler::JobId& id);

  // ---- Faults ----
  void fault();
  void machine_fault(WorkerMachine& machine, int kind);
  void get_stuck(WorkerMachine& machine);
  void coordinator_fault(int kind);
  void power_failure();

  // ---- Users ----
  void user();
  bool command(const char* what, const scheduler::Event& event);
  void resume_later(const scheduler::JobId& id);
  void odd_command(const scheduler::JobId& id);
  void extend(const scheduler::JobId& id);

  scheduler::JobId any_job() { return {std::to_string(world_.random.integer(1, jobs_submitted_ + 1))}; }
  // A limit on workers; usually none.
  std::uint32_t any_limit() {
    return world_.random.chance(0.6) ? 0 : static_cast<std::uint32_t>(world_.random.integer(1, 4));
  }
  WorkerMachine& any_machine() {
    return *machines_[static_cast<std::size_t>(
        world_.random.integer(0, static_cast<int>(machines_.size()) - 1))];
  }
  double elapsed() const { return std::chrono::duration<double>(world_.now().time_since_epoch()).count(); }

  World world_;
  // Fetching and endless samples use a random generator of their own as well; and images and targets;
  // principals; and layers.
  Random slow_, images_, principals_, layers_;
  AuditedFarm audited_;
  Coordinator coordinator_;
  Liar liar_;
  Administrator administrator_;
  std::vector<std::unique_ptr<WorkerMachine>> machines_;
  // The names of machines that render.
  std::set<std::string> names_;
  int jobs_submitted_ = 0;
  double pixel_samples_ = 0;
  // How long the scheduler's time may stand still.
  double set_back_seconds_ = 0;
  // How long leases may be held by machines that render nothing, in total.
  double stuck_seconds_ = 0;
  bool stuck_for_good_ = false;
  // How often one of the two honest machines leaves after the faults.
  int absences_ = 0;
  // Enough of these names can fail a job.
  std::set<std::string> stuck_names_;
  // Jobs with samples that kill or hang every machine; whose scenes no machine can build; or some cannot.
  std::set<scheduler::JobId> deadly_jobs_, endless_jobs_, unbuildable_jobs_, doubtful_jobs_;
  bool calm_ = false;
};

}  // namespace tessera::simulation
