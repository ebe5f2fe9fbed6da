// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/unit/http/raw_client.hpp"

namespace tessera::http {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr const char* kKeptRequest = "GET /a HTTP/1.1\r\nHost: test\r\n\r\n";

TEST(HttpServer, PassesRequestsOn) {
  FunctionHandler handler;
  handler.on_handle = [](const Request& request) {
    return Response{.status = 203,
                    .headers = {{"X-Answer", "42"}},
                    .body = request.method + " " + request.path + " " + request.parameter("q").value_or("-") +
                            " " + request.header("x-name") + " " + request.cookie("c")};
  };
  const auto server = start_server(handler);
  const std::string response =
      get(server->address(), "/a%20b?q=1", "X-NAME: value\r\nCookie: b=1\r\nCookie: c=2\r\n");
  EXPECT_THAT(response, StartsWith("HTTP/1.1 203"));
  EXPECT_THAT(response, HasSubstr("\r\nX-Answer: 42\r\n"));
  EXPECT_THAT(response, HasSubstr("\r\n\r\nGET /a b 1 value 2"));
}

TEST(HttpServer, KeepsConnectionsAlsoAfterARejection) {
  FunctionHandler handler;
  handler.on_receive = [](const Request&) {
    Reception reception;
    reception.reject = Response{.status = 401, .body = "no"};
    return reception;
  };
  const auto server = start_server(handler);
  RawClient client(server->address());
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(client.send(kKeptRequest));
    EXPECT_THAT(client.receive_until("\r\n\r\nno"), StartsWith("HTTP/1.1 401"));
  }
}

TEST(HttpServer, AnswersHeadWithoutBody) {
  FunctionHandler handler;
  const auto server = start_server(handler);
  RawClient client(server->address());
  client.send("HEAD /a HTTP/1.1\r\nHost: test\r\nConnection: close\r\n\r\n");
  const std::string response = client.receive_all();
  EXPECT_THAT(response, HasSubstr("Content-Length: 16"));
  EXPECT_TRUE(response.ends_with("\r\n\r\n"));
}

TEST(HttpServer, TurnsExceptionsIntoErrors) {
  FunctionHandler handler;
  handler.on_handle = [](const Request&) -> Response { throw std::runtime_error("secret"); };
  const auto server = start_server(handler);
  const std::string response = get(server->address(), "/");
  EXPECT_THAT(response, StartsWith("HTTP/1.1 500"));
  EXPECT_THAT(response, Not(HasSubstr("secret")));
}

TEST(HttpServer, RefusesConnectionsBeyondItsLimit) {
  FunctionHandler handler;
  const auto server = start_server(handler, {.address = {}, .max_connections = 4});
  std::vector<std::unique_ptr<RawClient>> kept;
  for (int i = 0; i < 4; ++i) {
    kept.push_back(std::make_unique<RawClient>(server->address()));
    kept.back()->send(kKeptRequest);
    EXPECT_THAT(kept.back()->receive_until("/a"), StartsWith("HTTP/1.1 200"));
  }
  RawClient one_more(server->address());
  one_more.send(kKeptRequest);
  EXPECT_EQ(one_more.receive_all(), "");
  EXPECT_TRUE(one_more.is_ended());
  kept.pop_back();
  // The server learns of the end a moment later.
  std::string response;
  for (int i = 0; i < 1000 && response.empty(); ++i) response = get(server->address(), "/a");
  EXPECT_THAT(response, StartsWith("HTTP/1.1 200"));
}

TEST(HttpServer, RefusesConnectionsBeyondTheLimitOfAMachine) {
  FunctionHandler handler;
  const auto server = start_server(handler, {.address = {}, .max_connections_per_machine = 1});
  RawClient first(server->address());
  first.send(kKeptRequest);
  EXPECT_THAT(first.receive_until("/a"), StartsWith("HTTP/1.1 200"));
  RawClient second(server->address());
  second.send(kKeptRequest);
  EXPECT_EQ(second.receive_all(), "");
}

// Also one that sends a byte now and then.
TEST(HttpServer, EndsConnectionsWithoutARequest) {
  FunctionHandler handler;
  const auto server = start_server(handler, {.address = {}, .receive_timeout = milliseconds(500)});
  RawClient silent(server->address()), dribbling(server->address());
  const auto start = std::chrono::steady_clock::now();
  bool is_open = true;
  for (const char byte : std::string("GET / HTTP/1.1\r\nX: ") + std::string(200, 'x')) {
    is_open = is_open && dribbling.send(std::string(1, byte));
    if (!is_open) break;
    RawClient(server->address()).receive_until("\r\n");  // ends by itself after half a second
  }
  EXPECT_FALSE(is_open);
  EXPECT_EQ(silent.receive_all(), "");
  EXPECT_TRUE(silent.is_ended());
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(15));
}

TEST(HttpServer, ListensOnIpv6) {
  FunctionHandler handler;
  const auto server = start_server(handler, {.address = "[::1]:0"});
  EXPECT_THAT(server->address(), StartsWith("[::1]:"));
  EXPECT_THAT(get(server->address(), "/a"), StartsWith("HTTP/1.1 200"));
}

TEST(HttpServer, SaysWhyItCannotListen) {
  FunctionHandler handler;
  const auto first = start_server(handler);
  const auto second = Server::start({.address = first->address()}, handler);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, core::ErrorCode::kUnavailable);
  EXPECT_THAT(second.error().message, HasSubstr(first->address() + ": Address already in use"));
  const auto wrong = Server::start({.address = "8080"}, handler);
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, core::ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace tessera::http
