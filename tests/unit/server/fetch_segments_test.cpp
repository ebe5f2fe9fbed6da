// SPDX-License-Identifier: Apache-2.0
// Segments of blobs, which the coordinator sends or tells which worker has.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "proto/peer_ticket.hpp"
#include "proto/segments.hpp"
#include "proto/worker_key.hpp"
#include "tests/unit/server/limited_service.hpp"

namespace tessera::rpc {
namespace {

class FetchSegments : public LimitedService {
 protected:
  struct Answer {
    v1::FetchBlobResponse first;
    std::string bytes;
    grpc::Status status;
  };
  using Change = std::function<void(v1::FetchBlobRequest&)>;

  void start_with_blob() {
    start({});
    auto writer = coordinator_->blobs().write(digest_);
    ASSERT_TRUE(writer && writer->append(blob_) && writer->commit());
  }
  static std::string key_of(char worker) { return std::string(proto::kWorkerKeyBytes, worker); }
  static std::string ticket_key_of(char worker) { return std::string(proto::kTicketKeyBytes, worker); }

  // Asks as a worker that serves others and has these segments.
  Answer ask(
      char worker, const std::vector<std::uint64_t>& held, const Change& change = [](auto&) {}) {
    v1::FetchBlobRequest request;
    *request.mutable_digest() = proto::to_proto(digest_);
    v1::SegmentRequest& segment = *request.mutable_segment();
    segment.set_worker_key(key_of(worker));
    proto::SegmentSet set(proto::segment_count(blob_.size()));
    for (const std::uint64_t i : held) set.insert(i);
    segment.set_held(set.to_bytes());
    segment.mutable_endpoint()->set_port(4000);
    segment.mutable_endpoint()->set_certificate_pem(std::string("certificate of ") + worker);
    segment.mutable_endpoint()->set_ticket_key(ticket_key_of(worker));
    segment.mutable_endpoint()->set_clock_seconds(1000);
    change(request);
    grpc::ClientContext context;
    const auto stream = workers_->FetchBlob(&context, request);
    Answer answer;
    if (stream->Read(&answer.first)) answer.bytes = answer.first.chunk().data();
    v1::FetchBlobResponse response;
    while (stream->Read(&response)) answer.bytes += response.chunk().data();
    answer.status = stream->Finish();
    return answer;
  }

  const std::string blob_ = std::string(proto::kSegmentBytes, 'a') + std::string(1000, 'b');
  const proto::Digest digest_ = proto::digest_of(blob_);
};

TEST_F(FetchSegments, AreTheBytesOfTheBlob) {
  start_with_blob();
  const Answer first = ask('a', {});
  ASSERT_TRUE(first.status.ok()) << first.status.error_message();
  EXPECT_EQ(first.first.segment().offset_bytes(), 0u);
  EXPECT_TRUE(first.bytes == std::string(proto::kSegmentBytes, 'a'));
  const Answer second = ask('a', {0});
  EXPECT_EQ(second.first.segment().offset_bytes(), proto::kSegmentBytes);
  EXPECT_EQ(second.bytes, std::string(1000, 'b'));
}

TEST_F(FetchSegments, AWorkerThatHasOneIsNamedWithATicketForIt) {
  start_with_blob();
  ask('a', {});
  ask('a', {0});
  const Answer answer = ask('b', {0});
  const v1::PeerReferral& referral = answer.first.referral();
  ASSERT_EQ(referral.worker_id(), proto::worker_id_of(key_of('a')));
  EXPECT_EQ(referral.address(), "127.0.0.1:4000");
  EXPECT_EQ(referral.certificate_pem(), "certificate of a");
  const proto::Segment segment = proto::segment_at(blob_.size(), 1);
  EXPECT_EQ(proto::from_proto(referral.segment(), blob_.size()), segment);
  const auto sha256 = proto::digest_of(std::string(1000, 'b')).sha256;
  EXPECT_EQ(referral.segment_sha256(), std::string(sha256.begin(), sha256.end()));
  EXPECT_TRUE(proto::is_valid(referral.ticket(), ticket_key_of('a'), digest_, segment, 1000));
  EXPECT_FALSE(proto::is_valid(referral.ticket(), ticket_key_of('a'), digest_, segment, 1100));
  EXPECT_TRUE(answer.bytes.empty());
  const auto refuse = [&](v1::FetchBlobRequest& request) {
    request.mutable_segment()->add_excluded_worker_ids(referral.worker_id());
  };
  EXPECT_EQ(ask('c', {0}, refuse).bytes, std::string(1000, 'b')) << "from the coordinator";
}

TEST_F(FetchSegments, MalformedRequestsAreRefused) {
  start_with_blob();
  const std::vector<Change> changes{
      [](auto& request) { request.mutable_segment()->set_worker_key("short"); },
      [](auto& request) { request.mutable_segment()->set_held("\x07"); },
      [](auto& request) { request.mutable_segment()->set_held("\x03"); },
      [](auto& request) { request.mutable_segment()->mutable_endpoint()->set_port(0); },
      [](auto& request) { request.mutable_segment()->mutable_endpoint()->set_port(65536); },
      [](auto& request) { request.mutable_segment()->mutable_endpoint()->set_ticket_key("short"); },
      [](auto& request) {
        request.mutable_segment()->mutable_endpoint()->set_certificate_pem(std::string(5000, 'c'));
      }};
  for (std::size_t i = 0; i < changes.size(); ++i)
    EXPECT_EQ(ask('a', {}, changes[i]).status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << i;
  const auto unknown = [](auto& request) { request.mutable_digest()->set_size_bytes(~std::uint64_t{0}); };
  EXPECT_EQ(ask('a', {}, unknown).status.error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST_F(FetchSegments, WithoutASegmentRequestTheBlobComesWhole) {
  start_with_blob();
  const Answer answer = ask('a', {}, [](auto& request) { request.clear_segment(); });
  EXPECT_TRUE(answer.status.ok());
  EXPECT_TRUE(answer.bytes == blob_);
}

}  // namespace
}  // namespace tessera::rpc
