// Workers that are heard of, hold leases, and deliver nothing: no lease is held for ever.
#include <fmt/format.h>

#include <algorithm>

#include "tests/unit/scheduler/farm.hpp"

namespace tessera::scheduler {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Stalls : public Farm {
 protected:
  // Reports what it holds every five seconds for so long. Returns what it holds then, and what was logged.
  Actions keep_reporting(const std::string& worker, std::vector<LeaseDescription>& held, Duration time) {
    Actions last;
    for (const Time end = now_ + time; now_ < end;) {
      pass(seconds(5));
      last = handle(Synchronize{{{worker}, worker, "0.1.0", 1}, held, 1, false, fetching_, rendering_});
      held = last.reply->leases;
    }
    return last;
  }
  Actions keep_rendering(const std::string& worker, std::vector<LeaseDescription>& held, Duration time) {
    rendering_ = held.at(0).id;
    stuck_in_ = rendering_;
    Actions last = keep_reporting(worker, held, time);
    rendering_ = {};
    return last;
  }
  // Something that it delivers counts.
  void show(const std::string& worker) {
    const LeaseDescription lease = lease_to(worker);
    deliver(worker, lease);
  }
  // It never gets through with the first item of what it is given, which is returned. It is stuck after 100
  // s, and that counts five later: it has not said before that it renders.
  WorkItem lose(const std::string& worker, Duration time = seconds(105)) {
    std::vector<LeaseDescription> held{lease_to(worker)};
    const WorkItem item = held[0].items.at(0);
    last_ = keep_rendering(worker, held, time);
    EXPECT_THAT(held, testing::IsEmpty());
    return item;
  }
  const WorkerView& view(const std::string& worker) {
    views_ = scheduler_->workers(now_);
    return *std::find_if(views_.begin(), views_.end(), [&](const auto& v) { return v.info.name == worker; });
  }

  std::set<JobId> fetching_;
  LeaseId rendering_, stuck_in_;
  Actions last_;
  std::vector<WorkerView> views_;
};

TEST_F(Stalls, ALeaseOfWhichNothingComesEndsAfterTenLeaseDurations) {
  submit("job", tiles(100, 16), 0, 1);
  std::vector<LeaseDescription> held{lease_to("stuck")};
  const LeaseDescription lease = held.front();
  keep_reporting("stuck", held, seconds(95));
  EXPECT_THAT(held, ElementsAre(lease));
  EXPECT_THAT(sync("other").leases, IsEmpty()) << "the job may have one worker";
  const Actions last = keep_reporting("stuck", held, seconds(5));
  EXPECT_THAT(held, IsEmpty());
  EXPECT_THAT(last.stalled,
              ElementsAre(HasSubstr("worker stuck (stuck) is heard of, but has delivered nothing of "
                                    "job job for 100 s, where samples [0, 1) of tile 0 came first")));
  EXPECT_THAT(last.wake, ElementsAre(WorkerId{"other"}));
  EXPECT_EQ(handle(TopUp{{"other"}}).reply->leases.at(0).items, lease.items);
}

TEST_F(Stalls, ALeaseThatIsNeverReportedEndsAsWell) {
  submit("job", tiles(100, 16), 0, 1);
  lease_to("deaf");
  for (int i = 0; i < 19; ++i) {
    pass(seconds(5));
    EXPECT_EQ(sync("deaf").leases.size(), 1u);
  }
  pass(seconds(5));
  EXPECT_THAT(sync("deaf").leases, IsEmpty());
  EXPECT_EQ(job("job").active_workers, 0);
}

TEST_F(Stalls, WhoGivesLeasesBackAndTakesOthersIsNoBetter) {
  submit("job", tiles(100, 16));
  for (int i = 0; i < 10; ++i) {
    const LeaseDescription lease = lease_to("restless");
    pass(seconds(5));
    sync("restless", {lease});
    pass(seconds(5));
  }
  const LeaseDescription last = lease_to("restless");
  pass(seconds(5));
  EXPECT_THAT(sync("restless", {last}).leases, IsEmpty());
  EXPECT_EQ(sync("other").leases.size(), 1u);
}

TEST_F(Stalls, WhoDeliversWhatIsThereAlreadyIsNoBetter) {
  submit("job", tiles(100, 16));
  const LeaseDescription first = lease_to("parrot");
  deliver("parrot", first);
  std::vector<LeaseDescription> held{lease_to("parrot")};
  for (int i = 0; i < 20 && !held.empty(); ++i) {
    keep_reporting("parrot", held, seconds(5));
    deliver("parrot", first, first.items, false);
  }
  EXPECT_THAT(held, IsEmpty());
}

TEST_F(Stalls, EveryFurtherOneBarsTheWorkerForTwiceAsLong) {
  submit("job", tiles(100, 16));
  show("stuck");
  for (const int bar : {100, 200, 400}) {
    std::vector<LeaseDescription> held{lease_to("stuck")};
    keep_reporting("stuck", held, seconds(100));
    keep_reporting("stuck", held, seconds(bar - 5));
    EXPECT_THAT(held, IsEmpty()) << bar;
    pass(seconds(5));
  }
}

TEST_F(Stalls, WhoNeverHadAnythingCountedIsBarredForNoLongerEachTime) {
  submit("job", tiles(100, 16));
  for (int i = 0; i < 3; ++i) {
    std::vector<LeaseDescription> held{lease_to("new")};
    keep_reporting("new", held, seconds(100));
    ASSERT_THAT(view("new").bars, testing::SizeIs(1));
    EXPECT_EQ(view("new").bars[0].remaining, seconds(100));
    keep_reporting("new", held, seconds(95));
    EXPECT_THAT(held, IsEmpty());
    pass(seconds(5));
  }
}

TEST_F(Stalls, WhoFetchesTheSceneForLongLosesItsLeaseAndIsNotBarred) {
  submit("job", tiles(100, 16));
  std::vector<LeaseDescription> held{lease_to("far")};
  const LeaseDescription lease = held.front();
  fetching_ = {{"job"}};
  const Actions last = keep_reporting("far", held, seconds(100));
  EXPECT_THAT(held, IsEmpty());
  EXPECT_THAT(last.stalled, ElementsAre(HasSubstr("until it has the files of its scene")));
  EXPECT_EQ(lease_to("near").items, lease.items) << "others need not wait";
  keep_reporting("far", held, seconds(500));
  EXPECT_THAT(held, IsEmpty()) << "it can render nothing yet";
  EXPECT_TRUE(view("far").bars.at(0).fetching);
  fetching_ = {};
  keep_reporting("far", held, seconds(5));
  EXPECT_EQ(held.size(), 1u);
  EXPECT_THAT(view("far").bars, IsEmpty());
}

TEST_F(Stalls, WhoSaysAgainAndAgainThatItFetchesIsBarred) {
  submit("job", tiles(100, 16));
  fetching_ = {{"job"}};
  for (int i = 0; i < 2; ++i) {
    std::vector<LeaseDescription> held{lease_to("liar")};
    keep_reporting("liar", held, seconds(100));
    EXPECT_THAT(held, IsEmpty());
  }
  EXPECT_THAT(sync("liar").leases, IsEmpty());
  EXPECT_EQ(view("liar").bars.at(0).remaining, seconds(100));
}

TEST_F(Stalls, FetchingOneSceneExcusesNobodyFromAnotherJob) {
  submit("job", tiles(100, 16));
  std::vector<LeaseDescription> held{lease_to("w")};
  fetching_ = {{"other"}};
  keep_reporting("w", held, seconds(100));
  fetching_ = {};
  keep_reporting("w", held, seconds(50));
  EXPECT_THAT(held, IsEmpty());
}

TEST_F(Stalls, WhoSaysThatItStillRendersWhatOthersHaveIsGivenNothing) {
  submit("job", tiles(100, 16), 1);
  std::vector<LeaseDescription> held{lease_to("stuck")};
  const LeaseDescription lease = held.front();
  submit("other", tiles(100, 16));
  keep_rendering("stuck", held, seconds(100));
  rendering_ = lease.id;
  keep_reporting("stuck", held, seconds(1000));
  EXPECT_THAT(held, IsEmpty());
  EXPECT_TRUE(view("stuck").stuck);
  rendering_ = {};
  keep_reporting("stuck", held, seconds(5));
  EXPECT_EQ(held.size(), 1u);
  EXPECT_FALSE(view("stuck").stuck);
}

TEST_F(Stalls, WhatWaitsBehindTheRangeThatKeepsItGoesToOthersAtOnce) {
  submit("job", tiles(100, 16), 1);
  std::vector<LeaseDescription> held{lease_to("stuck")};
  keep_rendering("stuck", held, seconds(60));
  submit("other", tiles(100, 16), 2);
  held = sync("stuck", held, 2).leases;
  ASSERT_EQ(held.size(), 2u);
  keep_rendering("stuck", held, seconds(40));
  EXPECT_THAT(held, IsEmpty());
  EXPECT_EQ(job("other").active_workers, 0);
}

TEST_F(Stalls, KeepTheWorkerFromOtherJobsNot) {
  submit("job", tiles(100, 16), 1);
  std::vector<LeaseDescription> held{lease_to("stuck")};
  submit("other", tiles(100, 16));
  keep_reporting("stuck", held, seconds(100));
  ASSERT_EQ(held.size(), 1u);
  EXPECT_EQ(held[0].job, JobId{"other"});
}

TEST_F(Stalls, WhatComesAfterAllCountsAndEndsTheBar) {
  submit("job", tiles(100, 16));
  std::vector<LeaseDescription> held{lease_to("slow")};
  const LeaseDescription lease = held.front();
  keep_reporting("slow", held, seconds(150));
  ASSERT_THAT(held, IsEmpty());
  const Actions late = deliver("slow", lease, {lease.items[0]}, false, 150);
  EXPECT_THAT(late.verdicts, ElementsAre(Verdict::kAccepted));
  EXPECT_EQ(sync("slow").leases.size(), 1u);
}

// 4096 pixel samples in 200 s: what it is given now is a single sample of a tile, which it has 2000 s for.
TEST_F(Stalls, WhoIsKnownToBeSlowHasTime) {
  submit("job", tiles(100, 16));
  const LeaseDescription first = lease_to("slow");
  deliver("slow", first, {first.items[0]}, true, 200);
  std::vector<LeaseDescription> held{lease_to("slow")};
  const LeaseDescription lease = held.front();
  EXPECT_EQ(lease.items.size(), 1u);
  keep_reporting("slow", held, seconds(1995));
  EXPECT_THAT(held, ElementsAre(lease));
  keep_reporting("slow", held, seconds(5));
  EXPECT_THAT(held, IsEmpty());
}

TEST_F(Stalls, EachDeliveryGivesTimeForTheNext) {
  submit("job", tiles(100, 16));
  std::vector<LeaseDescription> held{lease_to("slow")};
  const LeaseDescription lease = held.front();
  ASSERT_EQ(lease.items.size(), 4u);
  for (int i = 0; i < 3; ++i) {
    keep_reporting("slow", held, seconds(90));
    deliver("slow", lease, {lease.items[static_cast<std::size_t>(i)]}, false, 1e-3);
  }
  keep_reporting("slow", held, seconds(90));
  ASSERT_EQ(held.size(), 1u);
  EXPECT_THAT(held[0].items, ElementsAre(lease.items[3]));
}

TEST_F(Stalls, AGapBetweenLeasesIsNobodysFault) {
  submit("job", tiles(2, 1));
  const LeaseDescription lease = lease_to("w");
  pass(seconds(5));
  sync("w", {lease}, 0);
  deliver("w", lease, {lease.items[0]}, true);
  for (int i = 0; i < 100; ++i) {
    pass(seconds(5));
    sync("w", {}, 0);
  }
  std::vector<LeaseDescription> held{lease_to("w")};
  keep_reporting("w", held, seconds(95));
  EXPECT_EQ(held.size(), 1u);
}

TEST_F(Stalls, ASampleThatThreeWorkersComeToNoEndWithFailsItsJob) {
  submit("job", tiles(4, 8));
  submit("other", tiles(4, 8), -1);
  for (const char* name : {"a", "b", "c"}) show(name);
  const WorkItem a = lose("a"), b = lose("b");
  EXPECT_EQ(state("job"), JobState::kRunning);
  const WorkItem c = lose("c");
  EXPECT_EQ(b.tile, a.tile);
  EXPECT_EQ(b.samples.begin, a.samples.begin);
  EXPECT_EQ(c, (WorkItem{a.tile, {a.samples.begin, a.samples.begin + 1}}));
  EXPECT_EQ(state("job"), JobState::kFailed);
  EXPECT_THAT(last_.job_changes, ElementsAre(JobChange{{"job"}, JobState::kRunning, JobState::kFailed}));
  EXPECT_THAT(job("job").failure,
              HasSubstr(fmt::format("3 workers came to no end one after the other with samples [{}, {}) of "
                                    "tile {} (pixels [",
                                    c.samples.begin, c.samples.end, c.tile)));
  EXPECT_THAT(job("job").failure, HasSubstr("a (a), b (b), c (c)"));
  EXPECT_EQ(state("other"), JobState::kRunning);
}

TEST_F(Stalls, WorkersThatHaveNotShownThatTheyCanDeliverFailNoJob) {
  submit("job", tiles(4, 8));
  for (const char* name : {"a", "b", "c", "d", "e"}) {
    std::vector<LeaseDescription> held{lease_to(name)};
    keep_rendering(name, held, seconds(100));
    EXPECT_TRUE(view(name).stuck);
  }
  EXPECT_EQ(state("job"), JobState::kRunning);
}

// A machine that breaks hangs in whatever it is given, and again when it is started anew.
TEST_F(Stalls, AMachineThatIsBrokenCountsOnceUntilItDelivers) {
  submit("first", tiles(4, 8), 1);
  show("a");
  for (int i = 0; i < 5; ++i) {
    const std::string id = "a" + std::to_string(i);
    Actions last = handle(Synchronize{{{id}, "a", "0.1.0", 1}, {}, 1, false});
    for (int s = 0; s < 20; ++s) {
      pass(seconds(5));
      const std::vector<LeaseDescription> held = last.reply->leases;
      last = handle(Synchronize{{{id}, "a", "0.1.0", 1}, held, 1, false, {}, held.at(0).id});
    }
    EXPECT_THAT(last.reply->leases, IsEmpty());
  }
  EXPECT_EQ(state("first"), JobState::kRunning);
}

TEST_F(Stalls, WhoWasOnlySlowIsTakenBack) {
  submit("job", tiles(4, 8));
  for (const char* name : {"a", "b", "c"}) show(name);
  lose("a");
  std::vector<LeaseDescription> none;
  keep_reporting("a", none, seconds(5));  // it is at something else now
  sync("a", {}, 1, true);
  lose("b");
  lose("c");
  EXPECT_EQ(state("job"), JobState::kRunning) << "two of three are left";
}

// Nothing honest takes an hour, whoever is at it.
TEST_F(Stalls, AnHourAtOneRangeCountsAgainstItInAnyCase) {
  submit("job", tiles(2, 1));
  for (const char* name : {"a", "b", "c"}) {
    EXPECT_EQ(lose(name, seconds(3600)), (WorkItem{0, {0, 1}}));
    EXPECT_EQ(state("job"), JobState::kRunning);
    rendering_ = stuck_in_;
    std::vector<LeaseDescription> none;
    keep_reporting(name, none, seconds(5));
    rendering_ = {};
  }
  EXPECT_EQ(state("job"), JobState::kFailed);
}

// What others may have done of it, or a coordinator that slept, is no fault of the worker's.
TEST_F(Stalls, ALeaseThatRanOutAndIsTakenUpAgainBeginsAnew) {
  submit("job", tiles(100, 16));
  std::vector<LeaseDescription> held{lease_to("w")};
  keep_reporting("w", held, seconds(95));
  pass(seconds(60));
  keep_reporting("w", held, seconds(95));
  EXPECT_EQ(held.size(), 1u);
}

TEST_F(Stalls, AStuckWorkerDoesNotKeepAJobThatNobodyCanBuildAlive) {
  submit("job", tiles(100, 8));
  std::vector<LeaseDescription> held{lease_to("stuck")};
  const auto refuse = [&] {
    const Reply reply = sync("other");
    SubmitResult given_back{{"other"}, {"job"}, reply.leases.at(0).id, {}, 0, true};
    given_back.cannot_build = "out of memory";
    handle(given_back);
  };
  for (int i = 0; i < 3; ++i) refuse();
  keep_reporting("stuck", held, seconds(100));
  EXPECT_EQ(state("job"), JobState::kRunning);
  refuse();
  EXPECT_EQ(state("job"), JobState::kFailed);
}

}  // namespace
}  // namespace tessera::scheduler
