// SPDX-License-Identifier: Apache-2.0
// Checks one scheduler from outside: compares its answers and actions with earlier ones by an independent
// implementation of the rules. Knows nothing of the scheduler's internals. Reports violations to the world.
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

// The accepted samples by job.
using Films = std::map<scheduler::JobId, ModelFilm>;

class Referee {
 public:
  Referee(World& world, const Films& films, const scheduler::Options& options)
      : world_(world), films_(films), options_(options), audits_(options.audit_share > 0) {}

  // From now on, samples that are done may be leased as well.
  void expect_audits() { audits_ = true; }

  // A new scheduler started, which has granted no lease yet.
  void restarted(std::uint32_t epoch);
  // The scheduler was given this job in this state.
  void entered(const scheduler::JobId& id, scheduler::JobState state) { states_[id] = state; }
  void deleted(const scheduler::JobId& id) { states_.erase(id); }

  // An event was handled at this time of the coordinator's clock; the films are not updated yet.
  void handled(const scheduler::Event& event, const scheduler::Actions& actions, Time clock);
  // The jobs before and after an event: none may exceed its limit on workers, unless it did so before.
  void counted(const std::vector<scheduler::JobView>& before, const std::vector<scheduler::JobView>& after);
  // The jobs or workers before and after an event: it must name those of which more than counters has
  // changed.
  void changed(const std::vector<scheduler::JobView>& before, const std::vector<scheduler::JobView>& after,
               const scheduler::Actions& actions);
  void changed(const std::vector<scheduler::WorkerView>& before,
               const std::vector<scheduler::WorkerView>& after, const scheduler::Actions& actions);
  // Missing samples must be accepted, and others dropped; other holders of the accepted samples must be
  // woken.
  void judged(const scheduler::SubmitResult& event, const scheduler::Actions& actions);
  // The films are updated.
  void settled(const scheduler::Actions& actions, const scheduler::Scheduler& scheduler, Time clock);
  // The worker receives this with the answer to its result. Called after settled(), since disproved samples
  // are out of the films by then and may be leased again.
  void told_with_answer(const scheduler::SubmitResult& event, const scheduler::Reply& reply);
  // May be called at any time.
  void look_around(const scheduler::Scheduler& scheduler, Time clock);

  // The reply with which this worker's call waits.
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
  // The coordinator's clock as the scheduler must see it: it never goes back.
  Time clock_{};
  // When this scheduler was first given anything, and when samples of a job were last rendered, audited, or
  // leased to a worker without known faults.
  std::optional<Time> began_;
  std::map<scheduler::JobId, Time> last_helped_;
  // Workers that were granted leases of the job, or reported not to be able to build it.
  std::set<std::pair<scheduler::WorkerId, scheduler::JobId>> tried_;
  std::map<scheduler::WorkerId, scheduler::Synchronize> last_call_;
  std::map<scheduler::WorkerId, Time> last_heard_;
  std::map<scheduler::WorkerId, scheduler::Reply> waiting_;
  // Workers that are about to ask again.
  std::set<scheduler::WorkerId> woken_;
  // Leases that the worker was told of or has reported.
  std::set<std::pair<scheduler::WorkerId, scheduler::LeaseId>> known_;
  // A worker's leases of a job as last told, and since when no result of them has counted.
  struct Held {
    Time since;
    std::vector<scheduler::WorkItem> items;
  };
  std::map<std::pair<scheduler::WorkerId, scheduler::JobId>, Held> held_without_progress_;
  // The maximum time per pixel sample that the worker has reported.
  std::map<scheduler::WorkerId, double> slowest_seconds_;
  // The highest lease id granted, over all runs.
  std::uint64_t highest_given_ = 0;
};

// The state that a refused event must not change.
std::string fingerprint(const scheduler::Scheduler& scheduler, Time clock);

}  // namespace tessera::simulation
