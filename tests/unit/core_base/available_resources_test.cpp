// SPDX-License-Identifier: Apache-2.0
// What a process may use, with control groups made of files.
#include "core/base/available_resources.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <filesystem>
#include <map>
#include <string>
#include <thread>

#include "tests/support/temporary_folder.hpp"

namespace tessera::core {
namespace {

constexpr std::uint64_t kGib = std::uint64_t{1} << 30;
constexpr const char* kV2 = "30 24 0:26 / /sys/fs/cgroup rw,nosuid shared:9 - cgroup2 cgroup2 rw\n";
constexpr const char* kV1 =
    "31 24 0:27 / /sys/fs/cgroup/cpu,cpuacct rw - cgroup cgroup rw,cpu,cpuacct\n"
    "32 24 0:28 / /sys/fs/cgroup/memory rw - cgroup cgroup rw,memory\n";

class AvailableResources : public testing::Test {
 protected:
  AvailableResources() {
    sources_ = {.root = folder_.path(),
                .affinity_processors = 128,
                .machine_bytes = 256 * kGib,
                .variable = [this](const char* name) { return variables_[name]; }};
  }

  void write(const std::string& path, const std::string& text) {
    std::filesystem::create_directories((folder_.path() / path).parent_path());
    write_file(folder_.path() / path, text);
  }
  void be_in(const std::string& groups, const std::string& mounts) {
    write("proc/self/cgroup", groups);
    write("proc/self/mountinfo", "24 1 8:1 / / rw - ext4 disk rw\n" + mounts);
  }
  unsigned threads() const { return available_threads(sources_); }

  TemporaryFolder folder_;
  std::map<std::string, std::string> variables_;
  ResourceSources sources_;
};

TEST_F(AvailableResources, AreTheMachineWithoutLimits) {
  EXPECT_EQ(threads(), 128u);
  EXPECT_EQ(available_memory_bytes(sources_), 256 * kGib);
}

TEST_F(AvailableResources, AreTheLeastOfAllGroupsAbove) {
  be_in("0::/slurm/job_7/step_0\n", kV2);
  write("sys/fs/cgroup/slurm/job_7/step_0/cpu.max", "max 100000\n");
  write("sys/fs/cgroup/slurm/job_7/step_0/memory.max", "max\n");
  write("sys/fs/cgroup/slurm/job_7/cpu.max", "350000 100000\n");
  write("sys/fs/cgroup/slurm/job_7/memory.max", std::to_string(8 * kGib) + "\n");
  write("sys/fs/cgroup/slurm/memory.max", std::to_string(16 * kGib) + "\n");
  EXPECT_EQ(threads(), 4u);
  EXPECT_EQ(available_memory_bytes(sources_), 8 * kGib);
}

TEST_F(AvailableResources, KnowTheFirstVersionOfControlGroups) {
  be_in("4:memory:/job\n3:cpu,cpuacct:/job\n1:name=systemd:/elsewhere\n", kV1);
  write("sys/fs/cgroup/cpu,cpuacct/cpu.cfs_quota_us", "-1\n");
  write("sys/fs/cgroup/cpu,cpuacct/cpu.cfs_period_us", "100000\n");
  write("sys/fs/cgroup/cpu,cpuacct/job/cpu.cfs_quota_us", "200000\n");
  write("sys/fs/cgroup/cpu,cpuacct/job/cpu.cfs_period_us", "100000\n");
  write("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
  write("sys/fs/cgroup/memory/job/memory.limit_in_bytes", std::to_string(2 * kGib) + "\n");
  EXPECT_EQ(threads(), 2u);
  EXPECT_EQ(available_memory_bytes(sources_), 2 * kGib);
}

TEST_F(AvailableResources, KnowContainersThatSeeTheirOwnGroupMounted) {
  be_in("0::/docker/3f2a\n", "30 24 0:26 /docker/3f2a /sys/fs/cgroup rw - cgroup2 cgroup rw\n");
  write("sys/fs/cgroup/cpu.max", "50000 100000\n");
  EXPECT_EQ(threads(), 1u);
}

TEST_F(AvailableResources, FollowTheFirstVariableThatIsSet) {
  variables_["OMP_NUM_THREADS"] = "16,2";
  EXPECT_EQ(threads(), 16u);
  variables_["SLURM_CPUS_PER_TASK"] = "4";
  EXPECT_EQ(threads(), 4u);
  variables_["OMP_NUM_THREADS"] = "1";
  EXPECT_EQ(threads(), 4u) << "a profile does not restrict what Slurm has granted";
  variables_["SLURM_CPUS_PER_TASK"] = "0";
  EXPECT_EQ(threads(), 1u);
}

TEST_F(AvailableResources, GrantNoMoreThanTheMaskAndTheGroupsWhateverVariablesSay) {
  variables_["SLURM_CPUS_PER_TASK"] = "256";
  EXPECT_EQ(threads(), 128u);
  be_in("0::/job\n", kV2);
  write("sys/fs/cgroup/job/cpu.max", "400000 100000\n");
  EXPECT_EQ(threads(), 4u);
  sources_.affinity_processors = 3;
  EXPECT_EQ(threads(), 3u);
  variables_["SLURM_CPUS_PER_TASK"] = "2";
  EXPECT_EQ(threads(), 2u);
}

TEST_F(AvailableResources, IgnoreVariablesThatAreNoPositiveNumbers) {
  for (const char* const wrong : {"0", "-3", "many", "4x", "1e3", "99999999999"}) {
    variables_["SLURM_CPUS_PER_TASK"] = wrong;
    EXPECT_EQ(threads(), 128u) << wrong;
  }
}

TEST(AvailableResourcesOfThisProcess, FollowTheAffinityMask) {
  std::thread([] {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<std::size_t>(sched_getcpu()), &one);
    ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
    EXPECT_EQ(available_threads(), 1u);
  }).join();
}

}  // namespace
}  // namespace tessera::core
