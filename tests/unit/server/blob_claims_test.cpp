// SPDX-License-Identifier: Apache-2.0
#include "server/blobs/blob_claims.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

namespace tessera::server {
namespace {

using namespace std::chrono_literals;

class BlobClaimsTest : public testing::Test {
 protected:
  static proto::Digest file(const std::string& bytes) { return proto::digest_of(bytes); }

  blobs::BlobClaims::Time now_{};
  blobs::BlobClaims claims_{[this] { return now_; }};
  const proto::Digest a_ = file("a"), b_ = file("b"), c_ = file("c");
};

TEST_F(BlobClaimsTest, WhatIsHeldIsNeededHoweverLong) {
  std::optional<blobs::BlobClaims::Hold> first = claims_.hold({a_, b_, a_});
  auto second = claims_.hold({a_});
  now_ += 1000h;
  EXPECT_TRUE(claims_.is_needed(a_));
  EXPECT_TRUE(claims_.is_needed(b_));
  EXPECT_FALSE(claims_.is_needed(c_));
  first.reset();
  EXPECT_TRUE(claims_.is_needed(a_));
  EXPECT_FALSE(claims_.is_needed(b_));
  second = claims_.hold({c_});
  EXPECT_FALSE(claims_.is_needed(a_));
  EXPECT_TRUE(claims_.is_needed(c_));
}

TEST_F(BlobClaimsTest, AClaimLapsesAQuarterOfAnHourAfterItsLastCall) {
  EXPECT_TRUE(claims_.claim("ada", {a_, b_}));
  now_ += 15min - 1s;
  EXPECT_TRUE(claims_.is_needed(a_));
  now_ += 1s;
  EXPECT_FALSE(claims_.is_needed(a_));
  EXPECT_FALSE(claims_.is_needed(b_));
  EXPECT_EQ(claims_.claimed_by("ada"), 0u);
}

TEST_F(BlobClaimsTest, AnUploadKeepsTheOtherFilesOfItsSubmissions) {
  EXPECT_TRUE(claims_.claim("ada", {a_, b_}));
  {
    const auto upload = claims_.use("ada", b_);
    now_ += 5h;
    EXPECT_TRUE(claims_.is_needed(a_)) << "its upload may be over long ago";
  }
  now_ += 14min;
  const auto next = claims_.use("ada", a_);
  now_ += 14min;
  EXPECT_TRUE(claims_.is_needed(b_));
}

TEST_F(BlobClaimsTest, WhatIsAbandonedIsNotKeptByOtherSubmissions) {
  EXPECT_TRUE(claims_.claim("ada", {a_, b_}));
  for (int i = 0; i < 15; ++i) {
    EXPECT_TRUE(claims_.use("ada", c_));
    EXPECT_TRUE(claims_.use("ben", a_));
    now_ += 1min;
  }
  EXPECT_FALSE(claims_.is_needed(b_));
  EXPECT_TRUE(claims_.is_needed(a_)) << "of ben's own";
  EXPECT_TRUE(claims_.is_needed(c_));
}

TEST_F(BlobClaimsTest, AnUnannouncedUploadHasItsOwnClaim) {
  EXPECT_TRUE(claims_.use("ada", a_));
  now_ += 14min;
  EXPECT_TRUE(claims_.is_needed(a_));
  now_ += 1min;
  EXPECT_FALSE(claims_.is_needed(a_));
}

TEST_F(BlobClaimsTest, ASubmissionThatMadeAJobEndsItsClaim) {
  EXPECT_TRUE(claims_.claim("ada", {b_, a_}));
  auto submission = claims_.claim("ada", {a_, b_, b_});
  now_ += 1h;
  EXPECT_TRUE(claims_.is_needed(a_)) << "it waits for its turn";
  submission->settle();
  EXPECT_FALSE(claims_.is_needed(a_));
  EXPECT_EQ(claims_.claimed_by("ada"), 0u);
}

TEST_F(BlobClaimsTest, ButNotWhileTheSameIsSubmittedOnceMore) {
  auto first = claims_.claim("ada", {a_}), second = claims_.claim("ada", {a_});
  first->settle();
  EXPECT_TRUE(claims_.is_needed(a_));
  second.reset();
  EXPECT_TRUE(claims_.is_needed(a_));
  now_ += 15min;
  EXPECT_FALSE(claims_.is_needed(a_));
}

TEST_F(BlobClaimsTest, TheSameFilesAskedForAgainCountOnce) {
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(claims_.claim("ada", {a_, b_}));
  EXPECT_EQ(claims_.claimed_by("ada"), blobs::BlobClaims::kMinFiles);
}

TEST_F(BlobClaimsTest, NoOwnerClaimsAllOfTheQuota) {
  constexpr std::uint64_t kFew = 4000;
  blobs::BlobClaims claims([this] { return now_; }, kFew);
  std::vector<proto::Digest> files(kFew / 4 + 1);
  const auto claim = [&](const std::string& caller, std::uint8_t kind) {
    for (std::size_t i = 0; i < files.size(); ++i) {
      for (int byte = 0; byte < 2; ++byte)
        files[i].sha256[static_cast<std::size_t>(byte)] = static_cast<std::uint8_t>(i >> 8 * byte);
      files[i].sha256[2] = kind;
    }
    return claims.claim(caller, files).has_value();
  };
  EXPECT_TRUE(claim("ada", 0));
  EXPECT_TRUE(claim("ada", 0)) << "the same ones";
  EXPECT_FALSE(claim("ada", 1) && claim("ada", 2));
  EXPECT_TRUE(claims.claim("ben", {a_}));
  now_ += 15min;
  EXPECT_TRUE(claim("ada", 3));
}

TEST_F(BlobClaimsTest, NothingIsDoneToWhatIsNeeded) {
  bool done = false;
  auto hold = claims_.hold({a_});
  EXPECT_FALSE(claims_.unless_needed(a_, [&] { done = true; }));
  EXPECT_FALSE(done);
  EXPECT_TRUE(claims_.unless_needed(b_, [&] { done = true; }));
  EXPECT_TRUE(done);
}

}  // namespace
}  // namespace tessera::server
