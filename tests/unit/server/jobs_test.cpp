// SPDX-License-Identifier: Apache-2.0
// The users' operations on jobs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "core/scene/settings.hpp"
#include "proto/blob.hpp"
#include "proto/convert.hpp"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

using core::ErrorCode;
using testing::HasSubstr;

class Jobs : public ScriptedFarm {};

core::Result<jobs::CheckedScene> accept_as_larger_than_allowed(const v1::Bundle& bundle,
                                                               const v1::RenderOverrides& overrides,
                                                               const std::vector<std::int32_t>&,
                                                               const std::stop_token&) {
  jobs::CheckedScene scene = *accept_scene(bundle, overrides);
  scene.settings.set_width_px(32768);
  scene.settings.set_height_px(16384);
  return scene;
}

TEST_F(Jobs, NamesThatCannotBeShownAreRefused) {
  const auto refusal = [&](const v1::SubmitJobRequest& request) {
    const auto job = coordinator().jobs().submit(request);
    EXPECT_FALSE(job);
    return job ? "" : job.error().message;
  };
  v1::SubmitJobRequest request = submission();
  request.set_name("a\x1b[2Jb");
  EXPECT_EQ(refusal(request),
            "name: must be UTF-8 without line breaks and other control characters, got 'a\\x1b[2Jb'");
  request = submission();
  request.set_request_id(std::string(201, 'x'));
  EXPECT_THAT(refusal(request), testing::HasSubstr("request_id: must have at most 200 bytes"));
  request = submission();
  request.mutable_bundle()->mutable_assets(0)->set_path("scene\n.json");
  EXPECT_THAT(refusal(request), testing::HasSubstr("bundle: path: must be UTF-8"));
  EXPECT_TRUE(listed().empty());
}

TEST_F(Jobs, ASubmittedJobRunsAndIsComplete) {
  v1::SubmitJobRequest request = submission();
  request.set_name("vase");
  request.set_priority(3);
  const v1::Job submitted = job(submit(request));
  EXPECT_EQ(submitted.id().size(), 32u);
  EXPECT_EQ(submitted.name(), "vase");
  EXPECT_EQ(submitted.priority(), 3);
  EXPECT_EQ(submitted.state(), v1::JOB_STATE_RUNNING);
  EXPECT_EQ(submitted.samples_total(), kSamples);
  EXPECT_EQ(submitted.samples_done(), 0u);
  EXPECT_EQ(submitted.settings().width_px(), 150u);
  EXPECT_EQ(submitted.bundle().assets_size(), 1);
  EXPECT_GT(submitted.created_at().seconds(), 1'700'000'000);
  EXPECT_FALSE(submitted.has_finished_at());
}

TEST_F(Jobs, IsCalledLikeItsSceneFileUnlessNamed) {
  EXPECT_EQ(job(submit()).name(), "scene.json");
}

TEST_F(Jobs, ARepeatedSubmissionAnswersWithTheFirstJob) {
  v1::SubmitJobRequest request = submission();
  request.set_request_id("once");
  const std::string first = submit(request);
  EXPECT_EQ(submit(request), first);
  open();
  EXPECT_EQ(submit(request), first);
  EXPECT_EQ(listed().size(), 1u);
}

TEST_F(Jobs, ASubmissionWithoutARequestIdMayBeMadeTwice) {
  EXPECT_NE(submit(), submit());
}

TEST_F(Jobs, MissingBlobsAreListedByTheirPaths) {
  v1::SubmitJobRequest request = submission();
  v1::Bundle::Asset* asset = request.mutable_bundle()->add_assets();
  asset->set_path("wood.png");
  *asset->mutable_digest() = proto::to_proto(proto::digest_of("not uploaded"));
  const auto refused = coordinator().jobs().submit(request);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kFailedPrecondition);
  EXPECT_THAT(refused.error().message,
              HasSubstr("wood.png (" + proto::digest_of("not uploaded").hex() + ")"));
}

TEST_F(Jobs, ABundleWithoutItsSceneOrWithAPathTwiceIsRefused) {
  v1::SubmitJobRequest other_scene = submission(), twice = submission();
  other_scene.mutable_bundle()->set_scene_path("other.json");
  *twice.mutable_bundle()->add_assets() = twice.bundle().assets(0);
  EXPECT_EQ(coordinator().jobs().submit(other_scene).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(coordinator().jobs().submit(twice).error().code, ErrorCode::kInvalidArgument);
}

TEST_F(Jobs, ASceneThatIsRefusedFailsItsJob) {
  check_scene_ = [](const v1::Bundle&, const v1::RenderOverrides&, const std::vector<std::int32_t>&,
                    const std::stop_token&) -> core::Result<jobs::CheckedScene> {
    return core::fail(ErrorCode::kInvalidArgument, "scene.json:3: no camera");
  };
  open();
  const std::string id = submit();
  for (int start = 0; start < 2; ++start) {
    EXPECT_EQ(job(id).state(), v1::JOB_STATE_FAILED);
    EXPECT_EQ(job(id).failure(), "scene.json:3: no camera");
    EXPECT_EQ(job(id).failure_details().message(), "scene.json:3: no camera");
    EXPECT_EQ(job(id).failure_details().reason(), v1::Failure::REASON_INVALID_SCENE);
    EXPECT_TRUE(job(id).has_finished_at());
    EXPECT_EQ(coordinator().images().get(id).error().code, ErrorCode::kFailedPrecondition);
    EXPECT_EQ(coordinator().jobs().extend(id, 100).error().code, ErrorCode::kFailedPrecondition);
    open();  // and after a restart
  }
}

TEST_F(Jobs, AnImageTooLargeForTheFarmIsRefused) {
  check_scene_ = accept_as_larger_than_allowed;
  open();
  EXPECT_EQ(refusal().code, ErrorCode::kResourceExhausted);
}

TEST_F(Jobs, KeepHowTheirSceneIsShownUnlessTheSubmissionSaysOtherwise) {
  check_scene_ = [](const v1::Bundle& bundle, const v1::RenderOverrides& overrides,
                    const std::vector<std::int32_t>&, const std::stop_token&) {
    jobs::CheckedScene scene = *accept_scene(bundle, overrides);
    scene.display.set_exposure_stops(2);
    scene.display.set_tone_curve(v1::TONE_CURVE_AGX);
    return core::Result<jobs::CheckedScene>(scene);
  };
  open();
  v1::SubmitJobRequest request = submission();
  const std::string as_the_scene_says = submit(request);
  request.mutable_display()->set_exposure_stops(-1);
  const std::string darker = submit(request);
  open();  // and after a restart
  EXPECT_EQ(job(as_the_scene_says).display().exposure_stops(), 2);
  EXPECT_EQ(job(as_the_scene_says).display().tone_curve(), v1::TONE_CURVE_AGX);
  EXPECT_EQ(job(darker).display().exposure_stops(), -1);
  EXPECT_EQ(job(darker).display().tone_curve(), v1::TONE_CURVE_AGX);
  request.mutable_display()->set_exposure_stops(1000);
  EXPECT_EQ(coordinator().jobs().submit(request).error().code, ErrorCode::kInvalidArgument);
}

TEST_F(Jobs, AreListedNewestFirst) {
  const std::string first = submit(), second = submit();
  const auto jobs = listed();
  ASSERT_EQ(jobs.size(), 2u);
  EXPECT_EQ(jobs[0].id(), second);
  EXPECT_EQ(jobs[1].id(), first);
}

TEST_F(Jobs, APausedJobIsNotLeasedUntilItIsResumed) {
  const std::string id = submit();
  EXPECT_EQ(coordinator().jobs().pause(id)->state(), v1::JOB_STATE_PAUSED);
  const WaitingCall call(coordinator(), greeting('a'));
  EXPECT_FALSE(call.answered());
  EXPECT_EQ(coordinator().jobs().resume(id)->state(), v1::JOB_STATE_RUNNING);
  ASSERT_TRUE(call.answered());
  EXPECT_EQ(call.answer()->leases_size(), 1);
}

TEST_F(Jobs, ACancelledJobKeepsItsImageAndTakesNoMore) {
  const std::string id = submit();
  const v1::Lease lease = synchronize(greeting('a')).leases(0);
  deliver(delivery('a', lease));
  const auto late = synchronize(greeting('a')).leases(0);
  const core::Image before = coordinator().images().get(id)->image;
  const v1::Job cancelled = *coordinator().jobs().cancel(id);
  EXPECT_EQ(cancelled.state(), v1::JOB_STATE_CANCELLED);
  EXPECT_TRUE(cancelled.has_finished_at());
  EXPECT_EQ(deliver(delivery('a', late)).accepted_items(), 0u);
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());  // the film is only in the store now
  EXPECT_EQ(coordinator().images().get(id)->image.pixels, before.pixels);
  EXPECT_EQ(job(id).counters().samples(), cancelled.counters().samples());
  EXPECT_EQ(coordinator().jobs().resume(id).error().code, ErrorCode::kFailedPrecondition);
}

TEST_F(Jobs, ChangesOfStateMayBeRepeated) {
  const std::string id = submit();
  EXPECT_TRUE(coordinator().jobs().pause(id));
  EXPECT_TRUE(coordinator().jobs().pause(id));
  EXPECT_TRUE(coordinator().jobs().cancel(id));
  EXPECT_TRUE(coordinator().jobs().cancel(id));
}

TEST_F(Jobs, ExtendingADoneJobGivesTheImageOfTheHigherNumber) {
  const std::string id = submit();
  work('a');
  ASSERT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  for (const std::uint32_t spp : {kSpp + 1, kSpp + 5}) {
    ASSERT_TRUE(coordinator().checkpointer().checkpoint());  // drops the film of the done job
    const v1::Job extended = *coordinator().jobs().extend(id, spp);
    EXPECT_EQ(extended.state(), v1::JOB_STATE_RUNNING);
    EXPECT_EQ(extended.settings().spp(), spp);
    EXPECT_FALSE(extended.has_finished_at());
    work('a');
    EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
    EXPECT_EQ(coordinator().images().get(id)->image.pixels,
              ready_made_image(kWidthPx, kHeightPx, spp).pixels);
  }
}

TEST_F(Jobs, CannotBeExtendedToFewerSamplesOrTooMany) {
  const std::string id = submit();
  EXPECT_EQ(coordinator().jobs().extend(id, kSpp - 1).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(coordinator().jobs().extend(id, core::kMaxSpp + 1).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(coordinator().jobs().extend("nobody", 100).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(job(id).settings().spp(), kSpp);
}

TEST_F(Jobs, ADeletedJobIsForgottenAlsoByTheStore) {
  v1::SubmitJobRequest request = submission();
  request.set_request_id("again");
  const std::string id = submit(request);
  work('a', 2);
  ASSERT_TRUE(coordinator().jobs().remove(id));
  EXPECT_EQ(coordinator().jobs().remove(id).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(coordinator().images().get(id).error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  open();
  EXPECT_TRUE(listed().empty());
  EXPECT_NE(submit(request), id);
}

TEST_F(Jobs, EveryMethodSaysThatThereIsNoSuchJob) {
  EXPECT_EQ(coordinator().jobs().get("nobody").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(coordinator().images().get("nobody").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(coordinator().jobs().pause("nobody").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(coordinator().jobs().resume("nobody").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(coordinator().jobs().cancel("nobody").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(coordinator().jobs().remove("nobody").error().code, ErrorCode::kNotFound);
}

TEST_F(Jobs, TakeTheirFilesWithThemWhenTheyAreDeleted) {
  const auto blob = coordinator().blobs().path(proto::digest_of(kSceneBytes));
  const auto last_used_hours_ago = [&](int hours) {
    std::filesystem::last_write_time(
        blob, std::filesystem::file_time_type::clock::now() - std::chrono::hours(hours));
  };
  const std::string id = submit();
  last_used_hours_ago(25);
  coordinator().files().collect();
  EXPECT_TRUE(std::filesystem::exists(blob)) << "a job needs it";
  ASSERT_TRUE(coordinator().jobs().remove(id));
  last_used_hours_ago(23);
  coordinator().files().collect();
  EXPECT_TRUE(std::filesystem::exists(blob)) << "it may be submitted again";
  last_used_hours_ago(25);
  coordinator().files().collect();
  EXPECT_FALSE(std::filesystem::exists(blob));
}

// However long the submission takes, and whatever the system time is then.
TEST_F(Jobs, KeepTheirFilesWhileTheyAreSubmitted) {
  const auto blob = coordinator().blobs().path(proto::digest_of(kSceneBytes));
  check_scene_ = [&](const v1::Bundle& bundle, const v1::RenderOverrides& overrides,
                     const std::vector<std::int32_t>&, const std::stop_token&) {
    std::filesystem::last_write_time(blob,
                                     std::filesystem::file_time_type::clock::now() - std::chrono::hours(25));
    std::thread([this] { coordinator().files().collect(); }).join();
    return accept_scene(bundle, overrides);
  };
  open();
  submit();
  EXPECT_TRUE(std::filesystem::exists(blob));
}

constexpr core::PixelRect kWindow{70, 3, 145, 99};

v1::SubmitJobRequest submission_of_window() {
  v1::SubmitJobRequest request = submission();
  *request.mutable_overrides()->mutable_crop() = proto::to_proto(kWindow);
  return request;
}

TEST_F(Jobs, OfAWindowComeToThosePixels) {
  const std::string id = submit(submission_of_window());
  EXPECT_EQ(job(id).samples_total(), kWindow.pixel_count() * kSpp);
  EXPECT_EQ(job(id).settings().width_px(), 150u) << "the camera's image";
  work('a', 1);
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  open();  // and after a restart
  work('b');
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(job(id).counters().samples(), kWindow.pixel_count() * kSpp) << "and no others";
  EXPECT_EQ(coordinator().images().get(id)->image.pixels, ready_made_image(kWindow, kSpp).pixels);
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());  // drops the film of the done job
  EXPECT_EQ(coordinator().images().get(id)->image.pixels, ready_made_image(kWindow, kSpp).pixels);
  ASSERT_TRUE(coordinator().jobs().extend(id, kSpp + 3));
  work('a');
  EXPECT_EQ(coordinator().images().get(id)->image.pixels, ready_made_image(kWindow, kSpp + 3).pixels);
}

TEST_F(Jobs, OfAWindowThatIsNoneAreRefused) {
  for (const core::PixelRect& window : {core::PixelRect{0, 0, 151, 100}, {5, 5, 5, 9}, {9, 0, 3, 5}}) {
    v1::SubmitJobRequest request = submission();
    *request.mutable_overrides()->mutable_crop() = proto::to_proto(window);
    const core::Error refused = refusal(request);
    EXPECT_EQ(refused.code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(refused.message, HasSubstr("crop: must be"));
  }
}

TEST_F(Jobs, AreFoundByTheBeginningOfTheirIds) {
  for (int i = 0; i < 20; ++i) submit();  // so that some ids begin with the same digit
  const auto all = listed();
  for (const std::string prefix : {"", "0", "7", "c", "f", all[3].id().c_str(), "g", "0000x"}) {
    for (const std::size_t most : {0u, 1u, 2u, 100u}) {
      std::vector<std::string> expected, found;
      for (const v1::Job& job : all)
        if (job.id().starts_with(prefix) && (most == 0 || expected.size() < most))
          expected.push_back(job.id());
      v1::ListJobsRequest request;
      request.set_id_prefix(prefix);
      request.set_page_size(static_cast<std::uint32_t>(most));
      for (const v1::Job& job : listed(request)) found.push_back(job.id());
      EXPECT_EQ(found, expected) << prefix << " " << most;
    }
  }
}

// A window of an image that is too large for the farm may be rendered.
TEST_F(Jobs, OfAWindowNeedMemoryForTheWindowAlone) {
  check_scene_ = accept_as_larger_than_allowed;
  open();
  EXPECT_EQ(job(submit(submission_of_window())).state(), v1::JOB_STATE_RUNNING);
}

TEST_F(Jobs, AreUpdatedForGood) {
  v1::SubmitJobRequest request = submission();
  request.set_priority(1);
  request.set_max_workers(2);
  const std::string id = submit(request);
  EXPECT_EQ(job(id).priority(), 1);
  EXPECT_EQ(job(id).max_workers(), 2u);
  v1::UpdateJobRequest update;
  update.set_job_id(id);
  update.set_priority(-4);
  EXPECT_EQ(coordinator().jobs().update(update)->priority(), -4);
  open();  // as after a crash: nothing was checkpointed
  EXPECT_EQ(job(id).priority(), -4);
  EXPECT_EQ(job(id).max_workers(), 2u);
  update.clear_priority();
  update.set_max_workers(0);
  EXPECT_EQ(coordinator().jobs().update(update)->max_workers(), 0u);
  open();
  EXPECT_EQ(job(id).priority(), -4);
  EXPECT_EQ(job(id).max_workers(), 0u);
}

TEST_F(Jobs, ThatAreOverAreNotUpdated) {
  v1::UpdateJobRequest update;
  update.set_priority(5);
  update.set_job_id("nobody");
  EXPECT_EQ(coordinator().jobs().update(update).error().code, ErrorCode::kNotFound);
  update.set_job_id(submit());
  work('a');
  EXPECT_EQ(coordinator().jobs().update(update).error().code, ErrorCode::kFailedPrecondition);
}

TEST_F(Jobs, ThatMayHaveMoreWorkersNotifyIdleWaiters) {
  v1::SubmitJobRequest request = submission();
  request.set_max_workers(1);
  v1::UpdateJobRequest update;
  update.set_job_id(submit(request));
  EXPECT_EQ(synchronize(greeting('a')).leases_size(), 1);
  const WaitingCall call(coordinator(), greeting('b'));
  EXPECT_FALSE(call.answered());
  update.set_max_workers(2);
  EXPECT_EQ(coordinator().jobs().update(update)->active_workers(), 2u);
  ASSERT_TRUE(call.answered());
  EXPECT_EQ(call.answer()->leases_size(), 1);
}

}  // namespace
}  // namespace tessera::server
