// SPDX-License-Identifier: Apache-2.0
// How many threads and how much memory this process may use. A machine often grants a process less than it
// has: by control groups (v1 and v2), the affinity mask, a batch system, or a user's environment.
// Thread-safe.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace tessera::core {

// Where limits are looked up.
struct ResourceSources {
  std::filesystem::path root;        // the folder that contains proc/ and the mounted control groups
  unsigned affinity_processors = 1;  // in the affinity mask
  std::uint64_t machine_bytes = 0;   // of physical memory
  // An environment variable; empty if it is not set.
  std::function<std::string(const char* name)> variable;
};
ResourceSources this_process();

// What SLURM_CPUS_PER_TASK says or, without that, the first number of OMP_NUM_THREADS; at most the processor
// quota of the control groups, rounded up, and the processors of the affinity mask. Variables that are no
// positive numbers are ignored. At least 1, at most 1024.
unsigned available_threads(const ResourceSources& sources = this_process());

// The least of the machine's memory and the limits of the control groups, in bytes.
std::uint64_t available_memory_bytes(const ResourceSources& sources = this_process());

}  // namespace tessera::core
