// SPDX-License-Identifier: Apache-2.0
// The commands of administrators, with real processes.
#include <gmock/gmock.h>

#include "tests/integration/farm_processes.hpp"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

class FleetTest : public FarmTest {
 protected:
  v1::Worker worker(const std::string& name) {
    for (const v1::Worker& each : workers())
      if (each.name() == name) return each;
    return {};
  }
  bool says(Process& process, const std::string& words) {
    return poll_until(30s, [&] { return process.err().find(words) != std::string::npos; });
  }
};

TEST_F(FleetTest, ADrainedWorkerRendersNothingUntilItIsUndone) {
  start_coordinator();
  start_worker("one", 1);
  ASSERT_TRUE(wait_for_workers(1));
  const Outcome drained = tessera({"drain", "one"});
  EXPECT_EQ(drained.exit_code, 0) << drained.err;
  EXPECT_THAT(drained.out, HasSubstr("takes no more leases"));
  EXPECT_THAT(tessera({"workers"}).out, HasSubstr("drained"));
  const std::string id = submit({"--size", "64x64", "--spp", "4"});
  start_worker("two", 1);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  EXPECT_EQ(worker("one").samples_accepted(), 0u);

  EXPECT_EQ(tessera({"drain", "two"}).exit_code, 0);
  EXPECT_EQ(tessera({"drain", "one", "--undo"}).exit_code, 0);
  ASSERT_EQ(tessera({"extend", id, "--spp", "8"}).exit_code, 0);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  EXPECT_EQ(worker("one").samples_accepted(), 64u * 64u * 4u);
}

// The coordinator crashes right after it has confirmed the drain.
TEST_F(FleetTest, ADrainSurvivesACrashOfTheCoordinator) {
  start_coordinator();
  start_worker("one", 1);
  ASSERT_TRUE(wait_for_workers(1));
  ASSERT_EQ(tessera({"drain", "one"}).exit_code, 0);
  kill_coordinator();
  restart_coordinator();
  const std::string id = submit({"--size", "64x64", "--spp", "4"});
  ASSERT_TRUE(poll_until(30s, [&] { return worker("one").drain_requested(); }));
  start_worker("two", 1);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  EXPECT_EQ(worker("one").samples_accepted(), 0u);
  EXPECT_EQ(worker("two").samples_accepted(), 64u * 64u * 4u);
}

TEST_F(FleetTest, AStoppedWorkerDeliversAndEnds) {
  start_coordinator(20);
  Process& one = start_worker("one", 1);
  const std::vector<std::string> options{"--size", "192x128", "--spp", "64"};
  const std::string id = submit(options);
  ASSERT_TRUE(wait_for_samples(id, 1));
  EXPECT_EQ(tessera({"drain", "one", "--stop"}).exit_code, 0);
  EXPECT_EQ(one.wait(60s), 0);
  EXPECT_THAT(one.err(), HasSubstr("an administrator has asked this worker to stop"));
  start_worker("two", 2);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  EXPECT_TRUE(image(id, ".exr") == render_here(options, ".exr"));
}

TEST_F(FleetTest, WrongNamesAreExplained) {
  start_coordinator();
  EXPECT_THAT(tessera({"drain", "nobody"}).err, HasSubstr("there is no worker 'nobody'"));
  EXPECT_EQ(tessera({"drain", "nobody", "--undo", "--stop"}).exit_code, 2);
  EXPECT_EQ(tessera({"quarantine"}).exit_code, 0);
  EXPECT_EQ(tessera({"quarantine", "lift"}).exit_code, 2);
  EXPECT_EQ(tessera({"quarantine", "break"}).exit_code, 2);
  EXPECT_THAT(tessera({"quarantine", "lift", "1f0c"}).err, HasSubstr("has no entry '1f0c'"));
  EXPECT_THAT(tessera({"server"}).out,
              AllOf(HasSubstr("release"), HasSubstr("fingerprints"), HasSubstr("max spp")));
  EXPECT_THAT(tessera({"server", "--json"}).out, HasSubstr("\"determinism_fingerprints\":[\""));
}

// A worker of another build waits until a coordinator accepts it.
TEST_F(FleetTest, AWorkerOfAnotherFingerprintWaitsUntilItIsAccepted) {
  coordinator_options_ = {"--accept-fingerprint", "0123456789abcdef"};
  start_coordinator();
  Process& one = start_worker("one", 1);
  ASSERT_TRUE(says(one, "is not bit-compatible with this farm"));
  const std::string log = one.err(), key = "its fingerprint is ";
  const std::string own = log.substr(log.find(key) + key.size(), 16);
  kill_coordinator();
  coordinator_options_ = {"--accept-fingerprint", "0123456789abcdef", "--accept-fingerprint", own};
  restart_coordinator();
  EXPECT_TRUE(wait_for_workers(1));
  EXPECT_EQ(one.wait(0s), std::nullopt);
}

}  // namespace
}  // namespace tessera::test
