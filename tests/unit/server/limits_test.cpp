// SPDX-License-Identifier: Apache-2.0
// Limits on jobs and bundles, and the messages of their rejections.
#include <gmock/gmock.h>

#include "proto/blob.hpp"
#include "server/blobs/admission.hpp"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

using core::ErrorCode;
using testing::HasSubstr;

class Limits : public ScriptedFarm {
 protected:
  void limit(const server::Limits& limits) {
    limits_ = limits;
    open();
  }
};

void expect_limit(const core::Error& error, const std::string& sentence) {
  EXPECT_EQ(error.code, ErrorCode::kResourceExhausted);
  EXPECT_THAT(error.message, HasSubstr(sentence));
}

TEST_F(Limits, OfImages) {
  limit({.image_pixels = kWidthPx * kHeightPx});
  submit();
  limit({.image_pixels = kWidthPx * kHeightPx - 1});
  expect_limit(refusal(submission()),
               "the image has 150 x 100 = 15000 pixels, and this farm takes at most 14999 "
               "(tessera-coordinator --max-image-pixels)");
}

TEST_F(Limits, OfSamplesPerPixelAlsoWhenTheyAreExtended) {
  limit({.spp = 8});
  const std::string id = submit();
  v1::SubmitJobRequest request = submission();
  request.mutable_overrides()->set_spp(9);
  const std::string sentence =
      "the job has 9 samples per pixel, and this farm takes at most 8 (tessera-coordinator --max-spp)";
  expect_limit(refusal(request), sentence);
  const auto extended = coordinator().jobs().extend(id, 9);
  ASSERT_FALSE(extended);
  expect_limit(extended.error(), sentence);
  EXPECT_EQ(job(id).settings().spp(), kSpp);
  EXPECT_TRUE(coordinator().jobs().extend(id, 8));
}

TEST_F(Limits, OfBundlesByWhatTheySay) {
  limit({.bundle_mib = 4, .blob_mib = 3});
  v1::SubmitJobRequest request = submission();
  v1::Bundle::Asset& asset = *request.mutable_bundle()->add_assets();
  asset.set_path("mesh.obj");
  *asset.mutable_digest() = proto::to_proto(proto::digest_of("never uploaded"));
  asset.mutable_digest()->set_size_bytes((3 << 20) + 1);
  expect_limit(refusal(request),
               "bundle: mesh.obj: the file has 3145729 bytes, and this farm takes at most 3 MiB "
               "(tessera-coordinator --max-blob-mib)");
  asset.mutable_digest()->set_size_bytes(3 << 20);
  *request.mutable_bundle()->add_assets() = asset;
  request.mutable_bundle()->mutable_assets(2)->set_path("the same once more.obj");
  EXPECT_EQ(refusal(request).code, core::ErrorCode::kFailedPrecondition)
      << "a file that has two names counts once";
  *request.mutable_bundle()->mutable_assets(2)->mutable_digest() =
      proto::to_proto(proto::digest_of("another"));
  request.mutable_bundle()->mutable_assets(2)->mutable_digest()->set_size_bytes(3 << 20);
  expect_limit(refusal(request),
               "the 3 files of the bundle have 6291458 bytes, and this farm takes at most 4 MiB "
               "(tessera-coordinator --max-bundle-mib)");
}

TEST_F(Limits, OfTheFilesOfABundle) {
  limit({.bundle_files = 2});
  v1::SubmitJobRequest request = submission();
  for (const char* const name : {"a", "b"}) {
    v1::Bundle::Asset& asset = *request.mutable_bundle()->add_assets();
    asset = request.bundle().assets(0);
    asset.set_path(name);
  }
  expect_limit(
      refusal(request),
      "the bundle has 3 files, and this farm takes at most 2 (tessera-coordinator --max-bundle-files)");
}

TEST_F(Limits, SizesThatOverflowTheirSumAreTooLarge) {
  limit({});
  limits_.blob_mib = limits_.bundle_mib = std::uint64_t{1} << 43;
  v1::Bundle bundle;
  for (int i = 0; i < 2; ++i) bundle.add_assets()->mutable_digest()->set_size_bytes(std::uint64_t{1} << 63);
  limits_.bundle_mib -= 1;
  EXPECT_FALSE(blobs::check_bundle_size(bundle, limits_));
}

TEST_F(Limits, OfOpenJobs) {
  limit({.open_jobs = 2});
  const std::string first = submit(), second = submit();
  EXPECT_TRUE(coordinator().jobs().pause(second));
  expect_limit(refusal(submission()),
               "there are 2 unfinished jobs already, and this farm takes at most 2 of all "
               "together (tessera-coordinator --max-open-jobs)");
  EXPECT_TRUE(coordinator().jobs().cancel(first));
  submit();
}

TEST_F(Limits, OfOpenJobsForEachOwnerByThemselves) {
  limit({.open_jobs = 1});
  EXPECT_TRUE(coordinator().jobs().submit(submission(), "ada"));
  EXPECT_TRUE(coordinator().jobs().submit(submission(), "ben"));
  expect_limit(refusal(submission(), "ada"),
               "'ada' has 1 unfinished jobs already, and this farm takes at most 1 of "
               "each owner (tessera-coordinator --max-open-jobs)");
}

TEST_F(Limits, ARepeatedSubmissionIsAnsweredAndNotCounted) {
  limit({.open_jobs = 1});
  v1::SubmitJobRequest request = submission();
  request.set_request_id("once");
  EXPECT_EQ(submit(request), submit(request));
}

TEST_F(Limits, AFinishedJobThatIsExtendedIsOpenAgain) {
  limit({.open_jobs = 1});
  const std::string done = submit();
  work('a');
  ASSERT_EQ(stored_job(done).state(), v1::JOB_STATE_DONE);
  submit();
  const auto extended = coordinator().jobs().extend(done, kSpp + 1);
  ASSERT_FALSE(extended);
  expect_limit(extended.error(), "--max-open-jobs");
  EXPECT_TRUE(coordinator().jobs().extend(done, kSpp)) << "which changes nothing";
}

TEST_F(Limits, JobsThatAreBeingCheckedCountAsOpen) {
  check_scene_ = [&](const v1::Bundle& bundle, const v1::RenderOverrides& overrides,
                     const std::vector<std::int32_t>&, const std::stop_token&) {
    expect_limit(refusal(submission()), "there are 1 unfinished jobs already");
    return accept_scene(bundle, overrides);
  };
  limit({.open_jobs = 1});
  submit();
}

TEST_F(Limits, ASceneThatIsRefusedLeavesItsPlaceToOthers) {
  check_scene_ = [](const v1::Bundle&, const v1::RenderOverrides&, const std::vector<std::int32_t>&,
                    const std::stop_token&) -> core::Result<jobs::CheckedScene> {
    return core::fail(ErrorCode::kInvalidArgument, "bad");
  };
  limit({.open_jobs = 1});
  for (int i = 0; i < 3; ++i) EXPECT_EQ(refusal(submission()).message, "bad");
}

TEST_F(Limits, NothingIsHashedForACoordinatorThatStops) {
  bool checked = false;
  check_scene_ = [&](const v1::Bundle& bundle, const v1::RenderOverrides& overrides,
                     const std::vector<std::int32_t>&, const std::stop_token&) {
    checked = true;
    return accept_scene(bundle, overrides);
  };
  open();
  coordinator().close();
  EXPECT_EQ(refusal(submission()).code, ErrorCode::kUnavailable);
  EXPECT_FALSE(checked);
}

}  // namespace
}  // namespace tessera::server
