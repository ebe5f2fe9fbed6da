#include "server/store/blob_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <barrier>
#include <thread>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace tessera::store {
namespace {

using core::ErrorCode;
using testing::HasSubstr;

std::size_t files_below(const std::filesystem::path& folder) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    files += entry.is_regular_file();
  return files;
}

class BlobStoreTest : public testing::Test {
 protected:
  core::Status put(const proto::Digest& digest, const std::vector<std::string>& pieces) {
    auto writer = store_.write(digest);
    if (!writer) return core::fail(writer.error());
    for (const std::string& piece : pieces) {
      if (auto appended = writer->append(piece); !appended) return appended;
    }
    return writer->commit();
  }

  core::Result<std::string> get(const proto::Digest& digest, std::size_t piece_bytes) {
    auto reader = store_.read(digest);
    if (!reader) return core::fail(reader.error());
    std::string bytes;
    while (true) {
      const auto piece = reader->next(piece_bytes);
      if (!piece || piece->empty()) return piece ? core::Result<std::string>(bytes) : piece;
      EXPECT_LE(piece->size(), piece_bytes);
      bytes += *piece;
    }
  }

  TemporaryFolder folder_;
  BlobStore store_ = *BlobStore::open(folder_.path());
};

TEST_F(BlobStoreTest, GivesBackWhatWasPut) {
  const std::string bytes = "a tessera is one tile of a mosaic";
  const proto::Digest digest = proto::digest_of(bytes);
  EXPECT_FALSE(store_.contains(digest));
  ASSERT_TRUE(put(digest, {bytes.substr(0, 5), bytes.substr(5)}));
  EXPECT_TRUE(store_.contains(digest));
  EXPECT_EQ(*get(digest, 7), bytes);
  EXPECT_EQ(read_file(store_.path(digest)), bytes);
}

TEST_F(BlobStoreTest, KeepsTheEmptyBlob) {
  const proto::Digest digest = proto::digest_of("");
  ASSERT_TRUE(put(digest, {}));
  EXPECT_EQ(*get(digest, 10), "");
}

TEST_F(BlobStoreTest, RefusesBytesOfAnotherDigestAndLeavesNothing) {
  const proto::Digest digest = proto::digest_of("wanted");
  const auto refused = put(digest, {"forged"});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kDataLoss);
  EXPECT_FALSE(store_.contains(digest));
  EXPECT_EQ(files_below(folder_.path()), 0u);
}

TEST_F(BlobStoreTest, RefusesTooFewBytes) {
  const auto refused = put(proto::digest_of("wanted"), {"want"});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kDataLoss);
}

TEST_F(BlobStoreTest, StopsAsSoonAsThereIsMoreThanTheDigestSays) {
  auto writer = store_.write(proto::digest_of("wanted"));
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->append("wanted"));
  const auto refused = writer->append("!");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
}

TEST_F(BlobStoreTest, ADigestWithAnotherLengthNamesNothing) {
  proto::Digest digest = proto::digest_of("wanted");
  ASSERT_TRUE(put(digest, {"wanted"}));
  digest.size_bytes = 5;
  EXPECT_FALSE(store_.contains(digest));
  EXPECT_EQ(store_.read(digest).error().code, ErrorCode::kNotFound);
}

TEST_F(BlobStoreTest, UploadsOfTheSameBlobAtOnceAllSucceed) {
  const std::string bytes(100'000, 'x');
  const proto::Digest digest = proto::digest_of(bytes);
  constexpr int kUploads = 4;
  std::barrier all_written(kUploads);
  std::atomic<int> committed = 0;
  std::vector<std::thread> uploads;
  for (int i = 0; i < kUploads; ++i) {
    uploads.emplace_back([&] {
      auto writer = store_.write(digest);
      const bool appended = writer && writer->append(bytes);
      all_written.arrive_and_wait();
      if (appended && writer->commit()) ++committed;
    });
  }
  for (std::thread& upload : uploads) upload.join();
  EXPECT_EQ(committed, kUploads);
  EXPECT_EQ(*get(digest, 1 << 20), bytes);
  EXPECT_EQ(files_below(folder_.path()), 1u);
}

TEST_F(BlobStoreTest, AnInterruptedUploadIsClearedAtTheNextStart) {
  auto writer = store_.write(proto::digest_of("wanted"));
  ASSERT_TRUE(writer && writer->append("wan"));
  ASSERT_EQ(files_below(folder_.path()), 1u);
  ASSERT_TRUE(BlobStore::open(folder_.path()));
  EXPECT_EQ(files_below(folder_.path()), 0u);
}

TEST_F(BlobStoreTest, CountsWhatIsHereAndWhatIsOnItsWay) {
  ASSERT_TRUE(put(proto::digest_of("wanted"), {"wan", "ted"}));
  EXPECT_EQ(store_.used_bytes(), 6u);
  {
    auto writer = store_.write(proto::digest_of("never whole"));
    ASSERT_TRUE(writer && writer->append("never"));
    EXPECT_EQ(store_.used_bytes(), 11u);
    const auto moved = std::move(*writer);
    EXPECT_EQ(store_.used_bytes(), 11u);
  }
  EXPECT_EQ(store_.used_bytes(), 6u) << "half an upload that was given up";
  EXPECT_FALSE(put(proto::digest_of("other"), {"forged"}));
  EXPECT_EQ(store_.used_bytes(), 6u);
}

TEST_F(BlobStoreTest, CountsEachFileOnce) {
  ASSERT_TRUE(put(proto::digest_of("wanted"), {"wanted"}));
  ASSERT_TRUE(put(proto::digest_of("wanted"), {"wanted"}));
  EXPECT_EQ(store_.used_bytes(), 6u);
  EXPECT_EQ(BlobStore::open(folder_.path())->used_bytes(), 6u);
  store_.discard(proto::digest_of("wanted"));
  store_.discard(proto::digest_of("wanted"));
  EXPECT_EQ(store_.used_bytes(), 0u);
}

TEST_F(BlobStoreTest, WhatIsCollectedCountsNoMore) {
  ASSERT_TRUE(put(proto::digest_of("kept"), {"kept"}));
  ASSERT_TRUE(put(proto::digest_of("unused"), {"unused"}));
  EXPECT_EQ(store_.collect({proto::digest_of("kept").hex()}, std::chrono::seconds(-60)), 1u);
  EXPECT_EQ(store_.used_bytes(), 4u);
}

TEST_F(BlobStoreTest, ABlobThatCannotBeOpenedIsNotMissing) {
  const proto::Digest digest = proto::digest_of("wanted");
  EXPECT_EQ(store_.read(digest).error().code, ErrorCode::kNotFound);
  std::filesystem::create_directories(store_.path(digest).parent_path());
  std::filesystem::create_symlink(store_.path(digest), store_.path(digest));
  EXPECT_EQ(store_.read(digest).error().code, ErrorCode::kInternal);
}

TEST_F(BlobStoreTest, ADamagedFileIsToldByName) {
  const proto::Digest digest = proto::digest_of("wanted");
  ASSERT_TRUE(put(digest, {"wanted"}));
  write_file(store_.path(digest), "forged");
  const auto got = get(digest, 4);
  ASSERT_FALSE(got);
  EXPECT_EQ(got.error().code, ErrorCode::kDataLoss);
  EXPECT_THAT(got.error().message, HasSubstr(store_.path(digest).string()));
}

TEST(BlobStoreOpening, SaysWhatIsInTheWay) {
  const TemporaryFolder folder;
  write_file(folder.path() / "file", "");
  const auto store = BlobStore::open(folder.path() / "file" / "blobs");
  ASSERT_FALSE(store);
  EXPECT_THAT(store.error().message, HasSubstr((folder.path() / "file").string()));
}

}  // namespace
}  // namespace tessera::store
