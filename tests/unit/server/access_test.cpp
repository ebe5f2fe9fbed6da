// SPDX-License-Identifier: Apache-2.0
// The file of tokens and certificates.
#include "server/auth/access.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace tessera::auth {
namespace {

using grpc::StatusCode;
using testing::HasSubstr;
using namespace std::chrono_literals;

const std::string kAda = "ada-0123456789abcdef", kAdaToo = "ada-fedcba9876543210",
                  kBen = "ben-0123456789abcdef";

// 2027-01-31T00:00:00Z
const Access::Time kLastDay{std::chrono::seconds(1'801'353'600)};

class AccessTest : public testing::Test {
 protected:
  Access read(const std::string& text) {
    const auto path = folder_.path() / "tokens";
    write_file(path, text);
    auto access = Access::read(path);
    EXPECT_TRUE(access) << access.error().message;
    return access ? *std::move(access) : Access();
  }
  std::string complaint(const std::string& text) {
    const auto path = folder_.path() / "tokens";
    write_file(path, text);
    const auto access = Access::read(path);
    EXPECT_FALSE(access);
    return access ? "" : access.error().message;
  }
  static Credentials token(const std::string& text) { return {.token = text}; }
  static Credentials certificate(const std::string& name) { return {.certificate = name}; }

  TemporaryFolder folder_;
  Principal principal_;
};

TEST_F(AccessTest, OneNameMayHaveTokensOfSeveralRoles) {
  const Access access = read("submit ada " + kAda + "\nadmin ada " + kAdaToo + "\nsubmit ben " + kBen + "\n");
  EXPECT_TRUE(access.admit(token(kAda), Role::kSubmit, kLastDay, principal_).ok());
  EXPECT_EQ(principal_.name, "ada");
  EXPECT_EQ(access.admit(token(kAda), Role::kAdmin, kLastDay, principal_).error_code(),
            StatusCode::PERMISSION_DENIED);
  EXPECT_TRUE(access.admit(token(kAdaToo), Role::kAdmin, kLastDay, principal_).ok());
  EXPECT_EQ(principal_.name, "ada");
  EXPECT_EQ(principal_.role, Role::kAdmin);
  EXPECT_TRUE(access.admit(token(kBen), Role::kSubmit, kLastDay, principal_).ok());
}

TEST_F(AccessTest, ADateIncludesItsLastSecond) {
  const Access access = read("submit ada " + kAda + " expires=2027-01-31\n");
  EXPECT_TRUE(access.admit(token(kAda), Role::kSubmit, kLastDay + 24h - 1s, principal_).ok());
  const grpc::Status late = access.admit(token(kAda), Role::kSubmit, kLastDay + 24h, principal_);
  EXPECT_EQ(late.error_code(), StatusCode::UNAUTHENTICATED);
  EXPECT_THAT(late.error_message(), HasSubstr("the token of ada has expired at 2027-02-01T00:00:00Z"));
}

TEST_F(AccessTest, ATimeHasAZone) {
  const Access access = read("submit ada " + kAda + " expires=2027-01-31T12:00:00+02:00\n");
  EXPECT_TRUE(access.admit(token(kAda), Role::kSubmit, kLastDay + 10h - 1s, principal_).ok());
  EXPECT_FALSE(access.admit(token(kAda), Role::kSubmit, kLastDay + 10h, principal_).ok());
}

TEST_F(AccessTest, CredentialsAreIndividualUnlessTheyAreShared) {
  const Access access = read("work ada " + kAda + "\nwork farm " + kBen + " shared expires=2027-01-31\n");
  EXPECT_TRUE(access.admit(token(kAda), Role::kWork, kLastDay, principal_).ok());
  EXPECT_TRUE(principal_.individual);
  EXPECT_TRUE(access.admit(token(kBen), Role::kWork, kLastDay, principal_).ok());
  EXPECT_FALSE(principal_.individual);
}

TEST_F(AccessTest, ACertificateWithALineNeedsNoToken) {
  const Access access = read("work node1 certificate expires=2027-01-31\nsubmit ada " + kAda + "\n");
  EXPECT_TRUE(access.admit(certificate("node1"), Role::kWork, kLastDay, principal_).ok());
  EXPECT_EQ(principal_.name, "node1");
  EXPECT_EQ(access.admit(certificate("node1"), Role::kSubmit, kLastDay, principal_).error_code(),
            StatusCode::PERMISSION_DENIED);
  EXPECT_EQ(access.admit(certificate("node1"), Role::kWork, kLastDay + 24h, principal_).error_code(),
            StatusCode::UNAUTHENTICATED);
  for (const Credentials& stranger :
       {certificate("ada"), certificate(""), token("certificate"), token("node1")})
    EXPECT_EQ(access.admit(stranger, Role::kSubmit, kLastDay, principal_).error_code(),
              StatusCode::UNAUTHENTICATED);
}

TEST_F(AccessTest, OnAnOpenFarmACertificateNamesItsCaller) {
  EXPECT_TRUE(Access().admit(certificate("node1"), Role::kAdmin, kLastDay, principal_).ok());
  EXPECT_EQ(principal_.name, "node1");
  EXPECT_FALSE(principal_.individual);
  EXPECT_TRUE(Access().admit({}, Role::kAdmin, kLastDay, principal_).ok());
  EXPECT_EQ(principal_.name, "");
}

TEST_F(AccessTest, WrongLinesAreNamedWithoutTheirWords) {
  EXPECT_THAT(complaint("submit ada " + kAda + " expires=tomorrow\n"), HasSubstr("tokens:1: expires="));
  EXPECT_THAT(complaint("submit ada " + kAda + " expires=2027-02-30\n"), HasSubstr("tokens:1: expires="));
  EXPECT_THAT(complaint("\nsubmit ada " + kAda + " " + kBen + "\n"), HasSubstr("tokens:2: a line has three"));
  EXPECT_THAT(complaint("work a certificate\nsubmit a certificate\n"), HasSubstr("a line already"));
  EXPECT_THAT(complaint("submit ada " + kAda + " " + kBen + "\n"), testing::Not(HasSubstr(kBen)));
}

}  // namespace
}  // namespace tessera::auth
