// SPDX-License-Identifier: Apache-2.0
#include "proto/status.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "core/base/printable.hpp"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "proto/blob.hpp"
#include "proto/error_reasons.hpp"

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
  EXPECT_EQ(code_of(grpc::StatusCode::UNIMPLEMENTED), ErrorCode::kFailedPrecondition);
  EXPECT_EQ(code_of(grpc::StatusCode::UNKNOWN), ErrorCode::kInternal);
}

TEST(Status, DetailsComeBackAsTheyWere) {
  const core::Error error =
      core::Error{ErrorCode::kFailedPrecondition, "upload them"}.with({.reason = kMissingBlobs,
                                                                       .field = "bundle",
                                                                       .option = "--max",
                                                                       .missing = {"a", "b"},
                                                                       .retry_delay_ms = 1500});
  const core::ErrorDetails back = core::details_of(error_from_grpc(to_grpc(error)));
  EXPECT_EQ(back.reason, kMissingBlobs);
  EXPECT_EQ(back.field, "bundle");
  EXPECT_EQ(back.option, "--max");
  EXPECT_EQ(back.missing, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(back.retry_delay_ms, 1500u);
}

google::rpc::Status wire_of(const core::Error& error) {
  google::rpc::Status status;
  EXPECT_TRUE(status.ParseFromString(to_grpc(error).error_details()));
  return status;
}

TEST(Status, EveryErrorHasAReasonAndTheMessageOfItsStatus) {
  for (int code = 0; code <= static_cast<int>(ErrorCode::kInternal); ++code) {
    const core::Error error{static_cast<ErrorCode>(code), "mend this"};
    const google::rpc::Status wire = wire_of(error);
    EXPECT_EQ(wire.code(), to_grpc(error).error_code());
    EXPECT_EQ(wire.message(), "mend this");
    ASSERT_EQ(wire.details_size(), 1);
    google::rpc::ErrorInfo info;
    ASSERT_TRUE(wire.details(0).UnpackTo(&info));
    EXPECT_EQ(info.domain(), "tessera");
    EXPECT_FALSE(info.reason().empty());
  }
}

TEST(Status, GivesReasonsToCodesThatCoreLacks) {
  const grpc::Status plain(grpc::StatusCode::UNAUTHENTICATED, "who are you?");
  const grpc::Status status = with_details(plain);
  EXPECT_EQ(status.error_code(), plain.error_code());
  EXPECT_EQ(status.error_message(), plain.error_message());
  EXPECT_EQ(core::details_of(error_from_grpc(status)).reason, "UNAUTHENTICATED");
  EXPECT_TRUE(with_details(grpc::Status::OK).ok());
  const grpc::Status with = to_grpc(core::Error{ErrorCode::kNotFound, "x"});
  EXPECT_EQ(with_details(with).error_details(), with.error_details());
}

TEST(Status, AQuotaNamesItsOption) {
  const google::rpc::Status wire = wire_of(
      core::Error{ErrorCode::kResourceExhausted, "full"}.with({.reason = kQuotaExceeded, .option = "--max"}));
  google::rpc::QuotaFailure quota;
  ASSERT_EQ(wire.details_size(), 2);
  ASSERT_TRUE(wire.details(1).UnpackTo(&quota));
  EXPECT_EQ(quota.violations(0).subject(), "--max");
}

// gRPC takes 8 KiB of metadata.
TEST(Status, IsSmallHoweverLongTheError) {
  core::ErrorDetails details{.reason = kMissingBlobs};
  details.missing.assign(10'000, blob_name(digest_of("x")));
  std::string message;
  for (int i = 0; i < 5000; ++i) message += "ä";
  const grpc::Status status =
      to_grpc(core::Error{ErrorCode::kFailedPrecondition, message}.with(std::move(details)));
  EXPECT_LE(3 * status.error_message().size() + status.error_details().size() * 4 / 3, 8u << 10);
  EXPECT_EQ(status.error_message(), core::printable_lines(status.error_message())) << "no half characters";
  EXPECT_EQ(core::details_of(error_from_grpc(status)).missing.size(), kMaxMissing);
  google::rpc::Status wire;
  google::rpc::ErrorInfo info;
  ASSERT_TRUE(wire.ParseFromString(status.error_details()) && wire.details(0).UnpackTo(&info));
  EXPECT_EQ(info.metadata().at("missing_count"), "10000");
}

TEST(Status, DamagedAndForeignDetailsAreIgnored) {
  EXPECT_FALSE(error_from_grpc({grpc::StatusCode::INTERNAL, "x", "no message"}).details);
  google::rpc::Status foreign;
  google::rpc::ErrorInfo info;
  info.set_domain("elsewhere");
  info.set_reason("OTHER");
  foreign.add_details()->PackFrom(info);
  foreign.add_details()->set_type_url("type.googleapis.com/unknown.Type");
  const auto error = error_from_grpc({grpc::StatusCode::INTERNAL, "x", foreign.SerializeAsString()});
  EXPECT_EQ(core::details_of(error).reason, "");
}

}  // namespace
}  // namespace tessera::proto
