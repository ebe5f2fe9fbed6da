// SPDX-License-Identifier: Apache-2.0
#include "core/scene/cache/cache_folder.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>

#include "tests/support/temporary_folder.hpp"

namespace tessera::core {
namespace {

class CacheFolder : public testing::Test {
 protected:
  void add(const std::string& name, std::size_t bytes, int hours_ago) const {
    write_file(folder_.path() / name, std::string(bytes, 'x'));
    std::filesystem::last_write_time(
        folder_.path() / name, std::filesystem::file_time_type::clock::now() - std::chrono::hours(hours_ago));
  }
  bool has(const std::string& name) const { return std::filesystem::exists(folder_.path() / name); }
  std::uint64_t remove_beyond(std::uint64_t bytes) const {
    return remove_least_used(folder_.path(), bytes, is_ours,
                             [](const std::string& name, std::chrono::seconds unused_for) {
                               return name != "made anew" && unused_for < kMayBeInUse;
                             });
  }

  static bool is_ours(const std::string& name) {
    return name != "theirs" && name.find('.') == std::string::npos;
  }

  TemporaryFolder folder_;
};

TEST_F(CacheFolder, LosesWhatWasNotUsedForLongest) {
  add("old", 10, 5), add("older", 10, 6), add("new", 10, 4);
  EXPECT_EQ(remove_beyond(20), 20u);
  EXPECT_TRUE(has("old") && has("new") && !has("older"));
}

TEST_F(CacheFolder, KeepsWhatMayBeInUseAndWhatIsNotItsOwn) {
  add("in use", 10, 0), add("theirs", 10, 9), add("old", 10, 5);
  EXPECT_EQ(remove_beyond(0), 10u);
  EXPECT_TRUE(has("in use") && has("theirs") && !has("old"));
}

TEST_F(CacheFolder, LosesWhatCanGoAtOnceEvenIfInUse) {
  add("in use", 10, 0), add("made anew", 10, 0);
  remove_beyond(10);
  EXPECT_TRUE(has("in use") && !has("made anew"));
}

TEST_F(CacheFolder, CountsWhatIsBeingWritten) {
  add("a", 10, 5), add("b", 10, 6);
  add("c.1.partial", 10, 0);
  EXPECT_EQ(remove_beyond(10), 10u);
  EXPECT_TRUE(has("c.1.partial") && !has("a") && !has("b"));
}

TEST_F(CacheFolder, ReleasesReservationsOfDeadProcesses) {
  add("a", 10, 1), add("c.1.partial", 10, 2);
  EXPECT_EQ(remove_beyond(10), 10u);
  EXPECT_TRUE(has("a") && !has("c.1.partial"));
}

TEST_F(CacheFolder, IsForItsOwnerAloneToWriteTo) {
  const std::filesystem::path folder = folder_.path() / "new" / "cache";
  const mode_t mask = umask(0);
  EXPECT_TRUE(make_folder(folder.string() + "/"));
  umask(mask);
  EXPECT_TRUE(check_is_own(folder));
  for (const auto others : {std::filesystem::perms::group_write, std::filesystem::perms::others_write}) {
    std::filesystem::permissions(folder, std::filesystem::perms::owner_all | others);
    const Status own = check_is_own(folder);
    ASSERT_FALSE(own);
    EXPECT_EQ(own.error().code, ErrorCode::kPermissionDenied);
  }
}

TEST_F(CacheFolder, IsNoFile) {
  add("file", 1, 0);
  EXPECT_FALSE(make_folder(folder_.path() / "file"));
  EXPECT_FALSE(make_folder(folder_.path() / "file" / "cache"));
}

TEST_F(CacheFolder, GivesEachWriterAFileOfItsOwn) {
  EXPECT_NE(partial_path_of("a"), partial_path_of("a"));
}

TEST_F(CacheFolder, CountsWhatIsMarkedAsUsedJustNow) {
  add("a", 10, 5), add("b", 10, 6);
  mark_as_used(folder_.path() / "b");
  remove_beyond(10);
  EXPECT_TRUE(has("b") && !has("a"));
}

TEST_F(CacheFolder, DeletesFilesOfDeadProcesses) {
  add("a.1.partial", 1, 25), add("b.2.partial", 1, 1), add("c", 1, 25);
  add("theirs.3.partial", 1, 25), add("notes.partial", 1, 25), add(".partial", 1, 25);
  remove_abandoned(folder_.path(), is_ours);
  EXPECT_TRUE(!has("a.1.partial") && has("b.2.partial") && has("c"));
  EXPECT_TRUE(has("theirs.3.partial") && has("notes.partial") && has(".partial"));
}

}  // namespace
}  // namespace tessera::core
