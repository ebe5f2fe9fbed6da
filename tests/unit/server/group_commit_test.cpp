// SPDX-License-Identifier: Apache-2.0
#include "server/store/group_commit.hpp"

#include <gtest/gtest.h>

#include <latch>
#include <new>
#include <thread>
#include <vector>

namespace tessera::store {
namespace {

using core::ErrorCode;

void apply_each(std::span<PendingChange* const> group) {
  for (PendingChange* each : group) each->status = each->change();
}

// While the first change is being written, the others come.
TEST(GroupCommit, ChangesThatComeMeanwhileShareTheNextGroup) {
  GroupCommit commits(apply_each);
  constexpr int kChanges = 100;
  std::latch begun(1), others_wait(1);
  std::thread first([&] {
    EXPECT_TRUE(commits.run([&]() -> core::Status {
      begun.count_down();
      others_wait.wait();
      return {};
    }));
  });
  begun.wait();
  std::vector<std::thread> others;
  int written = 0;  // by one group at a time
  for (int i = 0; i < kChanges; ++i)
    others.emplace_back([&] {
      EXPECT_TRUE(commits.run([&]() -> core::Status {
        ++written;
        return {};
      }));
    });
  while (commits.waiting() < kChanges) std::this_thread::yield();
  others_wait.count_down();
  first.join();
  for (std::thread& each : others) each.join();
  EXPECT_EQ(written, kChanges);
  EXPECT_EQ(commits.groups(), 2u);
}

TEST(GroupCommit, EachCallerGetsTheOutcomeOfItsOwnChange) {
  GroupCommit commits(apply_each);
  EXPECT_EQ(commits.run([] { return core::Status(core::fail(ErrorCode::kNotFound, "none")); }).error().code,
            ErrorCode::kNotFound);
  EXPECT_TRUE(commits.run([] { return core::Status(); }));
  EXPECT_EQ(commits.run([]() -> core::Status { throw std::bad_alloc(); }).error().code,
            ErrorCode::kResourceExhausted);
  EXPECT_TRUE(commits.run_alone([] { return core::Status(); }));
  EXPECT_TRUE(commits.run([] { return core::Status(); }));
}

}  // namespace
}  // namespace tessera::store
