// SPDX-License-Identifier: Apache-2.0
#include "server/blobs/blob_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <barrier>
#include <memory>
#include <string>
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
  blobs::BlobStore store_ = *blobs::BlobStore::open(folder_.path());
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
  ASSERT_TRUE(blobs::BlobStore::open(folder_.path()));
  EXPECT_EQ(files_below(folder_.path()), 0u);
}

// Whether the charge is still held.
bool is_kept(const std::weak_ptr<int>& charge) {
  return !charge.expired();
}

TEST_F(BlobStoreTest, KeepsAChargeFromTheFirstByteToTheDeletion) {
  auto charge = std::make_shared<int>();
  const std::weak_ptr<int> kept = charge;
  {
    auto writer = store_.write(proto::digest_of("wanted"), std::move(charge));
    ASSERT_TRUE(writer && writer->append("wan"));
    const auto moved = std::move(*writer);
    EXPECT_TRUE(is_kept(kept));
  }
  EXPECT_FALSE(is_kept(kept)) << "an upload that was given up";
}

TEST_F(BlobStoreTest, ABlobThatIsReplacedOrRemovedCostsNothingMore) {
  const proto::Digest digest = proto::digest_of("wanted");
  std::vector<std::weak_ptr<int>> charges;
  for (int i = 0; i < 2; ++i) {
    auto charge = std::make_shared<int>();
    charges.push_back(charge);
    auto writer = store_.write(digest, std::move(charge));
    ASSERT_TRUE(writer && writer->append("wanted") && writer->commit());
  }
  EXPECT_FALSE(is_kept(charges[0]));
  EXPECT_TRUE(is_kept(charges[1]));
  auto another = std::make_shared<int>();
  charges.push_back(another);
  store_.charge(digest, std::move(another));
  EXPECT_FALSE(is_kept(charges[1]));
  EXPECT_TRUE(is_kept(charges[2]));
  {
    const blobs::RemovedBlob removed = store_.take_away(digest);
    EXPECT_FALSE(store_.contains(digest));
    EXPECT_TRUE(is_kept(charges[2])) << "its file takes room still";
    EXPECT_EQ(files_below(folder_.path()), 1u);
  }
  EXPECT_FALSE(is_kept(charges[2]));
  EXPECT_EQ(files_below(folder_.path()), 0u);
  store_.discard(digest);
}

TEST_F(BlobStoreTest, KnowsWhatIsHere) {
  const proto::Digest first = proto::digest_of("first"), second = proto::digest_of("second");
  ASSERT_TRUE(put(first, {"first"}));
  const blobs::BlobStore store = *blobs::BlobStore::open(folder_.path());
  EXPECT_EQ(store.stored(), std::vector{first});
  auto writer = store.write(second);
  ASSERT_TRUE(writer && writer->append("second") && writer->commit());
  store.discard(first);
  EXPECT_EQ(store.stored(), std::vector{second});
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
  const auto store = blobs::BlobStore::open(folder.path() / "file" / "blobs");
  ASSERT_FALSE(store);
  EXPECT_THAT(store.error().message, HasSubstr((folder.path() / "file").string()));
}

}  // namespace
}  // namespace tessera::store
