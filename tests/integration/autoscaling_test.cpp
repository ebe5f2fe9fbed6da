// SPDX-License-Identifier: Apache-2.0
// A farm whose workers are started and ended by an autoscaler, which asks the coordinator as KEDA does.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <random>
#include <regex>
#include <string>
#include <thread>
#include <vector>

#include "externalscaler.grpc.pb.h"
#include "tests/integration/farm_processes.hpp"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;

// The port of "cluster managers are served at 127.0.0.1:PORT" in a log.
std::string cluster_address(const Process& coordinator) {
  const std::regex line("cluster managers are served at (127\\.0\\.0\\.1:[0-9]+)");
  std::smatch found;
  std::string log;
  poll_until(20s, [&] {
    log = coordinator.err();
    return std::regex_search(log, found, line);
  });
  return found.empty() ? "" : found[1].str();
}

// What a worker says when it ends.
std::uint64_t rendered_samples(const Process& worker) {
  const std::string log = worker.err();
  std::smatch found;
  return std::regex_search(log, found, std::regex("has rendered ([0-9]+) samples"))
             ? std::stoull(found[1].str())
             : 0;
}

class Autoscaling : public FarmTest {
 protected:
  void start(const std::string& seconds_per_worker) {
    coordinator_options_ = {"--cluster", "127.0.0.1:0"};
    start_coordinator();
    keda_ = externalscaler::ExternalScaler::NewStub(
        grpc::CreateChannel(cluster_address(coordinator()), grpc::InsecureChannelCredentials()));
    object_.set_name("tessera-worker");
    (*object_.mutable_scalermetadata())["secondsPerWorker"] = seconds_per_worker;
  }
  bool is_active() {
    grpc::ClientContext context;
    externalscaler::IsActiveResponse response;
    return keda_->IsActive(&context, object_, &response).ok() && response.result();
  }
  // As the autoscaler computes it from a metric with an average value.
  int wanted_workers(int most) {
    grpc::ClientContext of_spec, of_value;
    externalscaler::GetMetricSpecResponse specs;
    externalscaler::GetMetricsRequest request;
    externalscaler::GetMetricsResponse values;
    *request.mutable_scaledobjectref() = object_;
    if (!keda_->GetMetricSpec(&of_spec, object_, &specs).ok() || specs.metricspecs_size() != 1) return -1;
    request.set_metricname(specs.metricspecs(0).metricname());
    if (!keda_->GetMetrics(&of_value, request, &values).ok() || values.metricvalues_size() != 1) return -1;
    const double workers = values.metricvalues(0).metricvaluefloat() / specs.metricspecs(0).targetsizefloat();
    return std::min(static_cast<int>(std::ceil(workers)), most);
  }
  void add_worker() {
    Process& worker = start_worker("pod-" + std::to_string(++started_pods_), 1);
    ASSERT_TRUE(poll_until(20s, [&] { return worker.err().find("registered with") != std::string::npos; }));
    running_.push_back(&worker);
  }
  // Ends a worker as Kubernetes does: the hook's signal, and its own.
  void remove_worker(std::size_t index) {
    Process* const worker = running_[index];
    running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(index));
    worker->signal(SIGTERM);
    worker->signal(SIGTERM);
    ended_.push_back(worker);
  }

  std::unique_ptr<externalscaler::ExternalScaler::Stub> keda_;
  externalscaler::ScaledObjectRef object_;
  std::vector<Process*> running_, ended_;
  int started_pods_ = 0;
};

TEST_F(Autoscaling, FollowsTheBacklogFromNoneToNone) {
  start("1");
  EXPECT_FALSE(is_active());
  EXPECT_EQ(wanted_workers(4), 0);
  const std::string id = submit({"--size", "256x256", "--spp", "64"});
  ASSERT_TRUE(poll_until(10s, [this] { return is_active(); }));
  EXPECT_EQ(wanted_workers(4), 1) << "no speed is known yet";
  add_worker();
  EXPECT_TRUE(poll_until(20s, [this] { return wanted_workers(4) >= 2; })) << "there are seconds of work";
  add_worker();
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  EXPECT_TRUE(poll_until(10s, [this] { return !is_active() && wanted_workers(4) == 0; }));
}

// What workers have rendered when they are ended counts: nothing of it is rendered again.
TEST_F(Autoscaling, ScalingDownWastesNothing) {
  constexpr int kScaleDowns = 8;
  start("1");
  const std::string id = submit({"--size", "512x512", "--spp", "65536"});  // more than it can do meanwhile
  std::minstd_rand random(7);
  for (int i = 0; i < kScaleDowns; ++i) {
    while (running_.size() < 3) add_worker();
    const std::uint64_t before = job(id).samples_done();
    ASSERT_TRUE(wait_for_samples(id, before + 20'000));
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 300));  // anywhere in a piece
    remove_worker(random() % running_.size());
  }
  while (!running_.empty()) remove_worker(0);
  std::uint64_t rendered = 0;
  for (Process* const worker : ended_) {
    EXPECT_EQ(worker->wait(30s), 0) << worker->err();
    rendered += rendered_samples(*worker);
  }
  const std::uint64_t counted = job(id).samples_done();
  EXPECT_GT(counted, 100'000u);
  EXPECT_LE(rendered - counted, rendered / 100) << rendered << " rendered, " << counted << " counted";
}

}  // namespace
}  // namespace tessera::test
