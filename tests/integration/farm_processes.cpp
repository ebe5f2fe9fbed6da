// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/farm_processes.hpp"

#include <grpcpp/client_context.h>
#include <signal.h>
#include <algorithm>

#include <iostream>
#include <stdexcept>

#include "proto/channel.hpp"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;

constexpr Timeout kStartTimeout = 20s;
constexpr Timeout kCommandTimeout = 120s;

// Retries while there is no answer: after a restart of the coordinator, the channel must reconnect first. Any
// other failure, or a timeout, gives an empty answer.
template <typename Method, typename Request, typename Response>
Response ask(v1::RenderService::StubInterface& api, Method method, const Request& request,
             Response response) {
  poll_until(kStartTimeout, [&] {
    grpc::ClientContext context;
    context.set_wait_for_ready(true);
    context.set_deadline(std::chrono::system_clock::now() + kStartTimeout);
    return (api.*method)(&context, request, &response).error_code() != grpc::StatusCode::UNAVAILABLE;
  });
  return response;
}

std::string listening_address(const std::string& printed) {
  const std::string key = "listening on ";
  const std::size_t begin = printed.find(key);
  const std::size_t end = printed.find('\n', begin);
  if (begin == std::string::npos || end == std::string::npos) return "";
  return printed.substr(begin + key.size(), end - begin - key.size());
}

// The default port of the page is for one coordinator on the machine.
void without_page_by_default(std::vector<std::string>& arguments) {
  if (std::find(arguments.begin(), arguments.end(), "--http") == arguments.end())
    arguments.insert(arguments.end(), {"--http", "off"});
}

}  // namespace

FarmTest::~FarmTest() {
  if (!HasFailure()) return;
  for (const ProcessOptions& process : history_) {
    std::cerr << "---- ";
    for (const std::string& argument : process.arguments) std::cerr << argument << ' ';
    std::cerr << '\n' << read_file(process.out) << read_file(process.err);
  }
}

ProcessOptions FarmTest::with_files(const std::string& name, std::vector<std::string> arguments) {
  const std::string stem = name + "-" + std::to_string(++started_);
  ProcessOptions options;
  options.arguments = std::move(arguments);
  options.out = folder_ / (stem + ".out");
  options.err = folder_ / (stem + ".err");
  if (const auto network = networks_.find(name); network != networks_.end())
    options.network_of = network->second;
  options.hosts_file = hosts_file_;
  history_.push_back(options);
  return options;
}

void FarmTest::start_coordinator(double lease_seconds) {
  lease_seconds_ = lease_seconds;
  address_ = listen_;
  api_.reset();
  restart_coordinator();
}

void FarmTest::restart_coordinator() {
  std::vector<std::string> arguments{
      TESSERA_COORDINATOR_PROGRAM,   "--listen", address_, "--state", state_, "--lease-seconds",
      std::to_string(lease_seconds_)};
  arguments.insert(arguments.end(), coordinator_options_.begin(), coordinator_options_.end());
  without_page_by_default(arguments);
  coordinator_ = std::make_unique<Process>(with_files("coordinator", std::move(arguments)));
  const bool listens =
      poll_until(kStartTimeout, [this] { return !listening_address(coordinator_->out()).empty(); });
  if (!listens) throw std::runtime_error("the coordinator did not start");
  address_ = listening_address(coordinator_->out());
  if (!api_) api_ = v1::RenderService::NewStub(*proto::open_channel(address_, security_));
}

void FarmTest::kill_coordinator() {
  coordinator_->signal(SIGKILL);
  ASSERT_TRUE(coordinator_->wait(kStartTimeout).has_value());
}

void FarmTest::stop_coordinator() {
  coordinator_->signal(SIGTERM);
  ASSERT_EQ(coordinator_->wait(kStartTimeout), 0);
}

Outcome FarmTest::run_coordinator(const std::vector<std::string>& arguments) {
  std::vector<std::string> all{TESSERA_COORDINATOR_PROGRAM};
  all.insert(all.end(), arguments.begin(), arguments.end());
  without_page_by_default(all);
  Process process(with_files("coordinator", std::move(all)));
  const auto exit_code = process.wait(kCommandTimeout);
  EXPECT_TRUE(exit_code.has_value()) << "did not end";
  return {exit_code.value_or(-1), process.out(), process.err()};
}

std::string FarmTest::named_address() const {
  return coordinator_name_.empty() ? address_ : coordinator_name_ + address_.substr(address_.rfind(':'));
}

std::map<std::string, std::string> FarmTest::environment() const {
  std::map<std::string, std::string> variables;
  const auto add = [&](const char* name, const std::string& file) {
    if (!file.empty()) variables[name] = file;
  };
  add("TESSERA_TLS_CA", security_.ca);
  add("TESSERA_TLS_CERTIFICATE", security_.certificate);
  add("TESSERA_TLS_KEY", security_.key);
  add("TESSERA_TOKEN_FILE", security_.token);
  return variables;
}

Process& FarmTest::start_worker(const std::string& name, int threads,
                                const std::vector<std::string>& more_options) {
  ProcessOptions options =
      with_files(name, {TESSERA_WORKER, "--coordinator", named_address(), "--threads",
                        std::to_string(threads), "--cache", folder_ / ("cache-" + name), "--name", name});
  options.environment = environment();
  if (security_.insecure) options.arguments.push_back("--insecure");
  options.arguments.insert(options.arguments.end(), more_options.begin(), more_options.end());
  workers_.push_back(std::make_unique<Process>(std::move(options)));
  return *workers_.back();
}

Process FarmTest::start_tessera(const std::vector<std::string>& arguments,
                                const std::filesystem::path& folder) {
  std::vector<std::string> all{TESSERA_CLIENT};
  all.insert(all.end(), arguments.begin(), arguments.end());
  if (security_.insecure && arguments.front() != "render") all.push_back("--insecure");
  ProcessOptions options = with_files("tessera", std::move(all));
  options.folder = folder;
  options.environment = environment();
  options.environment["TESSERA_COORDINATOR"] = named_address();
  return Process(std::move(options));
}

Outcome FarmTest::tessera(const std::vector<std::string>& arguments, const std::filesystem::path& folder) {
  Process process = start_tessera(arguments, folder);
  const auto exit_code = process.wait(kCommandTimeout);
  EXPECT_TRUE(exit_code.has_value()) << "did not end: tessera " << arguments[0];
  return {exit_code.value_or(-1), process.out(), process.err()};
}

std::string FarmTest::render_here(const std::vector<std::string>& options, const std::string& ending) {
  const auto [known, is_new] =
      rendered_.try_emplace(options, folder_ / ("here-" + std::to_string(rendered_.size())));
  const std::filesystem::path& folder = known->second;
  if (is_new) {
    std::filesystem::create_directory(folder);
    std::vector<std::string> arguments{"render", kCornell};
    for (const char* format : {".png", ".exr", ".hdr", ".pfm"}) {
      arguments.push_back("-o");
      arguments.push_back((folder / (std::string("image") + format)).string());
    }
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = tessera(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  return read_file(folder / ("image" + ending));
}

std::string FarmTest::submit(const std::vector<std::string>& options) {
  std::vector<std::string> arguments{"submit", kCornell};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const Outcome outcome = tessera(arguments);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return outcome.out.substr(0, outcome.out.find('\n'));
}

grpc::Status FarmTest::submit_and_validate(const v1::SubmitJobRequest& request, std::string* id) {
  grpc::ClientContext submitting, watching;
  v1::SubmitJobResponse submitted;
  if (const grpc::Status status = api().SubmitJob(&submitting, request, &submitted); !status.ok())
    return status;
  if (id != nullptr) *id = submitted.job().id();
  v1::WatchJobRequest watch;
  watch.set_job_id(submitted.job().id());
  const auto stream = api().WatchJob(&watching, watch);
  v1::WatchJobResponse update;
  while (stream->Read(&update) && update.job().state() == v1::JOB_STATE_VALIDATING) {
  }
  watching.TryCancel();
  const grpc::Status watched = stream->Finish();
  const v1::Job& job = update.job();
  if (job.state() == v1::JOB_STATE_VALIDATING) return watched;
  if (job.state() != v1::JOB_STATE_FAILED) return grpc::Status::OK;
  const bool is_limit = job.failure_details().reason() == v1::Failure::REASON_LIMIT;
  EXPECT_TRUE(is_limit || job.failure_details().reason() == v1::Failure::REASON_INVALID_SCENE);
  return {is_limit ? grpc::StatusCode::RESOURCE_EXHAUSTED : grpc::StatusCode::INVALID_ARGUMENT,
          job.failure()};
}

std::size_t FarmTest::sound_jobs() {
  const std::vector<v1::Job> all = jobs();
  return static_cast<std::size_t>(std::count_if(
      all.begin(), all.end(), [](const v1::Job& job) { return job.state() != v1::JOB_STATE_FAILED; }));
}

std::string FarmTest::image(const std::string& job_id, const std::string& ending) {
  const std::filesystem::path path = folder_ / ("farm" + ending);
  const Outcome outcome = tessera({"image", job_id, "-o", path.string()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return read_file(path);
}

v1::RenderService::StubInterface& FarmTest::api() {
  return *api_;
}

v1::Job FarmTest::job(const std::string& id) {
  v1::GetJobRequest request;
  request.set_job_id(id);
  return ask(api(), &v1::RenderService::StubInterface::GetJob, request, v1::GetJobResponse()).job();
}

std::vector<v1::Job> FarmTest::jobs() {
  const auto response =
      ask(api(), &v1::RenderService::StubInterface::ListJobs, v1::ListJobsRequest(), v1::ListJobsResponse());
  return {response.jobs().begin(), response.jobs().end()};
}

std::vector<v1::Worker> FarmTest::workers() {
  const auto response = ask(api(), &v1::RenderService::StubInterface::ListWorkers, v1::ListWorkersRequest(),
                            v1::ListWorkersResponse());
  return {response.workers().begin(), response.workers().end()};
}

bool FarmTest::wait_for_samples(const std::string& job_id, std::uint64_t samples) {
  return poll_until(60s, [&] { return job(job_id).samples_done() >= samples; });
}

bool FarmTest::wait_for_state(const std::string& job_id, v1::JobState state, Timeout timeout) {
  return poll_until(timeout, [&] { return job(job_id).state() == state; });
}

bool FarmTest::wait_for_workers(std::size_t count) {
  return poll_until(30s, [&] { return workers().size() >= count; });
}

}  // namespace tessera::test
