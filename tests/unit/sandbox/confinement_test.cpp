// SPDX-License-Identifier: Apache-2.0
// What a confined process can do, tested in child processes; and its end with the parent.
#include "core/sandbox/confinement.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sched.h>
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
#include <optional>
#include <string>

#include "core/sandbox/landlock.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/sandbox/in_child.hpp"

namespace tessera::sandbox {
namespace {

// Checks that `what`, which succeeds here, fails with this error in a confined process.
void expect_refused(const std::function<int()>& what, int error = EPERM) {
  const auto refused = [&](bool confined) {
    if (!confined) return 2;
    errno = 0;
    return what() < 0 && errno == error ? 0 : 1;
  };
  EXPECT_EQ(status_of([&] { return what() < 0 ? 1 : 0; }), 0) << "it must work without confinement";
  EXPECT_EQ(status_of([&] { return refused(confine({}).has_value()); }), 0);
}

class Confined : public testing::Test {
 protected:
  void SetUp() override {
    if (kIsSanitized) GTEST_SKIP() << "sanitizers need what confinement takes away";
    write_file(file_, "its own");
  }

  TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_.path() / "file";
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

TEST_F(Confined, AffectsNoOtherProcess) {
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

TEST_F(Confined, OpensNoFile) {
  expect_refused([&] { return open(file_.c_str(), O_RDONLY); });
  expect_refused([] { return open("/proc/self/status", O_RDONLY); });
}

TEST_F(Confined, ReadsAndWritesWhatIsOpen) {
  const int in = open(file_.c_str(), O_RDONLY),
            out = open((folder_.path() / "out").c_str(), O_RDWR | O_CREAT, 0600);
  EXPECT_EQ(status_of([&] {
              if (dup2(in, STDIN_FILENO) < 0 || dup2(out, STDOUT_FILENO) < 0 || !confine({})) return 2;
              char text[8] = {};
              return read(STDIN_FILENO, text, 7) == 7 && write(STDOUT_FILENO, text, 7) == 7 ? 0 : 1;
            }),
            0);
  EXPECT_EQ(read_file(folder_.path() / "out"), "its own");
  close(in);
  close(out);
}

TEST_F(Confined, InheritsNothing) {
  const int file = open(file_.c_str(), O_RDONLY);
  const int inherited = fcntl(file, F_DUPFD, 10);
  EXPECT_EQ(status_of([&] {
              char byte = 0;
              return confine({}) && read(inherited, &byte, 1) < 0 && errno == EBADF ? 0 : 1;
            }),
            0);
  close(file);
  close(inherited);
}

// A confined child that waits until this object ends, so that /proc shows it. It may begin as another user.
class Waiting {
 public:
  explicit Waiting(std::optional<uid_t> user = {}) {
    EXPECT_EQ(pipe(to_child_), 0);
    EXPECT_EQ(pipe(to_parent_), 0);
    pid_ = fork();
    if (pid_ == 0) {
      close(to_child_[1]);
      dup2(to_child_[0], STDIN_FILENO);
      dup2(to_parent_[1], STDOUT_FILENO);
      char byte = 0;
      if (user && (setgid(*user) != 0 || setuid(*user) != 0)) _exit(2);
      const bool told = confine({}).has_value() && write(STDOUT_FILENO, &byte, 1) == 1;
      _exit(told && read(STDIN_FILENO, &byte, 1) == 0 ? 0 : 1);
    }
    close(to_child_[0]);
    close(to_parent_[1]);
    char byte = 0;
    EXPECT_EQ(read(to_parent_[0], &byte, 1), 1);
  }
  ~Waiting() {
    close(to_child_[1]);
    close(to_parent_[0]);
    int status = 0;
    EXPECT_EQ(waitpid(pid_, &status, 0), pid_);
    EXPECT_EQ(status, 0);
  }
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;

  std::string field(const std::string& name) const { return status_field(pid_, name); }

 private:
  int to_child_[2], to_parent_[2];
  pid_t pid_;
};

TEST_F(Confined, HasNoRightsAndGainsNone) {
  const Waiting process;
  EXPECT_EQ(process.field("NoNewPrivs"), "1");
  EXPECT_EQ(process.field("Seccomp"), "2");
  for (const char* set : {"CapInh", "CapPrm", "CapEff", "CapAmb"})
    EXPECT_EQ(process.field(set), "0000000000000000") << set;
}

TEST_F(Confined, OfRootIsNobody) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become somebody else";
  const Waiting process;
  EXPECT_EQ(process.field("Uid"), "65534\t65534\t65534\t65534");
  EXPECT_EQ(process.field("Gid"), "65534\t65534\t65534\t65534");
  EXPECT_EQ(process.field("Groups"), "");
}

TEST_F(Confined, OfAnotherUserStaysThat) {
  const std::string user = std::to_string(geteuid() == 0 ? 1000 : geteuid());
  const Waiting process(geteuid() == 0 ? std::optional<uid_t>(1000) : std::nullopt);
  EXPECT_EQ(process.field("Uid"), user + "\t" + user + "\t" + user + "\t" + user);
  EXPECT_EQ(process.field("CapPrm"), "0000000000000000");
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

// Each of the layers does without the other.
TEST_F(Confined, OpensNoFileByLandlockAlone) {
  const int status = status_of([&] {
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return 2;
    const auto missing = deny_files();
    if (!missing) return 3;
    if (*missing) return 4;
    return open(file_.c_str(), O_RDONLY) < 0 && errno == EACCES ? 0 : 1;
  });
  if (status == 4 << 8) GTEST_SKIP() << "this kernel has no Landlock";
  EXPECT_EQ(status, 0);
}

TEST_F(Confined, EndsWithItsClient) {
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
      const bool told =
          confine({.parent = self}).has_value() && write(STDOUT_FILENO, &pid, sizeof pid) == sizeof pid;
      while (told) sched_yield();
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
}  // namespace tessera::sandbox
