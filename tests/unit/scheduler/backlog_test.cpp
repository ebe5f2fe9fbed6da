// SPDX-License-Identifier: Apache-2.0
// What would take a single event too long is done with several, and nobody is told anything wrong meanwhile.
#include <string>
#include <vector>

#include "tests/unit/scheduler/audited_farm.hpp"

namespace tessera::scheduler {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

std::string worker_name(int number) {
  return "w" + std::to_string(100 + number);
}

class Backlog : public FarmOfSmallLeases {
 protected:
  bool is_left() { return scheduler_->next_deadline().value_or(Time::max()) <= now_; }
  // Lets time stand still until nothing is left. Returns the number of events.
  int finish() {
    int events = 0;
    for (; is_left() && !HasFailure(); ++events) handle(Tick{});
    return events;
  }
  // Workers with one lease each of a job, whose calls wait.
  void lease_to_many(int workers) {
    submit("job", tiles(1000, 16));
    for (int w = 0; w < workers; ++w) sync(worker_name(w), {lease_to(worker_name(w))});
  }
  int silent_workers() {
    int silent = 0;
    for (const WorkerView& worker : scheduler_->workers(now_)) silent += worker.silent;
    return silent;
  }
};

TEST_F(Backlog, ManyWaitingWorkersAreWokenAFewAtATime) {
  const auto most = static_cast<std::size_t>(options_.per_event.woken_workers);
  const int workers = options_.per_event.woken_workers * 5 / 2;
  for (int w = 0; w < workers; ++w) sync(worker_name(w));
  const Actions first = handle(SubmitJob{{"job"}, tiles(1000, 16)});
  ASSERT_THAT(first.wake, SizeIs(most));
  EXPECT_EQ(first.wake[0].value, worker_name(0));
  EXPECT_TRUE(is_left());
  std::vector<WorkerId> woken = first.wake;
  for (std::size_t i = 0; i < woken.size(); ++i) {
    const Actions actions = handle(TopUp{woken[i]});
    EXPECT_TRUE(actions.reply->changed);
    EXPECT_LE(actions.wake.size(), most);
    woken.insert(woken.end(), actions.wake.begin(), actions.wake.end());
  }
  EXPECT_THAT(woken, SizeIs(static_cast<std::size_t>(workers)));
  EXPECT_FALSE(is_left());
}

TEST_F(Backlog, NoIdleWaiterIsNotifiedOfRemovedWork) {
  const int most = options_.per_event.woken_workers;
  for (int w = 0; w < 3 * most; ++w) sync(worker_name(w));
  const Actions first = handle(SubmitJob{{"job"}, tiles(2, 1), 0, 1});
  ASSERT_THAT(first.wake, SizeIs(static_cast<std::size_t>(most)));
  const Actions next = handle(TopUp{first.wake[0]});
  EXPECT_TRUE(next.reply->changed);  // that is the only place
  EXPECT_THAT(next.wake, IsEmpty());
  EXPECT_FALSE(is_left());
}

TEST(WaitingWorkers, AreAllOfferedWorkThatAppearsDuringAWave) {
  std::vector<Worker> workers(4);
  WaitingWorkers waiting;
  for (std::size_t w = 0; w < workers.size(); ++w) {
    workers[w].info.id = {worker_name(static_cast<int>(w))};
    workers[w].sequence = w + 1;
    waiting.enter(workers[w]);
  }
  waiting.begin_wave();
  EXPECT_THAT(waiting.next(2), testing::ElementsAre(workers[0].info.id, workers[1].info.id));
  for (int w : {0, 1}) waiting.leave(workers[static_cast<std::size_t>(w)]);
  waiting.enter(workers[0]);  // it was given nothing
  waiting.begin_wave();
  EXPECT_THAT(waiting.next(3), testing::ElementsAre(workers[2].info.id, workers[3].info.id));
  for (int w : {2, 3}) waiting.leave(workers[static_cast<std::size_t>(w)]);
  ASSERT_TRUE(waiting.in_wave());
  EXPECT_THAT(waiting.next(3), testing::ElementsAre(workers[0].info.id));
  EXPECT_FALSE(waiting.in_wave());
}

TEST(WaitingWorkers, WithLeasesComeLastAndAlone) {
  std::vector<Worker> workers(3);
  WaitingWorkers waiting;
  for (std::size_t w = 0; w < workers.size(); ++w) {
    workers[w].info.id = {worker_name(static_cast<int>(w))};
    workers[w].sequence = w + 1;
  }
  workers[0].leases.push_back({});
  for (Worker& worker : workers) waiting.enter(worker);
  EXPECT_TRUE(waiting.any_idle());
  waiting.begin_wave();
  EXPECT_THAT(waiting.next(1), testing::ElementsAre(workers[1].info.id));
  waiting.skip_idle();
  EXPECT_THAT(waiting.next(3), testing::ElementsAre(workers[0].info.id));
  for (int w : {1, 2}) waiting.leave(workers[static_cast<std::size_t>(w)]);
  EXPECT_FALSE(waiting.any_idle());
  workers[0].leases.clear();
  waiting.update(workers[0]);
  EXPECT_TRUE(waiting.any_idle());
}

TEST_F(Backlog, LeasesOfManyLostWorkersExpireInBatches) {
  const int most = options_.per_event.expired_workers, workers = 5 * most / 2;
  lease_to_many(workers);
  pass(seconds(10));
  handle(Tick{});
  EXPECT_EQ(silent_workers(), most);
  EXPECT_EQ(job("job").active_workers, workers - most);
  EXPECT_TRUE(is_left());
  EXPECT_EQ(finish(), 2);
  EXPECT_EQ(silent_workers(), workers);
  EXPECT_EQ(job("job").active_workers, 0);
}

TEST_F(Backlog, AWorkerPastItsHeartbeatTimeoutIsLostBeforeItsEventIsHandled) {
  const int most = options_.per_event.expired_workers, workers = 2 * most;
  lease_to_many(workers);
  const std::string last = worker_name(workers - 1);
  pass(seconds(10));
  EXPECT_EQ(handle(TopUp{{last}}).status.error().code, core::ErrorCode::kNotFound);
  EXPECT_EQ(scheduler_->worker({last}, now_)->held_leases, 0);
}

TEST_F(Backlog, ManyForgottenWorkersAreRemovedAFewAtATime) {
  const int most = options_.per_event.expired_workers;
  for (int w = 0; w < 2 * most; ++w) sync(worker_name(w), {}, 0);
  pass(seconds(10));
  handle(Tick{});
  EXPECT_EQ(finish(), 1);
  pass(seconds(90));
  handle(Tick{});
  EXPECT_THAT(scheduler_->workers(now_), SizeIs(static_cast<std::size_t>(most)));
  EXPECT_EQ(finish(), 1);
  EXPECT_THAT(scheduler_->workers(now_), IsEmpty());
}

TEST_F(Backlog, TheLeasesOfACancelledJobAreRevokedAFewAtATime) {
  const int most = options_.per_event.revoked_leases, workers = 5 * most / 2;
  lease_to_many(workers);
  const Actions cancelled = handle(CancelJob{{"job"}});
  EXPECT_THAT(cancelled.wake, SizeIs(static_cast<std::size_t>(most)));
  EXPECT_EQ(job("job").active_workers, 0);
  for (const WorkerView& worker : scheduler_->workers(now_)) EXPECT_EQ(worker.held_leases, 0);
  EXPECT_TRUE(is_left());
  // A worker whose lease is still to be revoked.
  const Reply reply = *handle(TopUp{{worker_name(workers - 1)}}).reply;
  EXPECT_TRUE(reply.changed);
  EXPECT_THAT(reply.leases, IsEmpty());
  finish();
  EXPECT_FALSE(is_left());
}

TEST_F(Backlog, TheLeasesOfADeletedJobAreRevokedAFewAtATime) {
  const int workers = options_.per_event.revoked_leases * 2;
  lease_to_many(workers);
  handle(DeleteJob{{"job"}});
  EXPECT_TRUE(is_left());
  // The same id again is another job.
  submit("job", tiles(1000, 16));
  const std::string last = worker_name(workers - 1);
  EXPECT_THAT(sync(last, {}, 0).leases, IsEmpty());
  finish();
  EXPECT_FALSE(is_left());
}

// A job with more tiles than are searched in one event, of which a worker has rendered one sample each.
class LargeJob : public AuditsOf {
 protected:
  explicit LargeJob(double share = 0) : AuditsOf(share) {}

  int tile_count() const { return options_.per_event.searched_tiles * events_; }
  void restore(JobState state, int missing_tile, Due due = Due::kNo) {
    RestoreJob stored{{"job"}, tiles(tile_count(), 1), 0, state, "", {}, 0, {}};
    for (int tile = 0; tile < tile_count(); ++tile) {
      const WorkItem item{tile, {0, 1}};
      const bool done = tile != missing_tile;
      stored.done.push_back(done ? IntervalSet{{0, 1}} : IntervalSet{});
      if (done) stored.provenance.push_back({item, {"liar", {"liar"}, "liar"}, honest(item), due});
    }
    EXPECT_TRUE(handle(stored).status);
  }
  bool is_left() { return scheduler_->next_deadline().value_or(Time::max()) <= now_; }
  std::size_t search_on() {
    std::size_t found = 0;
    for (int i = 0; i < 10 && is_left(); ++i) found += handle(Tick{}).reviewed_tiles.size();
    return found;
  }

  int events_ = 2;  // that a search of the job takes
};

TEST_F(LargeJob, IsSearchedForDoubtfulSamplesWithSeveralEvents) {
  restore(JobState::kRunning, tile_count() - 1);
  sync("liar", {}, 0);
  const Actions actions = handle(Dismiss{{"liar"}, true});
  EXPECT_GT(actions.reviewed_tiles.size(), 1000u);
  EXPECT_LE(actions.reviewed_tiles.size(), static_cast<std::size_t>(options_.per_event.searched_tiles));
  EXPECT_TRUE(is_left());
  EXPECT_EQ(actions.reviewed_tiles.size() + search_on(), static_cast<std::size_t>(tile_count() - 1));
  EXPECT_EQ(job("job").samples_to_verify, job("job").samples_done);
}

TEST_F(LargeJob, IsNotDoneBeforeItIsSearched) {
  restore(JobState::kRunning, 0);
  const LeaseDescription lease = lease_to("honest");
  sync("liar", {}, 0);
  handle(Dismiss{{"liar"}, true});
  deliver_sums("honest", lease, honest);
  ASSERT_EQ(job("job").samples_done, job("job").samples_total);
  EXPECT_EQ(state("job"), JobState::kRunning);
  search_on();
  EXPECT_EQ(state("job"), JobState::kRunning);
  EXPECT_GT(job("job").samples_to_verify, 0u);
}

TEST_F(LargeJob, IsDoneAfterASearchThatFindsNothing) {
  restore(JobState::kRunning, 0);
  const LeaseDescription lease = lease_to("honest");
  sync("other", {}, 0);
  handle(Dismiss{{"other"}, true});
  ASSERT_TRUE(is_left());
  deliver_sums("honest", lease, honest);
  search_on();
  EXPECT_EQ(state("job"), JobState::kDone);
}

TEST_F(LargeJob, RunsAgainWhenItIsSearched) {
  restore(JobState::kDone, -1);
  sync("liar", {}, 0);
  std::vector<JobId> to_reopen = handle(Dismiss{{"liar"}, true}).reopen;
  EXPECT_THAT(to_reopen, testing::ElementsAre(JobId{"job"}));
  const std::size_t found = handle(ReopenJob{{"job"}}).reviewed_tiles.size();
  EXPECT_EQ(state("job"), JobState::kDone);
  EXPECT_EQ(found + search_on(), static_cast<std::size_t>(tile_count()));
  EXPECT_EQ(state("job"), JobState::kRunning);
}

TEST_F(LargeJob, DoesNotLeaveBeforeItIsSearched) {
  events_ = 3;
  restore(JobState::kDone, -1);
  sync("other", {}, 0);
  EXPECT_THAT(handle(Dismiss{{"other"}, true}).distrusted, testing::SizeIs(1));
  ASSERT_TRUE(is_left());
  const core::Status released = handle(ReleaseJob{{"job"}}).status;  // after the second part of the search
  ASSERT_FALSE(released);
  EXPECT_EQ(released.error().code, core::ErrorCode::kFailedPrecondition);
  search_on();
  EXPECT_TRUE(handle(ReleaseJob{{"job"}}).status);
}

TEST_F(LargeJob, IsGivenUpOnWithSeveralEvents) {
  restore(JobState::kRunning, -1, Due::kChosen);
  ASSERT_EQ(state("job"), JobState::kRunning);
  const auto most = static_cast<std::size_t>(options_.per_event.waived_audits);
  pass(options_.audit_patience);
  std::size_t events = 0, ranges = 0;
  for (; state("job") == JobState::kRunning && events < 100; ++events) {
    for (const Unaudited& unaudited : handle(Tick{}).unaudited) ranges += unaudited.ranges;
    EXPECT_EQ(is_left(), state("job") == JobState::kRunning);
  }
  EXPECT_EQ(ranges, static_cast<std::size_t>(tile_count()));
  EXPECT_EQ(events, ranges / most);
}

TEST_F(LargeJob, ManyJobsAreGivenUpOnWithSeveralEvents) {
  const int jobs = options_.per_event.unaudited_jobs * 2;
  for (int j = 0; j < jobs; ++j) {
    RestoreJob stored{{"job" + std::to_string(j)}, tiles(2, 1), 0, JobState::kRunning, "", {}, 0, {}};
    for (int tile = 0; tile < 2; ++tile) {
      stored.done.push_back({{0, 1}});
      stored.provenance.push_back({{tile, {0, 1}}, {"w", {"w"}}, sums(1), Due::kChosen});
    }
    handle(stored);
  }
  sync("w");  // it may not audit its own samples
  pass(options_.audit_patience - seconds(5));
  sync("w");
  pass(seconds(5));
  int events = 0;
  for (; events < 100 && (events == 0 || is_left()); ++events) handle(Tick{});
  EXPECT_LE(events, 4);
  for (const JobView& view : scheduler_->jobs(now_)) EXPECT_EQ(view.state, JobState::kDone);
}

TEST_F(LargeJob, AWorkerThatArrivesIsNoticedByManyJobs) {
  const int jobs = options_.per_event.unaudited_jobs * 2;
  for (int j = 0; j < jobs; ++j) {
    RestoreJob stored{{"job" + std::to_string(j)}, tiles(2, 1), 0, JobState::kRunning, "", {}, 0, {}};
    for (int tile = 0; tile < 2; ++tile) {
      stored.done.push_back({{0, 1}});
      stored.provenance.push_back({{tile, {0, 1}}, {"w", {"w"}}, sums(1), Due::kChosen});
    }
    handle(stored);
  }
  pass(options_.audit_patience - seconds(1));
  sync("other", {}, 0);
  while (is_left()) handle(Tick{});
  pass(seconds(2));
  EXPECT_THAT(handle(Tick{}).unaudited, IsEmpty());
}

}  // namespace
}  // namespace tessera::scheduler
