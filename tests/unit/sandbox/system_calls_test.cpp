// SPDX-License-Identifier: Apache-2.0
// The system calls of a confined process, by what happens to it.
#include "core/sandbox/system_calls.hpp"

#include <gtest/gtest.h>
#include <linux/landlock.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "core/sandbox/confinement.hpp"
#include "tests/unit/sandbox/in_child.hpp"

namespace tessera::sandbox {
namespace {

// Exit statuses of a confined child that has made a call.
constexpr int kCannotConfine = 2, kDone = 3, kRefused = 4, kUnknown = 5, kOtherError = 6;

int outcome_of(long result) {
  if (result >= 0) return kDone;
  return errno == EPERM ? kRefused : errno == ENOSYS ? kUnknown : kOtherError;
}

// The wait status of a confined process that makes this call with arguments of 0 or these.
int confined(long call, std::array<long, 6> a = {}) {
  return status_of([&] {
    if (!confine({})) return kCannotConfine;
    return outcome_of(syscall(call, a[0], a[1], a[2], a[3], a[4], a[5]));
  });
}

bool was_ended(int status) {
  return WIFSIGNALED(status) && WTERMSIG(status) == SIGSYS;
}

struct Call {
  const char* name;
  long number;
};

class SystemCalls : public testing::Test {
 protected:
  void SetUp() override {
    if (kIsSanitized) GTEST_SKIP() << "sanitizers need what the filter takes away";
  }
};

TEST_F(SystemCalls, ThatNothingNeedsAreRefused) {
  const Call refused[] = {{"socket", SYS_socket},
                          {"socketpair", SYS_socketpair},
                          {"connect", SYS_connect},
                          {"sendto", SYS_sendto},
                          {"sendmsg", SYS_sendmsg},
                          {"execve", SYS_execve},
                          {"execveat", SYS_execveat},
                          {"clone", SYS_clone},
                          {"kill", SYS_kill},
                          {"tkill", SYS_tkill},
                          {"pidfd_open", SYS_pidfd_open},
                          {"openat", SYS_openat},
                          {"newfstatat", SYS_newfstatat},
                          {"readlinkat", SYS_readlinkat},
                          {"getdents64", SYS_getdents64},
                          {"unlinkat", SYS_unlinkat},
                          {"ioctl", SYS_ioctl},
                          {"fcntl", SYS_fcntl},
                          {"dup", SYS_dup},
                          {"pipe2", SYS_pipe2},
                          {"mq_open", SYS_mq_open},
                          {"shmget", SYS_shmget},
                          {"msgget", SYS_msgget},
                          {"semget", SYS_semget},
                          {"memfd_create", SYS_memfd_create},
                          {"io_submit", SYS_io_submit},
                          {"prctl", SYS_prctl},
                          {"seccomp", SYS_seccomp},
                          {"setrlimit", SYS_setrlimit},
                          {"setpriority", SYS_setpriority},
                          {"inotify_init1", SYS_inotify_init1},
                          {"timer_create", SYS_timer_create},
                          {"landlock_create_ruleset", SYS_landlock_create_ruleset}};
  for (const Call& call : refused) EXPECT_EQ(confined(call.number), kRefused << 8) << call.name;
}

TEST_F(SystemCalls, OfAttacksEndTheProcess) {
  const Call deadly[] = {{"ptrace", SYS_ptrace},
                         {"process_vm_readv", SYS_process_vm_readv},
                         {"io_uring_setup", SYS_io_uring_setup},
                         {"bpf", SYS_bpf},
                         {"userfaultfd", SYS_userfaultfd},
                         {"perf_event_open", SYS_perf_event_open},
                         {"unshare", SYS_unshare},
                         {"setns", SYS_setns},
                         {"mount", SYS_mount},
                         {"fsopen", SYS_fsopen},
                         {"move_mount", SYS_move_mount},
                         {"open_tree", SYS_open_tree},
                         {"chroot", SYS_chroot},
                         {"keyctl", SYS_keyctl},
                         {"init_module", SYS_init_module},
                         {"setuid", SYS_setuid},
                         {"setresuid", SYS_setresuid},
                         {"capset", SYS_capset}};
  for (const Call& call : deadly) EXPECT_TRUE(was_ended(confined(call.number))) << call.name;
}

// So that a later C library makes the older call that it knows.
TEST_F(SystemCalls, OfNewerKernelsAreUnknown) {
  const Call unknown[] = {{"clone3", SYS_clone3},
                          {"statx", SYS_statx},
                          {"openat2", SYS_openat2},
                          {"futex_waitv", 449},
                          {"none", 999}};
  for (const Call& call : unknown) EXPECT_EQ(confined(call.number), kUnknown << 8) << call.name;
}

TEST_F(SystemCalls, MakeNoMemoryExecutable) {
  constexpr long kPage = 4096;
  const std::array<long, 6> map{0, kPage, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0};
  EXPECT_EQ(confined(SYS_mmap, map), kDone << 8);
  std::array<long, 6> executable = map;
  executable[2] |= PROT_EXEC;
  EXPECT_EQ(confined(SYS_mmap, executable), kRefused << 8);
  EXPECT_EQ(status_of([] {
              if (!confine({})) return kCannotConfine;
              void* const page = mmap(nullptr, kPage, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
              if (mprotect(page, kPage, PROT_READ | PROT_WRITE) != 0) return kOtherError;
              return outcome_of(mprotect(page, kPage, PROT_READ | PROT_EXEC));
            }),
            kRefused << 8);
}

TEST_F(SystemCalls, ReachNoOtherProcess) {
  const pid_t other = getpid();
  std::array<std::uint64_t, 2> limit{};
  const auto at = reinterpret_cast<long>(limit.data());
  EXPECT_EQ(confined(SYS_prlimit64, {0, 0, 0, at}), kDone << 8);
  EXPECT_EQ(confined(SYS_prlimit64, {other, 0, 0, at}), kRefused << 8);
  EXPECT_EQ(confined(SYS_prlimit64, {0, 0, at, 0}), kRefused << 8) << "nor change a limit";
  EXPECT_EQ(confined(SYS_tgkill, {other, other, 0}), kRefused << 8);
}

#ifdef __x86_64__

TEST_F(SystemCalls, OfX32EndTheProcess) {
  constexpr long kX32 = 0x40000000;
  EXPECT_TRUE(was_ended(confined(kX32 | SYS_getpid)));
  EXPECT_TRUE(was_ended(confined(kX32 | SYS_read)));
  EXPECT_TRUE(was_ended(confined(-1)));
}

int call_of_32_bits() {
  constexpr long kGetpid = 20;
  long result = kGetpid;
  asm volatile("int $0x80" : "+a"(result) : : "memory");
  return result > 0 ? 0 : 1;
}

TEST_F(SystemCalls, Of32BitsEndTheProcess) {
  if (status_of(call_of_32_bits) != 0) GTEST_SKIP() << "this kernel has no 32-bit system calls";
  EXPECT_TRUE(was_ended(status_of([] { return confine({}) ? call_of_32_bits() : kCannotConfine; })));
}

#endif

TEST_F(SystemCalls, SufficeToComputeAndToFail) {
  EXPECT_EQ(status_of([] {
              if (!confine({})) return kCannotConfine;
              std::vector<std::string> texts(100'000, std::string(100, 'x'));  // by brk() and mmap()
              for (std::string& text : texts) text.resize(1000);
              return std::thread::hardware_concurrency() > 0 ? 0 : 1;
            }),
            0);
  const int aborted = status_of([]() -> int {
    if (!confine({})) return kCannotConfine;
    std::abort();
  });
  EXPECT_TRUE(WIFSIGNALED(aborted) && WTERMSIG(aborted) == SIGABRT);
}

}  // namespace
}  // namespace tessera::sandbox
