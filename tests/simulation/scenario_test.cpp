// SPDX-License-Identifier: Apache-2.0
// Farms with a single fault, and bounds on its cost.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/simulation/coordinator.hpp"
#include "tests/simulation/ordinary_job.hpp"
#include "tests/simulation/worker.hpp"

namespace tessera::simulation {
namespace {

using scheduler::JobShape;
using scheduler::JobState;
using scheduler::JobView;
using scheduler::SubmitJob;

class FarmScenario : public testing::Test {
 protected:
  FarmScenario() { coordinator_.start(); }

  WorkerMachine& machine(double samples_per_second) {
    const std::string name = "m" + std::to_string(machines_.size());
    machines_.push_back(std::make_unique<WorkerMachine>(world_, coordinator_, name, samples_per_second));
    machines_.back()->start();
    return *machines_.back();
  }
  WorkerMachine& machine_at(int number) {
    while (machines_.size() <= static_cast<std::size_t>(number)) machine(50'000);
    return *machines_[static_cast<std::size_t>(number)];
  }
  void submit(const std::string& id, const JobShape& shape, std::uint32_t max_workers = 0) {
    ASSERT_TRUE(coordinator_.command(SubmitJob{{id}, shape, 0, max_workers}));
  }
  void run_until(double time_seconds) {
    while (elapsed() < time_seconds && world_.step()) {
    }
    ASSERT_FALSE(world_.failure()) << *world_.failure();
  }
  // When the first job is done.
  double run_until_one_is_done(double at_most_seconds = 1000) {
    const auto one_is_done = [&] {
      for (const JobView& job : coordinator_.jobs()) {
        if (job.state == JobState::kDone) return true;
      }
      return false;
    };
    while (!one_is_done() && elapsed() < at_most_seconds && world_.step()) {
    }
    EXPECT_FALSE(world_.failure()) << *world_.failure();
    return elapsed();
  }
  double elapsed() const { return std::chrono::duration<double>(world_.now().time_since_epoch()).count(); }

  World world_{1, false};
  Coordinator coordinator_{world_};
  std::vector<std::unique_ptr<WorkerMachine>> machines_;
};

TEST_F(FarmScenario, AStragglerDoesNotHoldUpTheEnd) {
  machine(500);
  machine(50'000);
  submit("job", kJob);
  EXPECT_LT(run_until_one_is_done(), kSlack * kJobSamples / 50'000 + 1);
}

TEST_F(FarmScenario, ALostWorkerCostsAtMostItsLeaseTime) {
  machine(50'000);
  WorkerMachine& dying = machine(50'000);
  submit("job", kJob);
  run_until(5);
  dying.crash();
  EXPECT_LT(run_until_one_is_done(), kSlack * kJobSamples / 50'000 + 11);
}

TEST_F(FarmScenario, ARestartOfTheCoordinatorCostsItsAbsenceAndTwoSeconds) {
  machine(50'000);
  machine(50'000);
  submit("job", kJob);
  run_until(8);
  coordinator_.crash();
  run_until(12);
  coordinator_.start();
  // The downtime, the samples accepted since the checkpoint, and the time until workers call again.
  EXPECT_LT(run_until_one_is_done(), kSlack * kJobSamples / 100'000 + 4 + 2 + 5);
}

TEST_F(FarmScenario, TwoWorkersAreNearlyTwiceAsFastAsOne) {
  machine(50'000);
  machine(50'000);
  submit("job", kJob);
  EXPECT_LT(run_until_one_is_done(), kSlack * kJobSamples / 100'000 + 1);
}

// Its render thread hangs, but it sends heartbeats, and no other worker may have the job.
TEST_F(FarmScenario, AStuckWorkerHoldsUpTheJobThatItHasAloneForAHundredSeconds) {
  WorkerMachine& stuck = machine(50'000);
  submit("job", kJob, 1);
  run_until(5);
  stuck.get_stuck(seconds(1e6));
  run_until(6);
  machine(50'000);
  EXPECT_LT(run_until_one_is_done(), 6 + 105 + kSlack * kJobSamples / 50'000);
  EXPECT_GT(elapsed(), 6 + 95);
}

// A sample of one tile takes it five minutes, which the scheduler cannot know.
TEST_F(FarmScenario, AVerySlowFarmLosesNoWork) {
  machine(4096 / 300.0);
  submit("job", {64, 64, 8});
  EXPECT_LT(run_until_one_is_done(8000), kSlack * 8 * 300 + 400);
}

// The machines of this farm are killed by one sample in the middle of a job, repeatedly.
TEST_F(FarmScenario, ARangeThatKillsItsWorkersEndsItsJobAndNoOther) {
  std::vector<WorkerMachine*> machines;
  for (int i = 0; i < 3; ++i) machines.push_back(&machine(50'000));
  for (WorkerMachine* machine : machines) machine->die_of({"deadly"}, {5, {9, 10}});
  submit("deadly", kJob);
  submit("other", kJob);
  run_until(1000);
  const auto jobs = coordinator_.jobs();
  EXPECT_EQ(jobs[0].state, JobState::kFailed);
  EXPECT_THAT(jobs[0].failure,
              testing::HasSubstr("3 workers died one after the other while they rendered "
                                 "samples [9, 10) of tile 5 (pixels [64, 128) x [64, 128))"));
  EXPECT_EQ(jobs[1].state, JobState::kDone);
}

// The machines of this farm hang in one sample in the middle of a job. One of them is spared, unless it was
// given a copy.
TEST_F(FarmScenario, ARangeThatNeverEndsEndsItsJobAndNoOther) {
  for (int i = 0; i < 4; ++i) machine(50'000).never_ends({"endless"}, {5, {9, 10}});
  submit("endless", kJob);
  submit("other", kJob);
  run_until(600);
  const auto jobs = coordinator_.jobs();
  EXPECT_EQ(jobs[0].state, JobState::kFailed);
  EXPECT_THAT(jobs[0].failure,
              testing::HasSubstr(" workers hung one after the other in "
                                 "samples [9, 10) of tile 5 (pixels [64, 128) x [64, 128))"));
  EXPECT_EQ(jobs[1].state, JobState::kDone);
}

// No sample of it is ever rendered, and so no range is tried by three workers.
TEST_F(FarmScenario, AJobOfWhichNothingEverEndsFailsToo) {
  for (int i = 0; i < 4; ++i) {
    for (int tile = 0; tile < 16; ++tile) machine_at(i).never_ends({"endless"}, {tile, {0, 32}});
  }
  submit("other", kJob);
  run_until_one_is_done();
  submit("endless", kJob);
  run_until(elapsed() + 150);
  EXPECT_EQ(coordinator_.jobs()[1].state, JobState::kFailed);
  EXPECT_THAT(coordinator_.jobs()[1].failure,
              testing::HasSubstr("workers hung in all samples of it that they held, and none has been "
                                 "rendered: m"));
}

// A machine that hangs in everything has never delivered, and fails no job.
TEST_F(FarmScenario, MachinesThatAreBrokenFailNoJob) {
  for (int i = 0; i < 3; ++i) machine(50'000).get_stuck(seconds(1e6));
  submit("job", kJob);
  run_until(1000);
  EXPECT_EQ(coordinator_.jobs()[0].state, JobState::kRunning);
  machine(50'000);
  run_until_one_is_done(2000);
  EXPECT_EQ(coordinator_.jobs()[0].state, JobState::kDone);
}

// Its leases go to others, and it is given new ones as soon as it can render them.
TEST_F(FarmScenario, ASlowDownloadGetsWorkOnceItHasTheScene) {
  WorkerMachine& slow = machine(50'000);
  slow.fetch_slowly(seconds(700));
  submit("job", {1024, 1024, 256}, 0);
  run_until(105);
  EXPECT_EQ(coordinator_.workers()[0].held_leases, 0) << "others may have them";
  run_until(695);
  EXPECT_EQ(coordinator_.workers()[0].held_leases, 0);
  run_until(710);
  EXPECT_GT(coordinator_.workers()[0].held_leases, 0);
  EXPECT_GT(coordinator_.workers()[0].samples_accepted, 0u);
}

// The samples are not to blame as long as workers die on one machine only.
TEST_F(FarmScenario, AMachineThatIsKilledAgainAndAgainFailsNoJob) {
  WorkerMachine& victim = machine(50'000);
  submit("job", kJob);
  for (int kills = 1; kills <= 10; ++kills) {
    run_until(12 * kills);
    victim.crash();
    victim.start();
  }
  run_until_one_is_done();
  EXPECT_EQ(coordinator_.jobs()[0].state, JobState::kDone);
}

TEST_F(FarmScenario, EqualJobsGetOnEqually) {
  for (const double speed : {3'000, 10'000, 30'000, 50'000}) machine(speed);
  for (const char* id : {"a", "b", "c"}) submit(id, kJob);
  run_until_one_is_done();
  for (const JobView& job : coordinator_.jobs()) {
    EXPECT_GT(static_cast<double>(job.samples_done), 0.8 * static_cast<double>(job.samples_total))
        << job.id.value;
  }
}

// It has one of four workers: others do not help it, and it does not keep its worker from other jobs.
TEST_F(FarmScenario, AJobWithALimitGetsItsShareAndItsEqualsTheRest) {
  for (int i = 0; i < 4; ++i) machine(20'000);
  submit("limited", kJob, 1);
  submit("equal", kJob);
  run_until(20);
  const auto jobs = coordinator_.jobs();
  // Renders take 0.7 to 1.3 times the nominal time.
  EXPECT_NEAR(static_cast<double>(jobs[0].samples_done), 20 * 20'000, 0.35 * 20 * 20'000);
  EXPECT_NEAR(static_cast<double>(jobs[1].samples_done), 60 * 20'000, 0.35 * 60 * 20'000);
}

TEST_F(FarmScenario, ALiftedLimitNotifiesAllIdleWorkers) {
  for (int i = 0; i < 4; ++i) machine(20'000);
  submit("job", kJob, 1);
  run_until(20);
  EXPECT_EQ(coordinator_.jobs()[0].active_workers, 1);
  ASSERT_TRUE(coordinator_.command(scheduler::UpdateJob{{"job"}, {}, 0}));
  run_until(21);
  EXPECT_EQ(coordinator_.jobs()[0].active_workers, 4);
  EXPECT_LT(run_until_one_is_done(), 20 + kSlack * (kJobSamples - 0.7 * 20 * 20'000) / 80'000 + 1);
}

TEST_F(FarmScenario, AJobThatIsGivenAHigherPriorityOvertakesItsEqual) {
  for (int i = 0; i < 3; ++i) machine(20'000);
  for (const char* id : {"a", "b"}) submit(id, kJob);
  run_until(10);
  ASSERT_TRUE(coordinator_.command(scheduler::UpdateJob{{"b"}, 1, {}}));
  run_until(22);  // leases from before the change, up to four for each job
  const auto before = coordinator_.jobs();
  run_until(32);
  const auto after = coordinator_.jobs();
  EXPECT_EQ(after[0].samples_done, before[0].samples_done);
  EXPECT_GT(static_cast<double>(after[1].samples_done - before[1].samples_done), 0.65 * 10 * 60'000);
}

}  // namespace
}  // namespace tessera::simulation
