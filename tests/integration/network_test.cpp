// SPDX-License-Identifier: Apache-2.0
// A farm on a faulty network: coordinator, workers and clients each have their own network namespace.
#include <gmock/gmock.h>

#include <algorithm>
#include <thread>

#include "tests/integration/network_farm.hpp"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr auto kReconnects = 60s;  // a few seconds on an idle machine

class NetworkTest : public NetworkFarmTest {
 protected:
  static constexpr std::uint64_t kSamples = 256ull * 192 * 48;
  const std::vector<std::string> options_{"--size", "256x192", "--spp", "48"};

  void start_farm(double lease_seconds) {
    start_coordinator(lease_seconds);
    start_worker("first", 1);
    start_worker("second", 1);
    ASSERT_TRUE(wait_for_workers(2));
  }

  std::string waited() const { return folder_ / "waited.exr"; }
  Process submit_and_wait(const std::vector<std::string>& options) {
    std::vector<std::string> arguments{"submit", kCornell, "--wait", "-o", waited()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return start_tessera(arguments);
  }
  void expect_same_bytes_from_a_farm() {
    const std::vector<std::string> options{"--size", "256x192", "--spp", "16"};
    start_farm(10);
    Process client = submit_and_wait(options);
    EXPECT_EQ(client.wait(120s), 0) << client.err();
    EXPECT_TRUE(read_file(waited()) == render_here(options, ".exr"));
    EXPECT_EQ(job(newest_job()).counters().samples(), 256u * 192 * 16);
  }
};

TEST_F(NetworkTest, ACutOfThirtySecondsCostsTimeAndNothingElse) {
  start_farm(3);
  Process client = submit_and_wait(options_);
  const std::string id = newest_job();
  ASSERT_TRUE(wait_for_samples(id, kSamples / 20));
  ASSERT_LT(job(id).samples_done(), kSamples / 2) << "the job was nearly over too soon for this test";
  for (const int host : {kFirst, kSecond, kClient}) network().pull(host);
  const std::uint64_t at_the_cut = job(id).samples_done();
  std::this_thread::sleep_for(30s);
  EXPECT_FALSE(is_heard("first"));
  EXPECT_EQ(job(id).active_workers(), 0u) << "leases of workers that are not heard of";
  EXPECT_LE(job(id).samples_done() - at_the_cut, kSamples / 4) << "the cables are not pulled";
  ASSERT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
  for (const int host : {kFirst, kSecond, kClient}) network().plug_in(host);
  EXPECT_TRUE(poll_until(kReconnects, [&] { return is_heard("first") && is_heard("second"); }));
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  EXPECT_EQ(client.wait(kReconnects), 0) << client.err();
  EXPECT_TRUE(read_file(waited()) == render_here(options_, ".exr"));
  EXPECT_EQ(job(id).samples_done(), kSamples);
}

TEST_F(NetworkTest, ADisconnectedWorkerDelaysNoOther) {
  start_farm(2);
  const std::string id = submit(options_);
  ASSERT_TRUE(wait_for_samples(id, kSamples / 20));
  network().pull(kFirst);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE)) << "the other worker does not carry on";
  EXPECT_TRUE(image(id, ".exr") == render_here(options_, ".exr"));
  network().plug_in(kFirst);
  EXPECT_TRUE(poll_until(kReconnects, [&] { return is_heard("first"); }));
  EXPECT_EQ(job(id).counters().samples(), kSamples) << "late results were counted again";
}

// A client that only listens sends nothing that would show that the peer has vanished.
TEST_F(NetworkTest, AWatcherOfAnIdleJobNoticesThatTheCoordinatorVanished) {
  start_coordinator();
  const std::string id = submit({"--size", "64x64", "--spp", "4"});
  Process watch = start_tessera({"watch", id});
  ASSERT_TRUE(watch.wait_until_catches(SIGINT, 20s));
  std::this_thread::sleep_for(45s);  // more than gRPC's default number of pings without data
  network().pull(kClient);
  kill_coordinator();  // its last packets do not arrive
  network().plug_in(kClient);
  network().pull(kCoordinator);
  ASSERT_TRUE(
      poll_until(kReconnects, [&] { return watch.err().find("lost the coordinator") != std::string::npos; }));
  network().plug_in(kCoordinator);
  restart_coordinator();
  start_worker("first", 1);
  EXPECT_EQ(watch.wait(kReconnects), 0) << watch.err();
}

// A file that takes a minute, and results of 64 tiles, on a line of 48 KB/s.
TEST_F(NetworkTest, ASlowLineCostsTimeAndNothingElse) {
  std::string mesh = "v -1 0 -1\nv 1 0 -1\nv 0 1 -1\nf 1 2 3\n";
  while (mesh.size() < 2'500'000) mesh += "# " + std::to_string(std::hash<std::size_t>{}(mesh.size())) + "\n";
  write_file(folder_ / "mesh.obj", mesh);
  write_file(folder_ / "scene.json", R"({"camera": {"position": [0, 0, 4], "look_at": [0, 0, 0]},
    "materials": {"lamp": {"type": "lambert", "emission": 1, "albedo": 0.5}},
    "shapes": [{"type": "mesh", "file": "mesh.obj", "material": "lamp"},
               {"type": "sphere", "center": [0, -2, 0], "radius": 2, "material": "lamp"}]})");
  start_coordinator(10);
  const Outcome submitted = tessera({"submit", folder_ / "scene.json", "--size", "512x512", "--spp", "1"});
  ASSERT_EQ(submitted.exit_code, 0) << submitted.err;
  const std::string id = jobs().at(0).id();
  network().limit_rate(48'000);
  start_worker("first", 1);
  EXPECT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE, 280s));
  EXPECT_EQ(job(id).counters().samples(), 512u * 512u);
}

TEST_F(NetworkTest, TwoHundredMillisecondsOfDelayChangeNoBit) {
  network().hold_up(200ms);
  expect_same_bytes_from_a_farm();
}

TEST_F(NetworkTest, ALossOfFivePercentChangesNoBit) {
  network().lose(0.05);
  expect_same_bytes_from_a_farm();
}

}  // namespace
}  // namespace tessera::test
