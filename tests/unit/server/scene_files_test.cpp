// SPDX-License-Identifier: Apache-2.0
// Which files stay, and whose quota they use, when the store of scene files is full.
#include "server/blobs/scene_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace tessera::server {
namespace {

using core::ErrorCode;
using testing::HasSubstr;
using namespace std::chrono_literals;

constexpr std::size_t kMib = server::kMib;

class SceneFilesTest : public testing::Test {
 protected:
  SceneFilesTest() {
    open();
    now_ += 1h;  // claims from before the start have expired
  }
  void open() {
    files_.reset();
    store_.emplace(*blobs::BlobStore::open(folder_.path()));
    files_ = std::make_unique<blobs::SceneFiles>(
        *store_, blobs::SceneFilesOptions{{.store_mib = 8}, 24h, [this] { return now_; }});
  }
  static std::string bytes_of(char name, std::size_t mib = 1) { return std::string(mib * kMib, name); }
  static proto::Digest file(char name, std::size_t mib = 1) { return proto::digest_of(bytes_of(name, mib)); }

  core::Status upload(const std::string& caller, char name, std::size_t mib = 1) {
    const std::string bytes = bytes_of(name, mib);
    const auto use = files_->use(caller, proto::digest_of(bytes));
    if (!use) return core::fail(use.error());
    auto writer = files_->write_making_room(caller, proto::digest_of(bytes));
    if (!writer) return core::fail(writer.error());
    if (auto appended = writer->append(bytes); !appended) return appended;
    return writer->commit();
  }
  bool has(char name, std::size_t mib = 1) { return store_->contains(file(name, mib)); }
  void last_used(char name, std::chrono::minutes ago) {
    std::filesystem::last_write_time(store_->path(file(name)),
                                     std::filesystem::file_time_type::clock::now() - ago);
  }
  static v1::Bundle bundle(const std::string& names) {
    v1::Bundle bundle;
    for (const char name : names) *bundle.add_assets()->mutable_digest() = proto::to_proto(file(name));
    return bundle;
  }

  TemporaryFolder folder_;
  blobs::BlobClaims::Time now_{};
  std::optional<blobs::BlobStore> store_;
  std::unique_ptr<blobs::SceneFiles> files_;
};

TEST_F(SceneFilesTest, AnUploadTakesItsRoomBeforeItsBytesCome) {
  {
    const auto writer = files_->write("ada", file('a', 3));
    ASSERT_TRUE(writer);
    EXPECT_EQ(files_->used_bytes(), 3 * kMib);
  }
  EXPECT_EQ(files_->used_bytes(), 0u);
  EXPECT_TRUE(upload("ada", 'a', 3));
  EXPECT_EQ(files_->used_bytes(), 3 * kMib);
}

TEST_F(SceneFilesTest, NoOwnerTakesTheQuotaOfOthers) {
  for (const char name : {'a', 'b', 'c', 'd'}) EXPECT_TRUE(upload("ada", name));
  const auto refused = upload("ada", 'e');
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kResourceExhausted);
  EXPECT_EQ(
      refused.error().message,
      "the files of scenes from here have 4194304 bytes, 1048576 more would be more than their share, "
      "and this farm takes at most 8 MiB from all callers (tessera-coordinator --max-store-mib), some of "
      "which it keeps for others: delete jobs that nobody needs any more (tessera delete); files that "
      "were uploaded and not submitted make room after a quarter of an hour");
  EXPECT_TRUE(upload("ben", 'f'));
  EXPECT_TRUE(upload("ben", 'g'));
  EXPECT_FALSE(upload("ben", 'h'));
  EXPECT_TRUE(upload("eve", 'i'));
  EXPECT_TRUE(has('a')) << "nothing that is claimed is lost";
}

TEST_F(SceneFilesTest, WhatIsLargerThanTheStoreIsRefusedAlsoWhereNothingIs) {
  EXPECT_THAT(upload("ada", 'a', 9).error().message,
              HasSubstr("the files of scenes here have 0 bytes, 9437184 more would be too many"));
  EXPECT_EQ(files_->used_bytes(), 0u);
}

TEST_F(SceneFilesTest, NothingGoesForWhatCannotFitInAnyCase) {
  EXPECT_TRUE(upload("ada", 'a'));
  const auto job = files_->hold(bundle("a"));
  EXPECT_TRUE(upload("ada", 'b'));
  now_ += 15min;
  EXPECT_FALSE(upload("ben", 'x', 8));
  EXPECT_TRUE(has('b'));
  EXPECT_TRUE(upload("ben", 'x', 7));
  EXPECT_FALSE(has('b'));
}

TEST_F(SceneFilesTest, OnlyAsMuchGoesAsIsWantedTheOldestFirst) {
  for (const char name : {'a', 'b', 'c', 'd'}) EXPECT_TRUE(upload("ada", name));
  last_used('c', 60min);
  last_used('a', 50min);
  now_ += 15min;
  EXPECT_TRUE(upload("ben", 'x', 5));
  EXPECT_FALSE(has('c'));
  EXPECT_TRUE(has('a'));
  EXPECT_TRUE(has('b'));
  EXPECT_TRUE(has('x', 5));
  EXPECT_EQ(files_->used_bytes(), 8 * kMib);
}

TEST_F(SceneFilesTest, WhatIsNeededStaysHoweverOldItIs) {
  for (const char name : {'a', 'b', 'c', 'd'}) {
    EXPECT_TRUE(upload("ada", name));
    last_used(name, 600min);
  }
  const auto of_a_job = files_->hold(bundle("ab"));
  now_ += 14min;
  const auto of_a_submission = files_->claim("ben", {file('c')});
  now_ += 1h;
  EXPECT_TRUE(upload("ben", 'x', 5)) << "the one file that nobody needs has made room";
  EXPECT_TRUE(has('a') && has('b') && has('c'));
  EXPECT_FALSE(has('d'));
  EXPECT_FALSE(upload("eve", 'e'));
  EXPECT_TRUE(has('a') && has('b') && has('c'));
}

TEST_F(SceneFilesTest, ADeletedJobMakesRoomAtOnce) {
  std::optional<blobs::BlobClaims::Hold> job;
  for (const char name : {'a', 'b', 'c', 'd'}) EXPECT_TRUE(upload("ada", name));
  auto submission = files_->claim("ada", blobs::files_of(bundle("abcd")));
  now_ += 15min;  // the uploads' own claims
  job = files_->hold(bundle("abcd"));
  submission->settle();
  EXPECT_FALSE(upload("ada", 'e'));
  EXPECT_FALSE(upload("ada", 'e')) << "again and again";
  job.reset();
  EXPECT_TRUE(upload("ada", 'e'));
}

TEST_F(SceneFilesTest, FilesOfAJobBelongToItsSubmitterOrNoOwner) {
  for (const char name : {'a', 'b', 'c', 'd'}) EXPECT_TRUE(upload("10.0.0.1", name));
  const auto job = files_->hold(bundle("abcd"));
  now_ += 15min;
  EXPECT_FALSE(upload("10.0.0.1", 'e'));
  files_->charge_to("", bundle("abcd"));
  EXPECT_EQ(files_->used_bytes(), 4 * kMib);
  EXPECT_TRUE(upload("10.0.0.1", 'e'));
  files_->charge_to("ada", bundle("abcd"));
  EXPECT_FALSE(upload(base::caller_key("ada"), 'f'));
  EXPECT_TRUE(upload(base::caller_key("ben"), 'f'));
}

TEST_F(SceneFilesTest, AfterARestartWhatWasUploadedJustBeforeStaysAWhile) {
  for (const char name : {'a', 'b', 'c', 'd'}) EXPECT_TRUE(upload("ada", name));
  last_used('a', 16min);
  open();
  EXPECT_EQ(files_->used_bytes(), 4 * kMib);
  EXPECT_TRUE(upload("ben", 'x', 5));
  EXPECT_FALSE(has('a'));
  EXPECT_FALSE(upload("eve", 'e'));
  EXPECT_TRUE(has('b') && has('c') && has('d'));
  now_ += 15min;
  EXPECT_TRUE(upload("eve", 'e'));
}

TEST_F(SceneFilesTest, WithoutNeedFilesGoWhenTheyWereNotUsedForLong) {
  for (const char name : {'a', 'b', 'c'}) {
    EXPECT_TRUE(upload("ada", name));
    last_used(name, 25 * 60min);
  }
  last_used('b', 23 * 60min);
  const auto job = files_->hold(bundle("c"));
  files_->collect();
  EXPECT_TRUE(has('a')) << "somebody is about to submit it";
  now_ += 15min;
  files_->collect();
  EXPECT_FALSE(has('a'));
  EXPECT_TRUE(has('b') && has('c'));
  EXPECT_EQ(files_->used_bytes(), 2 * kMib);
}

}  // namespace
}  // namespace tessera::server
