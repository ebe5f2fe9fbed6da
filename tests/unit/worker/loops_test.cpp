// SPDX-License-Identifier: Apache-2.0
// The threads of a worker, one by one, with a scripted coordinator.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <new>
#include <string>
#include <system_error>
#include <thread>

#include "confined.hpp"
#include "fake_coordinator.hpp"
#include "proto/tile_codec.hpp"
#include "tests/support/temporary_folder.hpp"
#include "worker/deliver_loop.hpp"
#include "worker/fetch_loop.hpp"
#include "worker/lease_tracker.hpp"
#include "worker/render_loop.hpp"
#include "worker/sync_loop.hpp"

namespace tessera::worker {
namespace {

using namespace std::chrono_literals;

constexpr core::PixelRect kLeasedTile{0, 0, 64, 64};
const Identity kIdentity{"id", "name", "0.1.0", "fingerprint", 3};

grpc::Status give_lease(const v1::SynchronizeRequest&, v1::SynchronizeResponse& response) {
  v1::Lease& lease = *response.add_leases();
  lease.set_id(1);
  lease.set_job_id("job");
  *lease.add_items() = proto::to_proto(WorkItem{kLeasedTile, {0, 4}});
  v1::JobSpec& spec = *response.add_jobs();
  spec.set_job_id("job");
  *spec.mutable_settings() = proto::to_proto(core::RenderSettings{});
  response.mutable_heartbeat_timeout()->set_seconds(10);
  return grpc::Status::OK;
}

grpc::Status unavailable(const v1::SynchronizeRequest&, v1::SynchronizeResponse&) {
  return {grpc::StatusCode::UNAVAILABLE, "restarting"};
}

class LoopsTest : public ::testing::Test {
 protected:
  // Holds a lease whose first `count` samples are rendered.
  void hold_rendered(std::uint32_t count) {
    v1::SynchronizeResponse response;
    give_lease({}, response);
    lease_tracker_.apply(response);
    lease_tracker_.next_to_fetch({});
    lease_tracker_.fetched(std::make_shared<Job>(Job{"job", {}, {}}));
    const auto piece = lease_tracker_.take({}, [&](const std::string&) { return count * 4096u; });
    core::FilmTile tile(piece->item.rect, piece->item.range);
    tile.counters.samples = 4096 * count;
    tile.sums[5] = 77;
    lease_tracker_.rendered(*piece, std::move(tile), 1500ms);
  }

  FakeCoordinator coordinator_;
  LeaseTracker lease_tracker_;
  Metrics metrics_;
};

TEST_F(LoopsTest, SynchronizingTellsWhatTheWorkerIsAndHolds) {
  coordinator_.answer_with({give_lease});
  const SyncLoop::Explain explain = [](const grpc::Status& status) { return proto::error_from_grpc(status); };
  SyncLoop sync(kIdentity, coordinator_.stub(), lease_tracker_, metrics_, explain, SyncLoop::kRefusalBackoff,
                [](v1::SynchronizeRequest& request) { request.mutable_cache()->set_used_bytes(77); });
  std::jthread thread([&](const std::stop_token& stop) { EXPECT_FALSE(sync.run(stop)); });
  const auto calls = coordinator_.wait_for_syncs(2);
  EXPECT_EQ(calls[0].cache().used_bytes(), 77u);
  EXPECT_EQ(calls[0].worker_id(), "id");
  EXPECT_EQ(calls[0].name(), "name");
  EXPECT_EQ(calls[0].version(), "0.1.0");
  EXPECT_EQ(calls[0].determinism_fingerprint(), "fingerprint");
  EXPECT_EQ(calls[0].threads(), 3u);
  EXPECT_EQ(calls[0].held_size(), 0);
  EXPECT_EQ(calls[1].held_size(), 1);
  EXPECT_EQ(calls[1].known_job_ids(0), "job");
}

TEST_F(LoopsTest, SynchronizingSurvivesARestart) {
  coordinator_.answer_with({give_lease, unavailable, unavailable});
  SyncLoop sync(kIdentity, coordinator_.stub(), lease_tracker_, metrics_);
  std::jthread thread([&](const std::stop_token& stop) { EXPECT_FALSE(sync.run(stop)); });
  EXPECT_EQ(coordinator_.wait_for_syncs(4)[3].held_size(), 1);
}

TEST_F(LoopsTest, ARefusedWorkerTriesAgain) {
  const auto refuse = [](const auto&, auto&) {
    return grpc::Status(grpc::StatusCode::FAILED_PRECONDITION, "different bits");
  };
  coordinator_.answer_with({refuse, refuse, give_lease});
  const SyncLoop::Explain explain = [](const grpc::Status& status) { return proto::error_from_grpc(status); };
  SyncLoop sync(kIdentity, coordinator_.stub(), lease_tracker_, metrics_, explain,
                {.first = 1ms, .longest = 2ms});
  std::jthread thread([&](const std::stop_token& stop) { EXPECT_FALSE(sync.run(stop)); });
  EXPECT_EQ(coordinator_.wait_for_syncs(4)[3].held_size(), 1);
}

// Tokens can be corrected while the worker runs.
TEST_F(LoopsTest, AWorkerWithWrongCredentialsTriesAgain) {
  const auto refuse_with = [](grpc::StatusCode code) {
    return [code](const auto&, auto&) { return grpc::Status(code, "no role"); };
  };
  coordinator_.answer_with({refuse_with(grpc::StatusCode::PERMISSION_DENIED),
                            refuse_with(grpc::StatusCode::UNAUTHENTICATED), give_lease});
  const SyncLoop::Explain explain = [](const grpc::Status& status) { return proto::error_from_grpc(status); };
  SyncLoop sync(kIdentity, coordinator_.stub(), lease_tracker_, metrics_, explain,
                {.first = 1ms, .longest = 2ms});
  std::jthread thread([&](const std::stop_token& stop) { EXPECT_FALSE(sync.run(stop)); });
  EXPECT_EQ(coordinator_.wait_for_syncs(4)[3].held_size(), 1);
}

TEST_F(LoopsTest, AStoppedWorkerDoesNotSynchronize) {
  coordinator_.answer_with({give_lease, [](const auto&, auto& response) {
                              response.set_stop(true);
                              return grpc::Status::OK;
                            }});
  SyncLoop sync(kIdentity, coordinator_.stub(), lease_tracker_, metrics_);
  EXPECT_TRUE(sync.run({}));
  EXPECT_EQ(coordinator_.wait_for_syncs(2).size(), 2u);
}

TEST_F(LoopsTest, GoodbyeSaysThatNothingIsHeld) {
  coordinator_.answer_with({[](const auto&, auto&) { return grpc::Status::OK; }});
  lease_tracker_.drain();
  SyncLoop(kIdentity, coordinator_.stub(), lease_tracker_, metrics_).deregister();
  const auto calls = coordinator_.wait_for_syncs(1);
  EXPECT_TRUE(calls[0].draining());
  EXPECT_EQ(calls[0].held_size(), 0);
}

TEST_F(LoopsTest, DeliveryDescribesItself) {
  hold_rendered(4);
  lease_tracker_.drain();
  DeliverLoop({.worker_id = "id"}, coordinator_.stub(), lease_tracker_, metrics_).run({});
  const auto results = coordinator_.wait_for_results(1);
  ASSERT_EQ(results.size(), 1u);
  EXPECT_EQ(results[0].worker_id(), "id");
  EXPECT_EQ(results[0].job_id(), "job");
  EXPECT_EQ(results[0].lease_id(), 1u);
  EXPECT_TRUE(results[0].lease_finished());
  EXPECT_EQ(results[0].render_time().seconds(), 1);
  EXPECT_EQ(results[0].render_time().nanos(), 500'000'000);
  ASSERT_EQ(results[0].items_size(), 1);
  const auto tile = proto::decode_tile(results[0].items(0));
  ASSERT_TRUE(tile.has_value()) << tile.error().message;
  EXPECT_EQ(tile->range, (core::SampleRange{0, 4}));
  EXPECT_EQ(tile->sums[5], 77u);
}

TEST_F(LoopsTest, DeliveryIsRepeatedUntilItArrives) {
  coordinator_.refuse_results_with({{grpc::StatusCode::UNAVAILABLE, ""}, {grpc::StatusCode::INTERNAL, ""}});
  hold_rendered(2);
  lease_tracker_.drain();
  DeliverLoop({.worker_id = "id"}, coordinator_.stub(), lease_tracker_, metrics_).run({});
  const auto results = coordinator_.wait_for_results(3);
  ASSERT_EQ(results.size(), 3u);
  EXPECT_EQ(results[2].SerializeAsString(), results[0].SerializeAsString());
  EXPECT_EQ(results[2].items(0).item().sample_end(), 2u);
  EXPECT_EQ(metrics_.results_delivered, 1u);
  EXPECT_EQ(metrics_.results_rejected, 0u);
}

TEST_F(LoopsTest, ARefusedDeliveryIsNotRepeated) {
  coordinator_.refuse_results_with({{grpc::StatusCode::INVALID_ARGUMENT, "does not fit"}});
  hold_rendered(4);
  lease_tracker_.drain();
  DeliverLoop({.worker_id = "id"}, coordinator_.stub(), lease_tracker_, metrics_).run({});
  EXPECT_EQ(coordinator_.wait_for_results(1).size(), 1u);
  EXPECT_EQ(metrics_.results_delivered, 0u);
  EXPECT_EQ(metrics_.results_rejected, 1u);
}

class SceneFilesTest : public ::testing::Test {
 protected:
  SceneFilesTest() { folder_ = mkdtemp(folder_.data()); }
  ~SceneFilesTest() override { std::filesystem::remove_all(folder_); }

  // Why the worker gives back the only lease of a job with these files.
  std::string refusal(const std::map<std::string, std::string>& blob_paths) {
    LeaseTracker lease_tracker({.delays = {.first = 0s, .longest = 0s}});
    v1::SynchronizeResponse response;
    give_lease({}, response);
    lease_tracker.apply(response);
    lease_tracker.next_to_fetch({});
    lease_tracker.fetched(std::make_shared<Job>(Job{"job", {}, {"key", "scene.json", blob_paths}}));
    RenderLoop render(1, lease_tracker, metrics_, load_);
    std::jthread thread([&](const std::stop_token& stop) { render.run(stop); });
    const auto delivery = lease_tracker.next_delivery({});
    EXPECT_TRUE(delivery->lease_finished);
    return delivery->decline_reason;
  }

  std::string folder_ = "/tmp/tessera-files-XXXXXX";
  LoadScene load_ = confined();
  Metrics metrics_;
};

TEST_F(SceneFilesTest, AreFetchedAgainWhenTheCacheHasLostThem) {
  EXPECT_EQ(refusal({{"scene.json", folder_ + "/gone"}}), "");
}

TEST_F(SceneFilesTest, ThatAreInvalidFailTheJob) {
  std::ofstream(folder_ + "/scene") << "no scene";
  EXPECT_NE(refusal({{"scene.json", folder_ + "/scene"}}), "");
}

TEST_F(SceneFilesTest, ThatNeedTooMuchMemoryAreDeclinedWithTheLimit) {
  std::ofstream(folder_ + "/scene") << "no scene";
  load_ = [](const auto&, int, const auto&) {
    return core::fail(core::ErrorCode::kResourceExhausted, "too big");
  };
  EXPECT_EQ(refusal({{"scene.json", folder_ + "/scene"}}), "too big");
}

// The names of a scene come from a process that may have been taken over.
TEST_F(SceneFilesTest, ReasonsCanBePrintedAndSent) {
  std::ofstream(folder_ + "/scene") << "no scene";
  load_ = [](const auto&, int, const auto&) {
    return core::fail(core::ErrorCode::kInternal, "\x1b[2J\xff" + std::string(5000, 'x'));
  };
  const std::string reason = refusal({{"scene.json", folder_ + "/scene"}});
  EXPECT_EQ(reason.substr(0, 11), "\\x1b[2J\\xff");
  EXPECT_LT(reason.size(), 20'000u);
}

TEST_F(SceneFilesTest, AreGivenBackByAWorkerThatStops) {
  std::ofstream(folder_ + "/scene") << "no scene";
  load_ = [](const auto&, int, const auto&) { return core::fail(core::ErrorCode::kCancelled, "stopping"); };
  EXPECT_EQ(refusal({{"scene.json", folder_ + "/scene"}}), "");
}

// A worker whose first render fails, and the reason with which it declines the job; it goes on.
void expect_to_decline(const LoadScene& load, const std::function<void()>& fail, const std::string& reason) {
  LeaseTracker lease_tracker({.delays = {.first = 0s, .longest = 0s}});
  v1::SynchronizeResponse response;
  give_lease({}, response);
  lease_tracker.apply(response);
  lease_tracker.next_to_fetch({});
  std::map<std::string, std::string> files;
  for (const char* name : {"scene.json", "box.obj", "box.mtl"})
    files[name] = std::string(TESSERA_SOURCE_DIR "/scenes/cornell/") + name;
  const auto job = std::make_shared<Job>(Job{"job", {}, {"key", "scene.json", files}});
  lease_tracker.fetched(job);
  int renders = 0;
  Metrics metrics;
  RenderLoop render(1, lease_tracker, metrics, load, {},
                    [&](const auto&, auto rect, auto range, int) -> core::FilmTile {
                      EXPECT_LE(metrics.step_began.load(), Metrics::Clock::now());
                      if (++renders == 1) fail();
                      return core::FilmTile(rect, range);
                    });
  std::jthread thread([&](const std::stop_token& stop) { render.run(stop); });
  const auto declined = lease_tracker.next_delivery({});
  EXPECT_TRUE(declined->lease_finished);
  EXPECT_TRUE(declined->tiles.empty());
  EXPECT_EQ(declined->decline_reason, reason);
  v1::SynchronizeRequest report;
  lease_tracker.report(report);
  EXPECT_FALSE(report.has_rendering());
  ASSERT_EQ(report.troubles_size(), 1);
  lease_tracker.delivered(*declined);

  response.mutable_leases(0)->set_id(2);
  lease_tracker.apply(response);
  lease_tracker.next_to_fetch({});
  lease_tracker.fetched(job);
  EXPECT_FALSE(lease_tracker.next_delivery({})->tiles.empty());
  thread.request_stop();
  thread.join();
  EXPECT_EQ(metrics.step_began.load(), Metrics::Clock::time_point::max()) << "it waits for work";
}

TEST_F(LoopsTest, AJobThatTakesTooMuchMemoryIsDeclinedAndTheWorkerGoesOn) {
  expect_to_decline(
      confined(), [] { throw std::bad_alloc(); }, "not enough memory to build and render the scene");
}

TEST_F(LoopsTest, AJobForWhichNoThreadStartsIsDeclinedAndTheWorkerGoesOn) {
  const std::error_code none = std::make_error_code(std::errc::resource_unavailable_try_again);
  expect_to_decline(
      confined(), [none] { throw std::system_error(none); },
      "cannot build and render the scene: Resource temporarily unavailable");
}

TEST_F(LoopsTest, AFileWithManyNamesIsFetchedOnce) {
  LeaseTracker lease_tracker;
  const std::string bytes = "v 0 0 0";
  const auto digest = proto::to_proto(proto::digest_of(bytes));
  coordinator_.keep_blob(digest.sha256(), bytes);
  v1::SynchronizeResponse response;
  give_lease({}, response);
  for (int i = 0; i < 1000; ++i) {
    v1::Bundle::Asset& asset = *response.mutable_jobs(0)->mutable_bundle()->add_assets();
    asset.set_path(std::to_string(i));
    *asset.mutable_digest() = digest;
  }
  lease_tracker.apply(response);
  std::string folder = "/tmp/tessera-fetch-XXXXXX";
  const auto cache = BlobCache::open(mkdtemp(folder.data()));
  {
    CoordinatorSource source(coordinator_.stub());
    FetchLoop fetch(*cache, source, lease_tracker);
    std::jthread thread([&](const std::stop_token& stop) { fetch.run(stop); });
    const auto piece = lease_tracker.take({}, [](const std::string&) { return 1u; });
    EXPECT_EQ(piece->job->files.blob_paths.size(), 1000u);
    EXPECT_EQ(coordinator_.fetches(), 1u);
    // The scene was read once: the files are not needed any more.
    std::filesystem::remove_all(folder);
  }
}

TEST_F(LoopsTest, AJobWithoutItsFilesIsReturned) {
  LeaseTracker lease_tracker({.delays = {.first = 0s, .longest = 0s}});
  v1::SynchronizeResponse response;
  give_lease({}, response);
  v1::Bundle::Asset& asset = *response.mutable_jobs(0)->mutable_bundle()->add_assets();
  asset.set_path("scene.json");
  *asset.mutable_digest() = proto::to_proto(proto::digest_of("gone"));
  lease_tracker.apply(response);

  std::string folder = "/tmp/tessera-fetch-XXXXXX";
  const auto cache = BlobCache::open(mkdtemp(folder.data()));
  CoordinatorSource source(coordinator_.stub());
  FetchLoop fetch(*cache, source, lease_tracker);
  std::jthread thread([&](const std::stop_token& stop) { fetch.run(stop); });
  const auto delivery = lease_tracker.next_delivery({});
  EXPECT_TRUE(delivery->lease_finished);
  EXPECT_TRUE(delivery->tiles.empty());
  rmdir(folder.c_str());
}

// Fetches jobs with these files one after the other, each with a lease.
class CacheLimitTest : public ::testing::Test {
 protected:
  void lease(std::uint64_t id, const std::vector<std::string>& files) {
    v1::Lease& lease = *response_.add_leases();
    lease.set_id(id);
    lease.set_job_id(std::to_string(id));
    *lease.add_items() = proto::to_proto(WorkItem{kLeasedTile, {0, 4}});
    v1::JobSpec& spec = *response_.add_jobs();
    spec.set_job_id(lease.job_id());
    *spec.mutable_settings() = proto::to_proto(core::RenderSettings{});
    for (const std::string& bytes : files) {
      v1::Bundle::Asset& asset = *spec.mutable_bundle()->add_assets();
      asset.set_path(fmt::format("{}", spec.bundle().assets_size()));
      *asset.mutable_digest() = proto::to_proto(proto::digest_of(bytes));
      coordinator_.keep_blob(asset.digest().sha256(), bytes);
    }
    lease_tracker_.apply(response_);
  }
  std::optional<Piece> take() {
    return lease_tracker_.take({}, [](const std::string&) { return 4 * 4096u; });
  }

  TemporaryFolder folder_;
  FakeCoordinator coordinator_;
  LeaseTracker lease_tracker_{{.delays = {.first = 0s, .longest = 0s}}};
  v1::SynchronizeResponse response_;
  core::Result<BlobCache> cache_ = BlobCache::open(folder_.path() / "cache", 3500);
  CoordinatorSource source_{coordinator_.stub()};
  FetchLoop fetch_{*cache_, source_, lease_tracker_};
};

TEST_F(CacheLimitTest, AJobWithMoreFilesThanTheCacheHoldsIsDeclined) {
  lease(1, {std::string(2000, 'a'), std::string(2000, 'b')});
  std::jthread thread([&](const std::stop_token& stop) { fetch_.run(stop); });
  const auto delivery = lease_tracker_.next_delivery({});
  EXPECT_TRUE(delivery->lease_finished);
  EXPECT_NE(delivery->decline_reason.find("--cache-gib"), std::string::npos) << delivery->decline_reason;
  EXPECT_EQ(coordinator_.fetches(), 0u);
}

TEST_F(CacheLimitTest, FilesOfAJobInHandAreNotRemovedForTheNext) {
  lease(1, {std::string(2000, 'a')});
  std::jthread thread([&](const std::stop_token& stop) { fetch_.run(stop); });
  const auto piece = take();
  const std::string path = piece->job->files.blob_paths.begin()->second;
  lease(2, {std::string(2000, 'b')});
  const auto given_back = lease_tracker_.next_delivery({});
  EXPECT_EQ(given_back->lease_id, 2u);
  EXPECT_TRUE(given_back->lease_finished);
  EXPECT_EQ(given_back->decline_reason, "") << "it may fit later";
  EXPECT_TRUE(std::filesystem::exists(path));
  EXPECT_LE(cache_->used_bytes(), 3500u);
}

TEST_F(CacheLimitTest, FilesOfAJobThatIsDoneMakeRoomForTheNext) {
  lease(1, {std::string(2000, 'a')});
  std::jthread thread([&](const std::stop_token& stop) { fetch_.run(stop); });
  lease_tracker_.rendered(*take(), core::FilmTile(kLeasedTile, {0, 4}), 1ms);
  lease_tracker_.delivered(*lease_tracker_.next_delivery({}));
  lease(2, {std::string(2000, 'b')});
  EXPECT_EQ(take()->job->id, "2");
  EXPECT_EQ(cache_->used_bytes(), 2000u);
}

TEST(BundleKey, TellsBundlesApart) {
  const auto bundle = [](const std::string& scene,
                         const std::vector<std::pair<std::string, std::string>>& assets) {
    v1::Bundle message;
    message.set_scene_path(scene);
    for (const auto& [path, bytes] : assets) {
      v1::Bundle::Asset& asset = *message.add_assets();
      asset.set_path(path);
      *asset.mutable_digest() = proto::to_proto(proto::digest_of(bytes));
    }
    return bundle_key(message);
  };
  const std::string key = bundle("a", {{"a", "1"}, {"b", "2"}});
  EXPECT_EQ(key, bundle("a", {{"a", "1"}, {"b", "2"}}));
  EXPECT_NE(key, bundle("b", {{"a", "1"}, {"b", "2"}}));
  EXPECT_NE(key, bundle("a", {{"a", "1"}, {"b", "3"}}));
  EXPECT_NE(key, bundle("a", {{"a", "1"}, {"c", "2"}}));
  EXPECT_NE(key, bundle("a", {{"a", "1"}}));
}

}  // namespace
}  // namespace tessera::worker
