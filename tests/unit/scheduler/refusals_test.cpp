// SPDX-License-Identifier: Apache-2.0
// Workers that cannot build a job's scene, and invalid reports of workers.
#include "tests/unit/scheduler/farm.hpp"

namespace tessera::scheduler {
namespace {

using enum JobState;

class Refusals : public Farm {
 protected:
  void refuse(const std::string& worker, const LeaseDescription& lease) {
    SubmitResult given_back{{worker}, lease.job, lease.id, {}, 0, true};
    given_back.decline_reason = "out of memory";
    EXPECT_TRUE(handle(given_back).status);
  }
};

TEST_F(Refusals, AllThatThereAreCanRefuseWhileTheyHoldLeases) {
  submit("job", tiles(100, 8));
  LeaseDescription of_a = lease_to("a");
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(state("job"), kRunning);
    refuse("b", lease_to("b"));
  }
  EXPECT_EQ(state("job"), kRunning) << "a may be able to";
  refuse("a", of_a);
  EXPECT_EQ(state("job"), kFailed);
}

TEST_F(Refusals, AWorkerThatHoldsALeaseMayBeAbleToWhateverOthersOfItsNameSay) {
  submit("job", tiles(100, 8));
  const auto greet = [&](const std::string& id) {
    return handle(Synchronize{{{id}, "render", "0.1.0", 1}, {}, 1, false}).reply->leases.at(0);
  };
  greet("able");
  for (int i = 0; i < 5; ++i) refuse("unable", greet("unable"));
  EXPECT_EQ(state("job"), kRunning);
}

TEST_F(Refusals, OfOneCallersWorkersFailNoJobThatOthersMayBuild) {
  submit("job", tiles(100, 8));
  const auto lease_as = [&](const std::string& id, const std::string& name, const std::string& principal) {
    const WorkerInfo info{{id}, name, "0.1.0", 1, "", principal};
    return handle(Synchronize{info, {}, 1}).reply->leases.at(0);
  };
  const LeaseDescription of_honest = lease_as("honest", "honest", "b");
  for (int i = 0; i < 6; ++i) {
    const std::string made_up = std::to_string(i);
    refuse(made_up, lease_as(made_up, i == 0 ? "honest" : made_up, "a"));
  }
  EXPECT_EQ(state("job"), kRunning);
  refuse("honest", of_honest);
  EXPECT_EQ(state("job"), kFailed);
}

TEST_F(Refusals, WhatAWorkerCannotBuildComesAfterWhatItCan) {
  submit("bad", tiles(100, 8), 1);
  submit("good", tiles(2, 1));
  lease_to("other");  // of the bad job, so that the refusals have no consequence yet
  refuse("w", lease_to("w"));
  const LeaseDescription good = lease_to("w");
  EXPECT_EQ(good.job, JobId{"good"}) << "though the other is of higher priority";
  deliver("w", good);
  EXPECT_EQ(lease_to("w").job, JobId{"bad"}) << "where there is nothing else";
}

TEST_F(Refusals, ARefusalIsForgottenAfterTheLeaseTime) {
  submit("bad", tiles(100, 8), 1);
  submit("good", tiles(100, 8));
  lease_to("other");
  refuse("w", lease_to("w"));
  pass(seconds(9));
  sync("other");
  const LeaseDescription good = lease_to("w");
  EXPECT_EQ(good.job, JobId{"good"});
  deliver("w", good);
  pass(seconds(1));
  EXPECT_EQ(lease_to("w").job, JobId{"bad"});
}

TEST_F(Refusals, ReportedTimesDoNotStarveAJob) {
  submit("slandered", tiles(100, 32));
  submit("other", tiles(100, 32));
  for (const double time : {1e308, 1e300, 1e-300, 1e308}) {
    const LeaseDescription lease = lease_to("liar");
    deliver("liar", {lease.id, {"slandered"}, {}}, {{99, {31, 32}}}, false, time);
  }
  // Other workers report correctly, and both jobs make progress.
  for (int i = 0; i < 60; ++i) deliver("w", lease_to("w"));
  const double slandered = static_cast<double>(job("slandered").samples_done);
  EXPECT_GT(slandered, 0.3 * static_cast<double>(job("other").samples_done));
}

TEST_F(Refusals, SamplesThatAJobHadBeforeACrashAreDroppedAndNotHeldAgainstTheirWorker) {
  submit("job", tiles(2, 1));
  handle(ExtendJob{{"job"}, 4});
  const LeaseDescription lease = lease_to("w");
  ++options_.epoch;
  start_again({{{"job"}, tiles(2, 1), 0, kRunning, "", std::vector<IntervalSet>(2)}});
  const Actions late = deliver("w", lease, {{0, {0, 1}}, {0, {1, 4}}});
  EXPECT_TRUE(late.status);
  EXPECT_EQ(late.verdicts, (std::vector{Verdict::kAccepted, Verdict::kDropped}));
  // This run has granted no such samples.
  EXPECT_FALSE(deliver("w", lease_to("w"), {{0, {1, 4}}}).status);
  EXPECT_FALSE(deliver("w", lease, {{2, {1, 4}}}).status) << "no tile of it";
}

}  // namespace
}  // namespace tessera::scheduler
