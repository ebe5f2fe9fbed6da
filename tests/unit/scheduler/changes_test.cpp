// SPDX-License-Identifier: Apache-2.0
// Every event names the jobs and workers that it has changed, once each.
#include <memory>

#include "tests/unit/scheduler/stalled_farm.hpp"

namespace tessera::scheduler {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;

class Changes : public Farm {
 protected:
  Actions synchronize(const WorkerInfo& worker, bool draining = false) {
    return handle(Synchronize{worker, {}, 0, draining});
  }
};

TEST_F(Changes, OfAJobAreNamed) {
  const JobId job{"job"};
  EXPECT_THAT(handle(SubmitJob{job, tiles(2, 4)}).changed_jobs, ElementsAre(job));
  EXPECT_THAT(handle(UpdateJob{job, 3, {}}).changed_jobs, ElementsAre(job));
  EXPECT_THAT(handle(UpdateJob{job, {}, 7}).changed_jobs, ElementsAre(job));
  EXPECT_THAT(handle(ExtendJob{job, 8}).changed_jobs, ElementsAre(job));
  EXPECT_THAT(handle(PauseJob{job}).changed_jobs, ElementsAre(job));
  EXPECT_THAT(handle(ResumeJob{job}).changed_jobs, ElementsAre(job));
  EXPECT_THAT(handle(FailJob{job, "why"}).changed_jobs, ElementsAre(job));
  EXPECT_THAT(handle(DeleteJob{job}).changed_jobs, ElementsAre(job));
}

TEST_F(Changes, ThatChangeNothingAreNotNamed) {
  const JobId job{"job"};
  handle(SubmitJob{job, tiles(2, 4), 3});
  EXPECT_THAT(handle(SubmitJob{job, tiles(2, 4)}).changed_jobs, IsEmpty());
  EXPECT_THAT(handle(UpdateJob{job, 3, 0}).changed_jobs, IsEmpty());
  EXPECT_THAT(handle(ExtendJob{job, 4}).changed_jobs, IsEmpty());
  EXPECT_THAT(handle(ExtendJob{job, 2}).changed_jobs, IsEmpty());
  EXPECT_THAT(handle(ResumeJob{job}).changed_jobs, IsEmpty());
  EXPECT_THAT(handle(DeleteJob{{"other"}}).changed_jobs, IsEmpty());
}

TEST_F(Changes, OfProgressAreNotNamedUntilTheJobIsDone) {
  submit("job", tiles(2, 2));
  sync("w");
  Actions last;
  for (int i = 0; i < 10 && state("job") == JobState::kRunning; ++i) {
    const LeaseDescription lease = lease_to("w");
    last = deliver("w", lease);
    EXPECT_EQ(last.changed_jobs.empty(), state("job") == JobState::kRunning);
    EXPECT_THAT(last.changed_workers, IsEmpty());
  }
  EXPECT_THAT(last.changed_jobs, ElementsAre(JobId{"job"}));
}

TEST_F(Changes, OfProgressAreNamedApart) {
  const WorkerInfo w{{"w"}, "w", "0.1.0", 1};
  synchronize(w);
  EXPECT_THAT(handle(SubmitJob{{"job"}, tiles(2, 4)}).progressed_jobs, IsEmpty()) << "nothing is leased";
  const Actions leased = handle(Synchronize{w, {}, 1, false});
  EXPECT_THAT(leased.progressed_jobs, ElementsAre(JobId{"job"})) << "a worker holds a lease";
  EXPECT_THAT(leased.progressed_workers, ElementsAre(w.id));
  const Actions counted = deliver("w", leased.reply->leases.front());
  EXPECT_THAT(counted.progressed_jobs, ElementsAre(JobId{"job"}));
  EXPECT_THAT(counted.progressed_workers, ElementsAre(w.id));
  const Actions nothing = handle(Tick{});
  EXPECT_THAT(nothing.progressed_jobs, IsEmpty());
  EXPECT_THAT(nothing.progressed_workers, IsEmpty());
}

TEST_F(Changes, InSeveralStepsAreNamedOnce) {
  submit("job", tiles(2, 1));
  handle(PauseJob{{"job"}});
  RestoreJob done{{"done"}, tiles(2, 1), 0, JobState::kRunning, "", {{{0, 1}}, {{0, 1}}}, 0, {}};
  const Actions actions = handle(done);  // submitted, and done at once
  EXPECT_THAT(actions.job_changes, testing::SizeIs(1));
  EXPECT_THAT(actions.changed_jobs, ElementsAre(JobId{"done"}));
}

TEST_F(Changes, OfAWorkerAreNamed) {
  const WorkerInfo w{{"w"}, "name", "0.1.0", 1};
  EXPECT_THAT(synchronize(w).changed_workers, ElementsAre(w.id));
  EXPECT_THAT(synchronize(w).changed_workers, IsEmpty());
  EXPECT_THAT(synchronize(w, true).changed_workers, ElementsAre(w.id));
  EXPECT_THAT(synchronize(w).changed_workers, ElementsAre(w.id));
  WorkerInfo renamed = w;
  renamed.name = "other";
  EXPECT_THAT(synchronize(renamed).changed_workers, ElementsAre(w.id));
  pass(seconds(10));
  EXPECT_THAT(handle(Tick{}).changed_workers, ElementsAre(w.id)) << "lost";
  EXPECT_THAT(synchronize(renamed).changed_workers, ElementsAre(w.id)) << "back";
  pass(seconds(10));
  handle(Tick{});
  pass(seconds(90));
  EXPECT_THAT(handle(Tick{}).changed_workers, ElementsAre(w.id)) << "forgotten";
}

TEST_F(Changes, OfTwoStepsOfAWorkerAreNamedOnce) {
  sync("w");
  pass(seconds(200));
  // Lost, forgotten and registered again.
  EXPECT_THAT(synchronize({{"w"}, "w", "0.1.0", 1}).changed_workers, ElementsAre(WorkerId{"w"}));
}

TEST_F(Changes, LeaveWhatIsNotNeededToTheCaller) {
  submit("job", tiles(2, 4));
  EXPECT_THAT(handle(UpdateJob{{"job"}, 3, {}}).discarded, IsEmpty());
  EXPECT_THAT(handle(CancelJob{{"job"}}).discarded, Not(IsEmpty()));
  EXPECT_THAT(handle(DeleteJob{{"job"}}).discarded, Not(IsEmpty()));
  sync("w");
  pass(seconds(10));
  handle(Tick{});
  pass(seconds(90));
  EXPECT_THAT(handle(Tick{}).discarded, Not(IsEmpty())) << "a forgotten worker";
}

TEST_F(Changes, ShowInTheViewOfOneWorker) {
  EXPECT_FALSE(scheduler_->worker({"w"}, now_));
  submit("job", tiles(100, 4));
  sync("v");
  lease_to("w");
  const auto view = scheduler_->worker({"w"}, now_);
  ASSERT_TRUE(view);
  EXPECT_EQ(view->info.id.value, "w");
  EXPECT_EQ(view->held_leases, 1);
}

class ChangesOfStalledWorkers : public StalledFarm {};

TEST_F(ChangesOfStalledWorkers, AreNamedWhenACooldownBeginsAndWhenAResultEndsIt) {
  submit("job", tiles(100, 16));
  const LeaseDescription lease = lease_to("w");
  std::vector<LeaseDescription> held{lease};
  EXPECT_THAT(keep_reporting("w", held, seconds(95)).changed_workers, IsEmpty());
  EXPECT_THAT(keep_reporting("w", held, seconds(5)).changed_workers, ElementsAre(WorkerId{"w"}));
  ASSERT_THAT(view("w").cooldowns, testing::SizeIs(1));
  EXPECT_THAT(deliver("w", lease).changed_workers, ElementsAre(WorkerId{"w"}));
  EXPECT_THAT(view("w").cooldowns, IsEmpty());
}

TEST_F(ChangesOfStalledWorkers, AreNamedWhenAWorkerIsStuckAndWhenItGoesOn) {
  submit("job", tiles(100, 16));
  std::vector<LeaseDescription> held{lease_to("w")};
  EXPECT_THAT(keep_rendering("w", held, seconds(100)).changed_workers, ElementsAre(WorkerId{"w"}));
  ASSERT_TRUE(view("w").stuck);
  EXPECT_THAT(keep_reporting("w", held, seconds(5)).changed_workers, ElementsAre(WorkerId{"w"}));
  EXPECT_FALSE(view("w").stuck);
}

}  // namespace
}  // namespace tessera::scheduler
