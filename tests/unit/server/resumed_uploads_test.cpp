// SPDX-License-Identifier: Apache-2.0
// Batches of small blobs, and uploads that are interrupted and continued.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "proto/blob.hpp"
#include "server/blobs/partial_uploads.hpp"
#include "tests/unit/server/limited_service.hpp"

namespace tessera::rpc {
namespace {

using testing::HasSubstr;

constexpr std::size_t kLarge = 400'000, kSent = 150'000;

std::string varied_bytes(std::size_t size) {
  std::string bytes(size, '\0');
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i * i % 251);
  return bytes;
}

class ResumedUploads : public LimitedService {
 protected:
  // Sends bytes [begin, end) of a blob as one stream.
  grpc::Status send(v1::RenderService::Stub& user, const std::string& bytes, std::size_t begin,
                    std::size_t end) {
    grpc::ClientContext context;
    v1::UploadBlobResponse response;
    const auto stream = user.UploadBlob(&context, &response);
    v1::UploadBlobRequest request;
    request.set_offset_bytes(begin);
    *request.mutable_chunk()->mutable_digest() = proto::to_proto(proto::digest_of(bytes));
    for (std::size_t at = begin; at < end; at += proto::kChunkBytes) {
      request.mutable_chunk()->set_data(bytes.substr(at, std::min(proto::kChunkBytes, end - at)));
      if (!stream->Write(request)) break;
      request.Clear();
    }
    stream->WritesDone();
    return stream->Finish();
  }
  v1::GetUploadResponse ask(v1::RenderService::Stub& user, const std::string& bytes) {
    grpc::ClientContext context;
    v1::GetUploadRequest request;
    *request.mutable_digest() = proto::to_proto(proto::digest_of(bytes));
    v1::GetUploadResponse response;
    EXPECT_TRUE(user.GetUpload(&context, request, &response).ok());
    return response;
  }
  bool is_stored(const std::string& bytes) {
    return coordinator_->blobs().check(proto::digest_of(bytes)).has_value();
  }
  static void add_blob(v1::BatchUploadBlobsRequest& request, const std::string& said,
                       const std::string& sent) {
    auto& blob = *request.add_blobs();
    *blob.mutable_digest() = proto::to_proto(proto::digest_of(said));
    blob.set_data(sent);
  }
  grpc::Status upload_batch(const v1::BatchUploadBlobsRequest& request,
                            v1::BatchUploadBlobsResponse& response) {
    grpc::ClientContext context;
    return users_->BatchUploadBlobs(&context, request, &response);
  }

  const std::string bytes_ = varied_bytes(kLarge);
};

TEST_F(ResumedUploads, ContinueWhereTheyWereInterrupted) {
  start({});
  const grpc::Status broken = send(*users_, bytes_, 0, kSent);
  EXPECT_EQ(broken.error_code(), grpc::StatusCode::DATA_LOSS);
  EXPECT_THAT(broken.error_message(), HasSubstr("150000 of its 400000 bytes were received"));
  EXPECT_EQ(ask(*users_, bytes_).committed_bytes(), kSent);
  EXPECT_FALSE(ask(*users_, bytes_).is_stored());
  EXPECT_EQ(coordinator_->files().used_bytes(), kLarge) << "it keeps its room";
  EXPECT_TRUE(send(*users_, bytes_, kSent, kLarge).ok());
  EXPECT_TRUE(is_stored(bytes_));
  EXPECT_TRUE(ask(*users_, bytes_).is_stored());
  EXPECT_EQ(ask(*users_, bytes_).committed_bytes(), kLarge);
  EXPECT_EQ(files_in("incoming"), 0u);
}

TEST_F(ResumedUploads, ContinueAfterALostConnection) {
  start({});
  grpc::ClientContext context;
  v1::UploadBlobResponse response;
  const auto stream = users_->UploadBlob(&context, &response);
  v1::UploadBlobRequest request;
  *request.mutable_chunk()->mutable_digest() = proto::to_proto(proto::digest_of(bytes_));
  request.mutable_chunk()->set_data(bytes_.substr(0, kSent));
  ASSERT_TRUE(stream->Write(request));
  while (std::filesystem::is_empty(folder_.path() / "blobs" / "incoming") ||
         std::filesystem::file_size(
             std::filesystem::directory_iterator(folder_.path() / "blobs" / "incoming")->path()) < kSent)
    std::this_thread::yield();
  context.TryCancel();
  EXPECT_FALSE(stream->Finish().ok());
  while (ask(*users_, bytes_).committed_bytes() == 0) std::this_thread::yield();
  EXPECT_TRUE(send(*users_, bytes_, ask(*users_, bytes_).committed_bytes(), kLarge).ok());
  EXPECT_TRUE(is_stored(bytes_));
}

TEST_F(ResumedUploads, ContinueOnlyWhereTheyEnded) {
  start({});
  EXPECT_EQ(send(*users_, bytes_, kSent, kLarge).error_code(), grpc::StatusCode::OUT_OF_RANGE)
      << "nothing is here";
  ASSERT_FALSE(send(*users_, bytes_, 0, kSent).ok());
  EXPECT_EQ(send(*users_, bytes_, kSent - 1, kLarge).error_code(), grpc::StatusCode::OUT_OF_RANGE);
  EXPECT_EQ(ask(*users_, bytes_).committed_bytes(), kSent) << "it is kept";
  EXPECT_TRUE(send(*users_, bytes_, 0, kLarge).ok()) << "it may begin again";
  EXPECT_TRUE(is_stored(bytes_));
}

TEST_F(ResumedUploads, AreCheckedAsAWhole) {
  start({});
  std::string wrong = bytes_;
  wrong.back() ^= 1;
  ASSERT_FALSE(send(*users_, bytes_, 0, kSent).ok());
  grpc::ClientContext context;
  v1::UploadBlobResponse response;
  const auto stream = users_->UploadBlob(&context, &response);
  v1::UploadBlobRequest request;
  request.set_offset_bytes(kSent);
  *request.mutable_chunk()->mutable_digest() = proto::to_proto(proto::digest_of(bytes_));
  request.mutable_chunk()->set_data(wrong.substr(kSent));
  stream->Write(request);
  stream->WritesDone();
  EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::DATA_LOSS);
  EXPECT_FALSE(is_stored(bytes_));
  EXPECT_EQ(ask(*users_, bytes_).committed_bytes(), 0u) << "what is wrong cannot be continued";
}

TEST_F(ResumedUploads, BelongToTheirCallers) {
  start_with_names({});
  const auto ada = as("ada"), ben = as("ben");
  ASSERT_FALSE(send(*ada, bytes_, 0, kSent).ok());
  EXPECT_EQ(ask(*ada, bytes_).committed_bytes(), kSent);
  EXPECT_EQ(ask(*ben, bytes_).committed_bytes(), 0u);
  EXPECT_EQ(send(*ben, bytes_, kSent, kLarge).error_code(), grpc::StatusCode::OUT_OF_RANGE);
}

TEST_F(ResumedUploads, AreForgottenAfterAWhile) {
  start({});
  ASSERT_FALSE(send(*users_, bytes_, 0, kSent).ok());
  coordinator_->files().collect();
  EXPECT_EQ(ask(*users_, bytes_).committed_bytes(), kSent);
  pass(blobs::PartialUploads::kKeepTime);
  coordinator_->files().collect();
  EXPECT_EQ(ask(*users_, bytes_).committed_bytes(), 0u);
  EXPECT_EQ(files_in("incoming"), 0u);
  EXPECT_EQ(coordinator_->files().used_bytes(), 0u);
}

TEST_F(ResumedUploads, GiveTheirRoomToOthers) {
  start({.store_mib = 1});
  ASSERT_FALSE(send(*users_, bytes_, 0, kSent).ok());
  pass(std::chrono::minutes(20));
  const std::string other(900'000, 'x');
  EXPECT_TRUE(upload(other.size(), other).ok());
  EXPECT_EQ(ask(*users_, bytes_).committed_bytes(), 0u);
}

TEST_F(ResumedUploads, BatchesStoreEachBlobByItself) {
  start({});
  v1::BatchUploadBlobsRequest request;
  add_blob(request, "first", "first");
  add_blob(request, "second", "other!");
  add_blob(request, "third", "third");
  request.add_blobs();
  add_blob(request, "", "");
  v1::BatchUploadBlobsResponse response;
  const grpc::Status status = upload_batch(request, response);
  ASSERT_TRUE(status.ok()) << status.error_message();
  std::vector<int> codes;
  for (const auto& result : response.results()) codes.push_back(result.code());
  EXPECT_THAT(codes,
              testing::ElementsAre(grpc::OK, grpc::DATA_LOSS, grpc::OK, grpc::INVALID_ARGUMENT, grpc::OK));
  EXPECT_THAT(response.results(1).message(), HasSubstr(proto::digest_of("second").hex()));
  EXPECT_TRUE(is_stored("first") && is_stored("third") && is_stored(""));
  EXPECT_FALSE(is_stored("second"));
  EXPECT_EQ(files_in("incoming"), 0u);
  ASSERT_TRUE(upload_batch(request, response).ok()) << "again";
}

TEST_F(ResumedUploads, BatchesAreLimited) {
  start({.blob_mib = 1});
  v1::BatchUploadBlobsRequest request;
  v1::BatchUploadBlobsResponse response;
  for (int i = 0; i < 2; ++i) add_blob(request, "x", std::string(600'000, 'x'));
  EXPECT_EQ(upload_batch(request, response).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  request.Clear();
  for (int i = 0; i < 1025; ++i) add_blob(request, "x", "x");
  EXPECT_EQ(upload_batch(request, response).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  request.Clear();
  response.Clear();
  add_blob(request, "x", "x");
  request.mutable_blobs(0)->mutable_digest()->set_size_bytes(2 << 20);
  ASSERT_TRUE(upload_batch(request, response).ok());
  EXPECT_EQ(response.results(0).code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(response.results(0).message(), HasSubstr("--max-blob-mib"));
}

}  // namespace
}  // namespace tessera::rpc
