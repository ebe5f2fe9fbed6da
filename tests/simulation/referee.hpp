// SPDX-License-Identifier: Apache-2.0
// Watches one scheduler from outside: what it says and does is compared with what was said and done before,
// by rules written here a second time. Knows nothing of the scheduler's insides. Complains to the world.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/scheduler/scheduler.hpp"
#include "tests/simulation/model_film.hpp"
#include "tests/simulation/world.hpp"

namespace tessera::simulation {

// By job: what has been counted.
using Films = std::map<scheduler::JobId, ModelFilm>;

class Referee {
 public:
  Referee(World& world, const Films& films, const scheduler::Options& options)
      : world_(world), films_(films), options_(options), audits_(options.audit_share > 0) {}

  // From now on samples that are done may be leased as well.
  void expect_audits() { audits_ = true; }

  // A new scheduler, to which no lease has been given yet.
  void restarted(std::uint32_t epoch);
  // A job that it was handed, in the state in which it was.
  void entered(const scheduler::JobId& id, scheduler::JobState state) { states_[id] = state; }
  void deleted(const scheduler::JobId& id) { states_.erase(id); }

  // An event has been handled at this time of the coordinator's clock; the films are not yet what they will
  // be.
  void handled(const scheduler::Event& event, const scheduler::Actions& actions, Time clock);
  // The jobs before an event and after it: none has more workers than it may have, unless it had so many
  // before.
  void counted(const std::vector<scheduler::JobView>& before, const std::vector<scheduler::JobView>& after);
  // Samples that its films lack must be accepted, others dropped; and who else was rendering them must hear.
  void judged(const scheduler::SubmitResult& event, const scheduler::Actions& actions);
  // The films are what they should be.
  void settled(const scheduler::Actions& actions, const scheduler::Scheduler& scheduler, Time clock);
  // The worker is told this with the answer to its result. After settled(): what the result has disproved may
  // be leased again, and is out of the films by then.
  void told_with_answer(const scheduler::SubmitResult& event, const scheduler::Reply& reply);
  // Nothing need have happened.
  void look_around(const scheduler::Scheduler& scheduler, Time clock);

  // What this worker's call is waiting with.
  void parked(const scheduler::WorkerId& worker, const scheduler::Reply& reply);
  void answered(const scheduler::WorkerId& worker);

 private:
  void check_reply(const scheduler::Event& event, const scheduler::Reply& reply);
  void check_lease(const scheduler::LeaseDescription& lease, bool may_be_new, std::uint64_t highest_before);
  void check_items(const scheduler::LeaseDescription& lease);
  void check_arrow(const scheduler::JobChange& change);
  void check_progress(const scheduler::WorkerId& worker, const scheduler::Reply& reply);
  void check_given_up(const scheduler::JobId& job) const;
  void note_progress(const scheduler::SubmitResult& event, const scheduler::Actions& actions);
  Duration longest_without_progress(const scheduler::WorkerId& worker, const scheduler::Reply& reply) const;
  void note_delivered(const scheduler::WorkerId& worker, const scheduler::JobId& job,
                      const scheduler::WorkItem& item);
  std::uint64_t samples_in_film(const scheduler::JobView& job) const;

  World& world_;
  const Films& films_;
  const scheduler::Options options_;
  bool audits_;
  std::map<scheduler::JobId, scheduler::JobState> states_;
  // The coordinator's clock as the scheduler must take it: it never goes back.
  Time clock_{};
  // When this scheduler was first handed anything, and when any of a job was last rendered, or rendered
  // again, or given to somebody of whom nothing speaks against it.
  std::optional<Time> began_;
  std::map<scheduler::JobId, Time> last_helped_;
  // Who was given leases of the job before, or has said that it cannot build it.
  std::set<std::pair<scheduler::WorkerId, scheduler::JobId>> tried_;
  std::map<scheduler::WorkerId, scheduler::Synchronize> last_call_;
  std::map<scheduler::WorkerId, Time> last_heard_;
  std::map<scheduler::WorkerId, scheduler::Reply> waiting_;
  // Those of them that are about to ask again.
  std::set<scheduler::WorkerId> woken_;
  // Leases that the worker has been told of or has told of.
  std::set<std::pair<scheduler::WorkerId, scheduler::LeaseId>> known_;
  // What a worker holds of a job, as it was last told, and since when nothing has come of it.
  struct Held {
    Time since;
    std::vector<scheduler::WorkItem> items;
  };
  std::map<std::pair<scheduler::WorkerId, scheduler::JobId>, Held> held_without_progress_;
  // The most time for a sample of a pixel that the worker has said it took.
  std::map<scheduler::WorkerId, double> slowest_seconds_;
  // The highest lease given, in all runs.
  std::uint64_t highest_given_ = 0;
};

// What a refused event must leave as it was.
std::string fingerprint(const scheduler::Scheduler& scheduler, Time clock);

}  // namespace tessera::simulation
