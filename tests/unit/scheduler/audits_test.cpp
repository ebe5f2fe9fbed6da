// Who renders what again, and what comes of it.
#include "tests/unit/scheduler/farm.hpp"

namespace tessera::scheduler {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using enum JobState;

// Honest sums are linear in the number of samples, as a film's are.
Fingerprint honest(const WorkItem& item) {
  Fingerprint total;
  for (std::uint32_t s = item.samples.begin; s < item.samples.end; ++s)
    total.add(sums(1000 * static_cast<std::uint64_t>(item.tile + 1) + s));
  return total;
}

Fingerprint wrong(const WorkItem& item) {
  Fingerprint total = honest(item);
  total.add(sums(7));
  return total;
}

using Sums = Fingerprint (*)(const WorkItem&);

class AuditsOf : public Farm {
 protected:
  explicit AuditsOf(double share) : Farm(audited(share)) {}

  Actions deliver_sums(const std::string& worker, const LeaseDescription& lease,
                       const std::vector<WorkItem>& items, Sums sums_of, bool finished = true) {
    SubmitResult result{{worker}, lease.job, lease.id, items, 0.25, finished};
    for (const WorkItem& item : items) result.fingerprints.push_back(sums_of(item));
    return handle(result);
  }
  Actions deliver_sums(const std::string& worker, const LeaseDescription& lease, Sums sums_of) {
    return deliver_sums(worker, lease, lease.items, sums_of);
  }
  // Renders what it is given until it is given nothing.
  void render(const std::string& worker, Sums sums_of = honest) {
    for (int rounds = 0; rounds < 1000 && !HasFailure(); ++rounds) {
      const Reply reply = sync(worker);
      if (reply.leases.empty()) return;
      for (const LeaseDescription& lease : reply.leases) deliver_sums(worker, lease, sums_of);
    }
    ADD_FAILURE() << "there is no end to the work";
  }
  // Everybody in turn, until nobody is given anything.
  void render_together(const std::vector<std::pair<std::string, Sums>>& workers) {
    for (int rounds = 0; rounds < 1000 && state("job") == kRunning; ++rounds) {
      for (const auto& [worker, sums_of] : workers) {
        const Reply reply = sync(worker);
        for (const LeaseDescription& lease : reply.leases) deliver_sums(worker, lease, sums_of);
      }
    }
  }
  WorkerView worker(const std::string& id) {
    for (const WorkerView& view : scheduler_->workers(now_)) {
      if (view.info.id.value == id) return view;
    }
    return {};
  }

 private:
  static Options audited(double share) {
    Options options;
    options.audit_share = share;
    options.audit_secret = 17;
    // A first lease has up to 100,000 samples, of a small job all there are.
    options.sizing.first_lease_seconds = 2;
    options.sizing.end_divisor = 0.01;
    return options;
  }
};

struct Audits : AuditsOf {
  Audits() : AuditsOf(1) {}
};
struct WithoutAudits : AuditsOf {
  WithoutAudits() : AuditsOf(0) {}
};

TEST_F(Audits, AreForWorkersOfAnotherName) {
  submit("job", tiles(4, 1));
  const LeaseDescription rendered = lease_to("a");
  deliver_sums("a", rendered, honest);
  EXPECT_EQ(job("job").samples_done, job("job").samples_total);
  EXPECT_EQ(job("job").samples_to_verify, job("job").samples_total);
  EXPECT_EQ(state("job"), kRunning);
  EXPECT_THAT(sync("a").leases, IsEmpty());

  const LeaseDescription again = lease_to("b");
  EXPECT_EQ(again.items, rendered.items);
  const Actions actions = deliver_sums("b", again, honest);
  EXPECT_THAT(actions.verdicts, testing::Each(Verdict::kAudited));
  EXPECT_THAT(actions.job_changes, ElementsAre(JobChange{{"job"}, kRunning, kDone}));
  EXPECT_EQ(worker("a").audited_ranges, 4u);
  EXPECT_EQ(worker("a").disproved_ranges, 0u);
}

TEST_F(Audits, AreForNoOtherProcessOfTheSameMachine) {
  submit("job", tiles(4, 1));
  deliver_sums("a", lease_to("a"), honest);
  const Reply reply = *handle(Synchronize{{{"a's other process"}, "a", "0.1.0", 1}, {}, 1}).reply;
  EXPECT_THAT(reply.leases, IsEmpty());
}

// Who has delivered before it said its name is known by it afterwards.
TEST_F(Audits, AreForNobodyWhoDeliveredBeforeItWasHeardOf) {
  submit("job", tiles(2, 1));
  restart();
  deliver_sums("w", {LeaseId{7}, {"job"}, {}}, {{0, {0, 1}}, {1, {0, 1}}}, honest);
  const auto named = [&](const std::string& id) {
    return handle(Synchronize{{{id}, "machine", "0.1.0", 1}, {}, 1}).reply->leases;
  };
  EXPECT_THAT(named("w"), IsEmpty());
  EXPECT_THAT(named("v"), IsEmpty());
  EXPECT_FALSE(sync("another").leases.empty());
}

TEST_F(Audits, OfAHigherPriorityComeFirstAndOfALowerOneWait) {
  submit("low", tiles(4, 1), 0);
  deliver_sums("a", lease_to("a"), honest);
  submit("high", tiles(4, 1), 1);
  EXPECT_EQ(lease_to("b").job.value, "high");
}

// Or they would come back as one.
TEST_F(Audits, OfRangesThatTouchAreInSeveralLeases) {
  submit("job", tiles(2, 4));
  restart();
  deliver_sums("a", {LeaseId{7}, {"job"}, {}}, {{0, {0, 1}}, {0, {1, 2}}, {0, {2, 4}}, {1, {0, 4}}}, honest);
  const Reply reply = sync("b", {}, 2);
  ASSERT_EQ(reply.leases.size(), 2u);
  EXPECT_EQ(reply.leases[0].items, (std::vector<WorkItem>{{0, {0, 1}}, {0, {2, 4}}, {1, {0, 4}}}));
  EXPECT_EQ(reply.leases[1].items, (std::vector<WorkItem>{{0, {1, 2}}}));
}

TEST_F(Audits, AreLeasesOfTheWorkersThatAJobMayHave) {
  submit("job", tiles(2, 1), 0, 1);
  deliver_sums("a", lease_to("a"), honest);
  const LeaseDescription lease = lease_to("b");
  EXPECT_EQ(job("job").active_workers, 1);
  EXPECT_THAT(sync("c").leases, IsEmpty());
  const Actions part = deliver_sums("b", lease, {lease.items[0]}, honest, false);
  EXPECT_THAT(part.wake, IsEmpty());
  // It has given the rest back, and another may have its place.
  const Actions rest = deliver_sums("b", lease, {}, honest);
  EXPECT_THAT(rest.wake, testing::Contains(WorkerId{"c"}));
  EXPECT_EQ(lease_to("c").items, std::vector{lease.items[1]});
}

// Fewer workers may have the job since the limit was lowered, and audits keep it: no invariant is broken.
TEST_F(Audits, OutliveALowerLimitOnWorkers) {
  submit("job", tiles(2, 1));
  deliver_sums("a", lease_to("a"), honest);
  const LeaseDescription by_b = lease_to("b"), by_c = lease_to("c");
  ASSERT_TRUE(handle(UpdateJob{{"job"}, {}, 1}).status);
  EXPECT_EQ(job("job").active_workers, 2);
  deliver_sums("c", by_c, honest);
  EXPECT_EQ(job("job").active_workers, 1);
  EXPECT_THAT(sync("c").leases, IsEmpty());
  deliver_sums("b", by_b, std::vector{by_b.items[1]}, honest);
  EXPECT_EQ(state("job"), kDone);
}

// As jobs that lack samples do, jobs that are audited share the farm by the work that they are given.
TEST_F(Audits, AreWorkThatAJobIsGiven) {
  submit("x", tiles(200, 1));
  submit("y", tiles(200, 1));
  render("a");
  options_.audit_share = 0;
  restart();
  const auto job_given_to = [&](const std::string& id, int threads) {
    const Reply reply = *handle(Synchronize{{{id}, id, "0.1.0", threads}, {}, 1}).reply;
    return reply.leases.at(0).job.value;
  };
  EXPECT_EQ(job_given_to("b", 4), "x");
  EXPECT_EQ(job_given_to("c", 1), "y");
  EXPECT_EQ(job_given_to("d", 1), "y");
}

TEST_F(Audits, MayComeInParts) {
  submit("job", tiles(2, 8));
  restart();
  const LeaseDescription before{LeaseId{7}, {"job"}, {}};
  deliver_sums("a", before, {{0, {0, 8}}, {1, {0, 8}}}, honest);
  const LeaseDescription lease = lease_to("b");
  ASSERT_EQ(lease.items, (std::vector<WorkItem>{{0, {0, 8}}, {1, {0, 8}}}));
  deliver_sums("b", lease, {{0, {0, 3}}}, honest, false);
  EXPECT_EQ(sync("b", {lease}).leases[0].items, (std::vector<WorkItem>{{0, {3, 8}}, {1, {0, 8}}}));
  EXPECT_EQ(job("job").samples_to_verify, 16 * kTilePixels);
  deliver_sums("b", lease, {{0, {3, 8}}}, honest, false);
  EXPECT_EQ(job("job").samples_to_verify, 8 * kTilePixels);
  deliver_sums("b", lease, {{1, {0, 8}}}, honest);
  EXPECT_EQ(state("job"), kDone);
}

TEST_F(Audits, ThatAreNotFinishedBeginAnew) {
  submit("job", tiles(2, 8));
  restart();
  deliver_sums("a", {LeaseId{7}, {"job"}, {}}, {{0, {0, 8}}, {1, {0, 8}}}, honest);
  const LeaseDescription lease = lease_to("stopping");
  deliver_sums("stopping", lease, {{0, {0, 3}}}, honest);
  EXPECT_EQ(lease_to("b").items, (std::vector<WorkItem>{{0, {0, 8}}, {1, {0, 8}}}));
}

TEST_F(Audits, CountOnce) {
  submit("job", tiles(4, 1));
  deliver_sums("a", lease_to("a"), honest);
  const LeaseDescription lease = lease_to("b");
  deliver_sums("b", lease, {lease.items[0]}, honest, false);
  EXPECT_THAT(deliver_sums("b", lease, {lease.items[0]}, honest, false).verdicts,
              ElementsAre(Verdict::kDropped));
}

TEST_F(Audits, OfAWorkerThatDiesGoToAnother) {
  submit("job", tiles(4, 1));
  const LeaseDescription rendered = lease_to("a");
  deliver_sums("a", rendered, honest);
  const LeaseDescription lost = lease_to("b");
  pass(seconds(11));
  tick();
  EXPECT_EQ(lease_to("c").items, lost.items);
}

TEST_F(Audits, ThatTakeLongAreGivenToAnotherAsWell) {
  submit("job", tiles(2, 1));
  deliver_sums("a", lease_to("a"), honest);
  const LeaseDescription slow = lease_to("slow");
  const LeaseDescription copy = lease_to("quick");
  EXPECT_EQ(copy.items[0], slow.items[0]);
  EXPECT_EQ(lease_to("third").items, std::vector{slow.items[1]});
  EXPECT_THAT(sync("fourth").leases, IsEmpty());
  render("quick");
  render("third");
  EXPECT_EQ(state("job"), kDone);
  EXPECT_THAT(sync("slow", {slow}).leases, IsEmpty());
}

TEST_F(Audits, DisproveALiarBySentence) {
  submit("job", tiles(4, 1));
  const LeaseDescription lease = lease_to("liar");
  deliver_sums("liar", lease, wrong);
  const LeaseDescription by_b = lease_to("b");
  const Actions contradicted = deliver_sums("b", by_b, {by_b.items[0]}, honest, false);
  ASSERT_EQ(contradicted.contradictions.size(), 1u);
  EXPECT_THAT(contradicted.contradictions[0],
              HasSubstr("liar and b have rendered other bits of samples [0, 1) of tile 0"));
  EXPECT_THAT(contradicted.disproved, IsEmpty());
  // What is contradicted comes first.
  const LeaseDescription by_c = lease_to("c");
  ASSERT_EQ(by_c.items[0], by_b.items[0]);
  const Actions decided = deliver_sums("c", by_c, {by_c.items[0]}, honest, false);
  ASSERT_EQ(decided.disproved.size(), 1u);
  EXPECT_EQ(decided.disproved[0].author, (Author{"liar", {"liar"}}));
  EXPECT_EQ(decided.disproved[0].because,
            "it rendered other bits of samples [0, 1) of tile 0 (pixels [0, 64) x [0, 64)) of job job than b "
            "and c");
  EXPECT_THAT(decided.dropped_tiles, ElementsAre(TileOfJob{{"job"}, 0}));
  EXPECT_EQ(scheduler_->done({"job"}, 0), IntervalSet{});
  EXPECT_EQ(worker("liar").disproved_ranges, 1u);

  render_together({{"b", honest}, {"c", honest}});
  EXPECT_EQ(state("job"), kDone);
  EXPECT_EQ(job("job").samples_done, job("job").samples_total);
}

TEST_F(Audits, DisproveWhoContradictsTheTruth) {
  submit("job", tiles(2, 1));
  deliver_sums("a", lease_to("a"), honest);
  const LeaseDescription lie = lease_to("liar");
  deliver_sums("liar", lie, {lie.items[0]}, wrong, false);
  const LeaseDescription third = lease_to("c");
  const Actions decided = deliver_sums("c", third, {lie.items[0]}, honest, false);
  ASSERT_EQ(decided.disproved.size(), 1u);
  EXPECT_EQ(decided.disproved[0].author.name, "liar");
  EXPECT_THAT(decided.dropped_tiles, IsEmpty());
  EXPECT_EQ(worker("liar").held_leases, 0);
}

// Two liars that say different things do not vouch for each other.
TEST_F(Audits, NeedTwoThatAgree) {
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

TEST_F(Audits, AreWaitedForUntilNobodyHasComeForAWhile) {
  submit("job", tiles(4, 1));
  deliver_sums("a", lease_to("a"), honest);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(state("job"), kRunning);
    pass(seconds(9));
    EXPECT_THAT(sync("a").leases, IsEmpty());
  }
  EXPECT_LE(*scheduler_->next_deadline(), now_ + seconds(6));
  pass(seconds(6));
  const Actions actions = handle(Tick{});
  EXPECT_THAT(actions.job_changes, ElementsAre(JobChange{{"job"}, kRunning, kDone}));
  ASSERT_EQ(actions.unaudited.size(), 1u);
  EXPECT_EQ(actions.unaudited[0].ranges, 4u);
  EXPECT_EQ(job("job").samples_to_verify, 0u);
}

TEST_F(Audits, AreNotWaitedForIfTheOnlyOtherCannotBuildTheScene) {
  submit("job", tiles(4, 1));
  deliver_sums("a", lease_to("a"), honest);
  for (int i = 0; i < 8 && state("job") == kRunning; ++i) {
    const LeaseDescription lease = lease_to("b");
    handle(SubmitResult{{"b"}, lease.job, lease.id, {}, 0, true, "out of memory"});
    sync("a");
    pass(seconds(9));
    tick();
  }
  EXPECT_EQ(state("job"), kDone);
}

TEST_F(Audits, AreNotGivenUpWhileSomebodyCanDoThem) {
  submit("job", tiles(4, 1));
  deliver_sums("a", lease_to("a"), honest);
  sync("b", {}, 0);
  for (int i = 0; i < 20; ++i) {
    pass(seconds(9));
    sync("b", {}, 0);
  }
  EXPECT_EQ(state("job"), kRunning);
}

TEST_F(Audits, AreStillDueAfterARestart) {
  submit("job", tiles(4, 1));
  deliver_sums("a", lease_to("a"), honest);
  options_.audit_share = 0;
  restart();
  EXPECT_EQ(job("job").samples_to_verify, job("job").samples_total);
  EXPECT_THAT(sync("a").leases, IsEmpty());
  render("b");
  EXPECT_EQ(state("job"), kDone);
}

TEST_F(Audits, OfSamplesThatKillTheirWorkersEndTheJob) {
  submit("job", tiles(2, 1));
  restart();
  deliver_sums("liar", {LeaseId{7}, {"job"}, {}}, {{0, {0, 1}}, {1, {0, 1}}}, wrong);
  for (int deaths = 0; deaths < 10 && state("job") == kRunning; ++deaths) {
    const std::string victim = "victim " + std::to_string(deaths);
    const LeaseDescription lease = lease_to(victim);
    sync(victim, {lease});
    pass(seconds(10));
    tick();
  }
  EXPECT_EQ(state("job"), kFailed);
  EXPECT_THAT(job("job").failure, HasSubstr("3 workers died one after the other"));
}

TEST_F(WithoutAudits, WhatAWorkerThatIsPutAsideHasRenderedIsVerified) {
  submit("job", tiles(100, 2));
  const LeaseDescription lies = lease_to("liar");
  deliver_sums("liar", lies, wrong);
  deliver_sums("a", lease_to("a"), honest);
  EXPECT_EQ(job("job").samples_to_verify, 0u);
  const Actions actions = handle(Dismiss{{"liar"}, true});
  EXPECT_EQ(actions.reviewed_tiles.size(), lies.items.size());
  EXPECT_EQ(job("job").samples_to_verify, lies.items.size() * kTilePixels);
  // What it delivers under its name still counts, but not without being verified.
  const Reply late = *handle(Synchronize{{{"late"}, "liar", "0.1.0", 1}, {}, 1}).reply;
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
  const Actions put_aside = handle(Dismiss{{"liar"}, true});
  EXPECT_THAT(put_aside.reopen, ElementsAre(JobId{"job"}));
  const Actions reopened = handle(ReopenJob{{"job"}});
  EXPECT_THAT(reopened.job_changes, ElementsAre(JobChange{{"job"}, kDone, kRunning}));
  EXPECT_EQ(reopened.reviewed_tiles.size(), 2u);
  EXPECT_EQ(job("job").samples_to_verify, job("job").samples_total);
  // Nobody waits for this in vain: it goes on whenever somebody comes.
  pass(seconds(1000));
  tick();
  EXPECT_EQ(state("job"), kRunning);
  render_together({{"a", honest}, {"b", honest}});
  EXPECT_EQ(state("job"), kDone);
}

TEST_F(WithoutAudits, ADoneJobOfTrustedWorkersStaysDone) {
  submit("job", tiles(2, 1));
  sync("bad", {}, 0);
  render("a");
  EXPECT_THAT(handle(Dismiss{{"bad"}, true}).reopen, IsEmpty());
  EXPECT_TRUE(handle(ReopenJob{{"job"}}).job_changes.empty());
}

// A tile whose samples were dropped is empty, also of what the same result brought.
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
