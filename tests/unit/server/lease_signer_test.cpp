// SPDX-License-Identifier: Apache-2.0
#include "server/dispatch/lease_signer.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace tessera::dispatch {
namespace {

std::string hex(const std::string& bytes) {
  std::string text;
  for (const char byte : bytes) text += fmt::format("{:02x}", static_cast<unsigned char>(byte));
  return text;
}

// Workers deliver leases of earlier releases after an update. The expected bytes are those of another
// implementation of HMAC-SHA256.
TEST(LeaseSigner, IsTheSameInEveryRelease) {
  const LeaseSigner signer({1, 2});
  EXPECT_EQ(hex(signer.sign({7}, {"w-1"}, {"job-1"})), "ce307a8f78b65296bb5d1cb49331f021");
}

TEST(LeaseSigner, DependsOnLeaseWorkerJobAndSecret) {
  const LeaseSigner signer({1, 2}), other({1, 3});
  const std::string token = signer.sign({7}, {"w"}, {"job"});
  EXPECT_EQ(signer.sign({7}, {"w"}, {"job"}), token);
  EXPECT_NE(signer.sign({8}, {"w"}, {"job"}), token);
  EXPECT_NE(signer.sign({7}, {"v"}, {"job"}), token);
  EXPECT_NE(signer.sign({7}, {"w"}, {"bob"}), token);
  EXPECT_NE(other.sign({7}, {"w"}, {"job"}), token);
}

TEST(LeaseSigner, SignsForSeveralThreads) {
  const LeaseSigner signer({1, 2});
  const std::string expected = signer.sign({7}, {"w"}, {"job"});
  std::vector<std::jthread> threads;
  for (int thread = 0; thread < 4; ++thread)
    threads.emplace_back([&] {
      for (int i = 0; i < 1000; ++i) ASSERT_EQ(signer.sign({7}, {"w"}, {"job"}), expected);
    });
}

}  // namespace
}  // namespace tessera::dispatch
