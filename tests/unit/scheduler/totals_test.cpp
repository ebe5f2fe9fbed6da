// SPDX-License-Identifier: Apache-2.0
// The sums over jobs and workers. That they are right after every event is an invariant (check.cpp); these
// tests say what counts as what.
#include <gtest/gtest.h>

#include "tests/unit/scheduler/farm.hpp"

namespace tessera::scheduler {
namespace {

class TotalsTest : public Farm {
 protected:
  Totals totals() { return scheduler_->totals(now_); }
  std::uint64_t jobs(JobState state) { return totals().jobs[static_cast<std::size_t>(state)]; }
  std::uint64_t workers(WorkerActivity activity) {
    return totals().workers[static_cast<std::size_t>(activity)];
  }
  std::uint64_t ended(LeaseState state) {
    return totals().counts.ended_leases[static_cast<std::size_t>(state)];
  }
};

TEST_F(TotalsTest, JobsCountInTheirStateAndRunningOnesWithWhatTheyLack) {
  submit("first", tiles(4, 2));
  submit("second", tiles(2, 1));
  EXPECT_EQ(jobs(JobState::kRunning), 2u);
  EXPECT_EQ(totals().missing_samples, 10 * kTilePixels);
  handle(PauseJob{{"first"}});
  EXPECT_EQ(jobs(JobState::kPaused), 1u);
  EXPECT_EQ(totals().missing_samples, 2 * kTilePixels);
  handle(ResumeJob{{"first"}});
  handle(CancelJob{{"second"}});
  EXPECT_EQ(jobs(JobState::kCancelled), 1u);
  EXPECT_EQ(totals().counts.job_changes[static_cast<std::size_t>(JobState::kCancelled)], 1u);
  EXPECT_EQ(totals().missing_samples, 8 * kTilePixels);
  handle(ExtendJob{{"first"}, 3});
  EXPECT_EQ(totals().missing_samples, 12 * kTilePixels);
  handle(DeleteJob{{"first"}});
  handle(DeleteJob{{"second"}});
  EXPECT_EQ(jobs(JobState::kRunning) + jobs(JobState::kCancelled), 0u);
  EXPECT_EQ(totals().missing_samples, 0u);
}

TEST_F(TotalsTest, AcceptedSamplesAreNoLongerMissing) {
  submit("job", tiles(4, 2));
  const LeaseDescription lease = lease_to("worker");
  pass(seconds(1));
  deliver("worker", lease);
  const Totals now = totals();
  EXPECT_EQ(now.counts.accepted_items, lease.items.size());
  EXPECT_EQ(now.counts.accepted_samples, lease.items.size() * kTilePixels);
  EXPECT_EQ(now.missing_samples, 8 * kTilePixels - now.counts.accepted_samples);
  pass(seconds(1));
  EXPECT_GT(totals().samples_per_second, 0);
  deliver("worker", lease);
  EXPECT_EQ(totals().counts.dropped_items, lease.items.size());
  EXPECT_EQ(totals().counts.accepted_samples, now.counts.accepted_samples);
}

TEST_F(TotalsTest, ResultsOfUnknownJobsAreDropped) {
  handle(SubmitResult{{"worker"}, {"job"}, {1}, {{0, {0, 1}}, {1, {0, 1}}}, 1, true});
  EXPECT_EQ(totals().counts.dropped_items, 2u);
}

TEST_F(TotalsTest, WorkersCountByWhatTheyDo) {
  submit("job", tiles(4, 2));
  sync("busy");
  sync("draining", {}, 1, true);
  handle(CancelJob{{"job"}});
  tick();
  sync("idle");
  EXPECT_EQ(workers(WorkerActivity::kBusy), 0u) << "its job has ended";
  EXPECT_EQ(workers(WorkerActivity::kIdle), 2u);
  EXPECT_EQ(workers(WorkerActivity::kDraining), 1u);
  submit("other", tiles(4, 2));
  sync("busy");
  EXPECT_EQ(workers(WorkerActivity::kBusy), 1u);
  EXPECT_EQ(workers(WorkerActivity::kIdle), 1u);
  pass(options_.lease_duration);
  tick();
  EXPECT_EQ(workers(WorkerActivity::kSilent), 3u);
  pass(options_.forget_after);
  tick();
  EXPECT_EQ(workers(WorkerActivity::kSilent), 0u);
}

TEST_F(TotalsTest, LeasesCountAsTheyEnd) {
  submit("job", tiles(4, 4));
  const LeaseDescription lease = lease_to("a");
  EXPECT_EQ(totals().counts.granted_leases, 1u);
  deliver("a", lease);
  EXPECT_EQ(ended(LeaseState::kDone), 1u);
  deliver("a", lease_to("a"), {});
  EXPECT_EQ(ended(LeaseState::kReturned), 1u);
  const LeaseDescription lost = lease_to("a");
  pass(options_.lease_duration);
  tick();
  EXPECT_EQ(ended(LeaseState::kExpired), 1u);
  sync("a", {lost});
  EXPECT_EQ(totals().counts.adopted_leases, 1u);
  handle(CancelJob{{"job"}});
  EXPECT_EQ(ended(LeaseState::kRevoked), 1u);
}

}  // namespace
}  // namespace tessera::scheduler
