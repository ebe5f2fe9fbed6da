// SPDX-License-Identifier: Apache-2.0
// Bodies of requests.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <utility>

#include "tests/unit/http/raw_client.hpp"

namespace tessera::http {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string post(const std::string& address, const std::string& body, const std::string& headers = {}) {
  RawClient client(address);
  client.send("POST /upload HTTP/1.1\r\nHost: test\r\nConnection: close\r\nContent-Length: " +
              std::to_string(body.size()) + "\r\n" + headers + "\r\n" + body);
  return client.receive_all();
}

TEST(HttpUpload, ArrivesWhole) {
  FunctionHandler handler;
  handler.on_handle = [](const Request& request) { return Response{.body = request.body}; };
  const auto server = start_server(handler);
  const std::string body = std::string(300'000, 'a') + "z";
  EXPECT_TRUE(post(server->address(), body).ends_with(body));
}

TEST(HttpUpload, ThatIsTooLargeIsRefusedAtOnce) {
  FunctionHandler handler;
  handler.on_receive = [](const Request&) { return Reception{.max_body_bytes = 10}; };
  const auto server = start_server(handler);
  EXPECT_THAT(post(server->address(), "0123456789"), StartsWith("HTTP/1.1 200"));
  // Before the body.
  RawClient client(server->address());
  client.send("POST / HTTP/1.1\r\nHost: test\r\nContent-Length: 11\r\n\r\n");
  EXPECT_THAT(client.receive_all(), StartsWith("HTTP/1.1 413"));
}

TEST(HttpUpload, NeedsALength) {
  FunctionHandler handler;
  const auto server = start_server(handler);
  RawClient client(server->address());
  client.send("POST / HTTP/1.1\r\nHost: test\r\nTransfer-Encoding: chunked\r\n\r\n1\r\na\r\n0\r\n\r\n");
  EXPECT_THAT(client.receive_all(), StartsWith("HTTP/1.1 411"));
}

class CountingSink final : public BodySink {
 public:
  CountingSink(std::size_t most, std::atomic<int>& alive) : most_(most), alive_(alive) { ++alive_; }
  ~CountingSink() override { --alive_; }
  core::Status write(std::string_view bytes) override {
    bytes_ += bytes.size();
    if (bytes_ > most_) return core::fail(core::ErrorCode::kResourceExhausted, "full");
    return {};
  }
  Response finish(const core::Status& status) override {
    return status ? Response{.body = std::to_string(bytes_) + " bytes"}
                  : Response{.status = 507, .body = status.error().message};
  }

 private:
  const std::size_t most_;
  std::atomic<int>& alive_;
  std::size_t bytes_ = 0;
};

struct SinkHandler {
  explicit SinkHandler(std::size_t most) {
    handler.on_receive = [this, most](const Request&) {
      Reception reception;
      reception.sink = std::make_unique<CountingSink>(most, alive);
      return reception;
    };
  }
  std::atomic<int> alive{0};
  FunctionHandler handler;
};

TEST(HttpUpload, GoesIntoASink) {
  SinkHandler sink(1 << 30);
  const auto server = start_server(sink.handler);
  EXPECT_THAT(post(server->address(), std::string(3 << 20, 'x')), HasSubstr("\r\n\r\n3145728 bytes"));
  EXPECT_THAT(post(server->address(), ""), HasSubstr("\r\n\r\n0 bytes"));
}

TEST(HttpUpload, LearnsWhyTheSinkFailed) {
  SinkHandler sink(1000);
  const auto server = start_server(sink.handler);
  const std::string response = post(server->address(), std::string(1 << 20, 'x'));
  EXPECT_THAT(response, StartsWith("HTTP/1.1 507"));
  EXPECT_TRUE(response.ends_with("full"));
}

TEST(HttpUpload, ThatStopsHalfwayEnds) {
  SinkHandler sink(1 << 30);
  const auto server =
      start_server(sink.handler, {.address = {}, .receive_timeout = std::chrono::milliseconds(300)});
  RawClient client(server->address());
  client.send("POST / HTTP/1.1\r\nHost: test\r\nContent-Length: 100\r\n\r\nhalf");
  EXPECT_EQ(client.receive_all(), "");
  EXPECT_TRUE(client.is_ended());
  for (int i = 0; i < 1000 && sink.alive > 0; ++i) get(server->address(), "/");
  EXPECT_EQ(sink.alive, 0);
}

}  // namespace
}  // namespace tessera::http
