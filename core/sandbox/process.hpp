// SPDX-License-Identifier: Apache-2.0
// Runs programs that confine themselves (confinement.hpp): starts one, sends it the files that it asks for,
// and waits for its end. Thread-safe.
#pragma once

#include <chrono>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/open_file.hpp"
#include "core/sandbox/file_channel.hpp"

namespace tessera::sandbox {

struct Program {
  std::string path;
  std::vector<std::string> arguments{};  // besides the id of this process
  std::chrono::milliseconds timeout{};
  std::stop_token stop{};  // a stop request kills the process
};

// Its standard input and output, and the files that it may ask for.
struct Streams {
  const core::OpenFile& in;
  const core::OpenFile& out;
  OpenNumbered open_file;
};

struct Ending {
  enum class Cause { kByItself, kTimeout, kStopRequest };
  Cause cause = Cause::kByItself;
  int status = 0;         // as from waitpid()
  std::string message{};  // the start of what it wrote to stderr, printable

  bool succeeded() const;  // by itself, with status 0
  bool by_signal(int signal) const;
};

// Blocks until the process has ended. INTERNAL if it cannot be started or waited for. Throws what `open_file`
// throws, with the process killed.
core::Result<Ending> run(const Program& program, const Streams& streams);

// "NAME ended by signal 11 (Segmentation fault)", or "NAME ended with status 1: its message".
std::string describe(const Ending& ending, const std::string& name);

// The path of a program in the folder of this process's own executable.
std::string path_beside_this(const std::string& name);

// FAILED_PRECONDITION if there is no executable at this path, which is one of the program `name`. `option`
// names another.
core::Status check_program(const std::string& path, const std::string& name, const std::string& option);

}  // namespace tessera::sandbox
