// SPDX-License-Identifier: Apache-2.0
// The workers' calls.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>

#include "proto/state_text.hpp"
#include "server/farm/job_life.hpp"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

using core::ErrorCode;
using testing::HasSubstr;

class Work : public ScriptedFarm {
 protected:
  // A worker that sends heartbeats for a hundred seconds, and delivers nothing.
  void keep_saying(const v1::SynchronizeRequest& request) {
    for (int call = 0; call < 20; ++call) {
      now_ += std::chrono::seconds(5);
      const WaitingCall waiting(coordinator(), request);
    }
  }
  bool is_stuck(char worker) {
    for (const auto& each : coordinator().dispatcher().workers()) {
      if (each.id() == std::string(32, worker)) return each.stuck();
    }
    return false;
  }
  // Whether worker a keeps a lease that it reports after others that the coordinator does not know.
  bool keeps_behind(const v1::Lease& lease, int others, int items) {
    v1::SynchronizeRequest request = greeting('a');
    for (int i = 0; i < others; ++i) {
      v1::Lease& other = *request.add_held();
      other.set_id(1'000'000 + static_cast<std::uint64_t>(i));
      other.set_job_id(lease.job_id());
      for (int j = 0; j < items; ++j) *other.add_items() = lease.items(0);
    }
    *request.add_held() = lease;
    const v1::SynchronizeResponse answer = synchronize(request);
    return answer.leases_size() > 0 && answer.leases(0).id() == lease.id();
  }
  // The kinds of what has happened to a job.
  std::string events_of(const std::string& id) {
    std::string names;
    std::int64_t last = 0;
    const v1::Job described = job(id);
    for (const v1::JobEvent& event : described.events()) {
      EXPECT_GE(event.at().seconds(), last);
      last = event.at().seconds();
      names += (names.empty() ? "" : " ") + proto::event_name(event.kind());
    }
    return names;
  }
  // The report of a worker that holds the lease and renders this item of it.
  v1::SynchronizeRequest rendering(char worker, const v1::Lease& lease, int item) {
    v1::SynchronizeRequest request = greeting(worker);
    *request.add_held() = lease;
    request.add_known_job_ids(lease.job_id());
    request.mutable_rendering()->set_lease_id(lease.id());
    request.mutable_rendering()->set_job_id(lease.job_id());
    *request.mutable_rendering()->mutable_item() = lease.items(item);
    return request;
  }
};

TEST_F(Work, AFarmComesToTheLocalImage) {
  const std::string id = submit();
  while (stored_job(id).state() == v1::JOB_STATE_RUNNING) {
    for (const char worker : {'a', 'b', 'c'}) work(worker, 1);
  }
  const v1::Job done = job(id);
  EXPECT_EQ(done.state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(done.samples_done(), kSamples);
  EXPECT_EQ(done.counters().samples(), kSamples);
  EXPECT_EQ(done.counters().closest_hit_rays(), 2 * kSamples);
  EXPECT_TRUE(done.has_finished_at());
  EXPECT_EQ(coordinator().images().get(id)->image.pixels, ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
}

TEST_F(Work, AJobTellsWhatHasHappenedToIt) {
  const std::string id = submit();
  EXPECT_EQ(events_of(id), "submitted validated");
  work('a', 1);
  ASSERT_TRUE(coordinator().jobs().pause(id));
  ASSERT_TRUE(coordinator().jobs().resume(id));
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(coordinator().jobs().extend(id, kSpp + 1));
  const std::string before = "submitted validated started paused resumed extended";
  EXPECT_EQ(events_of(id), before);
  work('a');
  EXPECT_EQ(events_of(id), before) << "its end is not stored yet";
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(events_of(id), before + " done");
  open();
  EXPECT_EQ(events_of(id), before + " done");
  ASSERT_TRUE(coordinator().jobs().extend(id, kSpp + 2));
  open();
  EXPECT_EQ(events_of(id), before + " done resumed extended");
  EXPECT_EQ(listed().at(0).events_size(), 0) << "a list is short";
}

TEST_F(Work, TheFirstSamplesOfAJobAreCountedOnce) {
  const std::string id = submit();
  const auto count = [&] {
    const auto counts = coordinator().farm().first_samples().snapshot().counts;
    return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  };
  EXPECT_EQ(count(), 0u);
  work('a', 2);
  EXPECT_EQ(count(), 1u);
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  open();
  work('a');
  EXPECT_EQ(count(), 0u) << "it had samples before the restart";
}

TEST(JobLife, KeepsTheFirstAndTheLastEvents) {
  farm::JobLife life;
  for (int i = 0; i < 200; ++i)
    life.note(i % 2 == 0 ? v1::JobEvent::KIND_PAUSED : v1::JobEvent::KIND_RESUMED, 1000 + i);
  ASSERT_EQ(life.events().size(), farm::JobLife::kMaxEvents);
  EXPECT_EQ(life.events()[farm::JobLife::kFirstEvents - 1].at_ms, 1006);
  EXPECT_EQ(life.events()[farm::JobLife::kFirstEvents].at_ms, 1143);
  EXPECT_EQ(life.events().back().at_ms, 1199);
  stored::v1::Counters counters;
  farm::write_life(life, counters);
  EXPECT_EQ(farm::read_life(counters), life);
  counters.mutable_events(0)->set_kind(1000);
  counters.mutable_events(1)->set_at_ms(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(farm::read_life(counters).events().size(), farm::JobLife::kMaxEvents - 2);
}

TEST_F(Work, LeasesComeWithWhatTheWorkerMustKnowOfTheJob) {
  const std::string id = submit();
  const v1::SynchronizeResponse first = synchronize(greeting('a'));
  ASSERT_EQ(first.leases_size(), 1);
  ASSERT_EQ(first.jobs_size(), 1);
  EXPECT_EQ(first.jobs(0).job_id(), id);
  EXPECT_EQ(first.jobs(0).settings().spp(), kSpp);
  EXPECT_EQ(first.jobs(0).bundle().scene_path(), "folder/scene.json");
  EXPECT_EQ(first.heartbeat_timeout().seconds(), 10);

  v1::SynchronizeRequest knowing = greeting('b');
  knowing.add_known_job_ids(id);
  EXPECT_EQ(synchronize(knowing).jobs_size(), 0);
}

// Each reported item takes time under the state lock.
TEST_F(Work, OnlyAsManyLeasesAreLookedAtAsAWorkerCanHold) {
  submit();
  const v1::Lease lease = synchronize(greeting('a')).leases(0);
  EXPECT_TRUE(keeps_behind(lease, 7, 1));
  EXPECT_FALSE(keeps_behind(lease, 8, 1));
}

TEST_F(Work, OnlyAsManyItemsAreLookedAtAsAWorkerCanHold) {
  submit();
  const v1::Lease lease = synchronize(greeting('a')).leases(0);
  EXPECT_TRUE(keeps_behind(lease, 1, 100));
  EXPECT_FALSE(keeps_behind(lease, 1, 1000));
}

TEST_F(Work, AResultThatComesTwiceIsDroppedTheSecondTime) {
  const std::string id = submit();
  const v1::Lease lease = synchronize(greeting('a')).leases(0);
  const auto first = deliver(delivery('a', lease));
  EXPECT_EQ(first.accepted_items(), static_cast<std::uint32_t>(lease.items_size()));
  EXPECT_EQ(first.dropped_items(), 0u);
  const v1::Counters counted = job(id).counters();
  const auto second = deliver(delivery('a', lease));
  EXPECT_EQ(second.accepted_items(), 0u);
  EXPECT_EQ(second.dropped_items(), static_cast<std::uint32_t>(lease.items_size()));
  EXPECT_EQ(job(id).counters().samples(), counted.samples());
}

TEST_F(Work, AResultForADeletedJobIsDropped) {
  const std::string id = submit();
  const v1::Lease lease = synchronize(greeting('a')).leases(0);
  ASSERT_TRUE(coordinator().jobs().remove(id));
  EXPECT_EQ(deliver(delivery('a', lease)).dropped_items(), static_cast<std::uint32_t>(lease.items_size()));
}

TEST_F(Work, AWorkerWithoutAProperIdIsRefused) {
  v1::SynchronizeRequest request = greeting('a');
  request.set_worker_id("worker 7");
  const WaitingCall call(coordinator(), request);
  ASSERT_TRUE(call.answered());
  EXPECT_EQ(call.answer().error().code, ErrorCode::kInvalidArgument);
}

TEST_F(Work, AJobWithAnUnbuildableSceneFails) {
  const std::string id = submit(), other = submit();
  ASSERT_TRUE(coordinator().jobs().pause(other));
  for (const char worker : {'a', 'b', 'c'}) {
    EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
    v1::SubmitResultRequest given_back = delivery(worker, synchronize(greeting(worker)).leases(0));
    given_back.clear_items();
    given_back.set_decline_reason("scene.json:3: shapes: unknown shape 'torus'");
    deliver(given_back);
  }
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_FAILED);
  EXPECT_THAT(job(id).failure(),
              HasSubstr("3 times in a row a worker could not build the scene, the last of them host-c, which "
                        "says: \"scene.json:3: shapes: unknown shape 'torus'\""));
  EXPECT_EQ(job(other).state(), v1::JOB_STATE_PAUSED);
}

TEST_F(Work, AWorkersTroublesReachWaitingSubmitters) {
  const std::string id = submit(), other = submit();
  v1::SynchronizeRequest request = greeting('a');
  v1::Trouble& trouble = *request.add_troubles();
  trouble.set_job_id(id);
  trouble.set_text("cannot fetch \x1b[31mmesh.obj: No space left on device" + std::string(2000, '!'));
  for (int i = 0; i < 10; ++i) *request.add_troubles() = trouble;
  synchronize(request);
  ASSERT_EQ(coordinator().dispatcher().workers()[0].troubles_size(), farm::Troubles::kMaxOfWorker);
  const std::string told = coordinator().dispatcher().workers()[0].troubles(0);
  EXPECT_THAT(told, testing::StartsWith("cannot fetch \\x1b[31mmesh.obj: No space left on device!!!"));
  EXPECT_LT(told.size(), farm::Troubles::kMaxTextBytes + 20);
  ASSERT_GT(job(id).troubles_size(), 0);
  EXPECT_EQ(job(id).troubles(0), "worker host-a says: " + told);
  EXPECT_EQ(job(other).troubles_size(), 0);

  request.mutable_troubles(0)->clear_job_id();
  synchronize(request);
  EXPECT_EQ(job(other).troubles_size(), 1);
  synchronize(greeting('a'));
  EXPECT_EQ(job(id).troubles_size(), 0);
}

TEST_F(Work, ASceneThatOneWorkerAloneCannotBuildFailsNoJob) {
  const std::string id = submit();
  synchronize(greeting('c'));
  const auto refuse = [&](char worker) {
    v1::SubmitResultRequest given_back = delivery(worker, synchronize(greeting(worker)).leases(0));
    given_back.clear_items();
    given_back.set_decline_reason("out of memory");
    deliver(given_back);
  };
  for (int i = 0; i < 5; ++i) refuse('a');
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
  work('c');
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
}

TEST_F(Work, ASceneThatTheOnlyWorkerCannotBuildFailsTheJob) {
  const std::string id = submit();
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
    v1::SubmitResultRequest given_back = delivery('a', synchronize(greeting('a')).leases(0));
    given_back.clear_items();
    given_back.set_decline_reason("out of memory");
    deliver(given_back);
  }
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_FAILED);
}

// Texts of the protocol are UTF-8, so a text cut within a character could not be sent.
TEST_F(Work, ALongReasonOfAWorkerIsCutBetweenCharacters) {
  const std::string id = submit();
  for (int i = 0; i < 3; ++i) {
    v1::SubmitResultRequest given_back = delivery('a', synchronize(greeting('a')).leases(0));
    given_back.clear_items();
    std::string reason = "x";
    for (int k = 0; k < 600; ++k) reason += "\u00e9";
    given_back.set_decline_reason(reason);
    deliver(given_back);
  }
  v1::Job read_again;
  EXPECT_TRUE(read_again.ParseFromString(stored_job(id).SerializeAsString()));
  EXPECT_THAT(read_again.failure(), HasSubstr("\u00e9\u00e9\u00e9"));
}

TEST_F(Work, AReasonOfAWorkerIsMadePrintable) {
  const std::string id = submit();
  for (int i = 0; i < 3; ++i) {
    v1::SubmitResultRequest given_back = delivery('a', synchronize(greeting('a')).leases(0));
    given_back.clear_items();
    given_back.set_decline_reason("a\x1b[2Jb\nc");
    deliver(given_back);
  }
  EXPECT_THAT(stored_job(id).failure(), HasSubstr("a\\x1b[2Jb\\x0ac"));
}

TEST_F(Work, NamesThatCannotBeShownAreRefused) {
  const auto refusal = [&](const v1::SynchronizeRequest& request) {
    const WaitingCall call(coordinator(), request);
    EXPECT_TRUE(call.answered() && !call.answer());
    return call.answer() ? core::Error{} : call.answer().error();
  };
  v1::SynchronizeRequest request = greeting('a');
  request.set_name("a\x1b]0;b\a");
  EXPECT_EQ(refusal(request).code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(refusal(request).message,
            "name: must be UTF-8 without line breaks and other control characters, got 'a\\x1b]0;b\\x07'");
  request.set_name(std::string(201, 'x'));
  EXPECT_THAT(refusal(request).message, HasSubstr("name: must have at most 200 bytes"));
  request = greeting('a');
  request.set_version("1\n2");
  EXPECT_THAT(refusal(request).message, HasSubstr("version: must be UTF-8"));
  request = greeting('a');
  request.set_determinism_fingerprint("f\r");
  EXPECT_THAT(refusal(request).message, HasSubstr("determinism_fingerprint: must be UTF-8"));
  EXPECT_TRUE(coordinator().dispatcher().workers().empty());

  submit();
  v1::SubmitResultRequest result = delivery('a', synchronize(greeting('a')).leases(0));
  result.set_version("\x1b");
  EXPECT_THAT(coordinator().dispatcher().submit_result(result).error().message,
              HasSubstr("version: must be UTF-8"));
}

TEST_F(Work, ABlobThatIsIntactAfterAllFailsNoJob) {
  const std::string id = submit();
  const proto::Digest scene = proto::digest_of(kSceneBytes);
  coordinator().jobs().blob_is_lost(scene, {ErrorCode::kDataLoss, "read wrongly"});
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
  coordinator().blobs().discard(scene);
  coordinator().jobs().blob_is_lost(scene, {ErrorCode::kNotFound, "gone"});
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_FAILED);
}

TEST_F(Work, SubmittingWhatIsDamagedFailsNoRunningJobAndAsksForItNextTime) {
  const std::string id = submit();
  const proto::Digest scene = proto::digest_of(kSceneBytes);
  write_file(coordinator().blobs().path(scene), "[]");
  EXPECT_EQ(refusal().code, ErrorCode::kDataLoss);
  EXPECT_FALSE(coordinator().blobs().contains(scene));
  EXPECT_EQ(refusal().code, ErrorCode::kFailedPrecondition);
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
}

TEST_F(Work, WorkersAreListed) {
  submit();
  work('a', 1);
  synchronize(greeting('a'));
  const auto workers = coordinator().dispatcher().workers();
  ASSERT_EQ(workers.size(), 1u);
  EXPECT_EQ(workers[0].id(), std::string(32, 'a'));
  EXPECT_EQ(workers[0].name(), "host-a");
  EXPECT_EQ(workers[0].held_leases(), 1u);
  EXPECT_GT(workers[0].samples_accepted(), 0u);
  EXPECT_GT(workers[0].last_seen_at().seconds(), 1'700'000'000);
}

TEST_F(Work, SamplesThatKeepThreeWorkersFailTheirJob) {
  const std::string id = submit();
  for (const char worker : {'a', 'b', 'c'}) work(worker, 1);
  const v1::Lease lease = synchronize(greeting('a')).leases(0);
  ASSERT_GT(lease.items_size(), 1);
  keep_saying(rendering('a', lease, 1));
  work('b', 1);  // samples before those
  for (const char worker : {'b', 'c'}) {
    EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
    const v1::Lease alone = synchronize(greeting(worker)).leases(0);
    EXPECT_EQ(alone.items(0).SerializeAsString(), lease.items(1).SerializeAsString());
    keep_saying(rendering(worker, alone, 0));
  }
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_FAILED);
  EXPECT_THAT(job(id).failure(), HasSubstr("host-a (aaaaaaaa), host-b (bbbbbbbb), host-c (cccccccc)"));
  open();
  const v1::Failure failure = job(id).failure_details();
  EXPECT_EQ(failure.reason(), v1::Failure::REASON_WORKERS_LOST);
  EXPECT_EQ(failure.message(), job(id).failure());
  EXPECT_EQ(failure.item().SerializeAsString(), lease.items(1).SerializeAsString());
  EXPECT_THAT(failure.workers(), testing::ElementsAre("host-a", "host-b", "host-c"));
}

TEST_F(Work, FalseProgressReportsChangeNoSamples) {
  v1::SubmitJobRequest job = submission();
  job.mutable_overrides()->set_spp(64);
  submit(job);
  const std::vector<std::function<void(v1::Rendering&)>> lies{
      [](v1::Rendering& said) { said.Clear(); },
      [](v1::Rendering& said) { said.clear_item(); },
      [](v1::Rendering& said) { said.set_job_id("none"); },
      [](v1::Rendering& said) { said.set_lease_id(~std::uint64_t{0}); },
      [](v1::Rendering& said) { said.mutable_item()->mutable_rect()->set_x1(~std::uint32_t{0}); },
      [](v1::Rendering& said) { said.mutable_item()->mutable_rect()->set_x0(1); },
      [](v1::Rendering& said) { said.mutable_item()->set_sample_end(0); },
  };
  for (std::size_t lie = 0; lie < lies.size(); ++lie) work(static_cast<char>('0' + lie), 1);
  for (std::size_t lie = 0; lie < lies.size(); ++lie) {
    const char worker = static_cast<char>('0' + lie);
    const v1::Lease lease = synchronize(greeting(worker)).leases(0);
    EXPECT_GT(lease.items_size(), 1) << "nothing is suspected, and leased by itself";
    v1::SynchronizeRequest request = rendering(worker, lease, 0);
    lies[lie](*request.mutable_rendering());
    keep_saying(request);
    EXPECT_TRUE(is_stuck(worker)) << lie;
  }
}

TEST_F(Work, TheLeaseOfALostWorkerIsReassigned) {
  const std::string id = submit();
  const v1::Lease lost = synchronize(greeting('a')).leases(0);
  now_ += std::chrono::seconds(11);
  EXPECT_FALSE(coordinator().dispatcher().workers()[0].silent());
  coordinator().dispatcher().tick();
  EXPECT_TRUE(coordinator().dispatcher().workers()[0].silent());
  work('b');
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(deliver(delivery('a', lost)).accepted_items(), 0u);
}

}  // namespace
}  // namespace tessera::server
