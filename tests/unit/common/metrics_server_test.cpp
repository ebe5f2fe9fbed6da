// SPDX-License-Identifier: Apache-2.0
#include "core/common/metrics_server.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>

#include <atomic>
#include <string>

namespace tessera::common {
namespace {

using testing::HasSubstr;

MetricFamilies one_metric() {
  MetricWriter writer;
  writer.begin_counter("tessera_tests_total", "Tests by \"name\"");
  writer.add(2, {{"name", "a\\b\nc\"d"}});
  return writer.take();
}

int port_of(const MetricsServer& server) {
  return std::stoi(server.address().substr(server.address().rfind(':') + 1));
}

// Connects to this port of the address, without blocking for long; -1 if nobody listens there.
int connect_to(const char* host, int port) {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  inet_pton(AF_INET, host, &address.sin_addr);
  sockaddr untyped{};
  static_assert(sizeof untyped == sizeof address);
  std::memcpy(&untyped, &address, sizeof address);
  if (::connect(socket, &untyped, sizeof untyped) == 0) return socket;
  ::close(socket);
  return -1;
}

std::string get(int port, const std::string& path) {
  const int socket = connect_to("127.0.0.1", port);
  EXPECT_GE(socket, 0);
  const std::string request = "GET " + path + " HTTP/1.0\r\n\r\n";
  EXPECT_EQ(::send(socket, request.data(), request.size(), MSG_NOSIGNAL),
            static_cast<ssize_t>(request.size()));
  std::string response, buffer(4096, '\0');
  for (ssize_t count; (count = ::recv(socket, buffer.data(), buffer.size(), 0)) > 0;)
    response.append(buffer, 0, static_cast<std::size_t>(count));
  ::close(socket);
  return response;
}

TEST(MetricsServer, AnswersWithTheTextOfPrometheus) {
  const auto server = MetricsServer::start("127.0.0.1:0", one_metric);
  ASSERT_TRUE(server) << server.error().message;
  const std::string response = get(port_of(**server), "/metrics");
  EXPECT_THAT(response, HasSubstr("# HELP tessera_tests_total Tests by \"name\"\n"
                                  "# TYPE tessera_tests_total counter\n"
                                  "tessera_tests_total{name=\"a\\\\b\\nc\\\"d\"} 2\n"));
  EXPECT_THAT(get(port_of(**server), "/other"), HasSubstr("404"));
}

TEST(MetricsServer, SaysHowTheProgramIs) {
  std::atomic<bool> is_alive{true}, is_ready{false};
  const auto check = [](const std::atomic<bool>& holds) {
    return holds ? core::Status() : core::fail(core::ErrorCode::kUnavailable, "no coordinator");
  };
  const auto server = MetricsServer::start(
      "127.0.0.1:0", one_metric,
      {.alive = [&] { return check(is_alive); }, .ready = [&] { return check(is_ready); }});
  ASSERT_TRUE(server) << server.error().message;
  const int port = port_of(**server);
  EXPECT_THAT(get(port, "/healthz"), testing::ContainsRegex("^HTTP/1.[01] 200 "));
  EXPECT_THAT(get(port, "/readyz"),
              AllOf(testing::ContainsRegex("^HTTP/1.[01] 503 "), HasSubstr("\r\n\r\nno coordinator\n")));
  is_alive = false;
  is_ready = true;
  EXPECT_THAT(get(port, "/healthz"), testing::ContainsRegex("^HTTP/1.[01] 503 "));
  EXPECT_THAT(get(port, "/readyz"), testing::ContainsRegex("^HTTP/1.[01] 200 "));
}

TEST(MetricsServer, HasNoHealthOfAProgramThatDoesNotTellIt) {
  const auto server = MetricsServer::start("127.0.0.1:0", one_metric);
  ASSERT_TRUE(server) << server.error().message;
  for (const char* const path : {"/healthz", "/readyz"})
    EXPECT_THAT(get(port_of(**server), path), testing::ContainsRegex("^HTTP/1.[01] 404 ")) << path;
}

// The test is on one machine: 127.0.0.2 stands for another interface.
TEST(MetricsServer, IsBoundToTheAddressThatIsNamedAndNoOther) {
  const auto server = MetricsServer::start("localhost:0", one_metric);
  ASSERT_TRUE(server) << server.error().message;
  EXPECT_THAT((*server)->address(), testing::StartsWith("localhost:"));
  EXPECT_EQ(connect_to("127.0.0.2", port_of(**server)), -1);
}

TEST(MetricsServer, SaysIfThePortIsTaken) {
  const auto first = MetricsServer::start("127.0.0.1:0", one_metric);
  ASSERT_TRUE(first);
  const auto second = MetricsServer::start((*first)->address(), one_metric);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, core::ErrorCode::kUnavailable);
  EXPECT_THAT(second.error().message, HasSubstr((*first)->address()));
}

// The library beneath takes several of these, and then listens on all interfaces, or on other ports.
TEST(MetricsServer, TakesNoAddressButAHostAndAPort) {
  for (const char* const address :
       {"", "9464", ":9464", "+9464", "127.0.0.1", "127.0.0.1:", "127.0.0.1:0,8080", "127.0.0.1:65536",
        "127.0.0.1:80s", "no.such.host:80", "127.1:80", "*:80", "127.0.0.1:-1", "::1:80"}) {
    const auto server = MetricsServer::start(address, one_metric);
    ASSERT_FALSE(server) << address;
    EXPECT_EQ(server.error().code, core::ErrorCode::kInvalidArgument) << address;
  }
}

TEST(MetricWriter, WritesFamiliesInTheirOrder) {
  MetricWriter writer;
  writer.gauge("first", "One", 1);
  writer.begin_histogram("second", "Two");
  writer.add({.sample_count = 3, .sample_sum = 4, .bucket = {{3, 1.0}}});
  const MetricFamilies families = writer.take();
  ASSERT_EQ(families.size(), 2u);
  EXPECT_EQ(families[0].metric[0].gauge.value, 1);
  EXPECT_EQ(families[1].metric[0].histogram.sample_count, 3u);
}

}  // namespace
}  // namespace tessera::common
