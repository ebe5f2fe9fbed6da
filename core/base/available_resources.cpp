// SPDX-License-Identifier: Apache-2.0
#include "core/base/available_resources.hpp"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>
#include <system_error>
#include <vector>

// Of OpenMP, if the program links it.
extern "C" __attribute__((weak)) int omp_get_num_procs();

namespace tessera::core {
namespace {

namespace fs = std::filesystem;

constexpr unsigned kMaxThreads = 1024;
constexpr int kMaxProcessors = 1 << 16;

// The control groups of one controller of v1 ("cpu", "memory"), or of v2.
struct Hierarchy {
  std::string controller;  // empty: v2
  bool is_v2() const { return controller.empty(); }
};

bool is_in_list(const std::string& list, const std::string& word) {
  std::istringstream words(list);
  for (std::string next; std::getline(words, next, ',');)
    if (next == word) return true;
  return false;
}

// The group of this process, by proc/self/cgroup: lines of "NUMBER:CONTROLLERS:PATH", see cgroups(7).
std::optional<fs::path> group_in(const Hierarchy& hierarchy, const fs::path& root) {
  std::ifstream file(root / "proc/self/cgroup");
  for (std::string line; std::getline(file, line);) {
    const std::size_t first = line.find(':');
    const std::size_t second = first == std::string::npos ? first : line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const bool matches =
        hierarchy.is_v2() ? controllers.empty() : is_in_list(controllers, hierarchy.controller);
    if (matches) return line.substr(second + 1);
  }
  return std::nullopt;
}

struct Mount {
  fs::path group;   // that is mounted
  fs::path folder;  // where
};

// By proc/self/mountinfo: "ID PARENT DEVICE GROUP FOLDER OPTIONS... - TYPE SOURCE OPTIONS", see proc(5).
std::optional<Mount> mount_of(const Hierarchy& hierarchy, const fs::path& root) {
  std::ifstream file(root / "proc/self/mountinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t dash = line.find(" - ");
    if (dash == std::string::npos) continue;
    std::istringstream before(line.substr(0, dash)), after(line.substr(dash + 3));
    std::string id, parent, device, group, folder, type, source, options;
    before >> id >> parent >> device >> group >> folder;
    after >> type >> source >> options;
    const bool matches =
        hierarchy.is_v2() ? type == "cgroup2" : type == "cgroup" && is_in_list(options, hierarchy.controller);
    if (matches) return Mount{group, folder};
  }
  return std::nullopt;
}

// The folders of the group and of all groups that contain it, as far as they are mounted: each may limit it.
std::vector<fs::path> group_folders(const Hierarchy& hierarchy, const fs::path& root) {
  const auto group = group_in(hierarchy, root);
  const auto mount = mount_of(hierarchy, root);
  if (!group || !mount) return {};
  const fs::path top = root / mount->folder.relative_path();
  std::vector<fs::path> folders{top};
  // A container may see its own group mounted, and a path from outside.
  const fs::path inside = group->lexically_relative(mount->group);
  if (inside.empty() || *inside.begin() == ".." || *inside.begin() == ".") return folders;
  for (const fs::path& part : inside) folders.push_back(folders.back() / part);
  return folders;
}

// The first number in a file; empty if there is none, as in "max", or if it is negative.
std::optional<std::uint64_t> number_in(const fs::path& path) {
  std::ifstream file(path);
  std::int64_t number = 0;
  if (!(file >> number) || number < 0) return std::nullopt;
  return static_cast<std::uint64_t>(number);
}

struct Quota {
  std::optional<std::uint64_t> time, period;
};

Quota quota_of(const Hierarchy& hierarchy, const fs::path& folder) {
  if (!hierarchy.is_v2())
    return {number_in(folder / "cpu.cfs_quota_us"), number_in(folder / "cpu.cfs_period_us")};
  std::ifstream file(folder / "cpu.max");
  std::uint64_t time = 0, period = 0;
  if (!(file >> time >> period)) return {};
  return {time, period};
}

unsigned quota_threads(const fs::path& root) {
  std::uint64_t least = kMaxThreads;
  for (const Hierarchy& hierarchy : {Hierarchy{}, Hierarchy{"cpu"}}) {
    for (const fs::path& folder : group_folders(hierarchy, root)) {
      const Quota quota = quota_of(hierarchy, folder);
      if (quota.time.value_or(0) == 0 || quota.period.value_or(0) == 0) continue;
      least = std::min(least, (*quota.time + *quota.period - 1) / *quota.period);
    }
  }
  return static_cast<unsigned>(least);
}

// A positive number before the end or a comma.
std::optional<unsigned> positive_number(const std::string& text) {
  unsigned number = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, wrong] = std::from_chars(text.data(), end, number);
  if (wrong != std::errc() || number == 0 || (rest != end && *rest != ',')) return std::nullopt;
  return number;
}

// A batch system knows this process; OMP_NUM_THREADS often stands in a user's profile for all of them.
std::optional<unsigned> wanted_threads(const ResourceSources& sources) {
  for (const char* const name : {"SLURM_CPUS_PER_TASK", "OMP_NUM_THREADS"})
    if (const auto number = positive_number(sources.variable(name))) return number;
  return std::nullopt;
}

// Where OMP_PROC_BIND or OMP_PLACES is set, OpenMP has bound the first thread to one place before main(), and
// knows the mask before that.
unsigned processors_of_mask() {
  cpu_set_t* const mask = CPU_ALLOC(kMaxProcessors);
  if (mask == nullptr) return 1;
  const std::size_t bytes = CPU_ALLOC_SIZE(kMaxProcessors);
  CPU_ZERO_S(bytes, mask);
  const int count = sched_getaffinity(0, bytes, mask) == 0 ? CPU_COUNT_S(bytes, mask) : 1;
  CPU_FREE(mask);
  const int before_binding = omp_get_num_procs == nullptr ? 1 : omp_get_num_procs();
  return static_cast<unsigned>(std::max({count, before_binding, 1}));
}

}  // namespace

ResourceSources this_process() {
  return {.root = "/",
          .affinity_processors = processors_of_mask(),
          .machine_bytes = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
                           static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)),
          .variable = [](const char* name) {
            const char* const value = std::getenv(name);
            return std::string(value == nullptr ? "" : value);
          }};
}

unsigned available_threads(const ResourceSources& sources) {
  const unsigned granted = std::min(quota_threads(sources.root), sources.affinity_processors);
  return std::clamp(std::min(granted, wanted_threads(sources).value_or(granted)), 1u, kMaxThreads);
}

std::uint64_t available_memory_bytes(const ResourceSources& sources) {
  std::uint64_t least = sources.machine_bytes;
  for (const Hierarchy& hierarchy : {Hierarchy{}, Hierarchy{"memory"}}) {
    const char* const file = hierarchy.is_v2() ? "memory.max" : "memory.limit_in_bytes";
    for (const fs::path& folder : group_folders(hierarchy, sources.root))
      least = std::min(least, number_in(folder / file).value_or(least));
  }
  return least;
}

}  // namespace tessera::core
