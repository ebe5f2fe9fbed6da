// SPDX-License-Identifier: Apache-2.0
// Limits of downloads by workers.
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "proto/status.hpp"
#include "tests/unit/server/limited_service.hpp"

namespace tessera::rpc {
namespace {

class FetchLimits : public LimitedService {
 protected:
  struct Download {
    grpc::ClientContext context;
    std::unique_ptr<grpc::ClientReaderInterface<v1::FetchBlobResponse>> stream;
  };
  std::unique_ptr<Download> begin_download(const std::string& bytes) {
    auto download = std::make_unique<Download>();
    v1::FetchBlobRequest request;
    *request.mutable_digest() = proto::to_proto(proto::digest_of(bytes));
    download->stream = workers_->FetchBlob(&download->context, request);
    return download;
  }
  grpc::Status finish_download(Download& download) {
    v1::FetchBlobResponse response;
    while (download.stream->Read(&response)) {
    }
    return download.stream->Finish();
  }
  void put(const std::string& bytes) {
    auto writer = coordinator_->blobs().write(proto::digest_of(bytes));
    ASSERT_TRUE(writer && writer->append(bytes) && writer->commit());
  }

  // More than all buffers hold while nobody reads.
  const std::string large_ = std::string(8 << 20, 'x');
};

TEST_F(FetchLimits, OfFilesThatAreFetchedAtOnce) {
  start({.fetches = 2});
  put(large_);
  const auto slow = begin_download(large_);
  slow->stream->WaitForInitialMetadata();
  const auto refused = begin_download(large_);
  const grpc::Status status = finish_download(*refused);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(status.error_message(),
            "1 files from here are being fetched already, and this farm takes at most 2 from all callers "
            "(tessera-coordinator --max-fetches), some of which it keeps for others");
  EXPECT_EQ(proto::error_from_grpc(status, refused->context).code, core::ErrorCode::kUnavailable)
      << "it passes by itself";
  EXPECT_TRUE(finish_download(*slow).ok());
}

TEST_F(FetchLimits, AFileThatIsNotTakenIsEnded) {
  start({.fetches = 2, .stall_time = std::chrono::seconds(3)});
  put(large_);
  const auto slow = begin_download(large_);
  slow->stream->WaitForInitialMetadata();
  grpc::StatusCode later;
  do {
    later = finish_download(*begin_download(large_)).error_code();
  } while (later == grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(later, grpc::StatusCode::OK);
  EXPECT_EQ(finish_download(*slow).error_code(), grpc::StatusCode::CANCELLED);
}

}  // namespace
}  // namespace tessera::rpc
