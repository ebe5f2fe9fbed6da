// SPDX-License-Identifier: Apache-2.0
// A model coordinator around the real scheduler: parks calls, adds results to model films, writes
// checkpoints, crashes and restarts. After every event, the scheduler's own invariants and those of a referee
// are checked.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include "server/scheduler/scheduler.hpp"
#include "tests/simulation/digest.hpp"
#include "tests/simulation/disk.hpp"
#include "tests/simulation/model_film.hpp"
#include "tests/simulation/quarantine.hpp"
#include "tests/simulation/referee.hpp"
#include "tests/simulation/world.hpp"

namespace tessera::simulation {

class Coordinator {
 public:
  using Answer = std::function<void(const scheduler::Reply&)>;

  explicit Coordinator(World& world, const scheduler::Options& options = {});
  // Its results may be wrong; no others may be disproved.
  void expect_liar(const std::string& host) { liars_.insert(host); }

  void start();
  // Loses everything that is not stored.
  void crash();
  bool up() const { return scheduler_ != nullptr; }
  // Does nothing during this time; messages wait.
  void stall(Duration duration);
  // Moves its clock, and no other, forward or back.
  void clock_jumps(Duration by);
  Disk& disk() { return disk_; }

  // The id belongs to this worker from now on: no other principal can call with it.
  void introduce(const scheduler::WorkerInfo& worker) { owners_[worker.id] = producer_of(worker); }

  // ---- Messages from the network; lost while it is down ----
  void synchronize(const scheduler::Synchronize& request, const Answer& answer);
  // The answer may have the leases that the worker should hold.
  using ResultAnswer = std::function<void(const std::optional<scheduler::Reply>&)>;
  void submit_result(const scheduler::SubmitResult& result, const ResultAnswer& answer);

  // A user's command. The coordinator must be up. Returns whether it was accepted and stored.
  bool command(const scheduler::Event& event);
  // Quarantines the worker, as after too many rejected results.
  void quarantined(const scheduler::Producer& producer);
  bool is_quarantined(const std::string& machine) const { return quarantine_.has_machine(machine); }
  // Whether the job's film has wrong samples.
  bool spoilt(const std::string& job) const { return !films_.at({job}).spoilt().empty(); }
  // Dismisses a random worker that is registered.
  void dismiss_any();

  // ---- What happens besides scheduling (coordinator_surroundings.cpp). It must be up, but for the memory
  // ----

  // Drains a registered worker, also after restarts; or stops it.
  void drain_any(Random& random);
  void undo_drains();
  // Lifts an entry of the quarantine, with those that belong to it. False if there is none.
  bool lift_any(Random& random);
  // Stores the quarantine, as every checkpoint does before it writes tiles, and every change by an
  // administrator.
  void save_fleet();
  // Takes no samples during this time: workers must deliver them again.
  void films_lack_memory(Duration duration);
  // The store has lost a tile of a job.
  void lose_a_tile(Random& random);
  // A job leaves the scheduler if it is finished and stored, until a user changes it.
  void release_any(Random& random);

  std::vector<scheduler::JobView> jobs() const { return scheduler_->jobs(clock()); }
  std::vector<scheduler::WorkerView> workers() const { return scheduler_->workers(clock()); }
  // The size of a tile of any job that was ever submitted: every worker knows the image's size.
  double tile_pixels(const scheduler::JobId& job, int tile) const {
    return shapes_.at(job).grid().rect(tile).pixel_count();
  }
  bool has_layers(const scheduler::JobId& job) const { return shapes_.at(job).has_layers; }
  std::string describe() const { return fingerprint(*scheduler_, clock()); }
  // Jobs that failed without a user's command, with the messages.
  const std::map<scheduler::JobId, std::string>& failures() const { return failures_; }
  // Whether every job is done, cancelled or failed, and the done ones have every sample exactly once.
  bool all_settled() const;
  std::uint64_t digest() const { return digest_.value(); }
  void check_films();

 private:
  struct Parked {
    std::uint64_t call = 0;
    Answer answer;
  };
  // What a checkpoint in progress still has to write.
  struct Checkpoint {
    std::vector<std::pair<scheduler::JobId, JobRow>> rows;
    std::vector<std::pair<scheduler::JobId, int>> tiles;
    std::size_t written = 0;
    double batch_seconds = 0;
  };

  Time clock() const { return world_.now() + clock_error_; }
  bool delayed(const std::function<void()>& again);
  scheduler::Actions handle(const scheduler::Event& event);
  // Lets the scheduler finish what is due, so that the next event does nothing else.
  void catch_up();
  void restore(const Disk::StoredJob& job);
  // ---- Audits (coordinator_audits.cpp) ----
  void follow_audits(const scheduler::Actions& actions);
  void empty_tiles(const scheduler::Actions& actions);
  void reopen_later(const scheduler::JobId& job);
  bool is_refused(const scheduler::WorkerInfo& worker);
  bool is_refused(const scheduler::SubmitResult& result) const;
  bool is_foreign(const scheduler::WorkerId& worker, const std::string& principal) const;
  std::optional<scheduler::WorkerInfo> registered(const scheduler::WorkerId& worker) const;
  void check_quarantined();
  bool is_expected_liar(const scheduler::WorkerId& worker) const;
  void note_refusal(const scheduler::WorkerId& worker);
  void check_bits();
  static bool counts(const scheduler::Actions& actions);
  void check_holders(const scheduler::Event& event, const scheduler::Actions& actions);
  bool must_drain_anew(const scheduler::WorkerId& worker) const;
  void drain(const scheduler::WorkerId& worker);
  void check_told(const scheduler::WorkerId& worker, std::uint64_t call);
  void check_drained(const scheduler::WorkerId& worker, const scheduler::Reply& reply, bool has_new,
                     bool is_answer);
  bool is_whole_on_disk(const scheduler::JobView& job) const;
  void bring_back(const scheduler::JobId& job);
  void park(const scheduler::WorkerId& worker, const scheduler::Reply& reply, const Answer& answer);
  void wake(const scheduler::WorkerId& worker);
  void answer_parked(const scheduler::WorkerId& worker, std::uint64_t call);
  void answer_now(const scheduler::WorkerId& worker, const scheduler::Reply& reply);
  void tick_when_due();
  void look_around(std::uint64_t run);
  JobRow row_of(const scheduler::JobId& id);
  bool submit(const scheduler::SubmitJob& event);
  bool remove(const scheduler::DeleteJob& event);
  void checkpoint(std::uint64_t run);
  void write_some(std::uint64_t run, Checkpoint checkpoint);
  bool write_tiles(Checkpoint& checkpoint);
  void finish(const Checkpoint& checkpoint);
  void compare(const scheduler::JobId& id, int tile);

  World& world_;
  Disk disk_;
  const scheduler::Options options_;
  // The number of this start of the coordinator: the scheduler's epoch.
  std::uint32_t run_ = 0;
  std::unique_ptr<scheduler::Scheduler> scheduler_;
  Duration clock_error_{};
  Time stalled_until_{};
  std::optional<Time> next_tick_;
  // The latest time that this scheduler was told.
  Time latest_{};
  std::uint64_t calls_ = 0;
  std::uint64_t revisions_ = 0;
  std::map<scheduler::WorkerId, Parked> parked_;
  // The worker to which each lease was granted first; survives restarts.
  std::map<scheduler::LeaseId, scheduler::WorkerId> holders_;
  std::set<std::string> liars_;
  Quarantine quarantine_;
  std::map<scheduler::WorkerId, scheduler::Producer> owners_;
  int refused_ = 0;
  std::set<scheduler::JobId> to_reopen_;
  // Jobs of which ranges were not audited because the clock had jumped; survives restarts.
  std::set<scheduler::JobId> unaudited_;
  // A worker that takes no more leases.
  struct Drained {
    bool stop = false;       // its process must end
    bool is_known = false;   // the scheduler was told
    bool has_reply = false;  // it has had a reply since
  };
  // Survives restarts.
  std::map<scheduler::WorkerId, Drained> drains_;
  Time lacks_film_memory_until_{};
  // Finished jobs that are on disk alone; survives restarts.
  std::set<scheduler::JobId> released_;
  std::map<scheduler::JobId, scheduler::JobShape> shapes_;
  Films films_;
  Referee referee_;
  Digest digest_;
  std::map<scheduler::JobId, std::string> failures_;
};

// The prefix of dishonest workers' names.
inline constexpr const char* kLiar = "liar";
bool is_liar(const scheduler::WorkerId& worker);

}  // namespace tessera::simulation
