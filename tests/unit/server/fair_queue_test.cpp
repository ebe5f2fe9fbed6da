// SPDX-License-Identifier: Apache-2.0
#include "server/base/fair_queue.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

namespace tessera::server {
namespace {

class FairQueueTest : public testing::Test {
 protected:
  // No request may be granted while held_ is destroyed.
  ~FairQueueTest() override {
    for (const auto& [name, who] : names_) queue_.leave(&who);
  }
  // Waits as the caller with the first letter of the name.
  bool wait(const std::string& name, std::uint64_t amount) {
    const auto [entry, added] = names_.emplace(name, name);
    return queue_.wait(&entry->second, name.substr(0, 1), amount, [this, name](base::FairShare::Held held) {
      order_.push_back(name);
      held_.emplace(name, std::move(held));
    });
  }
  bool leave(const std::string& name) { return queue_.leave(&names_.at(name)); }
  void give_back(const std::string& name) {
    const auto given_back = held_.extract(name);  // grants to others, which adds to held_
    ASSERT_TRUE(given_back);
  }

  base::FairQueue queue_{100, 8};
  std::map<std::string, const std::string> names_;
  std::vector<std::string> order_;
  std::map<std::string, base::FairShare::Held> held_;
};

using Names = std::vector<std::string>;

TEST_F(FairQueueTest, WhatFitsIsGrantedAtOnce) {
  EXPECT_TRUE(wait("a1", 30));
  EXPECT_TRUE(wait("b1", 30));
  EXPECT_EQ(order_, (Names{"a1", "b1"}));
  EXPECT_EQ(queue_.held(), 60u);
  give_back("a1");
  EXPECT_EQ(queue_.held(), 30u);
}

TEST_F(FairQueueTest, ALargeAmountIsNotOvertakenBySmallOnes) {
  EXPECT_TRUE(wait("a1", 10));
  EXPECT_TRUE(wait("large", 95));
  for (int i = 2; i < 5; ++i) {
    EXPECT_TRUE(wait("b" + std::to_string(i), 10));
    EXPECT_EQ(order_.back(), "a1") << "though it would fit";
  }
  give_back("a1");
  EXPECT_EQ(order_, (Names{"a1", "large"}));
  give_back("large");
  EXPECT_EQ(order_, (Names{"a1", "large", "b2", "b3", "b4"}));
}

TEST_F(FairQueueTest, AHolderDoesNotBlockOthers) {
  EXPECT_TRUE(wait("a1", 60));
  EXPECT_TRUE(wait("a2", 60));
  EXPECT_TRUE(wait("b1", 20));
  EXPECT_EQ(order_, (Names{"a1", "b1"}));
  give_back("a1");
  EXPECT_EQ(order_, (Names{"a1", "b1", "a2"}));
}

TEST_F(FairQueueTest, MoreThanThereIsWaitsForAll) {
  EXPECT_TRUE(wait("a1", 1));
  EXPECT_TRUE(wait("b1", 500));
  EXPECT_EQ(order_, (Names{"a1"}));
  give_back("a1");
  EXPECT_EQ(order_, (Names{"a1", "b1"}));
}

TEST_F(FairQueueTest, ACancelledWaiterIsNotServedAndDoesNotBlock) {
  EXPECT_TRUE(wait("a1", 10));
  EXPECT_TRUE(wait("large", 95));
  EXPECT_TRUE(wait("b1", 10));
  EXPECT_TRUE(leave("large"));
  EXPECT_EQ(order_, (Names{"a1", "b1"}));
  EXPECT_FALSE(leave("large"));
  EXPECT_FALSE(leave("a1")) << "it has been granted";
}

TEST_F(FairQueueTest, NoClientFillsTheQueue) {
  EXPECT_TRUE(wait("x", 100));
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(wait("a" + std::to_string(i), 10));
  EXPECT_FALSE(wait("a4", 10));
  EXPECT_TRUE(wait("b0", 10));
}

}  // namespace
}  // namespace tessera::server
