// SPDX-License-Identifier: Apache-2.0
// Farms with a worker that delivers flipped bits with a valid checksum.
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

using scheduler::JobState;
using scheduler::SubmitJob;

scheduler::Options audited(double share) {
  scheduler::Options options;
  options.audit_share = share;
  options.audit_patience = seconds(200);
  return options;
}

class AuditScenario : public testing::Test {
 protected:
  WorkerMachine& machine(const std::string& name, double samples_per_second = 50'000) {
    machines_.push_back(std::make_unique<WorkerMachine>(world_, coordinator_, name, samples_per_second));
    machines_.back()->start();
    return *machines_.back();
  }
  void start() {
    coordinator_.start();
    ASSERT_TRUE(coordinator_.command(SubmitJob{{"job"}, kJob, 0}));
  }
  // When the job is done; 1000 if it is not.
  double run_until_done() {
    while (!coordinator_.all_settled() && elapsed() < 1000 && world_.step()) {
    }
    EXPECT_FALSE(world_.failure()) << *world_.failure();
    return elapsed();
  }
  void run_until(double time_seconds) {
    while (elapsed() < time_seconds && world_.step()) {
    }
    ASSERT_FALSE(world_.failure()) << *world_.failure();
  }
  double elapsed() const { return std::chrono::duration<double>(world_.now().time_since_epoch()).count(); }
  JobState state() const { return coordinator_.jobs()[0].state; }

  explicit AuditScenario(double share = 1) : coordinator_(world_, audited(share)) {}

  World world_{1, false};
  Coordinator coordinator_;
  std::vector<std::unique_ptr<WorkerMachine>> machines_;
};

TEST_F(AuditScenario, AnAuditOfEverythingCostsAsMuchAsTheRender) {
  start();
  for (const char* name : {"a", "b", "c"}) machine(name);
  EXPECT_LT(run_until_done(), kSlack * 2 * kJobSamples / 150'000 + 3);
}

TEST_F(AuditScenario, OneForgingWorkerOfThreeIsDetectedAndItsTilesAreRenderedAgain) {
  start();
  for (const char* name : {"a", "b"}) machine(name);
  machine("liar machine").lie(0.1);
  coordinator_.expect_liar("liar machine");
  EXPECT_LT(run_until_done(), 1000);
  EXPECT_EQ(state(), JobState::kDone);
  coordinator_.check_films();
  EXPECT_FALSE(world_.failure()) << *world_.failure();
  EXPECT_TRUE(coordinator_.is_quarantined("liar machine"));
}

// Of two workers that differ, it is unknown which is wrong; a third one decides.
TEST_F(AuditScenario, OneForgingWorkerOfTwoKeepsTheJobWaitingForAThird) {
  start();
  machine("a");
  machine("liar machine").lie(1);
  coordinator_.expect_liar("liar machine");
  run_until(300);
  EXPECT_EQ(state(), JobState::kRunning);
  EXPECT_GT(coordinator_.jobs()[0].samples_to_verify, 0u);
  machine("b");
  EXPECT_LT(run_until_done(), 1000);
  coordinator_.check_films();
  EXPECT_FALSE(world_.failure()) << *world_.failure();
}

TEST_F(AuditScenario, AFarmOfOneMachineIsDoneWithoutItsAuditsAfterAWhile) {
  start();
  machine("a");
  const double done = run_until_done();
  EXPECT_GT(done, kJobSamples / 50'000 + 100);
  EXPECT_LT(done, kSlack * kJobSamples / 50'000 + 250);
  EXPECT_EQ(state(), JobState::kDone);
}

// Without audits a lying worker is trusted until its results are rejected. Then all of its ranges are
// verified, also those of a done job.
class Quarantined : public AuditScenario, public testing::WithParamInterface<double> {
 protected:
  Quarantined() : AuditScenario(0) {}
};

TEST_P(Quarantined, TheSamplesOfAQuarantinedWorkerAreVerified) {
  start();
  for (const char* name : {"a", "b"}) machine(name);
  WorkerMachine& liar = machine("liar machine");
  liar.lie(1);
  coordinator_.expect_liar("liar machine");
  run_until(GetParam());
  EXPECT_EQ(state(), GetParam() > 100 ? JobState::kDone : JobState::kRunning);
  EXPECT_TRUE(coordinator_.spoilt("job"));
  coordinator_.quarantined({"liar machine", {liar.worker_id()}, "liar machine"});
  EXPECT_LT(run_until_done(), 1000);
  EXPECT_EQ(state(), JobState::kDone);
  EXPECT_FALSE(coordinator_.spoilt("job"));
}

INSTANTIATE_TEST_SUITE_P(WhileTheJobRunsAndAfter, Quarantined, testing::Values(8.0, 500.0));

}  // namespace
}  // namespace tessera::simulation
