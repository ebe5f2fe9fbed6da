// SPDX-License-Identifier: Apache-2.0
// Texts of others: checked where they are chosen, and escaped where they are shown.
#include "proto/text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "proto/status.hpp"

namespace tessera::proto {
namespace {

TEST(CheckText, TakesNamesOfAnyLanguage) {
  EXPECT_TRUE(check_text("name", ""));
  EXPECT_TRUE(check_text("name", "Käse-rechner 7 (€)"));
  EXPECT_TRUE(check_text("name", std::string(kMaxNameBytes, 'x')));
}

TEST(CheckText, SaysWhatIsWrong) {
  const auto steering = check_text("--name", "a\x1b[2Jb");
  ASSERT_FALSE(steering);
  EXPECT_EQ(steering.error().code, core::ErrorCode::kInvalidArgument);
  EXPECT_EQ(steering.error().message,
            "--name: must be UTF-8 without line breaks and other control characters, got 'a\\x1b[2Jb'");
  EXPECT_FALSE(check_text("name", "one\ntwo"));
  EXPECT_FALSE(check_text("name", "\xff"));
  EXPECT_EQ(check_text("name", std::string(201, 'x')).error().message,
            "name: must have at most 200 bytes, got 201");
}

TEST(Sentences, LeaveInPrintableLines) {
  const grpc::Status status = to_grpc(core::Error{core::ErrorCode::kInternal, "a\x1b[2J\n  b"});
  EXPECT_EQ(status.error_message(), "a\\x1b[2J\n  b");
}

}  // namespace
}  // namespace tessera::proto
