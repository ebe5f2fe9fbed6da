// SPDX-License-Identifier: Apache-2.0
#include "proto/unreachable.hpp"

#include <gtest/gtest.h>

#include <string>

namespace tessera::proto {
namespace {

grpc::Status not_connected(const std::string& reason) {
  return {grpc::StatusCode::UNAVAILABLE,
          "failed to connect to all addresses; last error: UNKNOWN: ipv4:10.0.0.1:7420: "
          "Failed to connect to remote host: " +
              reason};
}

TEST(Unreachable, ACoordinatorThatDoesNotAnswerMayBeStarting) {
  EXPECT_TRUE(may_be_starting(not_connected("Connection refused")));
  for (const char* after_its_timeout : {"FD Shutdown", "tcp handshaker shutdown"})
    EXPECT_TRUE(may_be_starting(not_connected(after_its_timeout)));
  EXPECT_TRUE(may_be_starting(not_connected("Socket closed")));
  EXPECT_FALSE(may_be_starting(not_connected("Permission denied")));
  EXPECT_FALSE(may_be_starting({grpc::StatusCode::UNAVAILABLE, "FD Shutdown"})) << "of a call that was sent";
}

}  // namespace
}  // namespace tessera::proto
