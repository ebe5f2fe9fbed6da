// SPDX-License-Identifier: Apache-2.0
#include "core/image/file_io.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace tessera::core {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class FileIo : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "file_io.XXXXXX";
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return folder_ / name; }
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator(folder_)) found.push_back(entry.path().filename());
    return found;
  }

  fs::path folder_;
};

TEST_F(FileIo, WritesAndReadsBackAnyBytes) {
  const std::string bytes("a\0b\n\xff", 5);
  ASSERT_TRUE(write_file_atomically(path("x"), bytes));
  EXPECT_EQ(read_file(path("x")), bytes);
  EXPECT_THAT(names(), testing::ElementsAre("x"));
}

TEST_F(FileIo, ReplacesWhatWasThere) {
  ASSERT_TRUE(write_file_atomically(path("x"), "a long first version"));
  ASSERT_TRUE(write_file_atomically(path("x"), "new"));
  EXPECT_EQ(read_file(path("x")), "new");
  EXPECT_THAT(names(), testing::ElementsAre("x"));
}

TEST_F(FileIo, GivesTheRightsThatTheUserMaskLeaves) {
  const mode_t before = ::umask(027);
  const Status status = write_file_atomically(path("x"), "");
  ::umask(before);
  ASSERT_TRUE(status);
  EXPECT_EQ(fs::status(path("x")).permissions(), fs::perms(0640));
}

TEST_F(FileIo, FollowsLinks) {
  fs::create_directory(folder_ / "elsewhere");
  ASSERT_TRUE(write_file_atomically(path("elsewhere/x"), "old"));
  fs::create_symlink("elsewhere/x", folder_ / "link");
  ASSERT_TRUE(write_file_atomically(path("link"), "new"));
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(read_file(path("elsewhere/x")), "new");
}

TEST_F(FileIo, LongNamesAreNoProblem) {
  const std::string name(250, 'n');
  EXPECT_TRUE(write_file_atomically(path(name), ""));
}

TEST_F(FileIo, DevicesAreWrittenToAndStay) {
  EXPECT_TRUE(write_file_atomically("/dev/null", "gone"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(FileIo, AFullDiskIsAnErrorThatSaysSo) {
  const Status status = write_file_atomically("/dev/full", "x");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kResourceExhausted);
  EXPECT_EQ(status.error().message, "cannot write '/dev/full': No space left on device");
}

// Lets files grow to a few bytes only, as a disk does that fills up in the middle of a write.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : old_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &old_limit_);
    const rlimit limit{bytes, old_limit_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &old_limit_);
    std::signal(SIGXFSZ, old_handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  void (*old_handler_)(int);
  rlimit old_limit_{};
};

TEST_F(FileIo, AFailureHalfwayLeavesTheOldFileAndNothingElse) {
  ASSERT_TRUE(write_file_atomically(path("x"), "old"));
  Status status;
  {
    const FileSizeLimit limit(1000);
    status = write_file_atomically(path("x"), std::string(100000, 'n'));
  }
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, AllOf(HasSubstr(path("x")), HasSubstr("File too large")));
  EXPECT_EQ(read_file(path("x")), "old");
  EXPECT_THAT(names(), testing::ElementsAre("x"));
}

// Whether files of the test's folder can be written before they have a name.
bool has_unnamed_files(const std::string& folder) {
  const int file = ::open(folder.c_str(), O_TMPFILE | O_WRONLY, 0600);
  return file >= 0 && ::close(file) == 0;
}

TEST_F(FileIo, AProcessThatIsKilledWhileItWritesLeavesNothing) {
  if (!has_unnamed_files(folder_)) GTEST_SKIP() << "this file system has no O_TMPFILE";
  ASSERT_TRUE(write_file_atomically(path("x"), "old"));
  const pid_t child = ::fork();
  if (child == 0) {
    const rlimit limit{1000, 1000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    std::signal(SIGXFSZ, SIG_DFL);  // ends the process in the middle of the write
    static_cast<void>(write_file_atomically(path("x"), std::string(100000, 'n')));
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGXFSZ);
  EXPECT_EQ(read_file(path("x")), "old");
  EXPECT_THAT(names(), testing::ElementsAre("x"));
}

TEST_F(FileIo, RemovesWhatKilledWritersOfTheSameFileHaveLeft) {
  const auto leave = [&](const std::string& name) { std::ofstream(path(name)) << "half"; };
  for (const char* const left : {".x.0.tmp", ".x.1.tmp", ".x.15.tmp"}) leave(left);
  const std::vector<std::string> others{".y.0.tmp", ".x.png.0.tmp", ".x.notes.tmp", ".x..tmp",  ".x.0-.tmp",
                                        ".x.tmp",   "x.0.tmp",      ".x.0.tmp~",    ".x.-1.tmp"};
  for (const std::string& name : others) leave(name);
  fs::create_symlink(path(".y.0.tmp"), path(".x.2.tmp"));
  ASSERT_TRUE(write_file_atomically(path("x"), "new"));
  std::vector<std::string> expected = others;
  expected.insert(expected.end(), {"x", ".x.2.tmp"});
  EXPECT_THAT(names(), testing::UnorderedElementsAreArray(expected));
}

// As where the file system has no locks: what cannot be locked stays.
TEST_F(FileIo, AnyNumberOfAbandonedFilesIsNoProblem) {
  for (int number = 0; number < 1100; ++number) {
    fs::create_symlink("nowhere", path(".x." + std::to_string(number) + ".tmp"));
  }
  ASSERT_TRUE(write_file_atomically(path("x"), "new"));
  EXPECT_EQ(read_file(path("x")), "new");
  EXPECT_EQ(names().size(), 1101U);
}

// As another process, which may be on another machine, locks what it writes.
TEST_F(FileIo, LeavesWhatAnotherProcessIsWriting) {
  const std::string theirs = path(".x.0.tmp");
  const int file = ::open(theirs.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_EQ(::flock(file, LOCK_EX), 0);
  ASSERT_TRUE(write_file_atomically(path("x"), "new"));
  EXPECT_TRUE(fs::exists(theirs));
  ::close(file);
  ASSERT_TRUE(write_file_atomically(path("x"), "newer"));
  EXPECT_FALSE(fs::exists(theirs)) << "it has ended";
}

TEST_F(FileIo, ManyWritersOfOneFileDoNotDisturbEachOther) {
  std::vector<pid_t> children;
  for (int i = 0; i < 4; ++i) {
    const pid_t child = ::fork();
    if (child == 0) {
      bool all = true;
      for (int n = 0; n < 200; ++n) all = write_file_atomically(path("x"), std::string(1000, 'x')) && all;
      ::_exit(all ? 0 : 1);
    }
    children.push_back(child);
  }
  for (const pid_t child : children) {
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  }
  EXPECT_EQ(read_file(path("x")), std::string(1000, 'x'));
  EXPECT_THAT(names(), testing::ElementsAre("x"));
}

TEST_F(FileIo, AMissingFolderIsNamed) {
  for (const auto& call : {check_can_write(path("no/x.png")), write_file_atomically(path("no/x.png"), "")}) {
    ASSERT_FALSE(call);
    EXPECT_EQ(call.error().code, ErrorCode::kNotFound);
    EXPECT_EQ(call.error().message,
              "cannot write '" + path("no/x.png") + "': the folder '" + path("no") + "' does not exist");
  }
}

TEST_F(FileIo, AFolderIsNotAFile) {
  ASSERT_FALSE(check_can_write(folder_));
  EXPECT_THAT(check_can_write(folder_).error().message, HasSubstr("Is a directory"));
  ASSERT_TRUE(write_file_atomically(path("file"), ""));
  EXPECT_THAT(check_can_write(path("file/x")).error().message, HasSubstr("cannot write"));
}

TEST_F(FileIo, CheckingTouchesNothing) {
  EXPECT_TRUE(check_can_write(path("x")));
  EXPECT_THAT(names(), testing::IsEmpty());
}

// Root may write everywhere, so that root becomes nobody meanwhile.
class AsOrdinaryUser {
 public:
  explicit AsOrdinaryUser(const fs::path& folder) : before_(::geteuid()) {
    constexpr uid_t kNobody = 65534;
    if (before_ != 0) return;
    EXPECT_TRUE(::chown(folder.c_str(), kNobody, kNobody) == 0 && ::seteuid(kNobody) == 0);
  }
  ~AsOrdinaryUser() { EXPECT_EQ(::seteuid(before_), 0); }
  AsOrdinaryUser(const AsOrdinaryUser&) = delete;
  AsOrdinaryUser& operator=(const AsOrdinaryUser&) = delete;

 private:
  uid_t before_;
};

TEST_F(FileIo, MissingRightsAreAnError) {
  const AsOrdinaryUser ordinary(folder_);
  ASSERT_TRUE(write_file_atomically(path("x"), "kept"));
  fs::permissions(path("x"), fs::perms(0444));
  EXPECT_EQ(check_can_write(path("x")).error().code, ErrorCode::kPermissionDenied);
  EXPECT_EQ(write_file_atomically(path("x"), "lost").error().code, ErrorCode::kPermissionDenied);
  fs::permissions(folder_, fs::perms(0555));
  EXPECT_EQ(check_can_write(path("y")).error().message,
            "cannot write '" + path("y") + "': its folder: Permission denied");
  fs::permissions(folder_, fs::perms(0755));
  EXPECT_EQ(read_file(path("x")), "kept");
}

}  // namespace
}  // namespace tessera::core
