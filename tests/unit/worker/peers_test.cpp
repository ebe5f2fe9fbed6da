// SPDX-License-Identifier: Apache-2.0
// Segments from the coordinator and from other workers, over real TLS on the loopback.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <string>
#include <vector>

#include "core/base/open_file.hpp"
#include "fake_coordinator.hpp"
#include "proto/peer_ticket.hpp"
#include "proto/segments.hpp"
#include "proto/worker_key.hpp"
#include "tests/support/temporary_folder.hpp"
#include "worker/peer_client.hpp"
#include "worker/peer_server.hpp"
#include "worker/segment_source.hpp"

namespace tessera::worker {
namespace {

std::string contents_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// One worker that has the blob and serves it, and a cache of another one.
class PeersTest : public ::testing::Test {
 protected:
  void SetUp() override {
    coordinator_.keep_blob(proto::to_proto(digest_).sha256(), blob_);
    CoordinatorSource whole(coordinator_.stub());
    ASSERT_TRUE(there_.get(digest_, {}, whole, {}));
    auto server = PeerServer::start("127.0.0.1:0", there_);
    ASSERT_TRUE(server) << server.error().message;
    server_ = *std::move(server);
  }
  proto::Segment segment(std::uint64_t index) const { return proto::segment_at(blob_.size(), index); }
  std::string bytes_of(const proto::Segment& segment) const {
    return blob_.substr(segment.offset_bytes, segment.size_bytes);
  }
  // To the worker that serves.
  v1::PeerReferral referral(std::uint64_t index, const std::string& worker_id = "there") const {
    const v1::PeerEndpoint endpoint = server_->endpoint();
    v1::PeerReferral referral;
    *referral.mutable_segment() = proto::to_proto(segment(index));
    const auto sha256 = proto::digest_of(bytes_of(segment(index))).sha256;
    referral.set_segment_sha256(sha256.data(), sha256.size());
    referral.set_worker_id(worker_id);
    referral.set_address("127.0.0.1:" + std::to_string(endpoint.port()));
    referral.set_certificate_pem(endpoint.certificate_pem());
    *referral.mutable_ticket() = proto::sign_ticket(endpoint.ticket_key(), digest_, segment(index),
                                                    endpoint.clock_seconds() + proto::kTicketSeconds);
    return referral;
  }
  void send_segment(std::uint64_t index, grpc::ServerWriter<v1::FetchBlobResponse>& writer) const {
    v1::FetchBlobResponse response;
    *response.mutable_segment() = proto::to_proto(segment(index));
    *response.mutable_chunk()->mutable_digest() = proto::to_proto(digest_);
    const std::string bytes = bytes_of(segment(index));
    for (std::size_t at = 0; at < bytes.size(); at += proto::kMaxChunkBytes) {
      response.mutable_chunk()->set_data(bytes.substr(at, proto::kMaxChunkBytes));
      writer.Write(response);
      response.Clear();
    }
  }
  static void refer(const v1::PeerReferral& referral, grpc::ServerWriter<v1::FetchBlobResponse>& writer) {
    v1::FetchBlobResponse response;
    *response.mutable_referral() = referral;
    writer.Write(response);
  }
  core::Result<std::string> get() { return here_.get(digest_, {}, source_, {}); }
  void expect_the_blob() {
    const auto path = get();
    ASSERT_TRUE(path) << path.error().message;
    EXPECT_TRUE(contents_of(*path) == blob_);
  }

  const std::string blob_ = [] {
    std::string bytes(2 * proto::kSegmentBytes + 12345, '\0');
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 31 + i / 251 + i / 65536);
    return bytes;
  }();
  const proto::Digest digest_ = proto::digest_of(blob_);
  const TemporaryFolder folder_;
  FakeCoordinator coordinator_;
  const BlobCache there_ = BlobCache::open(folder_.path() / "there").value();
  const BlobCache here_ = BlobCache::open(folder_.path() / "here").value();
  std::unique_ptr<PeerServer> server_;
  SegmentSource source_{std::string(proto::kWorkerKeyBytes, 'k'), here_, coordinator_.stub(), nullptr};
  PeerClient client_;
};

TEST_F(PeersTest, AWorkerSendsWhatItHasToHoldersOfATicket) {
  for (std::uint64_t i = 0; i < 3; ++i) {
    const auto bytes = client_.fetch(digest_, referral(i), {});
    ASSERT_TRUE(bytes) << bytes.error().message;
    EXPECT_TRUE(*bytes == bytes_of(segment(i)));
  }
  EXPECT_EQ(there_.traffic().peer_sent_bytes.load(), blob_.size());
}

TEST_F(PeersTest, OthersAreRefused) {
  v1::PeerReferral forged = referral(0, "forged");
  forged.mutable_ticket()->set_signature(std::string(32, 'x'));
  EXPECT_EQ(client_.fetch(digest_, forged, {}).error().code, core::ErrorCode::kPermissionDenied);
  v1::PeerReferral of_another_segment = referral(1, "other");
  *of_another_segment.mutable_ticket() = referral(0).ticket();
  EXPECT_EQ(client_.fetch(digest_, of_another_segment, {}).error().code, core::ErrorCode::kPermissionDenied);
  v1::PeerReferral expired = referral(0, "expired");
  *expired.mutable_ticket() = proto::sign_ticket(server_->endpoint().ticket_key(), digest_, segment(0), 0);
  EXPECT_EQ(client_.fetch(digest_, expired, {}).error().code, core::ErrorCode::kPermissionDenied);
  v1::PeerReferral impostor = referral(0, "impostor");
  impostor.set_certificate_pem(make_peer_certificate().certificate_pem);
  EXPECT_EQ(client_.fetch(digest_, impostor, {}).error().code, core::ErrorCode::kUnavailable)
      << "its certificate is not the one that the coordinator has named";
  EXPECT_EQ(there_.traffic().peer_sent_bytes.load(), 0u);
}

TEST_F(PeersTest, WhatAWorkerLacksIsNotFound) {
  proto::Digest unknown = proto::digest_of("unknown");
  unknown.size_bytes = blob_.size();
  v1::PeerReferral asked = referral(0);
  *asked.mutable_ticket() = proto::sign_ticket(server_->endpoint().ticket_key(), unknown, segment(0),
                                               server_->endpoint().clock_seconds() + 10);
  EXPECT_EQ(client_.fetch(unknown, asked, {}).error().code, core::ErrorCode::kNotFound);
  EXPECT_THAT(client_.excluded(PeerClient::Clock::now()), ::testing::ElementsAre("there"));
  EXPECT_THAT(client_.excluded(PeerClient::Clock::now() + 2 * PeerClient::kExcludedFor), ::testing::IsEmpty())
      << "it may have it later";
}

TEST_F(PeersTest, AWorkerWithWrongBytesIsExcludedForGood) {
  v1::PeerReferral wrong = referral(0);
  wrong.set_segment_sha256(std::string(32, 'x'));
  EXPECT_EQ(client_.fetch(digest_, wrong, {}).error().code, core::ErrorCode::kDataLoss);
  EXPECT_THAT(client_.excluded(PeerClient::Clock::now() + std::chrono::hours(24)),
              ::testing::ElementsAre("there"));
}

TEST_F(PeersTest, ABlobComesFromTheCoordinatorAndFromWorkers) {
  coordinator_.answer_downloads_with([&](const v1::FetchBlobRequest& request, auto& writer) {
    EXPECT_EQ(request.segment().worker_key(), std::string(proto::kWorkerKeyBytes, 'k'));
    EXPECT_FALSE(request.segment().has_endpoint()) << "it serves nobody";
    const auto held = proto::SegmentSet::from_bytes(request.segment().held(), 3);
    if (!held->contains(1))
      send_segment(1, writer);
    else
      refer(referral(held->contains(0) ? 2 : 0), writer);
    return grpc::Status::OK;
  });
  expect_the_blob();
  EXPECT_EQ(here_.traffic().peer_received_bytes.load(), blob_.size() - proto::kSegmentBytes);
  EXPECT_EQ(here_.traffic().received_bytes.load(), blob_.size());
}

TEST_F(PeersTest, ACorruptPeerIsNotUsedAgain) {
  std::vector<int> excluded;
  coordinator_.answer_downloads_with([&](const v1::FetchBlobRequest& request, auto& writer) {
    const auto held = proto::SegmentSet::from_bytes(request.segment().held(), 3);
    std::uint64_t missing = 0;
    while (held->contains(missing)) ++missing;
    excluded.push_back(request.segment().excluded_worker_ids_size());
    v1::PeerReferral bad = referral(missing);
    bad.set_segment_sha256(std::string(32, 'x'));
    excluded.back() == 0 ? refer(bad, writer) : send_segment(missing, writer);
    return grpc::Status::OK;
  });
  expect_the_blob();
  EXPECT_THAT(excluded, ::testing::ElementsAre(0, 1, 1, 1));
  EXPECT_EQ(here_.traffic().peer_received_bytes.load(), 0u);
}

TEST_F(PeersTest, AnInterruptedBlobIsContinued) {
  int calls = 0;
  coordinator_.answer_downloads_with([&](const v1::FetchBlobRequest& request, auto& writer) {
    const auto held = proto::SegmentSet::from_bytes(request.segment().held(), 3);
    EXPECT_EQ(held->contains(0), calls > 0) << "what had come is still there";
    switch (calls++) {
      case 0:
        send_segment(0, writer);
        return grpc::Status::OK;
      case 1:
        return grpc::Status(grpc::StatusCode::UNAVAILABLE, "restarting");
      default:
        send_segment(held->contains(1) ? 2 : 1, writer);
        return grpc::Status::OK;
    }
  });
  expect_the_blob();
  EXPECT_EQ(calls, 4);
}

TEST_F(PeersTest, ACoordinatorThatKnowsNoSegmentsSendsTheBlob) {
  expect_the_blob();
  EXPECT_EQ(coordinator_.fetches(), 3u) << "the other worker's, the question, the blob";
}

TEST_F(PeersTest, WhatIsDamagedAtTheCoordinatorIsFetchedWholeToTellIt) {
  coordinator_.answer_downloads_with([&](const v1::FetchBlobRequest& request, auto& writer) {
    if (!request.has_segment()) return grpc::Status(grpc::StatusCode::DATA_LOSS, "damaged");
    const auto held = proto::SegmentSet::from_bytes(request.segment().held(), 3);
    v1::FetchBlobResponse response;
    std::uint64_t missing = 0;
    while (held->contains(missing)) ++missing;
    *response.mutable_segment() = proto::to_proto(segment(missing));
    std::string left(segment(missing).size_bytes, 'x');
    while (!left.empty()) {
      response.mutable_chunk()->set_data(left.substr(0, proto::kMaxChunkBytes));
      left.erase(0, proto::kMaxChunkBytes);
      writer.Write(response);
      response.Clear();
    }
    return grpc::Status::OK;
  });
  EXPECT_EQ(get().error().code, core::ErrorCode::kDataLoss);
}

TEST_F(PeersTest, AWorkerServesWhatItIsStillFetching) {
  const auto partial = PartialBlob::create(folder_.path() / "partial", digest_);
  ASSERT_TRUE(partial);
  EXPECT_EQ((*partial)->read(segment(1), std::chrono::milliseconds(0)), std::nullopt);
  ASSERT_TRUE((*partial)->add(segment(1), bytes_of(segment(1))));
  EXPECT_TRUE((*partial)->read(segment(1), std::chrono::milliseconds(0)) == bytes_of(segment(1)));
  PartialBlobs blobs;
  {
    const PartialBlobs::Listing listing(blobs, *partial);
    EXPECT_EQ(blobs.find(digest_), *partial);
  }
  EXPECT_EQ(blobs.find(digest_), nullptr);
}

// Opens a connection over which nothing is said.
core::OpenFile connect_to(std::uint32_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  core::OpenFile connection(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (::connect(connection.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) return {};
  return connection;
}

// Whether the peer closes the connection within the timeout, without having sent anything.
bool is_closed(const core::OpenFile& connection, std::chrono::seconds timeout) {
  const timeval patience{timeout.count(), 0};
  ::setsockopt(connection.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  char byte = 0;
  const ssize_t received = ::recv(connection.get(), &byte, 1, 0);
  return received == 0 || (received < 0 && errno == ECONNRESET);
}

// The handshake of TLS may last ten seconds: no connection is closed earlier but those beyond the limit.
TEST_F(PeersTest, ConnectionsBeyondTheLimitsAreClosed) {
  server_ = *PeerServer::start("127.0.0.1:0", there_, {.connections = 3, .machine_connections = 2});
  std::vector<core::OpenFile> inside;
  for (int i = 0; i < 2; ++i) inside.push_back(connect_to(server_->endpoint().port()));
  for (int i = 0; i < 8; ++i)
    EXPECT_TRUE(is_closed(connect_to(server_->endpoint().port()), std::chrono::seconds(5)));
  EXPECT_EQ(client_.fetch(digest_, referral(0), {}).error().code, core::ErrorCode::kUnavailable);
  inside.pop_back();
  const auto end = PeerClient::Clock::now() + std::chrono::seconds(30);
  while (!client_.fetch(digest_, referral(0), {}) && PeerClient::Clock::now() < end) {
  }
  EXPECT_EQ(there_.traffic().peer_sent_bytes.load(), proto::kSegmentBytes) << "there is room again";
}

// Such as that of a worker that has what it needs. The next segment opens another.
TEST_F(PeersTest, AnIdleConnectionIsClosed) {
  server_ = *PeerServer::start(
      "127.0.0.1:0", there_,
      {.connections = 1, .machine_connections = 1, .idle = std::chrono::milliseconds(200)});
  ASSERT_TRUE(client_.fetch(digest_, referral(0), {}));
  PeerClient another;
  const auto end = PeerClient::Clock::now() + std::chrono::seconds(30);
  while (!another.fetch(digest_, referral(1), {}) && PeerClient::Clock::now() < end) {
  }
  EXPECT_EQ(there_.traffic().peer_sent_bytes.load(), 2 * proto::kSegmentBytes);
}

TEST_F(PeersTest, ATicketIsUsedUp) {
  const v1::PeerReferral granted = referral(2);
  for (unsigned i = 0; i < UploadQuota::kMaxTicketUses; ++i) ASSERT_TRUE(client_.fetch(digest_, granted, {}));
  const auto beyond = client_.fetch(digest_, granted, {});
  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.error().code, core::ErrorCode::kResourceExhausted);
  EXPECT_EQ(there_.traffic().peer_sent_bytes.load(), UploadQuota::kMaxTicketUses * segment(2).size_bytes);
  EXPECT_TRUE(client_.fetch(digest_, referral(1), {})) << "another ticket is not";
}

v1::PeerTicket ticket(std::uint64_t expires_seconds, const std::string& signature = "s") {
  v1::PeerTicket made;
  made.set_expires_seconds(expires_seconds);
  made.set_signature(signature);
  return made;
}

TEST(UploadQuota, LeavesRoomForOtherMachines) {
  UploadQuota quota;
  std::vector<UploadQuota::Upload> uploads;
  for (unsigned i = 0; i < UploadQuota::kMaxMachineUploads; ++i)
    uploads.push_back(std::move(*quota.begin("a", ticket(100), 50)));
  EXPECT_FALSE(quota.begin("a", ticket(100), 50));
  for (unsigned i = UploadQuota::kMaxMachineUploads; i < UploadQuota::kMaxUploads; ++i)
    uploads.push_back(std::move(*quota.begin("b", ticket(100), 50)));
  EXPECT_FALSE(quota.begin("c", ticket(100), 50));
  uploads.pop_back();
  EXPECT_TRUE(quota.begin("c", ticket(100), 50));
}

TEST(UploadQuota, CountsTheUsesOfATicketByMachineUntilItExpires) {
  UploadQuota quota;
  for (unsigned i = 0; i < UploadQuota::kMaxTicketUses; ++i) ASSERT_TRUE(quota.begin("a", ticket(100), 50));
  EXPECT_FALSE(quota.begin("a", ticket(100), 100));
  EXPECT_TRUE(quota.begin("b", ticket(100), 100));
  EXPECT_TRUE(quota.begin("a", ticket(100, "another"), 100));
  for (std::size_t i = 2; i < UploadQuota::kMaxTickets; ++i)
    static_cast<void>(quota.begin("a", ticket(101, std::to_string(i)), 100));
  EXPECT_TRUE(quota.begin("a", ticket(160), 101)) << "those that have expired are forgotten";
}

TEST(UploadQuota, RemembersNoMoreTicketsThanItsLimit) {
  UploadQuota quota;
  for (std::size_t i = 0; i < UploadQuota::kMaxTickets; ++i)
    ASSERT_TRUE(quota.begin("a", ticket(100, std::to_string(i)), 50));
  EXPECT_FALSE(quota.begin("a", ticket(100), 50));
  EXPECT_TRUE(quota.begin("a", ticket(100, "0"), 50)) << "one that is known";
}

TEST(PeerServer, SaysWhyItCannotListen) {
  const TemporaryFolder folder;
  const auto cache = BlobCache::open(folder.path() / "cache");
  const auto refused = PeerServer::start("192.0.2.1:1", *cache);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, ::testing::HasSubstr("--serve-blobs 192.0.2.1:1"));
}

}  // namespace
}  // namespace tessera::worker
