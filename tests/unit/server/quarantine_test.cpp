// SPDX-License-Identifier: Apache-2.0
// The quarantine by itself.
#include "server/farm/quarantine.hpp"

#include <gtest/gtest.h>

#include <string>

#include "server/fleet/stored_worker.hpp"

namespace tessera::farm {
namespace {

using scheduler::Producer;

QuarantineEntry entry_of(const Producer& producer, std::int64_t since_ms = 0) {
  return {producer, producer.principal, "it lied", since_ms};
}

TEST(QuarantineTest, CountsConsecutiveRejections) {
  Quarantine quarantine;
  for (int i = 1; i < Quarantine::kRejectionsUntilQuarantine; ++i) EXPECT_FALSE(quarantine.refused("liar"));
  EXPECT_TRUE(quarantine.refused("liar"));
  quarantine.in_order("liar");
  EXPECT_FALSE(quarantine.refused("liar"));
  EXPECT_EQ(quarantine.refusals("liar"), 4u);
  quarantine.refused("here");
  quarantine.forget("liar");
  EXPECT_EQ(quarantine.refusals("liar"), 0u);
  EXPECT_EQ(quarantine.refusals("here"), 1u);
}

TEST(QuarantineTest, CoversTheWorkerAndLaterOnesOfItsMachine) {
  Quarantine quarantine;
  EXPECT_TRUE(quarantine.add(entry_of({"host", {"a"}, "machine"})));
  EXPECT_FALSE(quarantine.add(entry_of({"host", {"a"}, "machine"})));
  EXPECT_NE(quarantine.find({"host", {"a"}, "other"}, true), nullptr);
  EXPECT_NE(quarantine.find({"another", {"b"}, "machine"}, false), nullptr);
  EXPECT_EQ(quarantine.find({"another", {"b"}, "machine"}, true), nullptr);
  EXPECT_EQ(quarantine.find({"host", {"c"}, "other"}, false), nullptr) << "a name proves nothing";
  EXPECT_EQ(quarantine.find({"host", {"c"}}, false), nullptr);
}

TEST(QuarantineTest, CoversAllWorkersOfAnIndividualPrincipal) {
  Quarantine quarantine;
  quarantine.add(entry_of({"host", {"a"}, "machine", "ada"}));
  EXPECT_NE(quarantine.find({"other", {"b"}, "other", "ada"}, true), nullptr);
  EXPECT_EQ(quarantine.find({"other", {"b"}, "other", "ben"}, false), nullptr);
}

TEST(QuarantineTest, IsLiftedForAllOfAMachineAndAPrincipal) {
  Quarantine quarantine;
  quarantine.add(entry_of({"host", {"a"}, "machine"}));
  quarantine.add(entry_of({"host", {"b"}, "machine"}));
  quarantine.add(entry_of({"host", {"c"}, "other", "ada"}));
  EXPECT_TRUE(quarantine.lift("d").empty());
  EXPECT_EQ(quarantine.lift("a").size(), 2u);
  EXPECT_EQ(quarantine.find({"host", {"b"}, "machine"}, true), nullptr);
  EXPECT_EQ(quarantine.find({"host", {"e"}, "machine"}, false), nullptr);
  EXPECT_EQ(quarantine.size(), 1u);
  EXPECT_EQ(quarantine.lift("c").size(), 1u);
  EXPECT_EQ(quarantine.find({"host", {"c"}, "other", "ada"}, false), nullptr);
}

TEST(QuarantineTest, TellsWhatHasChanged) {
  Quarantine quarantine;
  quarantine.add(entry_of({"host", {"a"}}));
  EXPECT_EQ(quarantine.take_changes(), std::set<std::string>{"a"});
  EXPECT_TRUE(quarantine.take_changes().empty());
  quarantine.return_changes({"a"});
  quarantine.add(entry_of({"host", {"b"}}));
  quarantine.lift("b");
  EXPECT_EQ(quarantine.take_changes(), (std::set<std::string>{"a", "b"}));
}

TEST(QuarantineTest, DropsTheOldestOfTooMany) {
  Quarantine quarantine;
  for (std::size_t i = 0; i <= Quarantine::kMaxEntries; ++i)
    quarantine.add(entry_of({"host", {std::to_string(i)}, "machine " + std::to_string(i)},
                            static_cast<std::int64_t>(i)));
  EXPECT_EQ(quarantine.size(), Quarantine::kMaxEntries);
  EXPECT_EQ(quarantine.find({"host", {"0"}, "machine 0"}, false), nullptr);
  EXPECT_NE(quarantine.find({"host", {"1"}, "machine 1"}, false), nullptr);
}

TEST(QuarantineTest, IsStoredWithEverything) {
  const QuarantineEntry entry{{"host", {"a"}, "machine", "ada"}, "ada", "it lied", 1'700'000'000'000};
  using Optional = std::optional<Drain>;
  for (const Optional& drain : {Optional(), Optional(Drain{false}), Optional(Drain{true})}) {
    const fleet::StoredWorker worker{"a", entry, drain}, drained{"a", {}, drain};
    EXPECT_EQ(fleet::decode(fleet::encode(worker)), worker);
    EXPECT_EQ(fleet::decode(fleet::encode(drained)), drained);
  }
  EXPECT_EQ(fleet::decode("no entry"), std::nullopt);
  EXPECT_EQ(fleet::decode(""), std::nullopt);
}

}  // namespace
}  // namespace tessera::farm
