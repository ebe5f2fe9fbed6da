// SPDX-License-Identifier: Apache-2.0
// Requests that no browser sends.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <deque>
#include <string>
#include <vector>

#include "tests/unit/http/raw_client.hpp"

namespace tessera::http {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

struct MalformedRequest {
  const char* name;
  std::string bytes;
};

std::vector<MalformedRequest> malformed_requests() {
  const std::string host = "Host: test\r\n";
  return {
      {"no host", "GET / HTTP/1.1\r\n\r\n"},
      {"a bad escape", "GET /%zz HTTP/1.1\r\n" + host + "\r\n"},
      {"a null byte", "GET /%00 HTTP/1.1\r\n" + host + "\r\n"},
      {"no slash", "GET jobs HTTP/1.1\r\n" + host + "\r\n"},
      {"two lengths", "POST / HTTP/1.1\r\n" + host + "Content-Length: 3\r\nContent-Length: 4\r\n\r\nabcd"},
      {"a negative length", "POST / HTTP/1.1\r\n" + host + "Content-Length: -1\r\n\r\n"},
      {"a length of words", "POST / HTTP/1.1\r\n" + host + "Content-Length: many\r\n\r\n"},
      {"a huge length", "POST / HTTP/1.1\r\n" + host + "Content-Length: 99999999999999999999999\r\n\r\n"},
      {"a length and chunks",
       "POST / HTTP/1.1\r\n" + host + "Content-Length: 3\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n"},
      {"chunks", "POST / HTTP/1.1\r\n" + host + "Transfer-Encoding: chunked\r\n\r\nzz\r\n"},
      {"a huge header", "GET / HTTP/1.1\r\n" + host + "X: " + std::string(200 << 10, 'x') + "\r\n\r\n"},
      {"a huge target", "GET /" + std::string(200 << 10, 'x') + " HTTP/1.1\r\n" + host + "\r\n"},
      {"TLS", std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n", 15)},
      {"noise", std::string("\xff\xfe\x00\x80\r\n\r\n", 8)},
  };
}

// Either an error or the end of the connection; the handler sees none of them, and the next client is served.
TEST(MalformedRequests, ReachNoHandler) {
  FunctionHandler handler;
  std::atomic<int> calls{0};
  handler.on_receive = [&](const Request&) {
    ++calls;
    return Reception{};
  };
  const auto server = start_server(handler, {.address = {}, .receive_timeout = std::chrono::seconds(2)});
  for (const MalformedRequest& request : malformed_requests()) {
    RawClient client(server->address());
    client.send(request.bytes);
    const std::string response = client.receive_until("\r\n\r\n");
    EXPECT_TRUE(response.empty() || response.starts_with("HTTP/1.1 4") || response.starts_with("HTTP/1.0 4"))
        << request.name << ": " << response;
  }
  EXPECT_EQ(calls, 0);
  EXPECT_THAT(get(server->address(), "/jobs"), HasSubstr("You asked for /jobs"));
  EXPECT_EQ(calls, 1);
}

// MHD's threads read and reject them while the server ends.
TEST(MalformedRequests, DoNotDisturbTheEnd) {
  FunctionHandler handler;
  for (int round = 0; round < 20; ++round) {
    std::deque<RawClient> clients;
    const auto server = start_server(handler);
    for (int i = 0; i < 20; ++i)
      clients.emplace_back(server->address()).send("GET / HTTP/1.1\r\nX\xff\r\n\r\n");
  }
}

// Every prefix of a request, and the request with each byte replaced.
TEST(MalformedRequests, DoNotDisturbTheServer) {
  FunctionHandler handler;
  const auto server = start_server(handler);
  const std::string valid =
      "POST /a?b=c HTTP/1.1\r\nHost: test\r\nContent-Length: 2\r\nConnection: close\r\n\r\nok";
  for (std::size_t i = 0; i < valid.size(); ++i) {
    RawClient half(server->address());
    half.send(valid.substr(0, i));
    for (const char byte : {'\0', '\n', ' ', '\xff'}) {
      std::string changed = valid;
      changed[i] = byte;
      RawClient(server->address()).send(changed);
    }
  }
  EXPECT_THAT(get(server->address(), "/jobs"), StartsWith("HTTP/1.1 200"));
}

}  // namespace
}  // namespace tessera::http
