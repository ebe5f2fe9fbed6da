// SPDX-License-Identifier: Apache-2.0
#include "server/validator/system_calls.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <vector>

namespace tessera::validator {

namespace {

constexpr std::array kForbidden{
    // Processes and programs.
    SYS_fork, SYS_vfork, SYS_clone, SYS_clone3, SYS_execve, SYS_execveat, SYS_ptrace, SYS_process_vm_readv,
    SYS_process_vm_writev, SYS_process_madvise, SYS_kill, SYS_tkill, SYS_rt_sigqueueinfo,
    SYS_rt_tgsigqueueinfo, SYS_pidfd_open, SYS_pidfd_getfd, SYS_pidfd_send_signal, SYS_setpriority,
    SYS_sched_setaffinity, SYS_sched_setscheduler, SYS_migrate_pages, SYS_move_pages,
    // The network, and calls that bypass this filter.
    SYS_socket, SYS_socketpair, SYS_connect, SYS_bind, SYS_listen, SYS_sendto, SYS_sendmsg,
    SYS_io_uring_setup, SYS_bpf, SYS_userfaultfd, SYS_perf_event_open, SYS_keyctl, SYS_add_key, SYS_unshare,
    SYS_setns,
    // Changes of files. openat2 is included, since a filter cannot see its flags.
    SYS_openat2, SYS_open_by_handle_at, SYS_creat, SYS_truncate, SYS_rename, SYS_renameat, SYS_renameat2,
    SYS_unlink, SYS_unlinkat, SYS_mkdir, SYS_mkdirat, SYS_rmdir, SYS_link, SYS_linkat, SYS_symlink,
    SYS_symlinkat, SYS_mknod, SYS_mknodat, SYS_chmod, SYS_fchmod, SYS_fchmodat, SYS_chown, SYS_fchown,
    SYS_lchown, SYS_fchownat, SYS_mount, SYS_umount2, SYS_chroot, SYS_setxattr, SYS_utimensat};

constexpr std::uint32_t kAllow = SECCOMP_RET_ALLOW, kRefuse = SECCOMP_RET_ERRNO | EPERM,
                        kEnd = SECCOMP_RET_KILL_PROCESS;

sock_filter load(std::size_t offset) {
  return BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset));
}
sock_filter answer(std::uint32_t what) {
  return BPF_STMT(BPF_RET | BPF_K, what);
}
// Skips the next instruction unless the loaded value is this one.
sock_filter if_equal(std::uint32_t value) {
  return BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, 0, 1);
}

// The offset of the lower half of a system call's argument.
constexpr std::size_t argument(std::size_t index) {
  return offsetof(seccomp_data, args) + index * sizeof(std::uint64_t);
}

void refuse_writing(std::vector<sock_filter>& filter, std::uint32_t call, std::size_t flags_argument) {
  constexpr std::uint32_t kWriting = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC;
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 4));
  filter.push_back(load(argument(flags_argument)));
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, kWriting, 0, 1));
  filter.push_back(answer(kRefuse));
  filter.push_back(answer(kAllow));
}

// Refuses the call if its first argument is another process.
void refuse_for_others(std::vector<sock_filter>& filter, std::uint32_t call, std::uint32_t self) {
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 4));
  filter.push_back(load(argument(0)));
  filter.push_back(if_equal(self));
  filter.push_back(answer(kAllow));
  filter.push_back(answer(kRefuse));
}

std::vector<sock_filter> make_filter() {
  std::vector<sock_filter> filter;
  filter.push_back(load(offsetof(seccomp_data, arch)));
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, AUDIT_ARCH_X86_64, 1, 0));
  filter.push_back(answer(kEnd));
  filter.push_back(load(offsetof(seccomp_data, nr)));
  refuse_writing(filter, SYS_open, 1);
  refuse_writing(filter, SYS_openat, 2);
  refuse_for_others(filter, SYS_tgkill, static_cast<std::uint32_t>(getpid()));  // abort() needs it
  refuse_for_others(filter, SYS_prlimit64, 0);
  for (const long call : kForbidden) {
    filter.push_back(if_equal(static_cast<std::uint32_t>(call)));
    filter.push_back(answer(kRefuse));
  }
  filter.push_back(answer(kAllow));
  return filter;
}

}  // namespace

core::Status forbid_system_calls() {
  std::vector<sock_filter> filter = make_filter();
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  if (prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0 || errno == EINVAL) return {};
  return core::fail(system_error("PR_SET_SECCOMP"));
}

core::Error system_error(const char* call) {
  return {core::ErrorCode::kInternal, fmt::format("{}: {}", call, std::strerror(errno))};
}

}  // namespace tessera::validator
