// SPDX-License-Identifier: Apache-2.0
#include "worker/blob_cache.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/scene/cache/scene_store.hpp"
#include "fake_coordinator.hpp"
#include "proto/worker_key.hpp"
#include "tests/support/test_scenes.hpp"
#include "worker/machine_key.hpp"

namespace tessera::worker {
namespace {

namespace fs = std::filesystem;

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class BlobCacheTest : public ::testing::Test {
 protected:
  BlobCacheTest() {
    std::string pattern = fs::temp_directory_path() / "tessera-cache-XXXXXX";
    folder_ = mkdtemp(pattern.data());
    coordinator_.keep_blob(proto::to_proto(digest_).sha256(), bytes_);
  }
  ~BlobCacheTest() override { fs::remove_all(folder_); }

  core::Result<std::string> get(const proto::Digest& digest) {
    return BlobCache::open(folder_ / "cache")->get(digest, {}, source_, {});
  }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_ / "cache"), fs::directory_iterator()));
  }

  const std::string bytes_ = std::string(3'000'000, 'b') + "lob";
  const proto::Digest digest_ = proto::digest_of(bytes_);
  fs::path folder_;
  FakeCoordinator coordinator_;
  CoordinatorSource source_{coordinator_.stub()};
};

TEST_F(BlobCacheTest, FetchesOnceAndKeeps) {
  const auto first = get(digest_);
  ASSERT_TRUE(first.has_value()) << first.error().message;
  EXPECT_EQ(read_file(*first), bytes_);
  EXPECT_EQ(get(digest_).value(), *first);
  EXPECT_EQ(coordinator_.fetches(), 1u);
  EXPECT_EQ(files(), 1u);
}

TEST_F(BlobCacheTest, FilesThatWereNotUsedForLongestMakeRoom) {
  const std::string path = get(digest_).value();
  const auto get_another = [&](const std::string& bytes) {
    coordinator_.keep_blob(proto::to_proto(proto::digest_of(bytes)).sha256(), bytes);
    const auto cache = BlobCache::open(folder_ / "cache", 3'700'000);
    return cache->get(proto::digest_of(bytes), {}, source_, {}).value();
  };
  const std::string first = get_another(std::string(600'000, 'x'));
  EXPECT_TRUE(fs::exists(path)) << "there is room for both";
  fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::minutes(1));
  const std::string second = get_another(std::string(600'000, 'y'));
  EXPECT_FALSE(fs::exists(path)) << "also what was used lately goes";
  EXPECT_TRUE(fs::exists(first) && fs::exists(second));
}

TEST_F(BlobCacheTest, FilesInUseStayAndNothingExceedsTheLimit) {
  const std::string used = get(digest_).value();
  const std::string other(600'000, 'x');
  const auto cache = BlobCache::open(folder_ / "cache", 3'500'000);
  coordinator_.keep_blob(proto::to_proto(proto::digest_of(other)).sha256(), other);
  const auto refused = cache->get(proto::digest_of(other), {digest_.hex()}, source_, {});
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, core::ErrorCode::kResourceExhausted);
  EXPECT_THAT(refused.error().message, ::testing::HasSubstr("--cache-gib"));
  EXPECT_EQ(coordinator_.fetches(), 1u) << "no byte comes before there is room for all";
  EXPECT_EQ(files(), 1u);
  EXPECT_TRUE(cache->get(proto::digest_of(other), {}, source_, {}).has_value());
  EXPECT_FALSE(fs::exists(used));
}

// Blobs of many sizes and built scenes, at a limit that two scenes reach.
TEST_F(BlobCacheTest, BlobsAndScenesTogetherNeverExceedTheLimit) {
  const auto build = [](const core::SceneStore& store, std::size_t key) {
    auto prepared = store.prepare(std::to_string(key), 1, [] { return test::room(); });
    const bool was_kept = prepared->bvh.has_value();
    EXPECT_TRUE(core::build_scene(std::move(*prepared), 1));
    return was_kept;
  };
  const auto ignore = [](const std::string&) {};
  build(*core::SceneStore::open(folder_ / "one", UINT64_MAX, ignore), 0);
  const std::size_t scene_bytes = fs::file_size(fs::directory_iterator(folder_ / "one")->path());
  const auto cache = BlobCache::open(folder_ / "cache", 2 * scene_bytes);
  const auto store =
      core::SceneStore::open(cache->folder(), cache->max_bytes(), ignore, BlobCache::is_file_name);
  int scenes_kept = 0;
  for (std::size_t i = 1; i <= 40; ++i) {
    const std::string blob(i * 7919 % scene_bytes, static_cast<char>(i));
    coordinator_.keep_blob(proto::to_proto(proto::digest_of(blob)).sha256(), blob);
    const auto path = cache->get(proto::digest_of(blob), {}, source_, {});
    ASSERT_TRUE(path.has_value()) << path.error().message;
    EXPECT_LE(cache->used_bytes(), cache->max_bytes());
    if (i % 2 == 0)  // no longer presumed to be in use
      fs::last_write_time(*path, fs::file_time_type::clock::now() - std::chrono::hours(2));
    build(*store, i);
    EXPECT_LE(cache->used_bytes(), cache->max_bytes());
    if (build(*store, i)) ++scenes_kept;
  }
  EXPECT_GT(scenes_kept, 0);
}

TEST_F(BlobCacheTest, FilesOfOthersStay) {
  fs::create_directory(folder_ / "cache");
  const std::vector<std::string> names{"thesis.tex", "notes.partial", std::string(64, 'A'),
                                       std::string(63, 'a'), std::string(65, 'a')};
  const auto make = [&](const std::string& name) {
    std::ofstream(folder_ / "cache" / name) << "precious";
    fs::last_write_time(folder_ / "cache" / name, fs::file_time_type::clock::now() - std::chrono::hours(48));
  };
  for (const std::string& name : names) make(name);
  const std::string unused(64, 'a'), abandoned = unused + ".7-1.partial";
  make(unused);
  make(abandoned);
  ASSERT_TRUE(BlobCache::open(folder_ / "cache", bytes_.size())->get(digest_, {}, source_, {}));
  for (const std::string& name : names) EXPECT_TRUE(fs::exists(folder_ / "cache" / name)) << name;
  EXPECT_FALSE(fs::exists(folder_ / "cache" / unused));
  EXPECT_FALSE(fs::exists(folder_ / "cache" / abandoned));
}

TEST_F(BlobCacheTest, AFolderThatOthersMayWriteToIsRefused) {
  const fs::path folder = folder_ / "cache";
  fs::create_directory(folder);
  for (const fs::perms others : {fs::perms::group_write, fs::perms::others_write}) {
    fs::permissions(folder, fs::perms::owner_all | others);
    const auto refused = BlobCache::open(folder);
    ASSERT_FALSE(refused.has_value());
    EXPECT_THAT(refused.error().message, ::testing::HasSubstr("others may write to it"));
  }
  fs::permissions(folder, fs::perms::owner_all);
  EXPECT_TRUE(BlobCache::open(folder).has_value());
  if (geteuid() != 0) GTEST_SKIP() << "only root can make a folder somebody else's";
  ASSERT_EQ(chown(folder.c_str(), 65534, 65534), 0);
  EXPECT_THAT(BlobCache::open(folder).error().message, ::testing::HasSubstr("belongs to another user"));
}

TEST_F(BlobCacheTest, WorkersOfAMachineKnowItsKeyAndHaveKeysOfTheirOwn) {
  const auto cache = BlobCache::open(folder_ / "cache");
  const auto first = machine_key(cache->folder()), again = machine_key(cache->folder());
  ASSERT_TRUE(first.has_value()) << first.error().message;
  EXPECT_EQ(*first, *again);
  const std::string one = new_worker_key(*first), other = new_worker_key(*first);
  EXPECT_EQ(one.size(), proto::kWorkerKeyBytes);
  EXPECT_NE(proto::worker_id_of(one), proto::worker_id_of(other));
  EXPECT_EQ(proto::client_key(one), proto::client_key(other));
  EXPECT_NE(proto::client_key(one), proto::client_key(new_worker_key(std::string(32, 'x'))));
  EXPECT_EQ(proto::client_key("short"), "");
  const fs::path file = folder_ / "cache" / "worker.key";
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  std::ofstream(file, std::ios::trunc) << "short";
  EXPECT_THAT(machine_key(cache->folder()).error().message, ::testing::HasSubstr("remove it"));
}

TEST_F(BlobCacheTest, AnEmptyBlobIsABlob) {
  const proto::Digest empty = proto::digest_of("");
  coordinator_.keep_blob(proto::to_proto(empty).sha256(), "");
  ASSERT_TRUE(get(empty).has_value());
  EXPECT_EQ(read_file(get(empty).value()), "");
}

TEST_F(BlobCacheTest, ReplacesADamagedFile) {
  const std::string path = get(digest_).value();
  fs::resize_file(path, 100);
  EXPECT_EQ(read_file(get(digest_).value()), bytes_);
  std::fstream(path, std::ios::binary | std::ios::in | std::ios::out).put('X');
  EXPECT_EQ(read_file(get(digest_).value()), bytes_);
  EXPECT_EQ(coordinator_.fetches(), 3u);
}

TEST_F(BlobCacheTest, KeepsNothingOfWhatIsNotTheBlob) {
  coordinator_.keep_blob(proto::to_proto(digest_).sha256(), std::string(bytes_.size(), 'x'));
  const auto path = get(digest_);
  ASSERT_FALSE(path.has_value());
  EXPECT_EQ(path.error().code, core::ErrorCode::kDataLoss);
  EXPECT_EQ(files(), 0u);
}

TEST_F(BlobCacheTest, PassesOnThatABlobIsUnknown) {
  const auto path = get(proto::digest_of("unknown"));
  ASSERT_FALSE(path.has_value());
  EXPECT_EQ(path.error().code, core::ErrorCode::kNotFound);
  EXPECT_EQ(files(), 0u);
}

TEST_F(BlobCacheTest, AFolderThatCannotBeIsNamed) {
  std::ofstream(folder_ / "file") << "x";
  const auto cache = BlobCache::open(folder_ / "file" / "cache");
  ASSERT_FALSE(cache.has_value());
  EXPECT_THAT(cache.error().message, ::testing::HasSubstr((folder_ / "file" / "cache").string()));
}

}  // namespace
}  // namespace tessera::worker
