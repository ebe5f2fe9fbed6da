// SPDX-License-Identifier: Apache-2.0
// A farm of real processes: a coordinator on a free port, workers, and command-line clients. Not thread-safe.
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

// The output of a command and its exit code.
struct Outcome {
  ExitCode exit_code = -1;
  std::string out, err;
};

class FarmTest : public ::testing::Test {
 protected:
  // Prints the output of every process if the test failed.
  ~FarmTest() override;

  // Throws std::runtime_error if it does not start.
  void start_coordinator(double lease_seconds = 2);
  // SIGKILL.
  void kill_coordinator();
  // With the same state and address.
  void restart_coordinator();
  // SIGTERM; it must exit with success.
  void stop_coordinator();
  // Runs a coordinator until it exits: for those that do not start, and for --check and --salvage.
  Outcome run_coordinator(const std::vector<std::string>& arguments);
  Process& coordinator() { return *coordinator_; }

  Process& start_worker(const std::string& name, int threads,
                        const std::vector<std::string>& more_options = {});
  // Runs one command until it exits.
  Outcome tessera(const std::vector<std::string>& arguments, const std::filesystem::path& folder = ".");
  Process start_tessera(const std::vector<std::string>& arguments, const std::filesystem::path& folder = ".");

  // The output of `tessera render` of the Cornell box with these options, in the format of the ending.
  // Renders once for all formats.
  std::string render_here(const std::vector<std::string>& options, const std::string& ending);
  // Submits the Cornell box with these options.
  std::string submit(const std::vector<std::string>& options);
  // Submits a job without the command line, and waits until its scene is validated. Returns the error of the
  // call, or the failure of the job with the code that fits its reason. `id` receives the job's id.
  grpc::Status submit_and_validate(const v1::SubmitJobRequest& request, std::string* id = nullptr);
  // The jobs that have not failed.
  std::size_t sound_jobs();
  // The current image of a job.
  std::string image(const std::string& job_id, const std::string& ending);

  v1::RenderService::StubInterface& api();
  const std::string& address() const { return address_; }
  // Where workers and clients are told that the coordinator is.
  std::string named_address() const;
  v1::Job job(const std::string& id);
  std::vector<v1::Job> jobs();
  std::vector<v1::Worker> workers();
  // Blocks until the job has at least so many pixel samples.
  bool wait_for_samples(const std::string& job_id, std::uint64_t samples);
  bool wait_for_state(const std::string& job_id, v1::JobState state,
                      Timeout timeout = std::chrono::seconds(60));
  bool wait_for_workers(std::size_t count);

  TempFolder folder_;
  // Set before a coordinator is started: its state folder and address, and the processes whose network
  // namespaces programs enter, by name ("coordinator", "tessera", or a worker's).
  std::filesystem::path state_ = folder_ / "state";
  std::string listen_ = "127.0.0.1:0";
  std::map<std::string, pid_t> networks_;
  // What workers and clients see as /etc/hosts, and the host name by which they know the coordinator; empty:
  // its address.
  std::filesystem::path hosts_file_;
  std::string coordinator_name_;
  // Set before a coordinator is started: its further options, and the credentials of this test, workers and
  // clients.
  std::vector<std::string> coordinator_options_;
  proto::ClientSecurity security_;

 private:
  std::map<std::string, std::string> environment() const;
  ProcessOptions with_files(const std::string& name, std::vector<std::string> arguments);

  double lease_seconds_ = 2;
  std::string address_;
  int started_ = 0;
  std::vector<ProcessOptions> history_;                                 // for their output
  std::map<std::vector<std::string>, std::filesystem::path> rendered_;  // folders with images, by options
  std::unique_ptr<Process> coordinator_;
  std::vector<std::unique_ptr<Process>> workers_;
  std::unique_ptr<v1::RenderService::StubInterface> api_;
};

}  // namespace tessera::test
