// SPDX-License-Identifier: Apache-2.0
// A coordinator that dies or stops costs seconds of work, but no bits of an image. Workers and waiting
// clients reconnect by themselves.
#include <gmock/gmock.h>
#include <signal.h>

#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "tests/integration/farm_processes.hpp"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using ::testing::HasSubstr;

class CoordinatorFaultsTest : public FarmTest {
 protected:
  static constexpr std::uint64_t kSpp = 48, kSamples = 320 * 256 * kSpp;
  const std::vector<std::string> options_{"--size", "320x256", "--spp", std::to_string(kSpp)};

  void start_farm() {
    start_coordinator();
    crew_ = {&start_worker("one", 1), &start_worker("two", 1)};
    ASSERT_TRUE(wait_for_workers(2));
  }
  void freeze_workers() {
    for (const Process* worker : crew_) worker->signal(SIGSTOP);
  }
  void thaw_workers() {
    for (const Process* worker : crew_) worker->signal(SIGCONT);
  }
  std::filesystem::path log() const { return state_ / "tessera.db-wal"; }
  // The coordinator writes all changes of its database to the log first.
  bool wait_for_write() {
    std::error_code ignored;
    const auto before = std::filesystem::last_write_time(log(), ignored);
    return poll_until(10s, [&] { return std::filesystem::last_write_time(log(), ignored) != before; });
  }

 private:
  std::vector<Process*> crew_;
};

// Kills it during a write, just after one, and at random moments.
TEST_F(CoordinatorFaultsTest, RepeatedKillsLoseNoBit) {
  // Twice the samples of the other tests, for many crashes.
  const std::vector<std::string> options{"--size", "320x256", "--spp", std::to_string(2 * kSpp)};
  start_farm();
  freeze_workers();
  std::vector<std::string> arguments{"submit", kCornell, "--wait", "-o", folder_ / "waited.exr"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  Process client = start_tessera(arguments);
  ASSERT_TRUE(poll_until(30s, [&] { return !jobs().empty(); }));
  const std::string id = jobs().front().id();
  Process watcher = start_tessera({"watch", id});
  ASSERT_TRUE(watcher.wait_until_catches(SIGINT, 20s));
  thaw_workers();
  ASSERT_TRUE(wait_for_samples(id, 1));
  std::mt19937 random(7);
  int kills = 0;
  for (; kills < 8 && job(id).state() == v1::JOB_STATE_RUNNING; ++kills) {
    if (kills % 2 == 0) wait_for_write();
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % (kills % 2 == 0 ? 20 : 700)));
    kill_coordinator();
    restart_coordinator();
    ASSERT_FALSE(jobs().empty()) << "the job is lost";
  }
  EXPECT_GE(kills, 3) << "the job was over too soon for this test";
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  EXPECT_EQ(client.wait(60s), 0) << client.err();
  EXPECT_EQ(watcher.wait(60s), 0) << watcher.err();
  EXPECT_TRUE(read_file(folder_ / "waited.exr") == render_here(options, ".exr"));
  EXPECT_EQ(job(id).samples_done(), 2 * kSamples);
  EXPECT_EQ(job(id).counters().samples(), 2 * kSamples);
  stop_coordinator();
  EXPECT_EQ(run_coordinator({"--check", state_}).exit_code, 0);
}

// A job that is reported as done has its image, even if the coordinator dies at that moment.
TEST_F(CoordinatorFaultsTest, AJobReportedAsDoneIsDoneAfterACrash) {
  start_farm();
  const std::vector<std::string> options{"--size", "320x256", "--spp", "2"};
  for (int crash = 0; crash < 4; ++crash) {
    const std::string id = submit(options);
    ASSERT_TRUE(poll_until(60s, [&] { return job(id).state() == v1::JOB_STATE_DONE; }));
    kill_coordinator();
    restart_coordinator();
    EXPECT_EQ(job(id).state(), v1::JOB_STATE_DONE);
    EXPECT_TRUE(image(id, ".exr") == render_here(options, ".exr"));
  }
}

TEST_F(CoordinatorFaultsTest, ACrashCostsWhatWasAcceptedInTheLastTwoSeconds) {
  start_farm();
  const std::string id = submit({"--size", "320x256", "--spp", "100000"});
  ASSERT_TRUE(wait_for_samples(id, 1));
  struct Seen {
    Clock::time_point at;
    std::uint64_t samples;
  };
  for (int crash = 0; crash < 2; ++crash) {
    std::vector<Seen> seen;
    const auto begin = Clock::now();
    while (Clock::now() < begin + 4s + crash * 300ms) {
      const std::uint64_t samples = job(id).samples_done();
      seen.push_back({Clock::now(), samples});
      std::this_thread::sleep_for(20ms);
    }
    ASSERT_GT(seen.back().samples, seen.front().samples);
    const auto killed = Clock::now();
    kill_coordinator();
    freeze_workers();
    restart_coordinator();
    std::uint64_t promised = 0;
    for (const Seen& each : seen)
      if (each.at <= killed - 2s) promised = each.samples;
    const std::uint64_t kept = job(id).samples_done();
    EXPECT_GE(kept, promised);
    RecordProperty("lost_of_last_two_seconds", std::to_string(seen.back().samples - kept));
    thaw_workers();
    ASSERT_TRUE(wait_for_samples(id, kept + 1)) << "the workers do not come back";
  }
}

TEST_F(CoordinatorFaultsTest, AStopWritesEverythingAndSucceeds) {
  start_farm();
  const std::string id = submit(options_);
  ASSERT_TRUE(wait_for_samples(id, kSamples / 20));
  freeze_workers();
  std::uint64_t before = 0;
  // Results that they sent before they froze are still accepted.
  ASSERT_TRUE(poll_until(20s, [&] {
    std::this_thread::sleep_for(500ms);
    return before == std::exchange(before, job(id).samples_done());
  }));
  ASSERT_LT(before, kSamples);
  stop_coordinator();
  EXPECT_FALSE(std::filesystem::exists(log())) << "the database was not closed";
  const Outcome checked = run_coordinator({"--check", state_});
  EXPECT_EQ(checked.exit_code, 0) << checked.out;
  EXPECT_THAT(checked.out, HasSubstr(std::to_string(before) + " of " + std::to_string(kSamples)));
  restart_coordinator();
  EXPECT_EQ(job(id).samples_done(), before);
  thaw_workers();
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  EXPECT_TRUE(image(id, ".exr") == render_here(options_, ".exr"));
}

// The answer with the job's id may be lost.
TEST_F(CoordinatorFaultsTest, ASubmissionDuringACrashMakesOneJob) {
  start_coordinator();
  ASSERT_EQ(tessera({"jobs"}).exit_code, 0);
  for (int moment = 0; moment < 4; ++moment) {
    const std::size_t before = jobs().size();
    const std::string name = "job" + std::to_string(moment);
    Process client = start_tessera({"submit", kCornell, "--size", "64x64", "--spp", "1", "--name", name});
    std::this_thread::sleep_for(30ms + moment * 30ms);  // before, between and after its calls
    kill_coordinator();
    restart_coordinator();
    const auto exit_code = client.wait(60s);
    ASSERT_TRUE(exit_code.has_value());
    EXPECT_LE(jobs().size(), before + 1);
    if (*exit_code == 0) {
      EXPECT_EQ(jobs().size(), before + 1) << "an acknowledged job is lost";
    }
  }
}

}  // namespace
}  // namespace tessera::test
