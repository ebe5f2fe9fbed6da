// A coordinator around the real scheduler: parks calls, counts results into model films, checkpoints, crashes
// and starts again. After every event the scheduler's invariants are checked.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include "server/scheduler/scheduler.hpp"
#include "tests/simulation/model_film.hpp"
#include "tests/simulation/world.hpp"

namespace tessera::simulation {

class Coordinator {
 public:
  using Answer = std::function<void(const scheduler::Reply&)>;

  explicit Coordinator(World& world);

  void start();
  // Forgets everything but what is stored.
  void crash();
  bool up() const { return scheduler_ != nullptr; }
  // Does nothing until then; what arrives meanwhile waits.
  void stall(Duration duration);

  // ---- What arrives over the network; lost while it is down ----
  void synchronize(const scheduler::Synchronize& request, const Answer& answer);
  void submit_result(const scheduler::SubmitResult& result, const std::function<void()>& answer);

  // A user's command. Must be up. Returns whether it was taken; what was taken is stored at once.
  bool command(const scheduler::Event& event);

  std::vector<scheduler::JobView> jobs() const { return scheduler_->jobs(world_.now()); }
  // Jobs that failed without a user's command, with the sentences.
  const std::map<scheduler::JobId, std::string>& failures() const { return failures_; }
  // Every job is done, cancelled or failed, and those that are done have every sample exactly once.
  bool all_settled() const;
  void check_films();

 private:
  struct Stored {
    scheduler::JobShape shape;
    int priority = 0;
    scheduler::JobState state = scheduler::JobState::kRunning;
    ModelFilm film;
  };
  struct Parked {
    std::uint64_t call = 0;
    Answer answer;
  };

  bool delayed(const std::function<void()>& again);
  scheduler::Actions handle(const scheduler::Event& event);
  void wake(const scheduler::WorkerId& worker);
  void answer_parked(const scheduler::WorkerId& worker, std::uint64_t call);
  void tick_when_due();
  void checkpoint();
  void checkpoint_regularly(std::uint64_t run);
  void store_jobs();

  World& world_;
  // Which start of the coordinator this is: the scheduler's epoch.
  std::uint32_t run_ = 0;
  std::unique_ptr<scheduler::Scheduler> scheduler_;
  Time stalled_until_{};
  std::optional<Time> next_tick_;
  std::uint64_t calls_ = 0;
  // What a liar said it holds: a result that its true holder sends once more may then be refused.
  std::set<scheduler::LeaseId> claimed_;
  std::map<scheduler::WorkerId, Parked> parked_;
  std::map<scheduler::JobId, ModelFilm> films_;
  std::map<scheduler::JobId, std::string> failures_;

  // Survives a crash. Jobs in the order of submission.
  std::vector<std::pair<scheduler::JobId, Stored>> stored_;
};

}  // namespace tessera::simulation
