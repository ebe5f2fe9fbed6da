// SPDX-License-Identifier: Apache-2.0
// A worker that dies, freezes or stops costs its leases and nothing else.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <set>

#include "tests/integration/farm_processes.hpp"
#include "tests/integration/raw_worker.hpp"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

class WorkerFaultsTest : public FarmTest {
 protected:
  static constexpr std::uint64_t kSamples = 256ull * 192 * 24;
  const std::vector<std::string> options_{"--size", "256x192", "--spp", "24"};

  // The accepted samples of all workers with this name that the coordinator knows.
  std::uint64_t accepted_of(const std::string& name) {
    std::uint64_t samples = 0;
    for (const auto& worker : workers())
      if (worker.name() == name) samples += worker.samples_accepted();
    return samples;
  }
  bool is_silent(const std::string& name) {
    const auto known = workers();
    return std::any_of(known.begin(), known.end(),
                       [&](const auto& worker) { return worker.name() == name && worker.silent(); });
  }
  // Stops it, and returns the number of samples that it reports to have rendered.
  std::uint64_t rendered_by(Process& worker) {
    worker.signal(SIGTERM);
    EXPECT_EQ(worker.wait(30s), 0);
    const std::string log = worker.err(), key = "has rendered ";
    const std::size_t at = log.find(key);
    EXPECT_NE(at, std::string::npos) << log;
    return at == std::string::npos ? 0 : std::stoull(log.substr(at + key.size()));
  }
};

// The surviving workers render what the killed ones have not delivered, and nothing else.
TEST_F(WorkerFaultsTest, OnlyLeasesOfKilledWorkersAreRenderedAgain) {
  start_coordinator(1);
  const std::string id = submit(options_);
  for (int kills = 0; kills < 6; ++kills) {
    Process& victim = start_worker("victim", 1);
    const std::uint64_t before = job(id).samples_done();
    // Each kill is at another moment of its work.
    ASSERT_TRUE(poll_until(30s, [&] { return job(id).samples_done() >= before + 15'000ull * (kills + 1); }));
    ASSERT_EQ(job(id).state(), v1::JOB_STATE_RUNNING) << "the job was over too soon for this test";
    victim.signal(SIGKILL);
    ASSERT_TRUE(victim.wait(5s).has_value());
  }
  ASSERT_TRUE(poll_until(20s, [&] { return job(id).active_workers() == 0; }));
  const std::uint64_t delivered = job(id).samples_done();
  ASSERT_LT(delivered, kSamples);
  // With such long leases, no worker loses one because the machine is slow.
  stop_coordinator();
  start_coordinator(3600);
  Process& survivor = start_worker("survivor", 1);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  EXPECT_EQ(rendered_by(survivor), kSamples - delivered);
  EXPECT_EQ(job(id).counters().samples(), kSamples);
  EXPECT_TRUE(image(id, ".exr") == render_here(options_, ".exr"));
}

TEST_F(WorkerFaultsTest, NoJobWaitsLongerThanTheLeaseAndASecond) {
  constexpr auto kLease = 2s;
  start_coordinator(std::chrono::duration<double>(kLease).count());
  const std::string id = submit({"--size", "64x64", "--spp", "1"});
  RawWorker dies(address(), "dies"), waits(address(), "waits");
  ASSERT_TRUE(poll_until(20s, [&] { return !dies.synchronize().leases().empty(); }));
  const auto was_alive = std::chrono::steady_clock::now();
  dies.synchronize();  // it reports the lease, and sends no more heartbeats
  const auto died = std::chrono::steady_clock::now();
  ASSERT_EQ(job(id).active_workers(), 1u);
  ASSERT_TRUE(poll_until(20s, [&] { return job(id).active_workers() == 0; }));
  const auto taken_away = std::chrono::steady_clock::now();
  EXPECT_LE(taken_away - died, kLease + 1s);
  EXPECT_GE(taken_away - was_alive, kLease / 2) << "the lease was taken away while it was held";
  EXPECT_FALSE(waits.synchronize().leases().empty());
}

TEST_F(WorkerFaultsTest, ASlowFetchLosesItsLeasesAndGetsOthersWithTheScene) {
  start_coordinator(1);
  const std::string id = submit({"--size", "64x64", "--spp", "1"});
  RawWorker far(address(), "far");
  far.say_fetching(id);
  ASSERT_TRUE(poll_until(20s, [&] { return !far.synchronize().leases().empty(); }));
  const auto leased = std::chrono::steady_clock::now();
  ASSERT_TRUE(poll_until(60s, [&] { return far.synchronize().leases().empty(); }));
  EXPECT_GE(std::chrono::steady_clock::now() - leased, 8s);
  const auto listed = tessera({"workers"});
  EXPECT_THAT(listed.out, HasSubstr("  fetching  "));
  EXPECT_THAT(listed.out, HasSubstr("until it has fetched its scene"));
  far.say_fetching("");
  EXPECT_TRUE(poll_until(20s, [&] { return !far.synchronize().leases().empty(); }));
}

// Nothing is leased while the job is paused, so later results belong to the lost lease.
TEST_F(WorkerFaultsTest, AFrozenWorkersLateResultCountsIfItIsMissing) {
  start_coordinator(1);
  Process& worker = start_worker("frozen", 1);
  const std::string id = submit(options_);
  ASSERT_TRUE(wait_for_samples(id, kSamples / 20));
  worker.signal(SIGSTOP);
  ASSERT_TRUE(poll_until(20s, [&] { return is_silent("frozen"); }));
  ASSERT_EQ(tessera({"pause", id}).exit_code, 0);
  const std::uint64_t before = job(id).samples_done();
  ASSERT_EQ(job(id).active_workers(), 0u);
  worker.signal(SIGCONT);
  ASSERT_TRUE(poll_until(30s, [&] { return job(id).samples_done() > before; }));
  ASSERT_EQ(tessera({"resume", id}).exit_code, 0);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  EXPECT_EQ(job(id).counters().samples(), kSamples);
  EXPECT_TRUE(image(id, ".exr") == render_here(options_, ".exr"));
}

TEST_F(WorkerFaultsTest, AStoppedWorkerDeliversAllItHasRendered) {
  start_coordinator(3600);
  Process& leaving = start_worker("leaves", 1);
  const std::string id = submit(options_);
  ASSERT_TRUE(wait_for_samples(id, kSamples / 20));
  const std::uint64_t rendered = rendered_by(leaving);
  EXPECT_EQ(job(id).samples_done(), rendered);
  EXPECT_EQ(job(id).active_workers(), 0u);
  ASSERT_LT(rendered, kSamples) << "the job was over too soon for this test";
  Process& stays = start_worker("stays", 1);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  EXPECT_EQ(rendered_by(stays), kSamples - rendered);
  EXPECT_TRUE(image(id, ".exr") == render_here(options_, ".exr"));
}

// The operator may correct the farm while it waits.
TEST_F(WorkerFaultsTest, AWorkerOfAnotherBuildNamesBothFingerprintsAndWaits) {
  coordinator_options_ = {"--accept-fingerprint", "0000000000000000"};
  start_coordinator(2);
  const std::string id = submit({"--size", "64x64", "--spp", "1"});
  Process& worker = start_worker("this build", 1);
  ASSERT_TRUE(poll_until(
      20s, [&] { return worker.err().find("is not bit-compatible with this farm") != std::string::npos; }));
  EXPECT_THAT(worker.err(), HasSubstr("0000000000000000"));
  EXPECT_THAT(worker.err(), HasSubstr("Install the coordinator's release on it"));
  EXPECT_THAT(worker.err(), HasSubstr("trying again from time to time"));
  EXPECT_EQ(worker.wait(2s), std::nullopt);
  stop_coordinator();
  coordinator_options_ = {};
  restart_coordinator();
  EXPECT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  worker.signal(SIGTERM);
  EXPECT_EQ(worker.wait(20s), 0);
}

// A recently free port of this machine, for a program that cannot print its own.
int free_port() {
  const int probe = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  EXPECT_EQ(bind(probe, generic, size), 0);
  EXPECT_EQ(getsockname(probe, generic, &size), 0);
  close(probe);
  return ntohs(address.sin_port);
}

struct Streams {
  const char* name;
  const char* redirection;  // for bash, before it executes the program
};

class StandardStreams : public WorkerFaultsTest, public testing::WithParamInterface<Streams> {
 protected:
  Process start(const std::string& command) {
    ProcessOptions options{.arguments = {"/bin/bash", "-c", GetParam().redirection + ("exec " + command)}};
    options.out = options.err = "/dev/null";
    return Process(options);
  }
};

// Output is lost, but nothing else fails.
TEST_P(StandardStreams, ThatCannotBeWrittenEndNoProgram) {
  const std::string listen = "127.0.0.1:" + std::to_string(free_port()), output = folder_ / "a.png";
  Process coordinator =
      start(TESSERA_COORDINATOR_PROGRAM " --listen " + listen + " --state " + state_.string());
  Process worker = start(TESSERA_WORKER " --verbose --threads 1 --coordinator " + listen + " --cache " +
                         (folder_ / "cache").string());
  const auto submit = [&] {
    ProcessOptions options{.arguments = {TESSERA_CLIENT, "submit", kCornell, "--size", "64x64", "--spp", "1",
                                         "--wait", "-o", output, "--coordinator", listen}};
    options.out = folder_ / "client.out";
    options.err = folder_ / "client.err";
    return Process(options).wait(60s) == 0;
  };
  EXPECT_TRUE(poll_until(60s, submit)) << read_file(folder_ / "client.err");
  EXPECT_TRUE(std::filesystem::exists(output));
  EXPECT_EQ(read_file(state_ / "lock"), "") << "a file has taken the place of a stream";
  for (Process* const process : {&worker, &coordinator}) {
    process->signal(SIGTERM);
    EXPECT_EQ(process->wait(30s), 0);
  }
}

INSTANTIATE_TEST_SUITE_P(
    WorkerFaultsTest, StandardStreams,
    testing::Values(Streams{"Closed", "exec <&- >&- 2>&-; "}, Streams{"Full", "exec > /dev/full 2>&1; "},
                    Streams{"PipesWhoseReaderHasGone", "exec > >(exec true) 2>&1; sleep 0.5; "},
                    // The program's own other end keeps a pipe open that nobody empties.
                    Streams{"FullPipesThatNobodyReads",
                            "pipe=$(mktemp -u); mkfifo $pipe; exec 9<>$pipe; rm $pipe; "
                            "head -c 65536 /dev/zero >&9; exec > /dev/null 2>&9; "}),
    [](const auto& streams) { return streams.param.name; });

}  // namespace
}  // namespace tessera::test
