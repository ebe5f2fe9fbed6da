// SPDX-License-Identifier: Apache-2.0
// Limits of uploads and of the store: quotas of callers, and which files make room.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "proto/status.hpp"
#include "tests/unit/server/limited_service.hpp"

namespace tessera::rpc {
namespace {

using testing::HasSubstr;

using UploadLimits = LimitedService;

TEST_F(UploadLimits, OfBlobsIsTheSizeThatTheyAreSaidToHave) {
  start({.blob_mib = 1});
  const grpc::Status status = upload((1 << 20) + 1, "the first of a million bytes");
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(),
              HasSubstr("the file has 1048577 bytes, and this farm takes at most 1 MiB "
                        "(tessera-coordinator --max-blob-mib)"));
  EXPECT_EQ(files_in("incoming"), 0u);
  const std::string largest(1 << 20, 'x');
  EXPECT_TRUE(upload(largest.size(), largest).ok());
}

TEST_F(UploadLimits, AStreamThatBringsMoreThanItSaidEndsThere) {
  start({.blob_mib = 1});
  const std::string chunk(1 << 20, 'x');
  const grpc::Status more = upload(chunk.size(), chunk, 50);
  EXPECT_EQ(more.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(more.error_message(), HasSubstr("more bytes than the 1048576 its digest says"));
  EXPECT_EQ(upload(chunk.size(), "less").error_code(), grpc::StatusCode::DATA_LOSS);
  server_.reset();  // a stream may end slightly after its caller sees the end
  EXPECT_EQ(files_in("incoming"), 0u);
}

TEST_F(UploadLimits, OfUploadsAtOnce) {
  start({.uploads = 2});
  const std::string first(1000, '1'), second(1000, '2');
  const auto under_way = begin_upload(first);
  grpc::ClientContext context;
  v1::UploadBlobResponse response;
  const grpc::Status refused = users_->UploadBlob(&context, &response)->Finish();
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(refused.error_message(),
            "1 uploads from here are in progress already, and this farm takes at most 2 from all callers "
            "(tessera-coordinator --max-uploads), some of which it keeps for others");
  EXPECT_EQ(proto::error_from_grpc(refused, context).code, core::ErrorCode::kUnavailable)
      << "it passes by itself";
  EXPECT_TRUE(finish_upload(*under_way, first).ok());
  expect_upload_in_the_end(second);
}

TEST_F(UploadLimits, OfTheStoreSayWhatMakesRoom) {
  start({.store_mib = 1});
  const std::string first(700'000, '1'), second(700'000, '2');
  ASSERT_TRUE(upload(first.size(), first).ok());
  const grpc::Status refused = upload(second.size(), second);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(
      refused.error_message(),
      "the files of scenes here have 700000 bytes, 700000 more would be too many, and this farm takes at "
      "most 1 MiB (tessera-coordinator --max-store-mib): delete jobs that nobody needs any more (tessera "
      "delete); files that were uploaded and not submitted make room after a quarter of an hour");
  EXPECT_TRUE(coordinator_->blobs().contains(proto::digest_of(first))) << "nothing that is here is lost";
  EXPECT_EQ(files_in("incoming"), 0u);
}

TEST_F(UploadLimits, AFullStoreKeepsWhatJobsNeedAndLetsGoOfTheRest) {
  start({.store_mib = 1});
  submit_now();
  const std::string unused(700'000, '1'), wanted(700'000, '2');
  ASSERT_TRUE(upload(unused.size(), unused).ok());
  pass(std::chrono::minutes(15));
  const blobs::BlobStore& blobs = coordinator_->blobs();
  EXPECT_TRUE(upload(wanted.size(), wanted).ok());
  EXPECT_FALSE(blobs.contains(proto::digest_of(unused)));
  EXPECT_TRUE(blobs.contains(proto::digest_of(server::kSceneBytes)));
  EXPECT_EQ(coordinator_->files().used_bytes(), wanted.size() + server::kSceneBytes.size());
}

TEST_F(UploadLimits, AnUploadCountsWithAllItsBytesAsLongAsItGoesOn) {
  start({.store_mib = 1});
  const std::string half(700'000, '1'), whole(700'000, '2');
  const auto under_way = begin_upload(half);
  EXPECT_EQ(upload(whole.size(), whole).error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  under_way->context.TryCancel();
  under_way->stream->Finish();
  expect_upload_in_the_end(whole);
  EXPECT_EQ(files_in("incoming"), 0u);
}

TEST_F(UploadLimits, AnUploadThatStandsStillIsEnded) {
  start({.uploads = 1, .stall_time = std::chrono::seconds(3)});
  const std::string half(1000, '1'), whole(1000, '2');
  const auto under_way = begin_upload(half);
  const grpc::Status ended = under_way->stream->Finish();
  EXPECT_EQ(ended.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(
      ended.error_message(),
      "no data of this upload has arrived for 3 s (tessera-coordinator --stall-seconds): send it again");
  expect_upload_in_the_end(whole);
  EXPECT_EQ(files_in("incoming"), 0u);
  EXPECT_EQ(coordinator_->files().used_bytes(), whole.size());
}

TEST_F(UploadLimits, AFullStoreIsClearedWhileASceneIsValidated) {
  hold_up_scenes();
  start({.store_mib = 1});
  Submission slow;
  submit(slow);
  barrier_.wait_for_someone();
  const std::string unused(700'000, '1'), wanted(700'000, '2');
  ASSERT_TRUE(upload(unused.size(), unused).ok());
  pass(std::chrono::minutes(15));
  EXPECT_TRUE(upload(wanted.size(), wanted).ok());
  EXPECT_FALSE(coordinator_->blobs().contains(proto::digest_of(unused)));
  EXPECT_TRUE(coordinator_->blobs().contains(proto::digest_of(server::kSceneBytes)));
  barrier_.open();
  EXPECT_TRUE(slow.status.get_future().get().ok());
}

TEST_F(UploadLimits, ASubmissionThatTakesHoursToArriveLosesNoFile) {
  start({.store_mib = 2});
  pass(std::chrono::hours(1));
  const std::string first(400'000, '1'), second(400'000, '2'), other(1'000'000, '3');
  Submission slow;
  v1::FindMissingBlobsRequest asked;
  for (const std::string& bytes : {first, second}) {
    v1::Bundle::Asset& asset = *slow.request.mutable_bundle()->add_assets();
    asset.set_path(bytes.substr(0, 1));
    *asset.mutable_digest() = proto::to_proto(proto::digest_of(bytes));
  }
  for (const v1::Bundle::Asset& asset : slow.request.bundle().assets()) *asked.add_digests() = asset.digest();
  grpc::ClientContext asking;
  v1::FindMissingBlobsResponse missing;
  ASSERT_TRUE(users_->FindMissingBlobs(&asking, asked, &missing).ok());
  EXPECT_EQ(missing.missing_size(), 2);
  ASSERT_TRUE(upload(first.size(), first).ok());
  const auto under_way = begin_upload(second);
  pass(std::chrono::hours(5));
  EXPECT_EQ(upload(other.size(), other).error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_TRUE(coordinator_->blobs().contains(proto::digest_of(first)));
  EXPECT_TRUE(finish_upload(*under_way, second).ok());
  submit(slow);
  const grpc::Status submitted = slow.status.get_future().get();
  EXPECT_TRUE(submitted.ok()) << submitted.error_message();
}

TEST_F(UploadLimits, AnAbandonedSubmissionMakesRoomAfterAQuarterOfAnHour) {
  start({.store_mib = 2});
  pass(std::chrono::hours(1));
  const std::string first(800'000, '1'), other(1'000'000, '2');
  ASSERT_TRUE(upload(first.size(), first).ok());
  pass(std::chrono::minutes(14));
  EXPECT_EQ(upload(other.size(), other).error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_TRUE(coordinator_->blobs().contains(proto::digest_of(first)));
  pass(std::chrono::minutes(1));
  EXPECT_TRUE(upload(other.size(), other).ok());
  EXPECT_FALSE(coordinator_->blobs().contains(proto::digest_of(first)));
}

TEST_F(UploadLimits, NoSubmitterFillsTheStore) {
  start_with_names({.store_mib = 4});
  const auto ada = as("ada"), ben = as("ben");
  const auto upload_as = [&](v1::RenderService::Stub& user, char name) {
    return upload(user, 1'000'000, std::string(1'000'000, name));
  };
  EXPECT_TRUE(upload_as(*ada, '1').ok());
  EXPECT_TRUE(upload_as(*ada, '2').ok());
  const grpc::Status refused = upload_as(*ada, '3');
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(refused.error_message(),
              HasSubstr("the files of scenes from here have 2000000 bytes, 1000000 more would be more than "
                        "their share"));
  EXPECT_TRUE(upload_as(*ben, '4').ok());
}

}  // namespace
}  // namespace tessera::rpc
