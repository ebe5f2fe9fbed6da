// SPDX-License-Identifier: Apache-2.0
#include "proto/status.hpp"

#include <gtest/gtest.h>

namespace tessera::proto {
namespace {

using core::ErrorCode;

TEST(Status, EveryErrorComesBackAsItWas) {
  for (int code = 0; code <= static_cast<int>(ErrorCode::kInternal); ++code) {
    const core::Error error{static_cast<ErrorCode>(code), "mend this"};
    const core::Error back = error_from_grpc(to_grpc(error));
    EXPECT_EQ(back.code, error.code);
    EXPECT_EQ(back.message, error.message);
  }
}

TEST(Status, OkIsOk) {
  EXPECT_TRUE(to_grpc(core::Status{}).ok());
  EXPECT_TRUE(from_grpc(grpc::Status::OK).has_value());
}

TEST(Status, CodesThatCoreLacksBecomeTheNearest) {
  const auto code_of = [](grpc::StatusCode code) { return error_from_grpc({code, "x"}).code; };
  EXPECT_EQ(code_of(grpc::StatusCode::UNAUTHENTICATED), ErrorCode::kPermissionDenied);
  EXPECT_EQ(code_of(grpc::StatusCode::ABORTED), ErrorCode::kUnavailable);
  EXPECT_EQ(code_of(grpc::StatusCode::OUT_OF_RANGE), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of(grpc::StatusCode::UNIMPLEMENTED), ErrorCode::kFailedPrecondition);
  EXPECT_EQ(code_of(grpc::StatusCode::UNKNOWN), ErrorCode::kInternal);
}

}  // namespace
}  // namespace tessera::proto
