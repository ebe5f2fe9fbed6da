// SPDX-License-Identifier: Apache-2.0
// Jobs of several images, and tiles with targets of their own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/scheduler/item_text.hpp"
#include "tests/unit/scheduler/farm.hpp"

namespace tessera::scheduler {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class Images : public FarmOfSmallLeases {};

JobShape two_images(std::uint32_t spp) {
  return {core::kTilePx, core::kTilePx, spp, 2};
}

TEST_F(Images, AreRenderedInTheirOrderUntilAllAreDone) {
  submit("job", two_images(2));
  EXPECT_EQ(job("job").samples_total, 4 * kTilePixels);
  EXPECT_THAT(lease_to("a").items, ElementsAre(WorkItem{0, {0, 1}}));
  EXPECT_THAT(lease_to("b").items, ElementsAre(WorkItem{0, {1, 2}}));
  const LeaseDescription second = lease_to("c");
  EXPECT_THAT(second.items, ElementsAre(WorkItem{1, {0, 1}}));
  deliver("c", second);
  EXPECT_EQ(state("job"), JobState::kRunning);
  EXPECT_EQ(scheduler_->done({"job"}, 1), (IntervalSet{{0, 1}}));
  EXPECT_TRUE(scheduler_->done({"job"}, 0).empty()) << "samples of one image are none of another";
  pass(seconds(20));
  tick();
  render_all("d");
  EXPECT_EQ(state("job"), JobState::kDone);
}

TEST_F(Images, SurviveARestart) {
  submit("job", two_images(1));
  render_all("a");
  handle(ExtendJob{{"job"}, 0, {{1, 3}}});
  restart();
  EXPECT_EQ(job("job").shape.target(1), 3u);
  EXPECT_THAT(render_all("a"), ElementsAre(WorkItem{1, {1, 2}}, WorkItem{1, {2, 3}}));
  EXPECT_EQ(state("job"), JobState::kDone);
}

TEST_F(Images, AreNotLeasedToWorkersThatCannotNameThem) {
  submit("job", two_images(1));
  Synchronize call{{{"old"}, "old", "0.1.0", 1, "old"}};
  call.worker.capabilities.names_images = false;
  EXPECT_THAT(handle(call).reply->leases, testing::IsEmpty());
  submit("of one image", {core::kTilePx, core::kTilePx, 1});
  const Reply reply = *handle(call).reply;
  ASSERT_EQ(reply.leases.size(), 1u);
  EXPECT_EQ(reply.leases[0].job.value, "of one image");
}

class Layers : public FarmOfSmallLeases {
 protected:
  static Synchronize call_of(const std::string& worker, bool renders_layers) {
    Synchronize call{{{worker}, worker, "0.1.0", 1, worker}};
    call.worker.capabilities.renders_layers = renders_layers;
    return call;
  }
  void submit_with_layers(const std::string& id) {
    JobShape shape{core::kTilePx, core::kTilePx, 1};
    shape.has_layers = true;
    submit(id, shape);
  }
};

TEST_F(Layers, AreLeasedOnlyToWorkersThatRenderThem) {
  submit_with_layers("job");
  EXPECT_THAT(handle(call_of("old", false)).reply->leases, testing::IsEmpty());
  EXPECT_EQ(handle(call_of("new", true)).reply->leases.size(), 1u);
}

TEST_F(Layers, WaitForAWorkerThatRendersThem) {
  submit_with_layers("job");
  EXPECT_EQ(job("job").waiting, Waiting::kNoWorker);
  handle(call_of("old", false));
  EXPECT_EQ(job("job").waiting, Waiting::kNoLayers);
  submit("without", {core::kTilePx, core::kTilePx, 1});
  EXPECT_EQ(job("without").waiting, Waiting::kTurn);
  handle(call_of("old", true));  // updated in place
  EXPECT_EQ(job("job").waiting, Waiting::kNo);
  EXPECT_EQ(job("job").active_workers, 1);
  Synchronize leaves = call_of("old", true);
  leaves.draining = true;
  handle(leaves);
  EXPECT_EQ(job("job").waiting, Waiting::kDraining);
}

TEST_F(Images, WaitForAWorkerThatNamesThem) {
  submit("job", two_images(1));
  Synchronize call{{{"old"}, "old", "0.1.0", 1, "old"}};
  call.worker.capabilities.names_images = false;
  handle(call);
  EXPECT_EQ(job("job").waiting, Waiting::kNoImages);
}

TEST_F(Images, AreNamedInMessagesAboutTheirTiles) {
  const JobGrid grid = JobShape(3 * core::kTilePx, core::kTilePx, 1, 2).grid();
  EXPECT_EQ(describe_item_with_pixels(grid, {4, {0, 1}}),
            "samples [0, 1) of tile 1 of image 1 (pixels [64, 128) x [0, 64))");
}

TEST_F(Images, CountTowardTheSamplesThatAreLeft) {
  submit("job", two_images(1));
  deliver("a", lease_to("a"));
  EXPECT_EQ(job("job").samples_done, kTilePixels);
  EXPECT_EQ(scheduler_->totals(now_).missing_samples, kTilePixels);
}

class Targets : public FarmOfSmallLeases {};

TEST_F(Targets, OfSingleTilesAreReachedBeforeTheJobIsDone) {
  JobShape shape = tiles(2, 2);
  shape.targets = TileTargets({{0, 1}, {1, 3}});
  submit("job", shape);
  EXPECT_EQ(job("job").samples_total, 4 * kTilePixels);
  EXPECT_THAT(render_all("a"), ElementsAre(WorkItem{0, {0, 1}}, WorkItem{1, {0, 1}}, WorkItem{1, {1, 2}},
                                           WorkItem{1, {2, 3}}));
  EXPECT_EQ(state("job"), JobState::kDone);
}

TEST_F(Targets, BoundTheSamplesThatCount) {
  JobShape shape = tiles(2, 2);
  shape.targets = TileTargets({{0, 1}});
  submit("job", shape);
  const LeaseDescription lease = lease_to("a");
  const Actions actions = deliver("a", lease, {WorkItem{0, {0, 2}}});
  ASSERT_FALSE(actions.status);
  EXPECT_THAT(actions.status.error().message, HasSubstr("samples [0, 1)"));
  EXPECT_TRUE(deliver("a", lease, {WorkItem{0, {0, 1}}}).status);
}

TEST_F(Targets, ThatAreRaisedMakeADoneJobRunAgain) {
  submit("job", tiles(2, 1));
  render_all("a");
  ASSERT_EQ(state("job"), JobState::kDone);
  EXPECT_THAT(handle(ExtendJob{{"job"}, 0, {{1, 2}}}).job_changes,
              ElementsAre(JobChange{{"job"}, JobState::kDone, JobState::kRunning}));
  EXPECT_EQ(job("job").shape.spp, 1u);
  EXPECT_THAT(render_all("a"), ElementsAre(WorkItem{1, {1, 2}}));
  EXPECT_EQ(state("job"), JobState::kDone);
}

TEST_F(Targets, OfTilesThatTheJobDoesNotHaveAreRefused) {
  submit("job", tiles(2, 1));
  for (const int tile : {-1, 2}) {
    const Actions actions = handle(ExtendJob{{"job"}, 1, {{tile, 2}}});
    ASSERT_FALSE(actions.status) << tile;
    EXPECT_EQ(actions.status.error().code, core::ErrorCode::kInvalidArgument);
  }
  EXPECT_FALSE(handle(ExtendJob{{"job"}, 0}).status) << "nothing to raise";
}

TEST_F(Targets, AreNoChangeIfTheyAreLowerThanBefore) {
  submit("job", tiles(2, 4));
  EXPECT_THAT(handle(ExtendJob{{"job"}, 0, {{1, 2}}}).changed_jobs, testing::IsEmpty());
  EXPECT_THAT(handle(ExtendJob{{"job"}, 0, {{1, 5}}}).changed_jobs, ElementsAre(JobId{"job"}));
}

}  // namespace
}  // namespace tessera::scheduler
