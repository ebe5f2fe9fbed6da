// SPDX-License-Identifier: Apache-2.0
#include "core/sandbox/system_calls.hpp"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera::sandbox {

namespace {

#if defined(__x86_64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#else
#error "the numbers of system calls are those of x86-64 and AArch64"
#endif

// What loading a scene makes, found by tracing it for files of all formats, and what the C library may do
// instead of it where the vDSO or a cache of its own does not serve.
constexpr std::array kAllowed{
    // Memory. Those that could make it executable are below.
    SYS_brk, SYS_munmap, SYS_mremap, SYS_madvise,
    // Open files, and the socket over which more of them come (file_channel.hpp).
    SYS_read, SYS_readv, SYS_pread64, SYS_write, SYS_writev, SYS_pwrite64, SYS_lseek, SYS_close, SYS_recvmsg,
    // Time, random numbers, the size of the machine, locks.
    SYS_clock_gettime, SYS_clock_getres, SYS_gettimeofday, SYS_getrandom, SYS_sysinfo, SYS_sched_getaffinity,
    SYS_sched_yield, SYS_futex,
    // Signals to itself, as by abort(), and the end.
    SYS_getpid, SYS_gettid, SYS_rt_sigaction, SYS_rt_sigprocmask, SYS_rt_sigreturn, SYS_restart_syscall,
    SYS_exit, SYS_exit_group};

// The C library then makes an older call.
constexpr std::array kUnknown{SYS_clone3, SYS_statx, SYS_openat2, SYS_faccessat2};
// Calls above this number are newer than Landlock. Programs that make them can do without.
constexpr std::uint32_t kNewestNumber = SYS_landlock_restrict_self;

// What nobody tries who loads a scene.
constexpr std::array kDeadly{
    // Other processes, and programs in the kernel.
    SYS_ptrace, SYS_process_vm_readv, SYS_process_vm_writev, SYS_process_madvise, SYS_pidfd_getfd, SYS_kcmp,
    SYS_bpf, SYS_perf_event_open, SYS_userfaultfd, SYS_io_uring_setup, SYS_io_uring_enter,
    SYS_io_uring_register,
    // Namespaces and mounts.
    SYS_unshare, SYS_setns, SYS_mount, SYS_umount2, SYS_pivot_root, SYS_chroot, SYS_fsopen, SYS_fsconfig,
    SYS_fsmount, SYS_fspick, SYS_move_mount, SYS_open_tree, SYS_mount_setattr, SYS_open_by_handle_at,
    // Keys, kernels and the machine.
    SYS_keyctl, SYS_add_key, SYS_request_key, SYS_init_module, SYS_finit_module, SYS_delete_module,
    SYS_kexec_load, SYS_kexec_file_load, SYS_reboot, SYS_swapon, SYS_swapoff, SYS_acct, SYS_quotactl,
    SYS_settimeofday, SYS_clock_settime, SYS_sethostname, SYS_setdomainname,
#ifdef __x86_64__
    SYS_iopl, SYS_ioperm, SYS_modify_ldt,
#endif
    // The user.
    SYS_setuid, SYS_setgid, SYS_setreuid, SYS_setregid, SYS_setresuid, SYS_setresgid, SYS_setgroups,
    SYS_setfsuid, SYS_setfsgid, SYS_capset};

constexpr std::uint32_t kAllow = SECCOMP_RET_ALLOW, kRefuse = SECCOMP_RET_ERRNO | EPERM,
                        kPretendUnknown = SECCOMP_RET_ERRNO | ENOSYS, kEnd = SECCOMP_RET_KILL_PROCESS;

using Filter = std::vector<sock_filter>;

sock_filter load(std::size_t offset) {
  return BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset));
}
sock_filter answer(std::uint32_t what) {
  return BPF_STMT(BPF_RET | BPF_K, what);
}
// Skips so many of the following instructions unless the loaded value is this one.
sock_filter unless_equal(long value, std::size_t skipped) {
  return BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(value), 0,
                  static_cast<std::uint8_t>(skipped));
}

// The offset of the lower half of a system call's argument. Both architectures are little-endian.
constexpr std::size_t lower(std::size_t argument) {
  return offsetof(seccomp_data, args) + argument * sizeof(std::uint64_t);
}
constexpr std::size_t upper(std::size_t argument) {
  return lower(argument) + sizeof(std::uint32_t);
}

template <typename Calls>
void answer_all(Filter& filter, const Calls& calls, std::uint32_t what) {
  for (const long call : calls) {
    filter.push_back(unless_equal(call, 1));
    filter.push_back(answer(what));
  }
}

// Refuses the call if its argument has any of these bits.
void allow_without(Filter& filter, long call, std::size_t argument, std::uint32_t bits) {
  filter.push_back(unless_equal(call, 4));
  filter.push_back(load(lower(argument)));
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, bits, 0, 1));
  filter.push_back(answer(kRefuse));
  filter.push_back(answer(kAllow));
}

struct Condition {
  std::size_t offset;  // of half an argument
  std::uint32_t value;
};

// Refuses the call unless all conditions hold.
void allow_if(Filter& filter, long call, const std::vector<Condition>& conditions) {
  filter.push_back(unless_equal(call, 2 * conditions.size() + 2));
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    const std::size_t left = conditions.size() - i - 1;
    filter.push_back(load(conditions[i].offset));
    filter.push_back(unless_equal(static_cast<long>(conditions[i].value), 2 * left + 1));
  }
  filter.push_back(answer(kAllow));
  filter.push_back(answer(kRefuse));
}

// Ends the process for calls with the numbers of another architecture.
void require_own_numbers(Filter& filter) {
  filter.push_back(load(offsetof(seccomp_data, arch)));
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kArchitecture, 1, 0));
  filter.push_back(answer(kEnd));
  filter.push_back(load(offsetof(seccomp_data, nr)));
#ifdef __x86_64__
  constexpr std::uint32_t kFirstOfX32 = 0x40000000;  // its architecture is that of x86-64
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, kFirstOfX32, 0, 1));
  filter.push_back(answer(kEnd));
#endif
}

Filter make_filter() {
  Filter filter;
  require_own_numbers(filter);
  answer_all(filter, kAllowed, kAllow);
  allow_without(filter, SYS_mmap, 2, PROT_EXEC);
  allow_without(filter, SYS_mprotect, 2, PROT_EXEC);
  allow_if(filter, SYS_tgkill, {{lower(0), static_cast<std::uint32_t>(getpid())}});  // abort() needs it
  // Reads the limits of this process.
  allow_if(filter, SYS_prlimit64, {{lower(0), 0}, {lower(2), 0}, {upper(2), 0}});
  answer_all(filter, kDeadly, kEnd);
  answer_all(filter, kUnknown, kPretendUnknown);
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JGT | BPF_K, kNewestNumber, 0, 1));
  filter.push_back(answer(kPretendUnknown));
  filter.push_back(answer(kRefuse));
  return filter;
}

}  // namespace

core::Result<Missing> allow_few_system_calls() {
  Filter filter = make_filter();
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  if (prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0) return Missing();
  return missing_or_error("system call filter: it takes Linux 3.5 with seccomp", "PR_SET_SECCOMP");
}

}  // namespace tessera::sandbox
