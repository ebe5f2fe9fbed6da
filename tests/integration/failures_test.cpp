// SPDX-License-Identifier: Apache-2.0
// Failures in a farm cost time, but never a bit of an image.
#include <gmock/gmock.h>
#include <signal.h>

#include <algorithm>

#include "proto/blob.hpp"
#include "tests/integration/farm_processes.hpp"
#include "tests/integration/raw_worker.hpp"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

class FailuresTest : public FarmTest {
 protected:
  static constexpr std::uint64_t kSamples = 256ull * 192 * 48;
  const std::vector<std::string> options_{"--size", "256x192", "--spp", "48"};

  // A job with some, but by far not all, of its samples rendered.
  std::string start_job() {
    const std::string id = submit(options_);
    EXPECT_TRUE(wait_for_samples(id, kSamples / 20));
    EXPECT_LT(job(id).samples_done(), kSamples) << "the job was over too soon for this test";
    return id;
  }

  // Takes leases and reports them. Returns whether there were any.
  bool take_and_die(const std::string& name) {
    RawWorker worker(address(), name);
    const bool taken = !worker.synchronize().leases().empty();
    worker.synchronize();
    return taken;
  }

  void expect_local_bytes(const std::string& id) {
    EXPECT_TRUE(image(id, ".png") == render_here(options_, ".png"));
    EXPECT_TRUE(image(id, ".exr") == render_here(options_, ".exr"));
    EXPECT_EQ(job(id).samples_done(), kSamples);
  }
};

TEST_F(FailuresTest, AKilledWorkerCostsOnlyItsLease) {
  start_coordinator();
  start_worker("survivor", 1);
  Process& victim = start_worker("victim", 1);
  ASSERT_TRUE(wait_for_workers(2));
  const std::string id = start_job();
  victim.signal(SIGKILL);
  EXPECT_EQ(victim.wait(5s), 128 + SIGKILL);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  expect_local_bytes(id);
}

// A lease lasts an hour here: the job is done in time only if the stopping worker gives its leases back.
TEST_F(FailuresTest, AStoppedWorkerReturnsItsLeases) {
  start_coordinator(3600);
  start_worker("stays", 1);
  Process& leaving = start_worker("leaves", 1);
  ASSERT_TRUE(wait_for_workers(2));
  const std::string id = start_job();
  leaving.signal(SIGTERM);
  EXPECT_EQ(leaving.wait(30s), 0);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  expect_local_bytes(id);
}

// These workers take leases, report them, and then send no more heartbeats.
TEST_F(FailuresTest, ARangeThatKillsEveryWorkerEndsItsJobAndNoOther) {
  start_coordinator(1);
  const std::string deadly = submit({"--size", "256x192", "--spp", "4"});
  for (const char* name : {"first", "second", "third"}) {
    ASSERT_TRUE(poll_until(20s, [&] { return take_and_die(name); }));
    ASSERT_TRUE(poll_until(20s, [&] { return job(deadly).active_workers() == 0; }));
  }
  const std::string other = submit({"--size", "64x64", "--spp", "1"});
  ASSERT_TRUE(wait_for_state(deadly, v1::JOB_STATE_FAILED));
  const std::string failure = job(deadly).failure();
  EXPECT_THAT(failure,
              HasSubstr("3 workers died one after the other while they rendered samples [0, 1) of tile 0"));
  for (const char* name : {"first", "second", "third"}) EXPECT_THAT(failure, HasSubstr(name));
  EXPECT_THAT(tessera({"job", deadly}).out, HasSubstr(failure));
  start_worker("survivor", 1);
  EXPECT_TRUE(wait_for_state(other, v1::JOB_STATE_DONE));
}

TEST_F(FailuresTest, AWorkerThatIsKilledAgainAndAgainFailsNoJob) {
  start_coordinator(1);
  const std::string id = submit(options_);
  const auto works = [](const auto& worker) { return !worker.silent() && worker.held_leases() > 0; };
  const auto somebody_works = [&] {
    const auto known = workers();
    return std::any_of(known.begin(), known.end(), works) || job(id).state() != v1::JOB_STATE_RUNNING;
  };
  for (int kills = 0; kills < 10; ++kills) {
    Process& victim = start_worker("victim", 1);
    ASSERT_TRUE(poll_until(20s, somebody_works));
    victim.signal(SIGKILL);
    ASSERT_TRUE(victim.wait(5s).has_value());
    ASSERT_TRUE(poll_until(20s, [&] { return job(id).active_workers() == 0; }));
  }
  start_worker("victim", 1);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  expect_local_bytes(id);
}

TEST_F(FailuresTest, AJobWhoseFilesTheCoordinatorHasLostFails) {
  start_coordinator();
  const std::string id = submit(options_);
  const v1::Job submitted = job(id);
  for (const v1::Bundle::Asset& asset : submitted.bundle().assets()) {
    if (asset.path() != "box.obj") continue;
    const std::string hex = proto::from_proto(asset.digest())->hex();
    const auto blob = folder_ / "state" / "blobs" / hex.substr(0, 2) / hex.substr(2);
    std::string bytes = read_file(blob);
    bytes[bytes.size() / 2] ^= 1;
    write_file(blob, bytes);
  }
  start_worker("worker", 1);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_FAILED));
  EXPECT_THAT(job(id).failure(), HasSubstr("box.obj: the coordinator has lost this file"));
  // The file is uploaded again.
  const std::string again = submit({"--size", "64x64", "--spp", "1"});
  EXPECT_TRUE(wait_for_state(again, v1::JOB_STATE_DONE));
}

TEST_F(FailuresTest, ASecondSignalStopsAWorkerAtOnce) {
  start_coordinator();
  Process& worker = start_worker("worker", 1);
  ASSERT_TRUE(wait_for_workers(1));
  kill_coordinator();
  // The first signal makes it retry the delivery without a coordinator; the second one ends that.
  worker.signal(SIGINT);
  ASSERT_TRUE(poll_until(10s, [&] { return worker.err().find("stopping") != std::string::npos; }));
  worker.signal(SIGINT);
  EXPECT_EQ(worker.wait(5s), 128 + SIGINT);
}

TEST_F(FailuresTest, LateResultsOfAFrozenWorkerAreDropped) {
  start_coordinator();
  start_worker("awake", 1);
  Process& frozen = start_worker("frozen", 1);
  ASSERT_TRUE(wait_for_workers(2));
  const std::string id = start_job();
  frozen.signal(SIGSTOP);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  const v1::Job done = job(id);
  frozen.signal(SIGCONT);
  // Its unwanted results are delivered before it renders for another job.
  const std::string next = submit({"--size", "64x64", "--spp", "1"});
  ASSERT_TRUE(wait_for_state(next, v1::JOB_STATE_DONE));
  frozen.signal(SIGTERM);
  EXPECT_EQ(frozen.wait(10s), 0);
  EXPECT_EQ(job(id).counters().samples(), done.counters().samples());
  expect_local_bytes(id);
}

TEST_F(FailuresTest, AKilledCoordinatorContinuesItsJobs) {
  start_coordinator();
  start_worker("one", 1);
  start_worker("two", 1);
  ASSERT_TRUE(wait_for_workers(2));
  std::vector<std::string> arguments{"submit", kCornell, "--wait", "-o", (folder_ / "waited.png").string()};
  arguments.insert(arguments.end(), options_.begin(), options_.end());
  Process client = start_tessera(arguments);
  ASSERT_TRUE(poll_until(30s, [&] { return !jobs().empty(); }));
  const std::string id = jobs().front().id();
  ASSERT_TRUE(wait_for_samples(id, kSamples / 4));

  kill_coordinator();
  ASSERT_FALSE(client.wait(100ms).has_value()) << "the client did not wait for the coordinator to come back";
  restart_coordinator();
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  EXPECT_EQ(client.wait(30s), 0);
  EXPECT_TRUE(read_file(folder_ / "waited.png") == render_here(options_, ".png"));
  expect_local_bytes(id);
}

TEST_F(FailuresTest, AWorkerThatIsStartedFirstWaitsForItsCoordinator) {
  start_coordinator();
  kill_coordinator();
  Process& worker = start_worker("early", 1);
  ASSERT_TRUE(poll_until(20s, [&] { return worker.err().find("cannot reach") != std::string::npos; }));
  restart_coordinator();
  EXPECT_TRUE(wait_for_workers(1));
}

}  // namespace
}  // namespace tessera::test
