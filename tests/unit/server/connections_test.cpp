// SPDX-License-Identifier: Apache-2.0
// Connection limits, listening addresses and timeouts of a coordinator on real sockets.
#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <future>
#include <sstream>

#include "proto/channel.hpp"
#include "proto/connection_slots.hpp"
#include "proto/listener.hpp"
#include "proto/listening_sockets.hpp"
#include "proto/peer_address.hpp"
#include "server/rpc/server.hpp"
#include "tessera/v1/render_service.grpc.pb.h"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::rpc {
namespace {

using namespace std::chrono_literals;
using base::Fd;
using proto::ConnectionSlots;
using proto::listen_on;
using proto::Listener;
using testing::HasSubstr;
using Room = ConnectionSlots::Room;

constexpr std::chrono::milliseconds kUnacknowledged = 5s;
constexpr auto kLongEnough = 60s;  // for steps that take milliseconds on an idle machine

int port_in(const std::string& address) {
  return std::stoi(address.substr(address.rfind(':') + 1));
}

// Opens an idle connection; invalid if nobody listens.
base::Fd connect_to(int port, int family = AF_INET) {
  sockaddr_in6 v6{};
  v6.sin6_family = AF_INET6;
  v6.sin6_port = htons(static_cast<std::uint16_t>(port));
  v6.sin6_addr = in6addr_loopback;
  sockaddr_in v4{};
  v4.sin_family = AF_INET;
  v4.sin_port = v6.sin6_port;
  v4.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const bool is_v6 = family == AF_INET6;
  base::Fd connection(::socket(family, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const auto* address = is_v6 ? reinterpret_cast<sockaddr*>(&v6) : reinterpret_cast<sockaddr*>(&v4);
  const bool connected = ::connect(connection.get(), address, is_v6 ? sizeof v6 : sizeof v4) == 0;
  return connected ? std::move(connection) : base::Fd();
}

// Waits for the byte that gRPC without TLS sends on each accepted connection. False if the peer has closed
// it.
bool is_taken(const base::Fd& connection) {
  char byte = 0;
  return ::recv(connection.get(), &byte, 1, MSG_PEEK) > 0;
}

// Whether the peer closes it within the timeout.
bool is_closed_at_last(const base::Fd& connection) {
  const timeval patience{std::chrono::seconds(kLongEnough).count(), 0};
  ::setsockopt(connection.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  char bytes[256];
  ssize_t received = 0;
  while ((received = ::recv(connection.get(), bytes, sizeof bytes, 0)) > 0) {
  }
  return received == 0 || errno == ECONNRESET;
}

base::Fd any_socket() {
  return base::Fd(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
}

// Closed connections may be noticed with a short delay.
bool has_room_at_last(ConnectionSlots& slots, const std::string& machine) {
  const auto end = ConnectionSlots::Clock::now() + kLongEnough;
  while (ConnectionSlots::Clock::now() < end)
    if (slots.room_for(machine) == Room::kYes) return true;
  return false;
}

sockaddr_storage address_of(int family, const char* text) {
  sockaddr_storage address{};
  address.ss_family = static_cast<sa_family_t>(family);
  void* bytes = family == AF_INET ? static_cast<void*>(&reinterpret_cast<sockaddr_in&>(address).sin_addr)
                                  : &reinterpret_cast<sockaddr_in6&>(address).sin6_addr;
  EXPECT_EQ(inet_pton(family, text, bytes), 1);
  return address;
}

TEST(ConnectionSlots, ComeBackWhenTheSocketIsClosed) {
  ConnectionSlots slots(2, 2);
  base::Fd first = any_socket();
  const base::Fd second = any_socket();
  slots.take(first.get(), "a");
  EXPECT_EQ(slots.room_for("a"), Room::kYes);
  slots.take(second.get(), "a");
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(slots.room_for("a"), Room::kNone);
  first = base::Fd();
  EXPECT_TRUE(has_room_at_last(slots, "a"));
}

TEST(ConnectionSlots, AreNotHeldByWhatHasTheDescriptorNext) {
  ConnectionSlots slots(1, 1);
  const base::Fd connection = any_socket(), next = any_socket(), last = any_socket();
  const base::Fd file(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  slots.take(connection.get(), "a");
  EXPECT_EQ(slots.room_for("b"), Room::kNone);
  ASSERT_EQ(::dup2(file.get(), connection.get()), connection.get());
  EXPECT_TRUE(has_room_at_last(slots, "b"));
  ASSERT_EQ(::dup2(next.get(), connection.get()), connection.get());
  slots.take(connection.get(), "b");
  EXPECT_EQ(slots.room_for("a"), Room::kNone);
  ASSERT_EQ(::dup2(last.get(), connection.get()), connection.get());
  EXPECT_TRUE(has_room_at_last(slots, "a"));
}

// The kernel assigns the lowest free descriptor.
TEST(ConnectionSlots, AreCountedOnceWhereADescriptorIsTakenAgain) {
  ConnectionSlots slots(2, 1);
  const base::Fd connection = any_socket(), next = any_socket(), other = any_socket();
  slots.take(connection.get(), "a");
  ASSERT_EQ(::dup2(next.get(), connection.get()), connection.get());
  slots.take(connection.get(), "b");
  EXPECT_EQ(slots.room_for("a"), Room::kYes);
  slots.take(other.get(), "a");
  EXPECT_EQ(slots.room_for("c"), Room::kNone);
}

TEST(ConnectionSlots, OfOneMachineLeaveRoomForOthers) {
  ConnectionSlots slots(3, 2);
  base::Fd held[] = {any_socket(), any_socket(), any_socket()};
  slots.take(held[0].get(), "a");
  slots.take(held[1].get(), "a");
  EXPECT_EQ(slots.room_for("a"), Room::kNoneForMachine);
  EXPECT_EQ(slots.room_for("b"), Room::kYes);
  slots.take(held[2].get(), "b");
  EXPECT_EQ(slots.room_for("b"), Room::kNone);
  held[1] = base::Fd();
  EXPECT_TRUE(has_room_at_last(slots, "a"));
}

TEST(ConnectionSlots, AMachineIsAnAddressOrItsNetwork) {
  EXPECT_EQ(proto::address_key(address_of(AF_INET, "10.0.0.5")), "10.0.0.5");
  EXPECT_EQ(proto::address_key(address_of(AF_INET6, "2001:db8:1:2:3:4:5:6")), "2001:db8:1:2::/64");
  EXPECT_EQ(proto::address_key(address_of(AF_INET6, "2001:db8:1:2::9")), "2001:db8:1:2::/64");
  EXPECT_EQ(proto::address_key("ipv4:10.0.0.5:4242"), "ipv4:10.0.0.5");
  EXPECT_EQ(proto::address_key("ipv6:[2001:db8:1:2::9]:4242"), "2001:db8:1:2::/64");
  EXPECT_EQ(proto::address_key("ipv6:%5B2001:db8:1:2:3:4:5:6%5D:17"), "2001:db8:1:2::/64");
  EXPECT_EQ(proto::address_key("ipv6:%5Bfe80::1%25eth0%5D:17"), "ipv6:%5Bfe80::1%25eth0%5D");
  EXPECT_EQ(proto::host_of("ipv4:10.0.0.5:4242"), "10.0.0.5");
  EXPECT_EQ(proto::host_of("ipv6:%5B2001:db8::5%5D:17"), "[2001:db8::5]");
  EXPECT_EQ(proto::host_of("ipv6:[::ffff:10.0.0.5]:17"), "10.0.0.5");
  for (const char* const nothing : {"ipv6:%5Bfe80::1%25eth0%5D:17", "unix:/tmp/socket", "", "ipv4:10.0.0.5"})
    EXPECT_EQ(proto::host_of(nothing), "") << nothing;
  EXPECT_TRUE(proto::is_loopback_host("127.0.0.1") && proto::is_loopback_host("[::1]"));
  EXPECT_FALSE(proto::is_loopback_host("10.0.0.5") || proto::is_loopback_host("[2001:db8::5]"));
}

TEST(ListeningSockets, HaveOnePortAtAllAddresses) {
  for (const char* host : {"localhost", "0.0.0.0", "[::]"}) {
    const auto listening = listen_on(std::string(host) + ":0", kUnacknowledged);
    ASSERT_TRUE(listening) << listening.error().message;
    EXPECT_NE(listening->port, 0);
    EXPECT_TRUE(connect_to(listening->port)) << host;
    const auto sixth = listen_on("[::1]:0", kUnacknowledged);  // if this machine has IPv6
    const bool is_wildcard = host != std::string("localhost");
    EXPECT_TRUE(!sixth || !is_wildcard || connect_to(listening->port, AF_INET6)) << host;
  }
}

TEST(ListeningSockets, APortIsForOneProcess) {
  const auto wildcard = listen_on("0.0.0.0:0", kUnacknowledged);
  ASSERT_TRUE(wildcard);
  for (const char* host : {"0.0.0.0", "127.0.0.1", "localhost"}) {
    const auto second = listen_on(fmt::format("{}:{}", host, wildcard->port), kUnacknowledged);
    ASSERT_FALSE(second) << host;
    EXPECT_EQ(second.error().code, core::ErrorCode::kUnavailable);
    EXPECT_THAT(second.error().message, HasSubstr("another program listens there"));
  }
}

TEST(ListeningSockets, AreAtHostAndPortOfThisMachine) {
  for (const char* address : {"", "127.0.0.1", "127.0.0.1:", ":7420", "127.0.0.1:x", "127.0.0.1:65536",
                              "127.0.0.1:-1", "::1:7420", "unix:/tmp/socket"}) {
    const auto listening = listen_on(address, kUnacknowledged);
    ASSERT_FALSE(listening) << address;
    EXPECT_EQ(listening.error().code, core::ErrorCode::kInvalidArgument);
    EXPECT_THAT(listening.error().message, HasSubstr("it is not HOST:PORT, such as")) << address;
  }
  const auto elsewhere = listen_on("192.0.2.1:7420", kUnacknowledged);  // an address of examples (RFC 5737)
  ASSERT_FALSE(elsewhere);
  EXPECT_THAT(elsewhere.error().message, HasSubstr("cannot listen on 192.0.2.1:7420: Cannot assign"));
}

TEST(Listener, HandsOnWhatConnectsUntilItStops) {
  auto listening = listen_on("127.0.0.1:0", kUnacknowledged);
  ASSERT_TRUE(listening);
  const auto listener = std::move(*Listener::make(std::move(*listening), ConnectionSlots(1, 1), {}));
  std::promise<int> taken;
  const base::Fd connection = connect_to(listener->port());  // blocks until it is accepted
  listener->start([&](int descriptor) { taken.set_value(descriptor); });
  const base::Fd accepted(taken.get_future().get());
  EXPECT_EQ(::send(accepted.get(), "x", 1, 0), 1);
  EXPECT_TRUE(is_taken(connection));
  listener->stop();
  EXPECT_FALSE(connect_to(listener->port())) << "nobody waits for one that will not be accepted";
  EXPECT_EQ(::send(accepted.get(), "x", 1, 0), 1);
  listener->stop();
}

// With mutual TLS or none.
class Connections : public testing::TestWithParam<bool> {
 protected:
  void start(const server::Limits& limits, const proto::Patience& patience = {}) {
    if (GetParam()) make_certificates();
    coordinator_ = std::move(*server::Coordinator::open(
        {}, std::move(*store::StateDirectory::open(folder_.path() / "state")), server::accept_scene));
    server_ = std::move(*Server::start(
        *coordinator_,
        {.address = "127.0.0.1:0", .security = serving_, .limits = limits, .patience = patience}));
  }
  void make_certificates() {
    const std::string keys = folder_.path() / "keys";
    ASSERT_EQ(
        std::system(fmt::format("{} {} 127.0.0.1 > /dev/null", TESSERA_MAKE_CERTIFICATES, keys).c_str()), 0);
    serving_ = {keys + "/coordinator.pem", keys + "/coordinator.key", keys + "/ca.pem", false};
    calling_ = {keys + "/ca.pem", keys + "/client.pem", keys + "/client.key", "", false};
  }
  int port() const { return port_in(server_->address()); }

  // A channel with its own connection, which it opens with its first call.
  std::shared_ptr<grpc::Channel> caller() {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
    arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 20);
    arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 20'000);
    arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 50);
    return grpc::CreateCustomChannel(server_->address(),
                                     *proto::channel_credentials(server_->address(), calling_), arguments);
  }
  // Makes one call, or waits until there is room.
  static grpc::StatusCode call(const std::shared_ptr<grpc::Channel>& channel, bool waits) {
    grpc::ClientContext context;
    context.set_wait_for_ready(waits);
    context.set_deadline(std::chrono::system_clock::now() + kLongEnough);
    v1::ListJobsResponse response;
    return v1::RenderService::NewStub(channel)->ListJobs(&context, {}, &response).error_code();
  }

  TemporaryFolder folder_;
  proto::ServerSecurity serving_;
  proto::ClientSecurity calling_;
  std::unique_ptr<server::Coordinator> coordinator_;
  std::unique_ptr<Server> server_;
};

INSTANTIATE_TEST_SUITE_P(, Connections, testing::Bool(),
                         [](const auto& tested) { return tested.param ? "OverTls" : "Plain"; });

TEST_P(Connections, BeyondTheLimitAreClosedAndGetInLater) {
  start({.connections = 3});
  std::vector<std::shared_ptr<grpc::Channel>> inside;
  for (int i = 0; i < 3; ++i) {
    inside.push_back(caller());
    EXPECT_EQ(call(inside.back(), false), grpc::StatusCode::OK);
  }
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(call(caller(), false), grpc::StatusCode::UNAVAILABLE);
    const auto waiting = caller();
    auto answer = std::async(std::launch::async, [&] { return call(waiting, true); });
    EXPECT_EQ(call(caller(), false), grpc::StatusCode::UNAVAILABLE);
    inside.erase(inside.begin());
    EXPECT_EQ(answer.get(), grpc::StatusCode::OK);
    inside.push_back(waiting);
  }
  for (const auto& channel : inside) EXPECT_EQ(call(channel, false), grpc::StatusCode::OK);
}

// Also for connections that close before they are accepted.
TEST_P(Connections, NoneLeavesItsSlotTaken) {
  start({.connections = 2});
  for (int i = 0; i < 300; ++i) connect_to(port());
  for (int i = 0; i < 10; ++i) {
    const auto first = caller(), second = caller();
    EXPECT_EQ(call(first, true), grpc::StatusCode::OK);
    EXPECT_EQ(call(second, true), grpc::StatusCode::OK);
  }
}

TEST_P(Connections, WithoutAWordAreClosed) {
  start({.connections = 1}, {.handshake = 2s, .ping_period = 1h, .answer = 1h});
  const base::Fd silent = connect_to(port());
  ASSERT_TRUE(silent);
  EXPECT_TRUE(is_closed_at_last(silent));
  const auto later = caller();
  EXPECT_EQ(call(later, true), grpc::StatusCode::OK);
}

class PlainConnections : public Connections {};
INSTANTIATE_TEST_SUITE_P(, PlainConnections, testing::Values(false), [](const auto&) { return "Plain"; });

// Like a machine without power, or a stopped process, between two calls.
TEST_P(PlainConnections, AreClosedWithoutPingResponses) {
  start({.connections = 1}, {.ping_period = 1s, .answer = 2s});
  const base::Fd stopped = connect_to(port());
  const std::string preface("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\4\0\0\0\0\0", 24 + 9);  // RFC 9113, 3.4
  ASSERT_EQ(::send(stopped.get(), preface.data(), preface.size(), 0), static_cast<ssize_t>(preface.size()));
  EXPECT_TRUE(is_closed_at_last(stopped));
  const auto later = caller();
  EXPECT_EQ(call(later, true), grpc::StatusCode::OK);
}

TEST_P(PlainConnections, OfOneMachineAreLimited) {
  start({.connections = 10, .machine_connections = 2});
  const auto first = caller(), second = caller();
  EXPECT_EQ(call(first, false), grpc::StatusCode::OK);
  EXPECT_EQ(call(second, false), grpc::StatusCode::OK);
  EXPECT_EQ(call(caller(), false), grpc::StatusCode::UNAVAILABLE);
}

TEST_P(PlainConnections, ThatAreTooManyFillNoLog) {
  std::ostringstream log;
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("log", std::make_shared<spdlog::sinks::ostream_sink_mt>(log)));
  start({.connections = 1});
  const base::Fd inside = connect_to(port());
  EXPECT_TRUE(is_taken(inside));
  for (int i = 0; i < 200; ++i) EXPECT_FALSE(is_taken(connect_to(port())));
  server_.reset();
  spdlog::set_default_logger(before);
  const std::string said = log.str();
  const std::string sentence =
      "closed a connection of 127.0.0.1: there are 1, and this farm takes no more (--max-connections)";
  EXPECT_THAT(said, HasSubstr(sentence));
  std::size_t times = 0;
  for (auto at = said.find(sentence); at != std::string::npos; at = said.find(sentence, at + 1)) ++times;
  EXPECT_LT(times, 10u) << said;  // one in ten seconds
}

TEST_P(PlainConnections, EndWithTheServerAndFreeThePort) {
  start({});
  const auto inside = caller();
  EXPECT_EQ(call(inside, false), grpc::StatusCode::OK);
  const int port = this->port();
  EXPECT_TRUE(server_->stop());
  EXPECT_EQ(call(inside, false), grpc::StatusCode::UNAVAILABLE);
  EXPECT_TRUE(listen_on(fmt::format("127.0.0.1:{}", port), kUnacknowledged)) << "the port is free again";
}

}  // namespace
}  // namespace tessera::rpc
