// SPDX-License-Identifier: Apache-2.0
#include "server/film/producer_keys.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace tessera::film {
namespace {

using scheduler::Producer;

TEST(ProducerKeys, HaveTheWorkersThatWereAddedAndOthersOfTheirMachinesAndPrincipals) {
  ProducerKeys keys;
  keys.add({"name", {"worker"}, "machine"});
  keys.add({"name", {"alone"}, "", "principal"});
  const ProducerKeys read(keys.encode());
  for (const ProducerKeys* each : {&std::as_const(keys), &read}) {
    EXPECT_TRUE(each->contains({"", {"worker"}, ""}));
    EXPECT_TRUE(each->contains({"", {"other"}, "machine"}));
    EXPECT_TRUE(each->contains({"", {"alone"}, "another"}));
    EXPECT_TRUE(each->contains({"", {"other"}, "another", "principal"}));
    EXPECT_FALSE(each->contains({"name", {"other"}, "another"})) << "anybody can take a name";
    EXPECT_FALSE(each->contains({"", {"machine"}, "worker"}));
    EXPECT_FALSE(each->contains({"", {"principal"}, "principal", "machine"}));
    EXPECT_FALSE(each->contains({"", {"other"}, ""}));
  }
  EXPECT_EQ(keys.encode().size(), 32u);
  EXPECT_FALSE(ProducerKeys().contains({"name", {"worker"}, "machine"}));
  EXPECT_EQ(ProducerKeys("torn").encode(), "");
}

}  // namespace
}  // namespace tessera::film
