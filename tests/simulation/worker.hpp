// SPDX-License-Identifier: Apache-2.0
// One machine that runs worker processes: renders its leases in virtual time, retries deliveries until they
// arrive, and can crash, hang or stop.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tests/simulation/coordinator.hpp"
#include "tests/simulation/world.hpp"

namespace tessera::simulation {

class WorkerMachine {
 public:
  // `host` is unique; `name` is the name of its workers, which two machines may share.
  WorkerMachine(World& world, Coordinator& coordinator, std::string host, double samples_per_second,
                std::string name = "");

  // Starts a worker process with a new id. If one is stopping, waits for its end; if one is running, does
  // nothing.
  void start();
  // kill -9
  void crash();
  // SIGSTOP for a while.
  void hang(Duration duration);
  // Hangs its render thread for a while; it sends heartbeats, and can be stopped. A restarted process does
  // not hang.
  void get_stuck(Duration duration);
  // Renders slower by this factor for a while.
  void slow_down(double factor, Duration duration);
  // Drops all messages from and to it during this time.
  void cut_off(Duration duration);
  // From now on these samples kill its processes, which are restarted after a while.
  void die_of(const scheduler::JobId& job, const scheduler::WorkItem& item);
  // From now on its processes hang in these samples, but send heartbeats.
  void never_ends(const scheduler::JobId& job, const scheduler::WorkItem& item);
  // Whether the running process hangs in such samples.
  bool is_at_no_end() const { return running_ && rendering_ && rendering_->endless; }
  // Whether any of its processes ever did.
  bool has_been_at_no_end() const { return has_been_at_no_end_; }
  // From now on it takes so long to fetch a job's scene, which it keeps.
  void fetch_slowly(Duration duration) { fetch_time_ = duration; }
  // From now on it reports to fetch the scene of every lease until the lease goes to others, and renders
  // nothing.
  void feign_fetching() { feigns_ = true; }
  // From now on its workers cannot build this job's scene, and give its leases back.
  void decline_reason(const scheduler::JobId& job) { unbuildable_.insert(job); }
  // From now on this share of its results has flipped bits.
  void lie(double share) { lies_ = share; }
  // From now on it calls with the individual credentials of this principal.
  void belong_to(const std::string& principal) { principal_ = principal; }
  // It says that it renders no layers, and must be given none.
  void lack_layers() { renders_layers_ = false; }
  // From now on it delivers many ranges in two parts.
  void split_ranges() { splits_ = true; }
  // SIGTERM: delivers its results, including a part of the current range, and stops.
  void stop();
  bool running() const { return running_; }
  double samples_per_second() const { return samples_per_second_; }
  // Of the leases that were rendered completely.
  double longest_lease_seconds() const { return longest_lease_seconds_; }
  const std::string& name() const { return name_; }
  // The id of the running worker, or of the last one.
  const std::string& worker_id() const { return id_; }

 private:
  struct Held {
    scheduler::LeaseId id;
    scheduler::JobId job;
    std::deque<scheduler::WorkItem> to_render;
    std::vector<scheduler::WorkItem> rendered;  // not yet passed to deliver()
    std::vector<scheduler::WorkItem> sent;      // not yet acknowledged
    double render_seconds = 0;                  // since the last delivery
    double lease_seconds = 0;                   // in total
    bool finished = false;
    scheduler::LeaseToken token{};
  };

  // Calls `what` in this process only, and not while it hangs.
  void later(Duration delay, std::function<void()> what);
  scheduler::WorkerInfo info() const;
  void synchronize();
  void take_reply(std::uint64_t call, const scheduler::Reply& reply);
  void send(const std::function<void()>& deliver);
  void fetch_what_is_new();
  bool is_here(const scheduler::JobId& job) const { return fetch_time_ == Duration{} || here_.contains(job); }
  std::set<scheduler::JobId> fetching() const;
  void render_next();
  void render_on();
  void rendered();
  void give_back(Held& held);
  std::vector<scheduler::Fingerprint> sums_of(const Held& held);
  std::deque<scheduler::WorkItem> in_pieces(const std::vector<scheduler::WorkItem>& items);
  void deliver(Held& held, bool finished, const std::string& decline_reason = "");
  void send_until_heard(std::uint64_t delivery);
  std::vector<scheduler::LeaseId> held_besides(const Held& held) const;
  void heard(std::uint64_t delivery, const std::optional<scheduler::Reply>& reply);
  void take_new(const scheduler::Reply& reply);
  void stop_as_told();
  void exit_if_idle();
  Held* find(scheduler::LeaseId id);
  struct Trap {
    scheduler::JobId job;
    scheduler::WorkItem item;
  };
  static bool any_holds(const std::vector<Trap>& traps, const scheduler::JobId& job,
                        const scheduler::WorkItem& item);
  void hand_back_current_range();

  // The current range. Each render has its own random factor on the machine's speed.
  struct Rendering {
    scheduler::LeaseId lease;
    scheduler::JobId job;
    scheduler::WorkItem item;
    double factor = 1;
    double samples_left = 0;
    double spent_seconds = 0;
    bool endless = false;
    scheduler::LeaseToken token{};
  };

  World& world_;
  Coordinator& coordinator_;
  const std::string host_;
  const std::string name_;
  const double samples_per_second_;
  // Its working habits, which differ between machines.
  const int wanted_leases_;
  const std::size_t items_per_delivery_;
  const bool takes_with_answers_;

  std::vector<Trap> deadly_, endless_;
  Duration fetch_time_{};
  bool feigns_ = false;
  std::set<scheduler::JobId> here_;
  double lies_ = 0;
  std::string principal_;  // empty without credentials
  bool splits_ = false;
  bool renders_layers_ = true;
  std::set<scheduler::JobId> unbuildable_;
  double longest_lease_seconds_ = 0;
  double slowness_ = 1;
  Time slow_until_{};
  Time cut_off_until_{};

  bool running_ = false;
  int process_ = 0;
  std::string id_;  // of the current process
  Time hung_until_{};
  Time stuck_until_{};
  bool has_been_at_no_end_ = false;
  bool stop_pending_ = false;  // takes effect after the hang
  bool stopping_ = false;
  bool start_again_ = false;
  std::set<scheduler::JobId> fetching_;
  std::optional<Rendering> rendering_;
  std::uint64_t call_ = 0;
  std::uint64_t deliveries_ = 0;
  std::vector<Held> held_;
  // Leases since the last call: received with answers to deliveries, and completely delivered.
  std::set<scheduler::LeaseId> just_given_, just_finished_;
  std::map<std::uint64_t, scheduler::SubmitResult> outbox_;
};

}  // namespace tessera::simulation
