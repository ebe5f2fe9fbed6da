// SPDX-License-Identifier: Apache-2.0
// WatchFarm and WatchTiles over real gRPC.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>

#include "tests/unit/server/limited_service.hpp"

namespace tessera::rpc {
namespace {

template <typename Response>
struct Subscription {
  grpc::ClientContext context;
  std::unique_ptr<grpc::ClientReaderInterface<Response>> stream;
  Response response;

  bool read() { return stream->Read(&response); }
  // Cancels the call, and returns how it ended.
  grpc::Status leave() {
    context.TryCancel();
    return end();
  }
  grpc::Status end() {
    while (read()) {
    }
    return stream->Finish();
  }
};
using FarmSubscription = Subscription<v1::WatchFarmResponse>;
using TileSubscription = Subscription<v1::WatchTilesResponse>;

class WatchStreams : public LimitedService {
 protected:
  std::unique_ptr<FarmSubscription> watch_farm(const std::string& token = {}) {
    auto watch = std::make_unique<FarmSubscription>();
    v1::WatchFarmRequest request;
    request.set_resume_token(token);
    watch->stream = users_->WatchFarm(&watch->context, request);
    return watch;
  }
  std::unique_ptr<TileSubscription> watch_tiles(const std::string& job, std::uint64_t since = 0,
                                                v1::TileFormat format = v1::TILE_FORMAT_RGB16F) {
    auto watch = std::make_unique<TileSubscription>();
    v1::WatchTilesRequest request;
    request.set_job_id(job);
    request.set_since_revision(since);
    request.set_format(format);
    watch->stream = users_->WatchTiles(&watch->context, request);
    return watch;
  }
  void cancel(const std::string& job) { ASSERT_TRUE(coordinator_->jobs().cancel(job)); }
  // Delivers one lease as a worker of the network does. Returns false if there is none.
  bool work_once() {
    v1::SynchronizeResponse given;
    bool is_answered = false;
    coordinator_->dispatcher().synchronize(greeting_with_key('a'), {.answer = [&](const auto& answer) {
                                             if (answer) given = *answer;
                                             is_answered = true;
                                           }});
    if (!is_answered || given.leases().empty()) {
      // The call waits, and refers to what is gone with this function: it is answered here.
      coordinator_->dispatcher().synchronize(greeting_with_key('a'), {.answer = [](const auto&) {}});
      return false;
    }
    for (const v1::Lease& lease : given.leases()) {
      EXPECT_TRUE(coordinator_->dispatcher().submit_result(server::delivery_with_key('a', lease)));
    }
    return true;
  }
};

TEST_F(WatchStreams, OfAFarmSendWhatThereIsAndWhatChanges) {
  start({});
  const std::string first = submit_now();
  const auto watch = watch_farm();
  ASSERT_TRUE(watch->read());
  EXPECT_TRUE(watch->response.reset());
  EXPECT_TRUE(watch->response.is_current());
  ASSERT_EQ(watch->response.jobs_size(), 1);
  EXPECT_EQ(watch->response.jobs(0).id(), first);
  EXPECT_FALSE(watch->response.jobs(0).has_bundle());
  const std::uint64_t revision = watch->response.jobs(0).revision();
  cancel(first);
  ASSERT_TRUE(watch->read());
  EXPECT_FALSE(watch->response.reset());
  ASSERT_EQ(watch->response.jobs_size(), 1);
  EXPECT_EQ(watch->response.jobs(0).state(), v1::JOB_STATE_CANCELLED);
  EXPECT_GT(watch->response.jobs(0).revision(), revision);
  EXPECT_EQ(watch->leave().error_code(), grpc::StatusCode::CANCELLED);
}

TEST_F(WatchStreams, OfAFarmGoOnWhereTheyEnded) {
  start({});
  const std::string known = submit_now();
  const auto before = watch_farm();
  ASSERT_TRUE(before->read());
  const std::string token = before->response.resume_token();
  before->leave();
  const std::string missed = submit_now();
  const auto after = watch_farm(token);
  ASSERT_TRUE(after->read());
  EXPECT_FALSE(after->response.reset());
  ASSERT_EQ(after->response.jobs_size(), 1) << "the other has not changed";
  EXPECT_EQ(after->response.jobs(0).id(), missed);
  after->leave();
}

TEST_F(WatchStreams, AreEndedWithTheCoordinator) {
  start({});
  const std::string job = submit_now();
  const auto farm = watch_farm();
  const auto tiles = watch_tiles(job);
  ASSERT_TRUE(farm->read());
  ASSERT_TRUE(tiles->read());
  ASSERT_TRUE(server_->stop());
  EXPECT_EQ(farm->end().error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(tiles->end().error_code(), grpc::StatusCode::UNAVAILABLE);
}

TEST_F(WatchStreams, OfTilesEndWithTheJob) {
  start({});
  const std::string job = submit_now();
  const auto watch = watch_tiles(job);
  ASSERT_TRUE(watch->read());
  EXPECT_EQ(watch->response.job().id(), job);
  EXPECT_EQ(watch->response.tiles_size(), 0);
  while (work_once()) {
  }
  std::set<std::pair<std::uint32_t, std::uint32_t>> complete;
  std::uint64_t revision = 0;
  v1::JobState state = v1::JOB_STATE_UNSPECIFIED;
  while (watch->read()) {
    for (const v1::TileImage& tile : watch->response.tiles())
      if (tile.samples() == server::kSpp) complete.insert({tile.rect().x0(), tile.rect().y0()});
    if (watch->response.has_job()) state = watch->response.job().state();
    if (watch->response.revision() != 0) revision = watch->response.revision();
  }
  EXPECT_TRUE(watch->stream->Finish().ok());
  EXPECT_EQ(state, v1::JOB_STATE_DONE);
  EXPECT_EQ(complete.size(), 6u);
  const auto again = watch_tiles(job, revision);
  ASSERT_TRUE(again->read());
  EXPECT_EQ(again->response.tiles_size(), 0) << "it has them all";
  EXPECT_EQ(again->response.job().state(), v1::JOB_STATE_DONE);
  EXPECT_TRUE(again->end().ok());
}

TEST_F(WatchStreams, OfTilesRefuseWhatTheyCannotSend) {
  start({});
  EXPECT_EQ(watch_tiles("nothing")->end().error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(watch_tiles(submit_now(), 0, v1::TILE_FORMAT_UNSPECIFIED)->end().error_code(),
            grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(WatchStreams, CountTowardTheLimitOfWatches) {
  start({.watches = 2});
  const std::string job = submit_now();
  const auto farm = watch_farm();
  ASSERT_TRUE(farm->read());
  EXPECT_EQ(watch_tiles(job)->end().error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  farm->leave();
}

}  // namespace
}  // namespace tessera::rpc
