// SPDX-License-Identifier: Apache-2.0
// The transitions of docs/protocol.md, and no others.
#include <gtest/gtest.h>

#include <set>
#include <utility>
#include <vector>

#include "server/scheduler/job.hpp"
#include "server/scheduler/job_state.hpp"
#include "server/scheduler/lease_state.hpp"
#include "server/scheduler/lease_table.hpp"
#include "server/scheduler/worker_state.hpp"

namespace tessera::scheduler {
namespace {

template <typename State>
void expect_transitions(const std::vector<State>& states,
                        const std::set<std::pair<State, State>>& transitions) {
  for (const State from : states) {
    for (const State to : states) {
      EXPECT_EQ(may_become(from, to), transitions.contains({from, to}))
          << static_cast<int>(from) << " to " << static_cast<int>(to);
    }
  }
}

TEST(Lifecycle, OfAJob) {
  using enum JobState;
  expect_transitions<JobState>({kRunning, kPaused, kDone, kCancelled, kFailed}, {{kRunning, kPaused},
                                                                                 {kPaused, kRunning},
                                                                                 {kRunning, kDone},
                                                                                 {kDone, kRunning},
                                                                                 {kRunning, kCancelled},
                                                                                 {kPaused, kCancelled},
                                                                                 {kRunning, kFailed},
                                                                                 {kPaused, kFailed}});
}

TEST(Lifecycle, OfAWorker) {
  using enum WorkerState;
  expect_transitions<WorkerState>({kPresent, kDraining, kSilent, kForgotten}, {{kPresent, kDraining},
                                                                               {kPresent, kSilent},
                                                                               {kDraining, kPresent},
                                                                               {kDraining, kSilent},
                                                                               {kSilent, kPresent},
                                                                               {kSilent, kDraining},
                                                                               {kSilent, kForgotten}});
}

TEST(Lifecycle, OfALease) {
  using enum LeaseState;
  std::set<std::pair<LeaseState, LeaseState>> transitions{{kGranted, kHeld}};
  for (const LeaseState end : {kDone, kReturned, kExpired, kStalled, kRevoked}) {
    transitions.insert({kGranted, end});
    transitions.insert({kHeld, end});
    EXPECT_FALSE(is_live(end));
  }
  expect_transitions<LeaseState>({kGranted, kHeld, kDone, kReturned, kExpired, kStalled, kRevoked},
                                 transitions);
}

TEST(LifecycleDeathTest, AnArrowThatIsNotDrawnEndsTheProcess) {
  Job job(1, {"job"}, {64, 64, 1}, {}, JobState::kCancelled, {});
  EXPECT_DEATH(job.become(JobState::kRunning), "a job went from cancelled to running");
  LeaseTable leases;
  leases.insert({{1}, {"worker"}, {{0, {0, 1}}}});
  leases.acknowledge({1});
  EXPECT_DEATH(leases.end({1}, LeaseState::kGranted), "a lease went from held to granted");
}

}  // namespace
}  // namespace tessera::scheduler
