// SPDX-License-Identifier: Apache-2.0
// Samples that never end fail their job, and cost each affected worker a minute.
#include <gmock/gmock.h>
#include <signal.h>
#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "tests/integration/farm_processes.hpp"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::Not;

// A scene within all limits: a room of mirrors that a ray leaves after 1024 reflections, each at a million
// coincident spheres. One sample of a tile takes half an hour of CPU time.
std::string endless_scene() {
  const std::string sphere =
      R"({"type": "sphere", "center": [0, 0, 0.1], "radius": 1, "material": "mirror"})";
  const std::string instance = R"({"type": "instance", "object": "spheres"})";
  std::string spheres = sphere, instances = instance;
  for (int i = 1; i < 100; ++i) spheres += "," + sphere;
  for (int i = 1; i < 10'000; ++i) instances += "," + instance;
  return R"({"render": {"width": 64, "height": 64, "spp": 1, "integrator": "naive", "max_depth": 1024},
             "camera": {"position": [0, 0, 0], "look_at": [0, 0, 1], "up": [0, 1, 0], "vertical_fov_degrees": 40},
             "materials": {"mirror": {"type": "mirror", "reflectance": 1}},
             "objects": {"spheres": {"shapes": [)" +
         spheres + R"(]}}, "shapes": [)" + instances + "]}";
}

class EndlessTest : public FarmTest {
 protected:
  const std::vector<std::string> honest_{"--size", "256x192", "--spp", "8"};

  // Starts workers that have delivered before.
  void start_farm(const std::set<std::string>& names) {
    start_coordinator(1);
    for (const std::string& name : names) farm_.emplace(name, &start_worker(name, 1));
    const std::string id = submit({"--size", "256x192", "--spp", "4096"});
    const auto has_delivered = [&](const std::string& name) { return accepted_of(name) > 0; };
    EXPECT_TRUE(poll_until(60s, [&] { return std::ranges::all_of(names, has_delivered); }));
    EXPECT_EQ(tessera({"cancel", id}).exit_code, 0);
  }
  std::string submit_endless() {
    const auto path = folder_ / "endless.json";
    write_file(path, endless_scene());
    const Outcome outcome = tessera({"submit", path.string()});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.out.substr(0, outcome.out.find('\n'));
  }
  std::uint64_t accepted_of(const std::string& name) {
    std::uint64_t samples = 0;
    for (const auto& worker : workers())
      if (worker.name() == name) samples += worker.samples_accepted();
    return samples;
  }
  // The sockets and pipes of a process.
  static std::set<std::string> open_files(pid_t process) {
    std::set<std::string> files;
    const std::filesystem::path folder = "/proc/" + std::to_string(process) + "/fd";
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      std::error_code gone;
      const std::string file = std::filesystem::read_symlink(entry, gone).string();
      const bool is_unique = file.find('[') != std::string::npos && !file.starts_with("anon_inode");
      if (!gone && is_unique) files.insert(file);
    }
    return files;
  }
  static std::string command_name(const Process& worker) {
    return read_file("/proc/" + std::to_string(worker.pid()) + "/comm");
  }
  static std::vector<std::string> lines_with(const std::string& key, const std::string& log) {
    std::vector<std::string> lines;
    std::istringstream text(log);
    for (std::string line; std::getline(text, line);)
      if (line.find(key) != std::string::npos) lines.push_back(line);
    return lines;
  }
  static bool has_started_anew(const Process& worker) {
    const std::string log = worker.err();
    const std::size_t at = log.find("restarting, since");
    return at != std::string::npos && log.find("registered with the coordinator", at) != std::string::npos;
  }

  std::map<std::string, Process*> farm_;
};

TEST_F(EndlessTest, HungWorkersRestartAndTheJobFails) {
  // Threads are bound to one processor each, and each start prints the processors.
  setenv("OMP_PROC_BIND", "true", 1);
  setenv("OMP_DISPLAY_ENV", "true", 1);
  start_farm({"first", "second", "third"});
  std::map<std::string, std::set<std::string>> files;
  for (const auto& [name, worker] : farm_) files[name] = open_files(worker->pid());

  const std::string endless = submit_endless();
  ASSERT_TRUE(wait_for_state(endless, v1::JOB_STATE_FAILED, 90s));
  for (const auto& [name, worker] : farm_) {
    EXPECT_THAT(job(endless).failure(), HasSubstr(name + " ("));
    ASSERT_TRUE(poll_until(90s, [&, w = worker] { return has_started_anew(*w); })) << name;
    EXPECT_THAT(worker->err(), HasSubstr("job " + endless +
                                         ": samples [0, 1) of the tile with the pixels "
                                         "[0, 64) x [0, 64) did not finish"));
    EXPECT_EQ(command_name(*worker), "tessera-worker\n");
    EXPECT_THAT(read_file("/proc/" + std::to_string(worker->pid()) + "/environ"),
                HasSubstr("TESSERA_WORKER_FAILED_RESTARTS=0"));
    const std::vector<std::string> processors = lines_with("OMP_PLACES", worker->err());
    ASSERT_GE(processors.size(), 2u);
    EXPECT_EQ(processors.back(), processors.front());
    std::set<std::string> kept;
    std::ranges::set_intersection(files[name], open_files(worker->pid()), std::inserter(kept, kept.end()));
    for (const std::string& inherited : open_files(getpid())) kept.erase(inherited);
    EXPECT_TRUE(kept.empty()) << *kept.begin();
  }

  const std::string honest = submit(honest_);
  ASSERT_TRUE(wait_for_state(honest, v1::JOB_STATE_DONE));
  EXPECT_TRUE(image(honest, ".exr") == render_here(honest_, ".exr"));
  for (const auto& [name, worker] : farm_) {
    worker->signal(SIGTERM);
    EXPECT_EQ(worker->wait(30s), 0) << name;
  }
}

TEST_F(EndlessTest, AHungWorkerStopsOnRequest) {
  start_coordinator(1);
  Process& worker = start_worker("told", 1);
  submit_endless();
  ASSERT_TRUE(
      poll_until(30s, [&] { return worker.err().find("made scene endless.json") != std::string::npos; }));
  worker.signal(SIGTERM);
  EXPECT_EQ(worker.wait(60s), 0);
  EXPECT_THAT(worker.err(), HasSubstr("did not finish"));
  EXPECT_THAT(worker.err(), Not(HasSubstr("restarting, since")));
}

}  // namespace
}  // namespace tessera::test
