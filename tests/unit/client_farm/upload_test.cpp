// SPDX-License-Identifier: Apache-2.0
// Uploads to a coordinator whose connections break.
#include "client/farm/upload.hpp"

#include <gmock/gmock.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "proto/blob.hpp"
#include "proto/error_reasons.hpp"
#include "proto/status.hpp"
#include "tests/support/temporary_folder.hpp"

namespace tessera::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// Stores blobs in memory, and keeps what it received of an upload that it ends.
class BlobService final : public v1::RenderService::Service {
 public:
  grpc::Status FindMissingBlobs(grpc::ServerContext*, const v1::FindMissingBlobsRequest* request,
                                v1::FindMissingBlobsResponse* response) override {
    ++questions;
    for (const v1::Digest& digest : request->digests())
      if (!stored.contains(digest.sha256())) *response->add_missing() = digest;
    return grpc::Status::OK;
  }
  grpc::Status BatchUploadBlobs(grpc::ServerContext*, const v1::BatchUploadBlobsRequest* request,
                                v1::BatchUploadBlobsResponse* response) override {
    batches.push_back(request->blobs_size());
    for (const auto& blob : request->blobs()) {
      stored[blob.digest().sha256()] = blob.data();
      auto& result = *response->add_results();
      if (!batch_error.empty()) {
        result.set_code(grpc::StatusCode::RESOURCE_EXHAUSTED);
        result.set_message(batch_error);
      }
    }
    return grpc::Status::OK;
  }
  grpc::Status GetUpload(grpc::ServerContext*, const v1::GetUploadRequest* request,
                         v1::GetUploadResponse* response) override {
    response->set_committed_bytes(partial[request->digest().sha256()].size());
    return grpc::Status::OK;
  }
  grpc::Status UploadBlob(grpc::ServerContext*, grpc::ServerReader<v1::UploadBlobRequest>* reader,
                          v1::UploadBlobResponse*) override {
    v1::UploadBlobRequest request;
    if (!reader->Read(&request)) return {grpc::StatusCode::INVALID_ARGUMENT, "nothing came"};
    const v1::Digest digest = request.chunk().digest();
    offsets.push_back(request.offset_bytes());
    std::string bytes = forgets ? "" : partial[digest.sha256()];
    if (request.offset_bytes() != (request.offset_bytes() == 0 ? 0 : bytes.size())) {
      partial.clear();
      return {grpc::StatusCode::OUT_OF_RANGE, "continue elsewhere"};
    }
    bytes.resize(request.offset_bytes());
    do {
      bytes += request.chunk().data();
      if (interruptions > 0 && bytes.size() > break_after) {
        --interruptions;
        partial[digest.sha256()] = bytes;
        return {grpc::StatusCode::UNAVAILABLE, "the connection broke"};
      }
    } while (reader->Read(&request));
    if (proto::to_proto(proto::digest_of(bytes)).sha256() != digest.sha256())
      return {grpc::StatusCode::DATA_LOSS, "other bytes"};
    stored[digest.sha256()] = bytes;
    return grpc::Status::OK;
  }

  std::map<std::string, std::string> stored, partial;  // by SHA-256
  std::vector<int> batches;                            // blobs of each
  std::vector<std::uint64_t> offsets;
  std::size_t break_after = 300'000;
  int interruptions = 0, questions = 0;
  bool forgets = false;
  std::string batch_error;
};

class Uploads : public testing::Test {
 protected:
  Uploads() {
    int port = 0;
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    farm_ = std::move(*Farm::open({.address = "127.0.0.1:" + std::to_string(port), .security = {}}));
    local_.folder = folder_.path();
  }
  void add_file(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_.path() / name, std::ios::binary) << bytes;
    local_.paths[name] = name;
    v1::Bundle::Asset& asset = *local_.bundle.add_assets();
    asset.set_path(name);
    *asset.mutable_digest() = proto::to_proto(proto::digest_of(bytes));
  }
  core::Status upload() {
    testing::internal::CaptureStderr();
    core::Status done = upload_missing(*farm_, local_);
    testing::internal::GetCapturedStderr();
    return done;
  }
  void expect_all_stored() {
    for (const v1::Bundle::Asset& asset : local_.bundle.assets())
      EXPECT_TRUE(service_.stored.contains(asset.digest().sha256())) << asset.path();
  }

  TemporaryFolder folder_;
  BlobService service_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<Farm> farm_;
  LocalBundle local_;
};

std::string bytes_of(std::size_t size, char seed) {
  std::string bytes(size, seed);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(seed + i * i % 251);
  return bytes;
}

TEST_F(Uploads, OfSmallFilesGoTogether) {
  for (int i = 0; i < 40; ++i) add_file(std::to_string(i), bytes_of(50'000, static_cast<char>(i)));
  add_file("same", bytes_of(50'000, 7));
  add_file("empty", "");
  EXPECT_TRUE(upload());
  expect_all_stored();
  EXPECT_THAT(service_.batches, ElementsAre(20, 21)) << "of at most 1 MiB; equal files are sent once";
  EXPECT_THAT(service_.offsets, ElementsAre());
}

TEST_F(Uploads, OfLargeFilesContinueWhereTheyBroke) {
  add_file("large", bytes_of(1'000'000, 1));
  service_.interruptions = 1;
  EXPECT_TRUE(upload());
  expect_all_stored();
  ASSERT_EQ(service_.offsets.size(), 2u);
  EXPECT_EQ(service_.offsets[0], 0u);
  EXPECT_GT(service_.offsets[1], service_.break_after);
  EXPECT_EQ(service_.questions, 2) << "a restarted coordinator may lack other files as well";
}

TEST_F(Uploads, BeginAgainWhereTheCoordinatorHasForgottenThem) {
  add_file("large", bytes_of(1'000'000, 1));
  service_.partial[local_.bundle.assets(0).digest().sha256()] = bytes_of(1'000'000, 1).substr(0, 70'000);
  service_.forgets = true;
  EXPECT_TRUE(upload());
  expect_all_stored();
  EXPECT_THAT(service_.offsets, ElementsAre(70'000u, 0u));
}

TEST_F(Uploads, OfFilesThatHaveChangedFail) {
  for (const std::size_t size : {std::size_t{100}, std::size_t{200'000}}) {
    local_.bundle.Clear();
    add_file("file", bytes_of(size, 1));
    for (const std::string& now : {bytes_of(size, 2), bytes_of(size / 2, 1), std::string()}) {
      std::ofstream(folder_.path() / "file", std::ios::binary) << now;
      const core::Status done = upload();
      ASSERT_FALSE(done) << size;
      EXPECT_EQ(done.error().message, "'file' has changed since the scene was read: submit it again");
    }
  }
}

TEST_F(Uploads, SayWhyAFileOfABatchIsRefused) {
  add_file("a", "a");
  service_.batch_error = "the store is full";
  const core::Status done = upload();
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, core::ErrorCode::kResourceExhausted);
  EXPECT_THAT(done.error().message, HasSubstr("the store is full"));
}

TEST_F(Uploads, SendOnlyWhatARefusedCallNames) {
  add_file("a", "a");
  add_file("b", "b");
  ASSERT_TRUE(upload_named(*farm_, local_, {proto::blob_name(proto::digest_of("b"))}));
  EXPECT_EQ(service_.questions, 0);
  EXPECT_EQ(service_.stored.size(), 1u);
  ASSERT_TRUE(upload_named(*farm_, local_, {proto::blob_name(proto::digest_of("foreign"))}));
  EXPECT_EQ(service_.questions, 1) << "it names what is no file of the bundle";
  expect_all_stored();
  service_.stored.clear();
  ASSERT_TRUE(
      upload_named(*farm_, local_, std::vector(proto::kMaxMissing, proto::blob_name(proto::digest_of("b")))));
  EXPECT_EQ(service_.questions, 2) << "there may be more than it names";
  expect_all_stored();
}

}  // namespace
}  // namespace tessera::client
