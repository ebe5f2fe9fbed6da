// SPDX-License-Identifier: Apache-2.0
// Confinement of validators, tested in child processes; and their end with the parent.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <new>

#include "server/validator/confinement.hpp"
#include "server/validator/visible_files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace tessera::validator {
namespace {

// The wait status of a child process that exits with the result of `what`.
int status_of(const std::function<int()>& what) {
  const pid_t pid = fork();
  if (pid == 0) _exit(what());
  int status = 0;
  EXPECT_EQ(waitpid(pid, &status, 0), pid);
  return status;
}

// Checks that `what`, which succeeds here, fails with this error in a confined process.
void expect_refused(const std::function<int()>& what, int error = EPERM) {
  const auto refused = [&](const core::Status& confined) {
    if (!confined) return 2;
    errno = 0;
    return what() < 0 && errno == error ? 0 : 1;
  };
  EXPECT_EQ(status_of([&] { return what() < 0 ? 1 : 0; }), 0) << "it must work without confinement";
  EXPECT_EQ(status_of([&] { return refused(confine({})); }), 0);
}

class Confined : public testing::Test {
 protected:
  void SetUp() override {
    if (kIsSanitized) GTEST_SKIP() << "sanitizers need what confinement takes away";
    write_file(file_, "its own");
    write_file(other_, "of others");
  }

  TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_.path() / "file", other_ = folder_.path() / "other";
};

TEST_F(Confined, StartsNoProcess) {
  expect_refused([] {
    const pid_t pid = fork();
    if (pid == 0) _exit(0);
    return pid;
  });
}

TEST_F(Confined, StartsNoProgram) {
  expect_refused([] { return execl("/bin/true", "true", nullptr); });
}

TEST_F(Confined, ReachesNoNetwork) {
  expect_refused([] { return socket(AF_INET, SOCK_STREAM, 0); });
}

TEST_F(Confined, HarmsNoOtherProcess) {
  const pid_t parent = getpid();
  expect_refused([&] { return kill(parent, 0); });
  rlimit limit{};
  expect_refused([&] { return prlimit(parent, RLIMIT_CORE, nullptr, &limit); });
}

TEST_F(Confined, MakesAndChangesNoFile) {
  expect_refused([&] { return open((folder_.path() / "new").c_str(), O_WRONLY | O_CREAT, 0600); });
  expect_refused([&] { return open(file_.c_str(), O_RDWR); });
  expect_refused([&] { return rename(file_.c_str(), file_.c_str()); });
  expect_refused([&] { return chmod(file_.c_str(), 0600); });
  expect_refused(
      [&] { return mkdir((folder_.path() / "folder").c_str(), 0700) == 0 || errno == EEXIST ? 0 : -1; });
}

TEST_F(Confined, StillReads) {
  EXPECT_EQ(status_of([&] { return confine({}) && open(file_.c_str(), O_RDONLY) >= 0 ? 0 : 1; }), 0);
}

TEST_F(Confined, HoldsFewFiles) {
  EXPECT_EQ(status_of([&] {
              if (!confine({})) return 2;
              for (int i = 0; i < 20; ++i)
                if (open(file_.c_str(), O_RDONLY) < 0) return errno == EMFILE ? 0 : 1;
              return 1;
            }),
            0);
}

TEST_F(Confined, InheritsNothing) {
  const int inherited = open(other_.c_str(), O_RDONLY);
  EXPECT_EQ(status_of([&] { return confine({}) && fcntl(inherited, F_GETFD) < 0 && errno == EBADF ? 0 : 1; }),
            0);
  close(inherited);
}

TEST_F(Confined, GainsNoRightsAndCannotBeTraced) {
  EXPECT_EQ(status_of([] {
              if (!confine({})) return 2;
              return prctl(PR_GET_NO_NEW_PRIVS, 0, 0, 0, 0) == 1 && prctl(PR_GET_DUMPABLE) == 0 ? 0 : 1;
            }),
            0);
}

// The address space of this process in MiB.
std::uint64_t taken_mib() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) >> 20;
}

TEST_F(Confined, HasSoMuchMemory) {
  const auto allocates = [](std::uint64_t mib) {
    return status_of([mib] {
      if (!confine({.memory_mib = taken_mib() + 768})) return 2;
      const std::unique_ptr<char[]> memory(new (std::nothrow) char[mib << 20]);
      return memory ? 0 : 1;
    });
  };
  EXPECT_EQ(allocates(256), 0);
  EXPECT_EQ(allocates(4096), 1 << 8);
}

// Under `ulimit -v` of a coordinator, which an unprivileged user cannot raise.
TEST_F(Confined, HasNoMoreThanItsParentMayHave) {
  EXPECT_EQ(status_of([] {
              const rlim_t bytes = (taken_mib() + 768) << 20;
              const rlimit most{bytes, bytes};
              if (setrlimit(RLIMIT_AS, &most) != 0) return 2;
              if (geteuid() == 0 && setuid(65534) != 0) return 3;
              if (!confine({.memory_mib = std::uint64_t{1} << 20})) return 4;
              rlimit left{};
              return getrlimit(RLIMIT_AS, &left) == 0 && left.rlim_cur == bytes ? 0 : 5;
            }),
            0);
}

TEST_F(Confined, HasSoMuchTime) {
  const int status = status_of([] {
    if (!confine({.cpu_seconds = 1})) return 2;
    for (volatile bool spinning = true; spinning;) {
    }
    return 1;
  });
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGXCPU);
}

TEST_F(Confined, SeesOnlyItsFiles) {
  const auto reads = [&](const std::filesystem::path& path) {
    return status_of([&] {
      if (!confine({}) || !see_only({file_, folder_.path() / "missing"})) return 2;
      if (open(path.c_str(), O_RDONLY) >= 0) return 0;
      return errno == EACCES ? 1 : 3;
    });
  };
  EXPECT_EQ(reads(file_), 0);
  const int of_other = reads(other_);
  if (of_other == 0) GTEST_SKIP() << "this kernel has no Landlock";
  EXPECT_EQ(of_other, 1 << 8);
  EXPECT_EQ(reads("/proc/self/status"), 1 << 8);
}

TEST_F(Confined, IsForNobodyWhoHasGone) {
  EXPECT_EQ(status_of([] { return confine({.parent = 1'000'000'000}) ? 1 : 0; }), 0);
}

// A parent that is killed takes its validator along, even one that hangs.
TEST_F(Confined, EndsWithItsParent) {
  ASSERT_EQ(prctl(PR_SET_CHILD_SUBREAPER, 1), 0);  // orphans of this process are reparented to it
  int from_orphan[2];
  ASSERT_EQ(pipe(from_orphan), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    const pid_t self = getpid();
    const pid_t child = fork();
    if (child == 0) {
      dup2(from_orphan[1], STDOUT_FILENO);
      const pid_t pid = getpid();
      const bool told = confine({.parent = self}) && write(STDOUT_FILENO, &pid, sizeof pid) == sizeof pid;
      while (told) pause();
      _exit(1);
    }
    while (true) pause();
  }
  close(from_orphan[1]);
  pid_t orphan = 0;
  ASSERT_EQ(read(from_orphan[0], &orphan, sizeof orphan), ssize_t{sizeof orphan});
  kill(parent, SIGKILL);
  int status = 0;
  EXPECT_EQ(waitpid(parent, &status, 0), parent);
  EXPECT_EQ(waitpid(orphan, &status, 0), orphan);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
  close(from_orphan[0]);
  prctl(PR_SET_CHILD_SUBREAPER, 0);
}

}  // namespace
}  // namespace tessera::validator
