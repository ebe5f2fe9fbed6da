// What workers ask and deliver.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "proto/convert.hpp"
#include "proto/tile_codec.hpp"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::coordinator {
namespace {

using core::ErrorCode;
using testing::HasSubstr;

class Work : public ScriptedFarm {};

TEST_F(Work, AFarmComesToTheLocalPicture) {
  const std::string id = submit();
  while (job(id).state() == v1::JOB_STATE_RUNNING) {
    for (const char worker : {'a', 'b', 'c'}) work(worker, 1);
  }
  const v1::Job done = job(id);
  EXPECT_EQ(done.state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(done.samples_done(), kSamples);
  EXPECT_EQ(done.counters().samples(), kSamples);
  EXPECT_EQ(done.counters().closest_hit_rays(), 2 * kSamples);
  EXPECT_TRUE(done.has_finished_at());
  EXPECT_EQ(coordinator().picture(id)->image.pixels, ready_made_picture(kWidthPx, kHeightPx, kSpp).pixels);
}

TEST_F(Work, LeasesComeWithWhatTheWorkerMustKnowOfTheJob) {
  const std::string id = submit();
  const v1::SynchronizeResponse first = synchronize(greeting('a'));
  ASSERT_EQ(first.leases_size(), 1);
  ASSERT_EQ(first.jobs_size(), 1);
  EXPECT_EQ(first.jobs(0).job_id(), id);
  EXPECT_EQ(first.jobs(0).settings().spp(), kSpp);
  EXPECT_EQ(first.jobs(0).bundle().scene_path(), "folder/scene.json");
  EXPECT_EQ(first.heard_within().seconds(), 10);

  v1::SynchronizeRequest knowing = greeting('b');
  knowing.add_known_job_ids(id);
  EXPECT_EQ(synchronize(knowing).jobs_size(), 0);
}

TEST_F(Work, AResultThatComesTwiceIsDroppedTheSecondTime) {
  const std::string id = submit();
  const v1::Lease lease = synchronize(greeting('a')).leases(0);
  const auto first = deliver(delivery('a', lease));
  EXPECT_EQ(first.accepted_items(), static_cast<std::uint32_t>(lease.items_size()));
  EXPECT_EQ(first.dropped_items(), 0u);
  const v1::Counters counted = job(id).counters();
  const auto second = deliver(delivery('b', lease));
  EXPECT_EQ(second.accepted_items(), 0u);
  EXPECT_EQ(second.dropped_items(), static_cast<std::uint32_t>(lease.items_size()));
  EXPECT_EQ(job(id).counters().samples(), counted.samples());
}

TEST_F(Work, AResultForAJobThatIsGoneIsDropped) {
  const std::string id = submit();
  const v1::Lease lease = synchronize(greeting('a')).leases(0);
  ASSERT_TRUE(coordinator().delete_job(id));
  EXPECT_EQ(deliver(delivery('a', lease)).dropped_items(), static_cast<std::uint32_t>(lease.items_size()));
}

struct Lie {
  const char* name;
  std::function<void(v1::RenderedItem&)> tell;
};

class WorkLies : public Work, public testing::WithParamInterface<Lie> {};

TEST_P(WorkLies, AreRefusedAndNothingIsCounted) {
  const std::string id = submit();
  v1::SubmitResultRequest request = delivery('a', synchronize(greeting('a')).leases(0));
  GetParam().tell(*request.mutable_items(request.items_size() - 1));
  const auto refused = coordinator().submit_result(request);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(job(id).samples_done(), 0u);
  EXPECT_EQ(job(id).counters().samples(), 0u);
  EXPECT_EQ(coordinator().picture(id)->image.pixels, core::Image(kWidthPx, kHeightPx).pixels);
}

void rerender(v1::RenderedItem& item, core::PixelRect rect, core::SampleRange range) {
  item = proto::encode_tile(ready_made_tile(rect, range));
}

INSTANTIATE_TEST_SUITE_P(
    Work, WorkLies,
    testing::Values(
        Lie{"NoTileOfTheGrid",
            [](auto& item) {
              rerender(item, {1, 0, 65, 64}, {0, 1});
            }},
        Lie{"PartOfATile",
            [](auto& item) {
              rerender(item, {0, 0, 64, 63}, {0, 1});
            }},
        Lie{"OutsideThePicture",
            [](auto& item) {
              rerender(item, {640, 0, 704, 64}, {0, 1});
            }},
        Lie{"SamplesNobodyAskedFor",
            [](auto& item) {
              rerender(item, {0, 0, 64, 64}, {kSpp, kSpp + 1});
            }},
        Lie{"EmptyRange",
            [](auto& item) { item.mutable_item()->set_sample_end(item.item().sample_begin()); }},
        Lie{"TooManySums", [](auto& item) { item.set_sums_zstd(item.sums_zstd() + item.sums_zstd()); }},
        Lie{"NoZstd", [](auto& item) { item.set_sums_zstd("sums"); }},
        Lie{"WrongChecksum", [](auto& item) { item.set_sums_xxh3(item.sums_xxh3() ^ 1); }},
        Lie{"WrongSampleCount", [](auto& item) { item.mutable_counters()->set_samples(1); }},
        Lie{"AForeignNonFiniteSample",
            [](auto& item) { item.mutable_counters()->mutable_first_non_finite()->set_x(100'000); }}),
    [](const auto& lie) { return lie.param.name; });

TEST_F(Work, AWorkerWhoseResultsAreRefusedAgainAndAgainIsPutAside) {
  const std::string id = submit();
  const v1::Lease lease = synchronize(greeting('a')).leases(0);
  v1::SubmitResultRequest lie = delivery('a', lease);
  lie.mutable_items(0)->set_sums_xxh3(lie.items(0).sums_xxh3() ^ 1);
  for (int i = 1; i <= 2; ++i) {
    EXPECT_EQ(coordinator().submit_result(lie).error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(coordinator().workers()[0].refused_results(), static_cast<std::uint64_t>(i));
  }
  v1::SubmitResultRequest invented = delivery('a', lease);
  invented.set_lease_id(lease.id() + 1);
  EXPECT_EQ(coordinator().submit_result(invented).error().code, ErrorCode::kInvalidArgument);
  EXPECT_TRUE(coordinator().workers()[0].put_aside());
  EXPECT_EQ(coordinator().workers()[0].held_leases(), 0u);

  EXPECT_EQ(coordinator().submit_result(delivery('a', lease)).error().code, ErrorCode::kFailedPrecondition);
  for (const char worker : {'a', 'b'}) {
    v1::SynchronizeRequest request = greeting(worker);
    request.set_name("host-a");
    const WaitingCall call(coordinator(), request);
    ASSERT_TRUE(call.answered());
    EXPECT_THAT(call.answer().error().message, HasSubstr("worker host-a is put aside"));
  }
  work('c');
  EXPECT_EQ(coordinator().picture(id)->image.pixels, ready_made_picture(kWidthPx, kHeightPx, kSpp).pixels);
}

TEST_F(Work, WhoWorksUnderTheNameOfOneThatIsPutAsideGoesOn) {
  submit();
  for (const std::string name : {"farm", ""}) {
    const auto named = [&](char worker) {
      v1::SynchronizeRequest request = greeting(worker);
      request.set_name(name);
      return request;
    };
    const char bad = name.empty() ? 'b' : 'a', later = name.empty() ? 'e' : 'd';
    const v1::Lease lease = synchronize(named(bad)).leases(0);
    v1::SynchronizeRequest other = named('c');
    *other.add_held() = synchronize(other).leases(0);
    v1::SubmitResultRequest lie = delivery(bad, lease);
    lie.mutable_items(0)->set_sums_xxh3(lie.items(0).sums_xxh3() ^ 1);
    for (int i = 0; i < Conduct::kRefusalsUntilAside; ++i) EXPECT_FALSE(coordinator().submit_result(lie));
    const WaitingCall refused(coordinator(), named(bad));
    EXPECT_TRUE(refused.answered() && !refused.answer());
    const WaitingCall goes_on(coordinator(), other);
    EXPECT_TRUE(!goes_on.answered() || goes_on.answer());
    const WaitingCall newcomer(coordinator(), named(later));
    EXPECT_EQ(newcomer.answered() && !newcomer.answer(), !name.empty());
  }
}

TEST(ConductTest, ForgetsWhoIsGoneUnlessItWasPutAside) {
  Conduct conduct;
  for (int i = 0; i < Conduct::kRefusalsUntilAside; ++i) conduct.refused("liar", "");
  conduct.refused("gone", "");
  conduct.refused("here", "");
  conduct.forget_others({"here"});
  EXPECT_EQ(conduct.refusals("gone"), 0u);
  EXPECT_EQ(conduct.refusals("here"), 1u);
  EXPECT_TRUE(conduct.is_aside("liar"));
  EXPECT_FALSE(conduct.is_name_aside(""));
}

TEST_F(Work, RefusalsWithGoodResultsInBetweenPutNobodyAside) {
  submit();
  for (int i = 0; i < 4; ++i) {
    const v1::Lease lease = synchronize(greeting('a')).leases(0);
    v1::SubmitResultRequest bad = delivery('a', lease);
    bad.mutable_items(0)->set_sums_zstd("sums");
    EXPECT_FALSE(coordinator().submit_result(bad));
    deliver(delivery('a', lease));
  }
  EXPECT_FALSE(coordinator().workers()[0].put_aside());
  EXPECT_EQ(coordinator().workers()[0].refused_results(), 4u);
}

TEST_F(Work, SamplesOfAnotherArithmeticAreRefused) {
  const std::string id = submit();
  v1::SubmitResultRequest request = delivery('a', synchronize(greeting('a')).leases(0));
  request.set_arithmetic_fingerprint("beef");
  EXPECT_EQ(coordinator().submit_result(request).error().code, ErrorCode::kFailedPrecondition);
  EXPECT_EQ(job(id).samples_done(), 0u);
  request.set_arithmetic_fingerprint("f00d");
  EXPECT_GT(deliver(request).accepted_items(), 0u);
}

TEST_F(Work, AResultOfTooManyItemsIsRefusedUnread) {
  submit();
  v1::SubmitResultRequest request = delivery('a', synchronize(greeting('a')).leases(0));
  while (request.items_size() <= 256) *request.add_items() = request.items(0);
  const auto refused = coordinator().submit_result(request);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
}

TEST_F(Work, AWorkerThatComputesOtherBitsIsRefusedByBothFingerprints) {
  submit();
  synchronize(greeting('a'));
  v1::SynchronizeRequest stranger = greeting('b');
  stranger.set_arithmetic_fingerprint("beef");
  const WaitingCall call(coordinator(), stranger);
  ASSERT_TRUE(call.answered());
  ASSERT_FALSE(call.answer());
  EXPECT_EQ(call.answer().error().code, ErrorCode::kFailedPrecondition);
  EXPECT_THAT(call.answer().error().message, HasSubstr("its fingerprint is beef, the farm's is f00d"));
}

TEST_F(Work, AnotherArithmeticMayTakeOverWhenNothingOfTheOldOneIsLeft) {
  const std::string done = submit();
  work('a');
  now_ += std::chrono::seconds(11);  // the old worker is gone
  coordinator().tick();
  v1::SynchronizeRequest successor = greeting('b');
  successor.set_arithmetic_fingerprint("beef");
  submit();
  EXPECT_EQ(synchronize(successor).leases_size(), 1);
  // But what the old one began cannot be continued.
  EXPECT_EQ(coordinator().extend_job(done, kSpp + 1).error().code, ErrorCode::kFailedPrecondition);
}

TEST_F(Work, AnUnfinishedJobKeepsItsArithmeticAcrossARestart) {
  submit();
  work('a', 1);
  ASSERT_TRUE(coordinator().checkpoint());
  open();
  v1::SynchronizeRequest stranger = greeting('b');
  stranger.set_arithmetic_fingerprint("beef");
  const WaitingCall call(coordinator(), stranger);
  ASSERT_TRUE(call.answered());
  EXPECT_EQ(call.answer().error().code, ErrorCode::kFailedPrecondition);
}

TEST_F(Work, AWorkerWithoutAProperIdIsRefused) {
  v1::SynchronizeRequest request = greeting('a');
  request.set_worker_id("worker 7");
  const WaitingCall call(coordinator(), request);
  ASSERT_TRUE(call.answered());
  EXPECT_EQ(call.answer().error().code, ErrorCode::kInvalidArgument);
}

TEST_F(Work, AJobWhoseSceneNobodyCanBuildFails) {
  const std::string id = submit(), other = submit();
  ASSERT_TRUE(coordinator().pause_job(other));
  for (const char worker : {'a', 'b', 'c'}) {
    EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
    v1::SubmitResultRequest given_back = delivery(worker, synchronize(greeting(worker)).leases(0));
    given_back.clear_items();
    given_back.set_cannot_build("scene.json:3: shapes: unknown shape 'torus'");
    deliver(given_back);
  }
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_FAILED);
  EXPECT_THAT(job(id).failure(),
              HasSubstr("3 times in a row a worker could not build the scene, the last of them host-c: "
                        "scene.json:3: shapes: unknown shape 'torus'"));
  EXPECT_EQ(job(other).state(), v1::JOB_STATE_PAUSED);
}

TEST_F(Work, ASceneThatOneWorkerAloneCannotBuildFailsNoJob) {
  const std::string id = submit();
  synchronize(greeting('c'));
  const auto refuse = [&](char worker) {
    v1::SubmitResultRequest given_back = delivery(worker, synchronize(greeting(worker)).leases(0));
    given_back.clear_items();
    given_back.set_cannot_build("out of memory");
    deliver(given_back);
  };
  for (int i = 0; i < 5; ++i) refuse('a');
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
  work('c');
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_DONE);
}

TEST_F(Work, ASceneThatTheOnlyWorkerCannotBuildFailsTheJob) {
  const std::string id = submit();
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
    v1::SubmitResultRequest given_back = delivery('a', synchronize(greeting('a')).leases(0));
    given_back.clear_items();
    given_back.set_cannot_build("out of memory");
    deliver(given_back);
  }
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_FAILED);
}

// Texts of the contract are UTF-8: what is cut within a character could not be told to anybody.
TEST_F(Work, ALongReasonOfAWorkerIsCutBetweenCharacters) {
  const std::string id = submit();
  for (int i = 0; i < 3; ++i) {
    v1::SubmitResultRequest given_back = delivery('a', synchronize(greeting('a')).leases(0));
    given_back.clear_items();
    std::string reason = "x";
    for (int k = 0; k < 600; ++k) reason += "\u00e9";
    given_back.set_cannot_build(reason);
    deliver(given_back);
  }
  v1::Job read_again;
  EXPECT_TRUE(read_again.ParseFromString(job(id).SerializeAsString()));
  EXPECT_THAT(read_again.failure(), HasSubstr("\u00e9\u00e9\u00e9"));
}

TEST_F(Work, AReasonOfAWorkerIsMadePrintable) {
  const std::string id = submit();
  for (int i = 0; i < 3; ++i) {
    v1::SubmitResultRequest given_back = delivery('a', synchronize(greeting('a')).leases(0));
    given_back.clear_items();
    given_back.set_cannot_build("a\x1b[2Jb\nc");
    deliver(given_back);
  }
  EXPECT_THAT(job(id).failure(), HasSubstr("a\\x1b[2Jb\\x0ac"));
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
  request.set_arithmetic_fingerprint("f\r");
  EXPECT_THAT(refusal(request).message, HasSubstr("arithmetic_fingerprint: must be UTF-8"));
  EXPECT_TRUE(coordinator().workers().empty());

  submit();
  v1::SubmitResultRequest result = delivery('a', synchronize(greeting('a')).leases(0));
  result.set_version("\x1b");
  EXPECT_THAT(coordinator().submit_result(result).error().message, HasSubstr("version: must be UTF-8"));
}

TEST_F(Work, ABlobThatIsIntactAfterAllFailsNoJob) {
  const std::string id = submit();
  const proto::Digest scene = proto::digest_of(kSceneBytes);
  coordinator().blob_is_lost(scene, {ErrorCode::kDataLoss, "read wrongly"});
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
  coordinator().blobs().discard(scene);
  coordinator().blob_is_lost(scene, {ErrorCode::kNotFound, "gone"});
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_FAILED);
}

TEST_F(Work, SubmittingWhatIsDamagedAsksForItAndFailsNoRunningJob) {
  const std::string id = submit();
  const proto::Digest scene = proto::digest_of(kSceneBytes);
  write_file(coordinator().blobs().path(scene), "[]");
  EXPECT_EQ(coordinator().submit_job(submission()).error().code, ErrorCode::kFailedPrecondition);
  EXPECT_FALSE(coordinator().blobs().contains(scene));
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
}

TEST_F(Work, WorkersAreListed) {
  submit();
  work('a', 1);
  synchronize(greeting('a'));
  const auto workers = coordinator().workers();
  ASSERT_EQ(workers.size(), 1u);
  EXPECT_EQ(workers[0].id(), std::string(32, 'a'));
  EXPECT_EQ(workers[0].name(), "host-a");
  EXPECT_EQ(workers[0].held_leases(), 1u);
  EXPECT_GT(workers[0].samples_accepted(), 0u);
  EXPECT_GT(workers[0].last_seen_at().seconds(), 1'700'000'000);
}

TEST_F(Work, TheLeaseOfASilentWorkerGoesToAnother) {
  submit();
  const v1::Lease lost = synchronize(greeting('a')).leases(0);
  now_ += std::chrono::seconds(11);
  EXPECT_FALSE(coordinator().workers()[0].silent());
  coordinator().tick();
  EXPECT_TRUE(coordinator().workers()[0].silent());
  work('b');
  EXPECT_EQ(coordinator().jobs()[0].state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(deliver(delivery('a', lost)).accepted_items(), 0u);
}

}  // namespace
}  // namespace tessera::coordinator
