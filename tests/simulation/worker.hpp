// One machine that runs workers: renders what it is leased in virtual time, delivers until it is heard, and
// can crash, hang, or stop as it should.
#pragma once

#include <deque>
#include <map>
#include <string>
#include <vector>

#include "tests/simulation/coordinator.hpp"
#include "tests/simulation/world.hpp"

namespace tessera::simulation {

class WorkerMachine {
 public:
  WorkerMachine(World& world, Coordinator& coordinator, std::string name, double samples_per_second);

  // Starts a worker process with an id of its own; if one is stopping, when it has stopped; if one runs, not.
  void start();
  // kill -9
  void crash();
  // SIGSTOP for a while.
  void hang(Duration duration);
  // From now on its processes die when they come to this item's samples, and are started again after a while.
  void die_of(const scheduler::JobId& job, const scheduler::WorkItem& item);
  // SIGTERM: delivers what it has rendered of its leases, also of the range it is at, and stops.
  void stop();
  bool running() const { return running_; }
  double samples_per_second() const { return samples_per_second_; }

 private:
  struct Held {
    scheduler::LeaseId id;
    scheduler::JobId job;
    std::deque<scheduler::WorkItem> to_render;
    std::vector<scheduler::WorkItem> rendered;  // not yet handed to deliver()
    std::vector<scheduler::WorkItem> sent;      // not yet acknowledged
    double render_seconds = 0;
    bool finished = false;
  };

  // Calls `what` in this process only, and not while it hangs.
  void later(Duration delay, std::function<void()> what);
  void synchronize();
  void take_reply(std::uint64_t call, const scheduler::Reply& reply);
  void render_next();
  void rendered(scheduler::LeaseId lease, scheduler::JobId job, scheduler::WorkItem item,
                double render_seconds);
  void deliver(Held& held, bool finished);
  void send_until_heard(std::uint64_t delivery);
  void heard(std::uint64_t delivery);
  void exit_if_idle();
  Held* find(scheduler::LeaseId id);
  double render_seconds(const scheduler::WorkItem& item);
  bool deadly(const scheduler::JobId& job, const scheduler::WorkItem& item) const;
  void hand_back_current_range();

  struct Deadly {
    scheduler::JobId job;
    scheduler::WorkItem item;
  };

  World& world_;
  Coordinator& coordinator_;
  const std::string name_;
  const double samples_per_second_;
  // How it likes to work; different for each machine.
  const int wanted_leases_;
  const std::size_t items_per_delivery_;

  std::vector<Deadly> deadly_;

  bool running_ = false;
  int process_ = 0;
  std::string id_;  // of this process
  Time hung_until_{};
  bool stop_pending_ = false;  // comes when it no longer hangs
  bool stopping_ = false;
  bool start_again_ = false;
  bool rendering_ = false;
  Time render_started_{};
  std::uint64_t call_ = 0;
  std::uint64_t deliveries_ = 0;
  std::vector<Held> held_;
  std::map<std::uint64_t, scheduler::SubmitResult> outbox_;
};

}  // namespace tessera::simulation
