// SPDX-License-Identifier: Apache-2.0
// The invariants are checked some jobs, leases and workers at a time.
#include "tests/unit/scheduler/farm.hpp"

namespace tessera::scheduler {
namespace {

class Checks : public FarmOfSmallLeases {
 protected:
  void SetUp() override {
    for (const char* job : {"a", "b", "c"}) submit(job, tiles(100, 16));
    for (const char* worker : {"u", "v", "w", "x"}) sync(worker, {}, 2);
  }
  std::optional<std::string> check(std::size_t most) { return scheduler_->check_some(cursor_, most); }

  static constexpr std::size_t kObjects = 3 + 8 + 4;  // jobs, leases and workers
  CheckCursor cursor_;
};

TEST_F(Checks, LookAtEachOnceInARound) {
  for (std::size_t i = 0; i < kObjects; ++i) {
    EXPECT_EQ(cursor_.rounds, 0u) << i;
    EXPECT_EQ(check(1), std::nullopt);
  }
  EXPECT_EQ(cursor_.rounds, 1u);
}

TEST_F(Checks, EndWithTheRoundHoweverManyAreAskedFor) {
  EXPECT_EQ(check(1'000'000), std::nullopt);
  EXPECT_EQ(cursor_.rounds, 1u);
  EXPECT_EQ(check(kObjects - 1), std::nullopt);
  EXPECT_EQ(cursor_.rounds, 1u);
}

TEST_F(Checks, ContinueWhenEntriesAreRemoved) {
  for (std::size_t steps = 0; steps < kObjects; ++steps) {
    CheckCursor cursor;
    EXPECT_EQ(scheduler_->check_some(cursor, steps), std::nullopt);
    handle(DeleteJob{{"b"}});
    submit("b", tiles(100, 16));
    sync("v", {}, 0);
    while (cursor.rounds == 0 && !HasFailure()) EXPECT_EQ(scheduler_->check_some(cursor, 1), std::nullopt);
  }
}

TEST_F(Checks, AreAllDoneInAnEmptyFarm) {
  scheduler_ = std::make_unique<Scheduler>(options_);
  EXPECT_EQ(check(5), std::nullopt);
  EXPECT_EQ(cursor_.rounds, 1u);
}

}  // namespace
}  // namespace tessera::scheduler
