// SPDX-License-Identifier: Apache-2.0
// Runs code in child processes, which confinement cannot be taken from. For tests in processes of one thread.
#pragma once

#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>
#include <string>

namespace tessera::sandbox {

// The wait status of a child process that exits with the result of `what`.
inline int status_of(const std::function<int()>& what) {
  const pid_t pid = fork();
  if (pid == 0) _exit(what());
  int status = 0;
  EXPECT_EQ(waitpid(pid, &status, 0), pid);
  return status;
}

// The value of a field of /proc/PID/status, such as "Uid", without the space before it.
inline std::string status_field(pid_t pid, const std::string& name) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(name + ":")) {
      const std::size_t begin = line.find_first_not_of(" \t", name.size() + 1);
      return begin == std::string::npos ? "" : line.substr(begin);
    }
  return "no such field";
}

// The environment of a process as /proc tells it: each variable ends with a NUL.
inline std::string read_environment(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/environ", std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// The only child process of this one.
inline pid_t child() {
  pid_t pid = -1;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task"))
    std::ifstream(task.path() / "children") >> pid;
  return pid;
}

// Checks what /proc tells of a confined process that waits for a file.
inline void expect_confined(pid_t pid, const std::string& name) {
  EXPECT_EQ(status_field(pid, "Name"), name.substr(0, 15));
  EXPECT_EQ(status_field(pid, "Seccomp"), "2");
  EXPECT_EQ(status_field(pid, "NoNewPrivs"), "1");
  EXPECT_EQ(status_field(pid, "CapEff"), "0000000000000000");
  EXPECT_EQ(status_field(pid, "Threads"), "1");
  const std::string user = std::to_string(geteuid() == 0 ? 65534 : geteuid());
  EXPECT_EQ(status_field(pid, "Uid"), user + "\t" + user + "\t" + user + "\t" + user);
  EXPECT_EQ(read_environment(pid), std::string("OMP_NUM_THREADS=1\0", 18));
}

// From now on this system call fails with this error, or only if its first argument is this one: as on a
// kernel that does not have it. Such filters stay, whatever is installed later.
inline bool lose_call(long call, int error, std::optional<std::uint32_t> first_argument = {}) {
  std::array<sock_filter, 6> filter{
      sock_filter BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      sock_filter BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, 3),
      sock_filter BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, args)),
      sock_filter BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, first_argument.value_or(0), 0, 1),
      sock_filter BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | static_cast<std::uint32_t>(error)),
      sock_filter BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)};
  if (!first_argument) filter[3].jf = 0;
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

}  // namespace tessera::sandbox
