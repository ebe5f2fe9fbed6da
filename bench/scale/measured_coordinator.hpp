// SPDX-License-Identifier: Apache-2.0
// A real tessera-coordinator process, and its resource use. Not thread-safe.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::bench {

// Since the process was started, unless stated otherwise.
struct Usage {
  double cpu_seconds = 0;            // in user mode and in the kernel, of all threads
  std::uint64_t resident_bytes = 0;  // now
  std::uint64_t most_resident_bytes = 0;
  std::uint64_t written_bytes = 0;  // passed to the file system
};

class MeasuredCoordinator {
 public:
  struct Options {
    std::filesystem::path program;
    // The folder of its state and log; must exist.
    std::filesystem::path folder;
    // Pins the process to this core, if present.
    std::optional<int> core;
  };

  // Returns when the coordinator listens. Errors end with its output.
  static core::Result<MeasuredCoordinator> start(const Options& options);
  // Stops the process and waits until it has exited.
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
