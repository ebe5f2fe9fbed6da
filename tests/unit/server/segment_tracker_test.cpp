// SPDX-License-Identifier: Apache-2.0
#include "server/blobs/segment_tracker.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace tessera::blobs {
namespace {

using namespace std::chrono_literals;
using Sending = SegmentTracker::Sending;
using Peer = SegmentTracker::Peer;
using Later = SegmentTracker::Later;

constexpr std::uint64_t kSegments = 24;

class SegmentTrackerTest : public ::testing::Test {
 protected:
  static proto::Digest blob_of(std::uint64_t segments, const std::string& name = "blob") {
    proto::Digest digest = proto::digest_of(name);
    digest.size_bytes = segments * proto::kSegmentBytes;
    return digest;
  }
  static proto::SegmentSet set_of(std::uint64_t count, const std::vector<std::uint64_t>& held) {
    proto::SegmentSet set(count);
    for (const std::uint64_t i : held) set.insert(i);
    return set;
  }
  SegmentTracker::Ask ask_of(const std::string& worker, const proto::Digest& blob,
                             const std::vector<std::uint64_t>& held = {}) const {
    return {worker, serving(worker), false, blob, set_of(proto::segment_count(blob.size_bytes), held), {}};
  }
  static SegmentTracker::Endpoint serving(const std::string& worker) {
    return {.address = worker + ":1", .certificate_pem = "", .ticket_key = "", .heard_at = {}};
  }
  SegmentTracker::Source choose(const SegmentTracker::Ask& ask) { return tracker_.choose(ask, now_); }
  // Gives the worker all of the blob.
  void send_all(const std::string& worker, const proto::Digest& blob) {
    std::vector<std::uint64_t> held;
    for (std::uint64_t i = 0; i < proto::segment_count(blob.size_bytes); ++i) {
      auto source = choose(ask_of(worker, blob, held));
      ASSERT_TRUE(std::holds_alternative<Sending>(source));
      std::get<Sending>(source).complete({});
      held.push_back(std::get<Sending>(source).index());
    }
  }

  SegmentTracker tracker_;
  SegmentTracker::Time now_{1h};
};

TEST_F(SegmentTrackerTest, WorkersThatServeNoBlobsGetAllSegmentsAtOnce) {
  std::vector<SegmentTracker::Source> sources;
  for (const std::string worker : {"a", "b", "c", "d"}) {
    auto ask = ask_of(worker, blob_of(2));
    ask.endpoint.reset();
    sources.push_back(choose(ask));
    EXPECT_TRUE(std::holds_alternative<Sending>(sources.back())) << worker;
  }
}

TEST_F(SegmentTrackerTest, AWorkerGetsFromAnotherWhatWasSentToThat) {
  auto first = choose(ask_of("a", blob_of(1)));
  ASSERT_TRUE(std::holds_alternative<Sending>(first));
  EXPECT_TRUE(std::holds_alternative<Later>(choose(ask_of("b", blob_of(1))))) << "it is on its way to a";
  std::get<Sending>(first).complete(blob_of(1).sha256);
  const auto second = choose(ask_of("b", blob_of(1)));
  ASSERT_TRUE(std::holds_alternative<Peer>(second));
  EXPECT_EQ(std::get<Peer>(second).worker_id, "a");
  EXPECT_EQ(std::get<Peer>(second).endpoint.address, "a:1");
  EXPECT_EQ(std::get<Peer>(second).sha256, blob_of(1).sha256);
}

TEST_F(SegmentTrackerTest, WhatWasNotSentWholeIsSentToTheNext) {
  choose(ask_of("a", blob_of(1)));  // the call ends at once
  EXPECT_TRUE(std::holds_alternative<Sending>(choose(ask_of("b", blob_of(1)))));
}

TEST_F(SegmentTrackerTest, NoFetchWaitsLongerThanTheTimeout) {
  const auto slow = choose(ask_of("a", blob_of(1)));
  EXPECT_TRUE(std::holds_alternative<Later>(choose(ask_of("b", blob_of(1)))));
  now_ += SegmentTracker::kPatience;
  EXPECT_TRUE(std::holds_alternative<Sending>(choose(ask_of("b", blob_of(1)))));
}

TEST_F(SegmentTrackerTest, ExcludedAndForgottenWorkersAreNotNamed) {
  send_all("a", blob_of(1));
  auto ask = ask_of("b", blob_of(1));
  ask.excluded = {"a"};
  EXPECT_TRUE(std::holds_alternative<Sending>(choose(ask)));
  EXPECT_TRUE(std::holds_alternative<Peer>(choose(ask_of("c", blob_of(1)))));
  now_ += SegmentTracker::kForgetAfter + 1s;
  EXPECT_TRUE(std::holds_alternative<Sending>(choose(ask_of("d", blob_of(1)))));
}

TEST_F(SegmentTrackerTest, WorkersOnTheLoopbackAreNamedToEachOtherAlone) {
  auto ask = ask_of("a", blob_of(1));
  ask.is_on_loopback = true;
  auto source = choose(ask);
  std::get<Sending>(source).complete({});
  EXPECT_TRUE(std::holds_alternative<Sending>(choose(ask_of("b", blob_of(1)))));
  ask = ask_of("c", blob_of(1));
  ask.is_on_loopback = true;
  EXPECT_TRUE(std::holds_alternative<Peer>(choose(ask)));
}

TEST_F(SegmentTrackerTest, AWorkerIsAskedToSendAFewAtATime) {
  send_all("a", blob_of(1));
  for (std::size_t i = 0; i < SegmentTracker::kMaxUploads; ++i)
    EXPECT_TRUE(std::holds_alternative<Peer>(choose(ask_of("b" + std::to_string(i), blob_of(1)))));
  EXPECT_TRUE(std::holds_alternative<Later>(choose(ask_of("c", blob_of(1)))));
  // b0 has it, and asks for another file.
  choose(ask_of("b0", blob_of(1, "other")));
  EXPECT_TRUE(std::holds_alternative<Peer>(choose(ask_of("c", blob_of(1)))));
}

TEST_F(SegmentTrackerTest, ASegmentWhoseBytesWereNotSeenSinceTheStartIsSent) {
  // After a restart of the coordinator, workers say that they have some.
  choose(ask_of("a", blob_of(3), {0, 1}));
  const auto source = choose(ask_of("b", blob_of(3)));
  EXPECT_TRUE(std::holds_alternative<Sending>(source)) << "nobody could verify it";
}

TEST_F(SegmentTrackerTest, WhatIsRememberedIsBounded) {
  SegmentTracker tracker({.blobs = 2, .segments = 100, .workers = 4, .holders_of_a_blob = 2});
  const auto give = [&](const std::string& worker, const std::string& name) {
    auto source = tracker.choose(ask_of(worker, blob_of(1, name)), now_);
    if (auto* const sending = std::get_if<Sending>(&source)) sending->complete({});
    return source.index();
  };
  give("a", "1");
  give("a", "2");
  EXPECT_EQ(give("b", "1"), 1u) << "named";
  give("a", "3");
  EXPECT_EQ(give("c", "2"), 0u) << "forgotten, as it was not used for longest";
  for (const std::string worker : {"d", "e", "f", "g", "h"}) give(worker, "3");
  SUCCEED() << "workers are forgotten, and blobs that name them do no harm";
}

TEST_F(SegmentTrackerTest, ADamagedBlobIsForgotten) {
  send_all("a", blob_of(2));
  EXPECT_TRUE(std::holds_alternative<Peer>(choose(ask_of("b", blob_of(2)))));
  tracker_.forget(blob_of(2));
  EXPECT_TRUE(std::holds_alternative<Sending>(choose(ask_of("c", blob_of(2)))));
}

// All begin at the same time; in each round, every worker asks once and has what it asked for in the next.
TEST_F(SegmentTrackerTest, ASwarmCostsTheCoordinatorEachSegmentOnce) {
  struct Member {
    std::string name;
    std::vector<std::uint64_t> held;
    std::shared_ptr<SegmentTracker::Source> source;
  };
  std::vector<Member> swarm(16);
  for (std::size_t i = 0; i < swarm.size(); ++i) swarm[i].name = "worker" + std::to_string(i);
  std::uint64_t sent = 0;
  int rounds = 0;
  const auto is_done = [](const Member& member) { return member.held.size() == kSegments; };
  while (!std::all_of(swarm.begin(), swarm.end(), is_done)) {
    ASSERT_LT(++rounds, 500);
    now_ += 200ms;
    for (Member& member : swarm)
      if (!is_done(member))
        member.source = std::make_shared<SegmentTracker::Source>(
            choose(ask_of(member.name, blob_of(kSegments), member.held)));
    for (Member& member : swarm) {
      if (!member.source) continue;
      if (auto* const sending = std::get_if<Sending>(member.source.get())) {
        ++sent;
        member.held.push_back(sending->index());
        sending->complete({});
      } else if (const auto* const peer = std::get_if<Peer>(member.source.get())) {
        member.held.push_back(peer->index);
      }
      member.source.reset();
    }
  }
  EXPECT_EQ(sent, kSegments);
  EXPECT_LT(rounds, 3 * static_cast<int>(kSegments)) << "they wait for each other";
}

}  // namespace
}  // namespace tessera::blobs
