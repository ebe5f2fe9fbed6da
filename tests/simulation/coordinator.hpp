// SPDX-License-Identifier: Apache-2.0
// A coordinator around the real scheduler: parks calls, counts results into model films, checkpoints, crashes
// and starts again. After every event the scheduler's own invariants are checked, and a referee's.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include "server/scheduler/scheduler.hpp"
#include "tests/simulation/disk.hpp"
#include "tests/simulation/model_film.hpp"
#include "tests/simulation/referee.hpp"
#include "tests/simulation/world.hpp"

namespace tessera::simulation {

class Coordinator {
 public:
  using Answer = std::function<void(const scheduler::Reply&)>;

  explicit Coordinator(World& world, const scheduler::Options& options = {});
  // Its results may be wrong, and others may be disproved by nobody.
  void expect_liar(const std::string& host) { liars_.insert(host); }

  void start();
  // Forgets everything but what is stored.
  void crash();
  bool up() const { return scheduler_ != nullptr; }
  // Does nothing until then; what arrives meanwhile waits.
  void stall(Duration duration);
  // Its clock, and no other, goes forward or back.
  void clock_jumps(Duration by);
  Disk& disk() { return disk_; }

  // ---- What arrives over the network; lost while it is down ----
  void synchronize(const scheduler::Synchronize& request, const Answer& answer);
  // The answer may have the leases that the worker should hold.
  using ResultAnswer = std::function<void(const std::optional<scheduler::Reply>&)>;
  void submit_result(const scheduler::SubmitResult& result, const ResultAnswer& answer);

  // A user's command. Must be up. Returns whether it was taken and stored.
  bool command(const scheduler::Event& event);
  // As after too many refused results.
  void quarantined(const scheduler::Producer& producer);
  bool is_quarantined(const std::string& machine) const { return machines_aside_.contains(machine); }
  // Whether there are wrong bits in the job's film.
  bool spoilt(const std::string& job) const { return films_.at({job}).spoilt_tile().has_value(); }
  // Takes away all that a worker holds that was heard of lately; which one, chance says.
  void dismiss_any();

  std::vector<scheduler::JobView> jobs() const { return scheduler_->jobs(clock()); }
  std::vector<scheduler::WorkerView> workers() const { return scheduler_->workers(clock()); }
  // Of a tile of a job that was submitted at some time: every worker knows the picture's size.
  double tile_pixels(const scheduler::JobId& job, int tile) const {
    return shapes_.at(job).grid().rect(tile).pixel_count();
  }
  std::string describe() const { return fingerprint(*scheduler_, clock()); }
  // Jobs that failed without a user's command, with the sentences.
  const std::map<scheduler::JobId, std::string>& failures() const { return failures_; }
  // Every job is done, cancelled or failed, and those that are done have every sample exactly once.
  bool all_settled() const;
  void check_films();

 private:
  struct Parked {
    std::uint64_t call = 0;
    Answer answer;
  };
  // What is still to be written of a checkpoint that is under way.
  struct Checkpoint {
    std::vector<std::pair<scheduler::JobId, JobRow>> rows;
    std::vector<std::pair<scheduler::JobId, int>> tiles;
    std::size_t written = 0;
    double batch_seconds = 0;
  };

  Time clock() const { return world_.now() + clock_error_; }
  bool delayed(const std::function<void()>& again);
  scheduler::Actions handle(const scheduler::Event& event);
  void restore(const Disk::StoredJob& job);
  // ---- Audits (coordinator_audits.cpp) ----
  void follow_audits(const scheduler::Actions& actions);
  void empty_tiles(const scheduler::Actions& actions);
  void reopen_later(const scheduler::JobId& job);
  bool is_refused(const scheduler::WorkerInfo& worker) const;
  bool is_expected_liar(const scheduler::WorkerId& worker) const;
  void note_refusal(const scheduler::WorkerId& worker);
  void check_bits();
  static bool counts(const scheduler::Actions& actions);
  void check_holders(const scheduler::Event& event, const scheduler::Actions& actions);
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
  // Which start of the coordinator this is: the scheduler's epoch.
  std::uint32_t run_ = 0;
  std::unique_ptr<scheduler::Scheduler> scheduler_;
  Duration clock_error_{};
  Time stalled_until_{};
  std::optional<Time> next_tick_;
  std::uint64_t calls_ = 0;
  std::uint64_t revisions_ = 0;
  std::map<scheduler::WorkerId, Parked> parked_;
  // To whom each lease was given first; survives restarts.
  std::map<scheduler::LeaseId, scheduler::WorkerId> holders_;
  std::set<std::string> liars_;
  std::set<scheduler::WorkerId> workers_aside_;
  std::set<std::string> machines_aside_;
  int refused_ = 0;
  std::set<scheduler::JobId> to_reopen_;
  std::set<scheduler::JobId> unaudited_;  // of some ranges, since the clock had jumped; survives restarts
  std::map<scheduler::JobId, scheduler::JobShape> shapes_;
  Films films_;
  Referee referee_;
  std::map<scheduler::JobId, std::string> failures_;
};

// Workers whose names begin with this are no honest ones.
inline constexpr const char* kLiar = "liar";
bool is_liar(const scheduler::WorkerId& worker);

}  // namespace tessera::simulation
