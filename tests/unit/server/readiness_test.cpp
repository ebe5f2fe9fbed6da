// SPDX-License-Identifier: Apache-2.0
// What probes are told.
#include "server/rpc/readiness.hpp"

#include <gmock/gmock.h>
#include <sys/statvfs.h>

#include <chrono>

#include "server/base/file.hpp"
#include "server/http/static_pages.hpp"
#include "tests/unit/server/http_service.hpp"

namespace tessera::http_api {
namespace {

using rpc::Readiness;
using std::chrono::seconds;
using testing::HasSubstr;

http::Response probe(const std::string& path, const Readiness& readiness) {
  http::Request request;
  request.method = "GET";
  request.path = path;
  return serve_page(request, readiness);
}

TEST(Readiness, SaysWhatStandsInTheWayOfNewWork) {
  Readiness readiness;
  const auto why = [&](Readiness::Clock::duration later = {}) {
    const core::Status ready = readiness.status(Readiness::Clock::now() + later);
    return ready ? "" : ready.error().message;
  };
  EXPECT_EQ(why(), "");
  EXPECT_EQ(why(seconds(6)), "not ready: the state lock was not available for 5 s");
  readiness.note_lock(Readiness::Clock::now() + seconds(100));
  EXPECT_EQ(why(seconds(61)), "not ready: no checkpoint has ended for 60 s: is the disk busy?");
  readiness.note_store("its disk is full");
  EXPECT_EQ(why(), "not ready: the state cannot be written: its disk is full");
  readiness.note_store("");
  EXPECT_EQ(why(), "");
  readiness.note_stop();
  EXPECT_EQ(why(), "not ready: the coordinator is stopping");
}

TEST(Readiness, IsNotThatTheProcessIsAlive) {
  Readiness readiness;
  EXPECT_EQ(probe("/readyz", readiness).status, 200);
  readiness.note_store("its disk is full");
  const http::Response response = probe("/readyz", readiness);
  EXPECT_EQ(response.status, 503);
  EXPECT_THAT(response.body, HasSubstr("its disk is full"));
  EXPECT_EQ(probe("/healthz", readiness).status, 200) << "a restart would not help";
}

TEST(Readiness, SeesFullAndReadOnlyFileSystems) {
  struct statvfs disk {};
  disk.f_frsize = 4096;
  disk.f_bavail = 1 << 20;
  EXPECT_EQ(base::write_obstacle(disk), "");
  disk.f_flag = ST_RDONLY;
  EXPECT_EQ(base::write_obstacle(disk), "its file system is read-only");
  disk.f_flag = 0;
  disk.f_bavail = 2;
  EXPECT_EQ(base::write_obstacle(disk), "its disk is full");
  EXPECT_EQ(base::write_obstacle(std::filesystem::path("/no such folder")), "");
}

class ReadinessOf : public HttpService {};

TEST_F(ReadinessOf, ACoordinatorEndsWhenItStops) {
  start_page();
  EXPECT_EQ(get("/readyz").status, 200);
  server_->announce_stop();
  const Reply stopping = get("/readyz");
  EXPECT_EQ(stopping.status, 503);
  EXPECT_THAT(stopping.body, HasSubstr("the coordinator is stopping"));
  EXPECT_EQ(get("/healthz").status, 200);
}

}  // namespace
}  // namespace tessera::http_api
