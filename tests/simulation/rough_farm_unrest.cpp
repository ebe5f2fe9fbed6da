// SPDX-License-Identifier: Apache-2.0
// The faults and the users of a rough farm.
#include "tests/simulation/rough_farm.hpp"

namespace tessera::simulation {

using namespace scheduler;

// ---- Faults ----

void RoughFarm::fault() {
  const int kind = world_.random.integer(0, 19);
  if (kind < 7) return machine_fault(any_machine(), kind);
  if (kind < 15) return coordinator_fault(kind);
  if (kind == 15) return power_failure();
  if (kind >= 18) return get_stuck(any_machine());
  for (int i = 0; i < 5; ++i) liar_.speak(jobs_submitted_, any_machine().worker_id());
}

void RoughFarm::machine_fault(WorkerMachine& machine, int kind) {
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

// Most machines hang for good, except those that must complete the farm or be killed by it.
void RoughFarm::get_stuck(WorkerMachine& machine) {
  const bool needed = &machine == machines_[0].get() || (audited_.any() && &machine == machines_[1].get());
  const bool for_good = world_.random.chance(0.7) && !needed && deadly_jobs_.empty() && endless_jobs_.empty();
  stuck_names_.insert(machine.name());
  stuck_for_good_ |= for_good;
  const double longest = needed ? 60 : 300;
  const double stuck = for_good ? 1e6 : world_.random.real(0, longest);
  // Its leases end after ten lease durations, and it may be given others after each cooldown.
  stuck_seconds_ += needed ? longest : 700;
  machine.get_stuck(seconds(stuck));
}

void RoughFarm::coordinator_fault(int kind) {
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

// Everything stops at once, and restarts one after the other.
void RoughFarm::power_failure() {
  if (coordinator_.up()) coordinator_.crash();
  world_.after(seconds(world_.random.real(0, 10)), [this] { coordinator_.start(); });
  for (const auto& machine : machines_) {
    machine->crash();
    world_.after(seconds(world_.random.real(0, 10)), [machine = machine.get()] { machine->start(); });
  }
}

// ---- Users ----

bool RoughFarm::command(const char* what, const Event& event) {
  const bool taken = coordinator_.command(event);
  world_.note(fmt::format("user: {}{}", what, taken ? "" : " (refused, or not stored)"));
  return taken;
}

void RoughFarm::resume_later(const JobId& id) {
  world_.after(seconds(world_.random.real(0, 10)), [this, id] {
    if (coordinator_.up()) command("resume", ResumeJob{id});
  });
}

void RoughFarm::user() {
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
      extend(id);
  }
}

// As a whole, some tiles of it, or both. The job may not have them.
void RoughFarm::extend(const JobId& id) {
  constexpr int kMaxTiles = 3 * 5 * 4;
  pixel_samples_ += kMaxTiles * 4096.0 * 60;
  ExtendJob event{id, static_cast<std::uint32_t>(world_.random.integer(1, 60))};
  if (images_.chance(0.3)) {
    for (int i = images_.integer(1, 3); i > 0; --i)
      event.tiles.push_back({images_.integer(-1, 9), static_cast<std::uint32_t>(images_.integer(0, 60))});
    if (images_.chance(0.7)) event.spp = 0;
  }
  command("extend", event);
}

// Values that no image has, or that it has already.
void RoughFarm::odd_command(const JobId& id) {
  Random& random = world_.random;
  const JobShape empty{random.integer(-1, 0), 10, 1};
  if (coordinator_.command(SubmitJob{{"empty"}, empty, 0})) world_.fail("an empty image was accepted");
  for (const JobView& job : coordinator_.jobs()) {
    if (coordinator_.command(SubmitJob{job.id, job.shape, 0})) world_.fail("a job was taken twice");
  }
  command("extend", ExtendJob{id, 0});
  command("resume", ResumeJob{id});
}

}  // namespace tessera::simulation
