#include "core/scene/cache/cache_folder.hpp"

#include <gtest/gtest.h>

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
  void remove_beyond(std::uint64_t bytes) const {
    remove_least_used(folder_.path(), bytes, [](const std::string& name) { return name != "theirs"; });
  }

  TemporaryFolder folder_;
};

TEST_F(CacheFolder, LosesWhatWasNotUsedForLongest) {
  add("old", 10, 5), add("older", 10, 6), add("new", 10, 4);
  remove_beyond(20);
  EXPECT_TRUE(has("old") && has("new") && !has("older"));
}

TEST_F(CacheFolder, KeepsWhatMayBeInUseAndWhatIsNotItsOwn) {
  add("in use", 10, 0), add("theirs", 10, 9), add("old", 10, 5);
  remove_beyond(0);
  EXPECT_TRUE(has("in use") && has("theirs") && !has("old"));
}

TEST_F(CacheFolder, CountsWhatIsMarkedAsUsedJustNow) {
  add("a", 10, 5), add("b", 10, 6);
  mark_as_used(folder_.path() / "b");
  remove_beyond(10);
  EXPECT_TRUE(has("b") && !has("a"));
}

TEST_F(CacheFolder, LosesWhatDeadWritersLeft) {
  add("a.partial", 1, 25), add("b.partial", 1, 1), add("c", 1, 25);
  remove_abandoned(folder_.path(), [](const std::string& name) { return name.ends_with(".partial"); });
  EXPECT_TRUE(!has("a.partial") && has("b.partial") && has("c"));
}

}  // namespace
}  // namespace tessera::core
