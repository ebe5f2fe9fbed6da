// SPDX-License-Identifier: Apache-2.0
// Kernels and containers that lack a part of the sandbox: their calls fail here.
#include <gtest/gtest.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <functional>
#include <string>

#include "core/sandbox/confinement.hpp"
#include "core/sandbox/privileges.hpp"
#include "tests/unit/sandbox/in_child.hpp"

namespace tessera::sandbox {
namespace {

constexpr int kAsExpected = 0, kOther = 1, kNotLost = 2;

// Confines a child that has lost a call, and expects these words, first where that is accepted, then where
// not.
void expect_missing(const std::function<bool()>& lose, const std::string& words) {
  EXPECT_EQ(status_of([&] {
              if (!lose()) return kNotLost;
              const auto missing = confine({});
              return missing && missing->size() == 1 && missing->front().find(words) != std::string::npos
                         ? kAsExpected
                         : kOther;
            }),
            kAsExpected)
      << words;
  EXPECT_EQ(status_of([&] {
              if (!lose()) return kNotLost;
              const auto missing = confine({.complete = true});
              return !missing && missing.error().code == core::ErrorCode::kFailedPrecondition &&
                             missing.error().message.find(words) != std::string::npos
                         ? kAsExpected
                         : kOther;
            }),
            kAsExpected)
      << words;
}

class MissingParts : public testing::Test {
 protected:
  void SetUp() override {
    if (kIsSanitized) GTEST_SKIP() << "builds with sanitizers have no filter";
  }
};

TEST_F(MissingParts, IsNothingHere) {
  EXPECT_EQ(status_of([] {
              const auto missing = confine({});
              return missing && missing->empty() ? kAsExpected : kOther;
            }),
            kAsExpected)
      << "this test needs a kernel with Landlock and seccomp";
  EXPECT_EQ(status_of([] { return confine({.complete = true}) ? kAsExpected : kOther; }), kAsExpected);
}

TEST_F(MissingParts, LandlockIsNamed) {
  for (const int error : {ENOSYS, EOPNOTSUPP, EPERM})
    expect_missing([error] { return lose_call(SYS_landlock_create_ruleset, error); }, "no Landlock: ");
  expect_missing([] { return lose_call(SYS_landlock_restrict_self, EPERM); }, "no Landlock: ");
}

TEST_F(MissingParts, TheFilterIsNamed) {
  for (const int error : {EINVAL, ENOSYS, EPERM})
    expect_missing([error] { return lose_call(SYS_prctl, error, PR_SET_SECCOMP); },
                   "no system call filter: ");
}

TEST_F(MissingParts, TheUserIsNamed) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become somebody else";
  for (const long call : {SYS_setgroups, SYS_setresgid, SYS_setresuid})
    expect_missing([call] { return lose_call(call, EPERM); }, "no user of its own: ");
}

// Of a parent that cannot kill it.
TEST_F(MissingParts, ACapabilityIsNamed) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become somebody else";
  const auto lose_capabilities = [] { return drop_capabilities().has_value(); };
  expect_missing(lose_capabilities,
                 "no user of its own: it stays root, without capabilities (there is no CAP_KILL)");
}

// A failure that is no lack of support must not pass for one.
TEST_F(MissingParts, OtherErrorsAreErrors) {
  EXPECT_EQ(status_of([] {
              if (!lose_call(SYS_landlock_create_ruleset, EMFILE)) return kNotLost;
              const auto missing = confine({});
              return !missing && missing.error().code == core::ErrorCode::kInternal ? kAsExpected : kOther;
            }),
            kAsExpected);
}

TEST(Sanitized, SaysSo) {
  if (!kIsSanitized) GTEST_SKIP() << "this build has no sanitizers";
  EXPECT_EQ(status_of([] {
              const auto missing = confine({});
              return missing && missing->back().find("sanitizers") != std::string::npos ? kAsExpected
                                                                                        : kOther;
            }),
            kAsExpected);
}

}  // namespace
}  // namespace tessera::sandbox
