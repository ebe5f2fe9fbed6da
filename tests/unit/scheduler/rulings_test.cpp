// SPDX-License-Identifier: Apache-2.0
// The consequences of audits, and of distrust of a worker.
#include "tests/unit/scheduler/audited_farm.hpp"

namespace tessera::scheduler {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using enum JobState;

struct Rulings : AuditsOf {
  Rulings() : AuditsOf(1) {}
};
struct WithoutAudits : AuditsOf {
  WithoutAudits() : AuditsOf(0) {}
};

TEST_F(Rulings, QuarantineAForgingWorkerBySentence) {
  submit("job", tiles(4, 1));
  const LeaseDescription lease = lease_to("liar");
  deliver_sums("liar", lease, wrong);
  const LeaseDescription by_b = lease_to("b");
  const Actions contradicted = deliver_sums("b", by_b, {by_b.items[0]}, honest, false);
  ASSERT_EQ(contradicted.contradictions.size(), 1u);
  EXPECT_THAT(contradicted.contradictions[0],
              HasSubstr("liar and b have rendered different bits of samples [0, 1) of tile 0"));
  EXPECT_THAT(contradicted.disproved, IsEmpty());
  // Contradicted ranges come first.
  const LeaseDescription by_c = lease_to("c");
  ASSERT_EQ(by_c.items[0], by_b.items[0]);
  const Actions decided = deliver_sums("c", by_c, {by_c.items[0]}, honest, false);
  ASSERT_EQ(decided.disproved.size(), 1u);
  EXPECT_EQ(decided.disproved[0].producer, (Producer{"liar", {"liar"}, "liar"}));
  EXPECT_EQ(
      decided.disproved[0].because,
      "it rendered different bits of samples [0, 1) of tile 0 (pixels [0, 64) x [0, 64)) of job job than b "
      "and c");
  EXPECT_THAT(decided.dropped_tiles, ElementsAre(TileOfJob{{"job"}, 0}));
  EXPECT_EQ(scheduler_->done({"job"}, 0), IntervalSet{});
  EXPECT_EQ(worker("liar").disproved_ranges, 1u);

  render_together({{"b", honest}, {"c", honest}});
  EXPECT_EQ(state("job"), kDone);
  EXPECT_EQ(job("job").samples_done, job("job").samples_total);
}

TEST_F(Rulings, QuarantineContradictingWorkers) {
  submit("job", tiles(2, 1));
  deliver_sums("a", lease_to("a"), honest);
  const LeaseDescription lie = lease_to("liar");
  deliver_sums("liar", lie, {lie.items[0]}, wrong, false);
  const LeaseDescription third = lease_to("c");
  const Actions decided = deliver_sums("c", third, {lie.items[0]}, honest, false);
  ASSERT_EQ(decided.disproved.size(), 1u);
  EXPECT_EQ(decided.disproved[0].producer.name, "liar");
  EXPECT_THAT(decided.dropped_tiles, IsEmpty());
  EXPECT_EQ(worker("liar").held_leases, 0);
}

// Two lying workers with different sums do not confirm each other.
TEST_F(Rulings, NeedTwoThatAgree) {
  submit("job", tiles(2, 1));
  const auto lie_otherwise = [](const WorkItem& item) {
    Fingerprint total = honest(item);
    total.add(sums(99));
    return total;
  };
  deliver_sums("liar", lease_to("liar"), wrong);
  deliver_sums("other liar", lease_to("other liar"), lie_otherwise);
  render("b");
  EXPECT_EQ(state("job"), kRunning);
  EXPECT_EQ(job("job").samples_done, job("job").samples_total);
  render_together({{"b", honest}, {"c", honest}});
  EXPECT_EQ(state("job"), kDone);
  EXPECT_GE(worker("liar").disproved_ranges, 1u);
  EXPECT_GE(worker("other liar").disproved_ranges, 1u);
}

TEST_F(WithoutAudits, SamplesOfAQuarantinedWorkerAreVerified) {
  submit("job", tiles(100, 2));
  const LeaseDescription lies = lease_to("liar");
  deliver_sums("liar", lies, wrong);
  deliver_sums("a", lease_to("a"), honest);
  EXPECT_EQ(job("job").samples_to_verify, 0u);
  const Actions actions = handle(Dismiss{{"liar"}, true});
  EXPECT_EQ(actions.reviewed_tiles.size(), lies.items.size());
  EXPECT_EQ(job("job").samples_to_verify, lies.items.size() * kTilePixels);
  // Results of other workers of its machine still count, but must be verified.
  const Reply late = *handle(Synchronize{{{"late"}, "another name", "0.1.0", 1, "liar"}, {}, 1}).reply;
  const LeaseDescription more_lies = late.leases.at(0);
  deliver_sums("late", more_lies, wrong);
  EXPECT_EQ(job("job").samples_to_verify, (lies.items.size() + more_lies.items.size()) * kTilePixels);
  render_together({{"a", honest}, {"b", honest}, {"c", honest}});
  EXPECT_EQ(state("job"), kDone);
  EXPECT_GE(worker("liar").disproved_ranges, 1u);
}

TEST_F(WithoutAudits, ADoneJobRunsAgainWhenItsWorkersAreDoubted) {
  submit("job", tiles(2, 1));
  deliver_sums("liar", lease_to("liar"), wrong);
  render("liar", wrong);
  ASSERT_EQ(state("job"), kDone);
  const Actions quarantined = handle(Dismiss{{"liar"}, true});
  EXPECT_THAT(quarantined.reopen, ElementsAre(JobId{"job"}));
  const Actions reopened = handle(ReopenJob{{"job"}});
  EXPECT_THAT(reopened.job_changes, ElementsAre(JobChange{{"job"}, kDone, kRunning}));
  EXPECT_EQ(reopened.reviewed_tiles.size(), 2u);
  EXPECT_EQ(job("job").samples_to_verify, job("job").samples_total);
  // The job waits without a timeout, until an auditor registers.
  pass(seconds(1000));
  tick();
  EXPECT_EQ(state("job"), kRunning);
  render_together({{"a", honest}, {"b", honest}});
  EXPECT_EQ(state("job"), kDone);
}

// Anybody can take a name.
TEST_F(WithoutAudits, DoubtsAboutAWorkerAreNotHeldAgainstOthersOfItsName) {
  submit("job", tiles(2, 4));
  const LeaseDescription by_honest = lease_to("honest");
  deliver_sums("honest", by_honest, honest);
  handle(Synchronize{{{"liar"}, "honest", "0.1.0", 1, "liar"}, {}, 1});
  handle(Dismiss{{"liar"}, true});
  EXPECT_EQ(job("job").samples_to_verify, 0u);
  render("honest");
  EXPECT_EQ(job("job").samples_to_verify, 0u);
}

TEST_F(WithoutAudits, ADoneJobOfTrustedWorkersStaysDone) {
  submit("job", tiles(2, 1));
  sync("bad", {}, 0);
  render("a");
  EXPECT_THAT(handle(Dismiss{{"bad"}, true}).reopen, IsEmpty());
  EXPECT_TRUE(handle(ReopenJob{{"job"}}).job_changes.empty());
}

// A dropped tile loses also the samples of the same result.
TEST_F(WithoutAudits, ATileIsDroppedWithWhatTheSameResultBrought) {
  submit("job", tiles(2, 2));
  restart();
  const LeaseDescription before{LeaseId{7}, {"job"}, {}};
  deliver_sums("liar", before, {{0, {0, 1}}}, wrong);
  sync("liar", {}, 0);
  handle(Dismiss{{"liar"}, true});
  const LeaseDescription first = lease_to("a");
  ASSERT_EQ(first.items[0], (WorkItem{0, {0, 1}}));
  deliver_sums("a", first, honest);
  const LeaseDescription second = lease_to("b");
  ASSERT_EQ(second.items[0], (WorkItem{0, {0, 1}}));
  const Actions actions = deliver_sums("b", second, {{0, {1, 2}}, {0, {0, 1}}}, honest);
  EXPECT_THAT(actions.verdicts, ElementsAre(Verdict::kDropped, Verdict::kAudited));
  EXPECT_THAT(actions.dropped_tiles, ElementsAre(TileOfJob{{"job"}, 0}));
  EXPECT_EQ(scheduler_->done({"job"}, 0), IntervalSet{});
}

}  // namespace
}  // namespace tessera::scheduler
