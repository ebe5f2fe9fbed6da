// SPDX-License-Identifier: Apache-2.0
// A program that this process starts, whose output goes to a file, and that never outlives it. Not
// thread-safe: start and destroy children in the main thread, whose end the kernel takes for that of the
// process.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::client {

class ChildProcess {
 public:
  // NOT_FOUND: there is no executable at this path. The child is in a process group of its own, so that
  // Ctrl-C reaches this process alone, and is killed if this process dies.
  static core::Result<ChildProcess> start(const std::string& program, std::vector<std::string> arguments,
                                          const std::string& log);
  // Ends the child: SIGTERM, and SIGKILL if it takes too long.
  ~ChildProcess();
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;

  bool is_running();
  // The rest of the first line of its output that begins with `begin`, once there is one. UNAVAILABLE, with
  // the end of its output: it has ended, or there is no such line in time. CANCELLED: interrupted().
  core::Result<std::string> wait_for_line(const std::string& begin, std::chrono::seconds timeout);

 private:
  ChildProcess(pid_t pid, std::string program, std::string log)
      : pid_(pid), program_(std::move(program)), log_(std::move(log)) {}
  core::Error explain(const std::string& what) const;

  pid_t pid_;  // 0 if it was waited for
  std::string program_, log_;
};

}  // namespace tessera::client
