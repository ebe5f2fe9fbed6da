// SPDX-License-Identifier: Apache-2.0
// Runs a real tessera-coordinator in its own process, and measures its resources. Not thread-safe.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::bench {

// Since the start of the process, unless a field says otherwise.
struct Usage {
  double cpu_seconds = 0;            // user and system time of all threads
  std::uint64_t resident_bytes = 0;  // at this moment
  std::uint64_t most_resident_bytes = 0;
  std::uint64_t written_bytes = 0;  // passed to the file system
};

class MeasuredCoordinator {
 public:
  struct Options {
    std::filesystem::path program;
    // The folder for its state and its log; must exist.
    std::filesystem::path folder;
    // The only core on which it may run; any if absent.
    std::optional<int> core;
    // Further options of its command line.
    std::vector<std::string> more{};
    // Whether it serves its page, on a free port.
    bool has_page = false;
  };

  // Returns when it listens. Errors end with its output.
  static core::Result<MeasuredCoordinator> start(const Options& options);
  // Stops it and waits for its end.
  ~MeasuredCoordinator();
  MeasuredCoordinator(MeasuredCoordinator&& other) noexcept;
  MeasuredCoordinator& operator=(MeasuredCoordinator&&) = delete;

  const std::string& address() const { return address_; }
  // HOST:PORT of the page; empty without one.
  const std::string& page_address() const { return page_address_; }
  Usage usage() const;

 private:
  explicit MeasuredCoordinator(pid_t pid) : pid_(pid) {}

  pid_t pid_;
  std::string address_, page_address_;
};

}  // namespace tessera::bench
