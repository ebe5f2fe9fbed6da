// SPDX-License-Identifier: Apache-2.0
// A real tessera-coordinator in a process of its own, and what it takes of the machine. Not thread-safe.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::bench {

// Since the process was started, except where it is said otherwise.
struct Usage {
  double cpu_seconds = 0;            // in user mode and in the kernel, of all threads
  std::uint64_t resident_bytes = 0;  // now
  std::uint64_t most_resident_bytes = 0;
  std::uint64_t written_bytes = 0;  // handed to the file system
};

class MeasuredCoordinator {
 public:
  struct Options {
    std::filesystem::path program;
    // Where it keeps its state and its log; must exist.
    std::filesystem::path folder;
    // The only core it may run on; any if absent.
    std::optional<int> core;
  };

  // Returns when it listens. Errors end with what it said.
  static core::Result<MeasuredCoordinator> start(const Options& options);
  // Stops it and waits for its end.
  ~MeasuredCoordinator();
  MeasuredCoordinator(MeasuredCoordinator&& other) noexcept;
  MeasuredCoordinator& operator=(MeasuredCoordinator&&) = delete;

  const std::string& address() const { return address_; }
  Usage usage() const;

 private:
  explicit MeasuredCoordinator(pid_t pid) : pid_(pid) {}

  pid_t pid_;
  std::string address_;
};

}  // namespace tessera::bench
