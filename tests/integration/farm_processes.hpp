// SPDX-License-Identifier: Apache-2.0
// A farm of real processes: a coordinator on a free port, workers, and the command line. Not thread-safe.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "proto/security.hpp"
#include "tessera/v1/render_service.grpc.pb.h"
#include "tests/integration/processes.hpp"

namespace tessera::test {

inline const std::string kCornell = TESSERA_SOURCE_DIR "/scenes/cornell/scene.json";

// What a command printed, and how it ended.
struct Outcome {
  ExitCode exit_code = -1;
  std::string out, err;
};

class FarmTest : public ::testing::Test {
 protected:
  // Prints what every process said if the test failed.
  ~FarmTest() override;

  // Throws std::runtime_error if it does not start.
  void start_coordinator(double lease_seconds = 2);
  // As a crash would: without any warning.
  void kill_coordinator();
  // On the same state and address.
  void restart_coordinator();
  // By SIGTERM; it must end well.
  void stop_coordinator();
  // As far as it gets: for coordinators that do not start, and for --check and --salvage.
  Outcome run_coordinator(const std::vector<std::string>& arguments);
  Process& coordinator() { return *coordinator_; }

  Process& start_worker(const std::string& name, int threads);
  // One command of the command line, from start to end.
  Outcome tessera(const std::vector<std::string>& arguments, const std::filesystem::path& folder = ".");
  Process start_tessera(const std::vector<std::string>& arguments, const std::filesystem::path& folder = ".");

  // The bytes of `tessera render` of the Cornell box with these options, in the format of the ending. Renders
  // once for all formats.
  std::string render_here(const std::vector<std::string>& options, const std::string& ending);
  // Submits the Cornell box with these options.
  std::string submit(const std::vector<std::string>& options);
  // The picture of a job as it is now.
  std::string image(const std::string& job_id, const std::string& ending);

  v1::RenderService::StubInterface& api();
  const std::string& address() const { return address_; }
  v1::Job job(const std::string& id);
  std::vector<v1::Job> jobs();
  std::vector<v1::ListWorkersResponse::Worker> workers();
  // Blocks until the job has at least so many pixel samples.
  bool wait_for_samples(const std::string& job_id, std::uint64_t samples);
  bool wait_for_state(const std::string& job_id, v1::JobState state,
                      Timeout timeout = std::chrono::seconds(60));
  bool wait_for_workers(std::size_t count);

  TempFolder folder_;
  // To be set before a coordinator is started: where it keeps its state and listens at first, and in whose
  // network namespaces processes run, by their names ("coordinator", "tessera", a worker's).
  std::filesystem::path state_ = folder_ / "state";
  std::string listen_ = "127.0.0.1:0";
  std::map<std::string, pid_t> networks_;
  // To be set before a coordinator is started: its further options, and how this test, workers and the
  // command line show who they are.
  std::vector<std::string> coordinator_options_;
  proto::ClientSecurity security_;

 private:
  std::map<std::string, std::string> environment() const;
  ProcessOptions with_files(const std::string& name, std::vector<std::string> arguments);

  double lease_seconds_ = 2;
  std::string address_;
  int started_ = 0;
  std::vector<ProcessOptions> history_;                                 // for what they said
  std::map<std::vector<std::string>, std::filesystem::path> rendered_;  // folders with pictures, by options
  std::unique_ptr<Process> coordinator_;
  std::vector<std::unique_ptr<Process>> workers_;
  std::unique_ptr<v1::RenderService::StubInterface> api_;
};

}  // namespace tessera::test
