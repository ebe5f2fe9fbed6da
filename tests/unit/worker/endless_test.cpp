// SPDX-License-Identifier: Apache-2.0
// A piece that never ends: when a worker gives it up, and what it does then.
#include <gtest/gtest.h>
#include <signal.h>
#include <stdlib.h>

#include <future>

#include "fake_coordinator.hpp"
#include "proto/blob.hpp"
#include "tests/support/temporary_folder.hpp"
#include "worker/hang_watchdog.hpp"
#include "worker/self_restart.hpp"
#include "worker/worker.hpp"

namespace tessera::worker {
namespace {

using namespace std::chrono_literals;

constexpr core::PixelRect kCorner{0, 0, 64, 64};
constexpr const char* kLamp =
    R"({"camera": {"position": [0, 0, -5], "look_at": [0, 0, 0]},
        "materials": {"lamp": {"type": "lambert", "albedo": 0.5, "emission": [1, 1, 1]}},
        "shapes": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "lamp"}]})";

UnwantedPiece unwanted(Duration heartbeat_timeout, Duration wanted_for, bool first) {
  return {.piece = {}, .wanted_for = wanted_for, .heartbeat_timeout = heartbeat_timeout, .first = first};
}

TEST(HangTimeout, GivesTheCoordinatorTimeToCountTheWorker) {
  EXPECT_EQ(compute_hang_timeout(unwanted(10s, 100s, false), 0), 200s);
  EXPECT_EQ(compute_hang_timeout(unwanted(10s, 2s, false), 0), 200s);
}

TEST(HangTimeout, GrowsWithTheLeaseTimeout) {
  EXPECT_EQ(compute_hang_timeout(unwanted(10s, 1000s, false), 0), 2000s);
}

TEST(HangTimeout, IsAnHourAtMostAndHalfAMinuteAtLeast) {
  EXPECT_EQ(compute_hang_timeout(unwanted(10s, 3600s, false), 0), 3600s);
  EXPECT_EQ(compute_hang_timeout(unwanted(0s, 0s, false), 0), 30s);
  EXPECT_EQ(compute_hang_timeout(unwanted(0s, 3600s, false), 0), 30s);
}

TEST(HangTimeout, IsDoubledForEachStartThatRenderedNothing) {
  EXPECT_EQ(compute_hang_timeout(unwanted(10s, 100s, true), 0), 200s);
  EXPECT_EQ(compute_hang_timeout(unwanted(10s, 100s, true), 1), 400s);
  EXPECT_EQ(compute_hang_timeout(unwanted(10s, 100s, true), 3), 1600s);
  EXPECT_EQ(compute_hang_timeout(unwanted(10s, 100s, true), 100), 3600s);
  EXPECT_EQ(compute_hang_timeout(unwanted(10s, 100s, false), 3), 200s) << "this one has rendered something";
}

TEST(HangTimeout, IsNoLongerForAWorkerThatIsToStop) {
  UnwantedPiece piece = unwanted(10s, 1000s, true);
  piece.stopping = true;
  EXPECT_EQ(compute_hang_timeout(piece, 3), 200s);
}

TEST(HangTimeout, IsPassedAcrossRestarts) {
  sigset_t signals_before;
  pthread_sigmask(SIG_SETMASK, nullptr, &signals_before);
  const auto hang_timeout_after = [](const char* failed_restarts) {
    setenv("TESSERA_WORKER_FAILED_RESTARTS", failed_restarts, 1);
    StopSignals signals;
    return with_self_restart(nullptr, signals).hang_timeout(unwanted(10s, 100s, true));
  };
  EXPECT_EQ(hang_timeout_after("0"), 200s);
  EXPECT_EQ(hang_timeout_after("2"), 800s);
  EXPECT_EQ(hang_timeout_after("-1"), 200s);
  EXPECT_EQ(hang_timeout_after("none"), 200s);
  unsetenv("TESSERA_WORKER_FAILED_RESTARTS");
  pthread_sigmask(SIG_SETMASK, &signals_before, nullptr);
}

v1::SynchronizeResponse lease_of_four_samples(const v1::Bundle& bundle) {
  v1::SynchronizeResponse response;
  v1::Lease& lease = *response.add_leases();
  lease.set_id(7);
  lease.set_job_id("job");
  *lease.add_items() = proto::to_proto(WorkItem{kCorner, {0, 4}});
  v1::JobSpec& spec = *response.add_jobs();
  spec.set_job_id("job");
  *spec.mutable_bundle() = bundle;
  *spec.mutable_settings() = proto::to_proto(core::RenderSettings{});
  response.mutable_heartbeat_timeout()->set_seconds(10);
  return response;
}

class EndlessPieceTest : public ::testing::Test {
 protected:
  EndlessPieceTest() {
    lease_tracker_.apply(lease_of_four_samples({}));
    lease_tracker_.next_to_fetch({});
    lease_tracker_.fetched(std::make_shared<Job>(Job{"job", {}, {}}));
  }
  Piece begin_next() {
    const Piece piece = lease_tracker_.take({}, [](const std::string&) { return 4096u; }).value();
    lease_tracker_.begins(piece);
    return piece;
  }
  void render(const Piece& piece) {
    lease_tracker_.rendered(piece, core::FilmTile(piece.item.rect, piece.item.range), 1ms);
  }
  void take_lease_away() { lease_tracker_.apply({}); }
  std::future<std::optional<UnwantedPiece>> watch() {
    return std::async(std::launch::async, [this] {
      return lease_tracker_.abandon_endless(stop_.get_token(), [](const UnwantedPiece&) { return 0s; });
    });
  }
  v1::SynchronizeRequest report() {
    v1::SynchronizeRequest request;
    lease_tracker_.report(request);
    return request;
  }

  LeaseTracker lease_tracker_;
  std::stop_source stop_;
};

TEST_F(EndlessPieceTest, IsOneWhoseLeaseWasRevoked) {
  auto endless = watch();
  render(begin_next());
  const Piece second = begin_next();
  take_lease_away();
  const auto found = endless.get();
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->piece.item, second.item);
  EXPECT_EQ(found->heartbeat_timeout, 10s);
  EXPECT_FALSE(found->first);
}

TEST_F(EndlessPieceTest, IsIgnoredAfterAStop) {
  begin_next();
  auto endless = watch();
  stop_.request_stop();
  EXPECT_FALSE(endless.get().has_value());
}

TEST_F(EndlessPieceTest, IsOneThatAWorkerIsAtThatIsToEnd) {
  auto endless = watch();
  begin_next();
  lease_tracker_.drop_all_wanted();
  EXPECT_TRUE(endless.get().has_value());
}

TEST_F(EndlessPieceTest, IsGivenTimeFromWhenItsSceneIsReadyAndItsLeaseIsGone) {
  const Piece piece = lease_tracker_.take({}, [](const std::string&) { return 4096u; }).value();
  take_lease_away();
  lease_tracker_.begins(piece);
  const auto found = watch().get();
  EXPECT_EQ(found->wanted_for, 0s);
  EXPECT_TRUE(found->first);
}

TEST_F(EndlessPieceTest, IsStillReportedAndWhatWasBeforeItDelivered) {
  render(begin_next());
  const Piece piece = begin_next();
  take_lease_away();
  ASSERT_TRUE(watch().get().has_value());
  EXPECT_EQ(report().rendering().lease_id(), 7u);
  EXPECT_TRUE(report().draining());

  const auto delivery = lease_tracker_.next_delivery({});
  ASSERT_EQ(delivery->tiles.size(), 1u);
  EXPECT_EQ(delivery->tiles[0].range, (core::SampleRange{0, 1}));
  EXPECT_TRUE(delivery->lease_finished);
  lease_tracker_.delivered(*delivery);
  EXPECT_FALSE(lease_tracker_.next_delivery({}).has_value());
  EXPECT_EQ(report().rendering().lease_id(), 7u);

  render(piece);
  EXPECT_EQ(report().rendering().lease_id(), 0u) << "it was slow";
}

// Renders the first sample of a tile, and hangs in the others until release().
class Renderer {
 public:
  core::FilmTile render(core::PixelRect rect, core::SampleRange range) {
    if (range.begin > 0) {
      hangs_.set_value();
      released_.get_future().wait();
    }
    return {rect, range};
  }
  void wait_until_it_hangs() { hangs_.get_future().wait(); }
  void release() { released_.set_value(); }

 private:
  std::promise<void> hangs_, released_;
};

TEST(EndlessWorker, DeliversReportsItsWorkAndRestarts) {
  const TemporaryFolder folder;
  const auto cache = BlobCache::open(folder.path(), 1 << 20);
  ASSERT_TRUE(cache.has_value());
  FakeCoordinator coordinator;
  const proto::Digest digest = proto::digest_of(kLamp);
  v1::Bundle bundle;
  bundle.set_scene_path("scene.json");
  v1::Bundle::Asset& asset = *bundle.add_assets();
  asset.set_path("scene.json");
  *asset.mutable_digest() = proto::to_proto(digest);
  coordinator.keep_blob(asset.digest().sha256(), kLamp);

  Renderer renderer;
  const auto take_leave = [](const auto&, auto&) { return grpc::Status::OK; };
  coordinator.answer_with({[&](const auto&, auto& response) {
                             response = lease_of_four_samples(bundle);
                             return grpc::Status::OK;
                           },
                           [&](const auto&, auto&) {
                             renderer.wait_until_it_hangs();
                             return grpc::Status::OK;
                           },
                           take_leave, take_leave});
  std::vector<v1::SynchronizeRequest> said;
  std::vector<v1::SubmitResultRequest> delivered;
  std::optional<Piece> endless;
  Worker worker(
      {.worker_id = "id", .threads = 1}, *cache, coordinator.stub(),
      {.render = [&](const auto&, auto rect, auto range, int) { return renderer.render(rect, range); },
       .hang_timeout = [](const UnwantedPiece&) { return 0s; },
       .self_restart =
           [&](const UnwantedPiece& piece, bool must_end) {
             EXPECT_FALSE(must_end);
             said = coordinator.wait_for_syncs(3);
             delivered = coordinator.wait_for_results(1);
             endless = piece.piece;
             renderer.release();
           }});
  worker.run({});

  ASSERT_TRUE(endless.has_value());
  EXPECT_EQ(endless->item.rect, kCorner);
  EXPECT_EQ(endless->item.range.begin, 1u);
  ASSERT_EQ(delivered.size(), 1u);
  ASSERT_EQ(delivered[0].items_size(), 1);
  EXPECT_EQ(delivered[0].items(0).item().sample_end(), 1u);
  EXPECT_TRUE(delivered[0].lease_finished());
  EXPECT_TRUE(said.back().draining());
  EXPECT_EQ(said.back().held_size(), 0);
  EXPECT_EQ(said.back().rendering().lease_id(), 7u);
}

}  // namespace
}  // namespace tessera::worker
