// SPDX-License-Identifier: Apache-2.0
#include "core/common/passed_sockets.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "core/base/open_file.hpp"

namespace tessera::common {
namespace {

using testing::HasSubstr;

class PassedSockets : public testing::Test {
 protected:
  // At two descriptors that follow each other.
  static constexpr int kFirst = 200;

  ~PassedSockets() override {
    for (const char* name : {"LISTEN_PID", "LISTEN_FDS", "LISTEN_FDNAMES"}) ::unsetenv(name);
    for (int i = 0; i < 2; ++i) ::close(kFirst + i);
  }
  static void put(int index, int family, bool listens) {
    const core::OpenFile socket(::socket(family, SOCK_STREAM, 0));
    sockaddr_storage address{};
    address.ss_family = static_cast<sa_family_t>(family);
    if (family == AF_INET) reinterpret_cast<sockaddr_in&>(address).sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (family == AF_INET6) reinterpret_cast<sockaddr_in6&>(address).sin6_addr = in6addr_loopback;
    const socklen_t size = family == AF_INET ? sizeof(sockaddr_in) : sizeof(sockaddr_in6);
    ASSERT_EQ(::bind(socket.get(), reinterpret_cast<sockaddr*>(&address), size), 0);
    if (listens) ASSERT_EQ(::listen(socket.get(), 1), 0);
    ASSERT_EQ(::dup2(socket.get(), kFirst + index), kFirst + index);
  }
  static void pass(int process, const char* count, const char* names) {
    ::setenv("LISTEN_PID", std::to_string(process).c_str(), 1);
    ::setenv("LISTEN_FDS", count, 1);
    ::setenv("LISTEN_FDNAMES", names, 1);
  }
};

TEST_F(PassedSockets, AreTakenOnceByTheirNames) {
  put(0, AF_INET, true);
  put(1, AF_INET, true);
  pass(::getpid(), "2", "grpc:http");
  const auto sockets = take_passed_sockets(kFirst);
  ASSERT_TRUE(sockets) << sockets.error().message;
  ASSERT_EQ(sockets->size(), 2u);
  EXPECT_EQ(sockets->at(0).name, "grpc");
  EXPECT_EQ(sockets->at(1).name, "http");
  EXPECT_EQ(sockets->at(1).descriptor, kFirst + 1);
  EXPECT_THAT(sockets->at(0).address, testing::StartsWith("127.0.0.1:"));
  EXPECT_NE(sockets->at(0).address, "127.0.0.1:0");
  EXPECT_NE(::fcntl(kFirst, F_GETFD) & FD_CLOEXEC, 0);
  EXPECT_NE(::fcntl(kFirst, F_GETFL) & O_NONBLOCK, 0);
  EXPECT_EQ(std::getenv("LISTEN_FDS"), nullptr) << "child processes must not take them";
  EXPECT_TRUE(take_passed_sockets(kFirst)->empty());
}

TEST_F(PassedSockets, OfAnotherProcessAreLeft) {
  put(0, AF_INET, true);
  pass(::getpid() + 1, "1", "grpc");
  EXPECT_TRUE(take_passed_sockets(kFirst)->empty());
  pass(::getpid(), "x", "grpc");
  EXPECT_TRUE(take_passed_sockets(kFirst)->empty());
}

TEST_F(PassedSockets, ThatDoNotListenAreRefused) {
  put(0, AF_INET, false);
  pass(::getpid(), "1", "grpc");
  const auto refused = take_passed_sockets(kFirst);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message,
              HasSubstr("descriptor 200 ('grpc'), which is no listening TCP socket"));
  ::close(kFirst);
  pass(::getpid(), "1", "grpc");
  EXPECT_FALSE(take_passed_sockets(kFirst)) << "not even open";
}

}  // namespace
}  // namespace tessera::common
