// SPDX-License-Identifier: Apache-2.0
// Streams over HTTP: server-sent events, and the tiles of images.
#include <gmock/gmock.h>
#include <half.h>
#include <libdeflate.h>

#include <cstring>
#include <map>
#include <optional>
#include <utility>

#include "server/http/farm_events.hpp"
#include "tests/unit/server/http_service.hpp"

namespace tessera::http_api {
namespace {

using testing::HasSubstr;
using testing::Not;

struct Frame {
  nlohmann::json header;
  std::string payload;
};

std::uint32_t length_at(const std::string& bytes, std::size_t at) {
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + at, sizeof length);
  return length;
}

std::vector<Frame> frames_of(const std::string& body) {
  std::vector<Frame> frames;
  for (std::size_t at = 0; at + 8 <= body.size();) {
    const std::uint32_t header = length_at(body, at), payload = length_at(body, at + 4);
    if (at + 8 + header + payload > body.size()) break;
    frames.push_back(
        {nlohmann::json::parse(body.substr(at + 8, header)), body.substr(at + 8 + header, payload)});
    at += 8 + header + payload;
  }
  return frames;
}

std::vector<std::uint16_t> halves_in(const std::string& zlib, std::size_t count) {
  std::vector<std::uint16_t> halves(count);
  libdeflate_decompressor* const inflater = libdeflate_alloc_decompressor();
  std::size_t size = 0;
  EXPECT_EQ(libdeflate_zlib_decompress(inflater, zlib.data(), zlib.size(), halves.data(), count * 2, &size),
            LIBDEFLATE_SUCCESS);
  EXPECT_EQ(size, count * 2);
  libdeflate_free_decompressor(inflater);
  return halves;
}

class HttpStreams : public HttpService {
 protected:
  std::unique_ptr<http::RawClient> watch(const std::string& last_id = {}) {
    return send("GET", "/api/v1/events", {},
                last_id.empty() ? Headers{} : Headers{{"Last-Event-ID", last_id}});
  }
  static std::string id_in(const std::string& events) {
    const std::size_t begin = events.rfind("id: ");
    return begin == std::string::npos ? "" : events.substr(begin + 4, events.find('\n', begin) - begin - 4);
  }
};

TEST_F(HttpStreams, OfTheFarmResume) {
  start_page();
  const std::string known = submit_now();
  const auto before = watch();
  const std::string first = before->receive_until(known);
  EXPECT_THAT(first, HasSubstr("event: reset"));
  EXPECT_THAT(first, HasSubstr("text/event-stream"));
  const std::string id = id_in(first);
  ASSERT_NE(id, "");
  ASSERT_TRUE(coordinator_->jobs().cancel(known));
  EXPECT_THAT(before->receive_until("cancelled"), HasSubstr("event: jobs"));
  const std::string missed = submit_now();
  const auto after = watch(id);
  const std::string next = after->receive_until(missed);
  EXPECT_THAT(next, Not(HasSubstr("event: reset")));
  EXPECT_THAT(next, HasSubstr("cancelled"));
  const auto again = watch("nonsense");
  EXPECT_THAT(again->receive_until(missed), HasSubstr("event: reset"));
  ASSERT_TRUE(coordinator_->jobs().remove(known));
  EXPECT_THAT(after->receive_until(R"("jobs":[")" + known), HasSubstr("event: removed"));
}

TEST_F(HttpStreams, EndWithTheCoordinator) {
  start_page();
  const std::string job = submit_now();
  const auto farm = watch();
  const auto tiles = send("GET", "/api/v1/jobs/" + job + "/tiles", {}, {});
  farm->receive_until("\n\n");
  tiles->receive_until("job");
  page_.reset();
  farm->receive_all();
  tiles->receive_all();
  EXPECT_TRUE(farm->is_ended());
  EXPECT_TRUE(tiles->is_ended());
}

TEST_F(HttpStreams, OfTilesAreTheHalvesOfTheImage) {
  start_page();
  const std::string job = submit_now();
  const std::string path = "/api/v1/jobs/" + job + "/tiles";
  const auto live = send("GET", path, {}, {});
  while (work_once()) {
  }
  const core::Image expected = server::ready_made_image(server::kWidthPx, server::kHeightPx, server::kSpp);
  std::uint64_t revision = 0;
  for (const std::string& body : {http::unchunked(live->receive_all()), get(path).body}) {
    const std::vector<Frame> frames = frames_of(body);
    ASSERT_FALSE(frames.empty());
    EXPECT_EQ(frames.front().header["type"], "job");
    EXPECT_EQ(frames.front().header["job"]["id"], job);
    EXPECT_EQ(frames.back().header["type"], "end");
    std::size_t complete = 0;
    for (const Frame& frame : frames) {
      const auto& header = frame.header;
      if (header["type"] == "revision") revision = header["revision"];
      if (header["type"] != "tile" || header["level"] != 0 || header["samples"] != server::kSpp) continue;
      const int x0 = header["x0"], y0 = header["y0"], x1 = header["x1"], y1 = header["y1"];
      const auto count = static_cast<std::size_t>(3 * (x1 - x0) * (y1 - y0));
      const auto halves = halves_in(frame.payload, count);
      auto half = halves.begin();
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x)
          for (int channel = 0; channel < 3; ++channel)
            ASSERT_EQ(*half++, Imath::half(expected.at(x, y)[channel]).bits());
      ++complete;
    }
    EXPECT_GE(complete, 6u);
  }
  const std::vector<Frame> rest = frames_of(get(path + "?since=" + std::to_string(revision)).body);
  for (const Frame& frame : rest) EXPECT_NE(frame.header["type"], "tile") << "it has them all";
  EXPECT_EQ(get(path + "?level=99").status, 400);
  EXPECT_EQ(get("/api/v1/jobs/none/tiles").status, 404);
}

TEST_F(HttpStreams, OfTilesAreThoseOfOneImage) {
  start_page();
  v1::SubmitJobRequest request = rpc::submission();
  for (const int frame : {1, 2}) request.add_frames(frame);
  const std::string job = submit_now(request);
  while (work_once()) {
  }
  const core::Image expected =
      server::ready_made_image({0, 0, server::kWidthPx, server::kHeightPx}, server::kSpp, 1);
  std::size_t complete = 0;
  for (const Frame& frame : frames_of(get("/api/v1/jobs/" + job + "/tiles?image=1").body)) {
    const auto& header = frame.header;
    if (header["type"] != "tile" || header["level"] != 0 || header["samples"] != server::kSpp) continue;
    const int x0 = header["x0"], y0 = header["y0"], x1 = header["x1"], y1 = header["y1"];
    const auto halves = halves_in(frame.payload, static_cast<std::size_t>(3 * (x1 - x0) * (y1 - y0)));
    EXPECT_EQ(halves.front(), Imath::half(expected.at(x0, y0)[0]).bits());
    ++complete;
  }
  EXPECT_EQ(complete, 6u);
}

// A reader that stops reading makes no queue of old tiles, delays nobody, and gets the newest ones when it
// reads on.
TEST_F(HttpStreams, OfTilesToASlowReaderAreBounded) {
  constexpr int kSidePx = 640;
  constexpr std::uint32_t kManySamples = 16;
  start_page();
  v1::SubmitJobRequest request = rpc::submission();
  request.mutable_overrides()->set_width_px(kSidePx);
  request.mutable_overrides()->set_height_px(kSidePx);
  request.mutable_overrides()->set_spp(kManySamples);
  const std::string job = submit_now(request);
  const std::string path = "/api/v1/jobs/" + job + "/tiles";
  http::RawClient slow(page_->address(), 256 << 10);
  ASSERT_TRUE(
      slow.send("GET " + path + " HTTP/1.1\r\nHost: " + page_->address() + "\r\nConnection: close\r\n\r\n"));
  std::string received = slow.receive_until("\"type\":\"job\"");
  // Passes of 1, 1, 2, 4 and 8 samples change every tile, each by more than 1.5 MiB of noise in all.
  while (work_once()) EXPECT_EQ(get("/api/v1/jobs/" + job).status, 200);
  const std::string others = http::unchunked(send("GET", path, {}, {})->receive_all());
  EXPECT_EQ(frames_of(others).back().header["type"], "end");
  EXPECT_GT(others.size(), std::size_t{3} << 19);
  const std::uint64_t sent = server_->services().streams.calls.traffic.watched_sent;
  EXPECT_LT(sent - others.size(), std::uint64_t{6} << 20) << "what the buffers of the sockets hold";
  received += slow.receive_all();
  const std::vector<Frame> frames = frames_of(http::unchunked(received));
  EXPECT_EQ(frames.back().header["type"], "end");
  std::map<std::pair<int, int>, std::uint32_t> newest;
  for (const Frame& frame : frames)
    if (frame.header["type"] == "tile" && frame.header["level"] == 0)
      newest[{frame.header["x0"], frame.header["y0"]}] = frame.header["samples"];
  EXPECT_EQ(newest.size(), 100u);
  for (const auto& [corner, samples] : newest) EXPECT_EQ(samples, kManySamples);
}

TEST_F(HttpStreams, AreLimitedWithThoseOfGrpc) {
  server::Limits limits;
  limits.watches = 2;
  start_page(limits);
  const auto first = watch();
  first->receive_until("\n\n");
  const Reply second = get("/api/v1/events");
  EXPECT_EQ(second.status, 429);
  EXPECT_THAT(second.message(), HasSubstr("--max-watches"));
}

TEST(HttpTokens, AreReadAsTheyWereWritten) {
  const std::string token("\x00\xff\x10 token\x80", 10);
  EXPECT_EQ(decode_token(encode_token(token)), token);
  EXPECT_EQ(decode_token("not a token!"), "");
  EXPECT_EQ(encode_token(std::string(16, '\xff')).find_first_of("+/="), std::string::npos);
}

}  // namespace
}  // namespace tessera::http_api
