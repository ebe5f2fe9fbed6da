// SPDX-License-Identifier: Apache-2.0
// What cluster managers are told: the backlog, health by service name, and the external scaler over gRPC.
#include <grpcpp/create_channel.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "externalscaler.grpc.pb.h"
#include "server/scaling/cluster_server.hpp"
#include "server/scaling/scaler_service.hpp"

namespace tessera::scaling {
namespace {

using namespace std::chrono_literals;

farm::Totals totals_with(std::uint64_t missing, std::uint64_t busy, double speed) {
  farm::Totals totals;
  totals.scheduler.missing_samples = missing;
  totals.scheduler.workers[static_cast<std::size_t>(scheduler::WorkerActivity::kBusy)] = busy;
  totals.scheduler.samples_per_second = speed;
  return totals;
}

TEST(Totals, AreALineForTheServiceManager) {
  farm::Totals totals = totals_with(0, 10, 0);
  totals.validating_jobs = 1;
  totals.scheduler.jobs[static_cast<std::size_t>(scheduler::JobState::kRunning)] = 2;
  totals.scheduler.workers[static_cast<std::size_t>(scheduler::WorkerActivity::kIdle)] = 2;
  totals.scheduler.workers[static_cast<std::size_t>(scheduler::WorkerActivity::kSilent)] = 5;
  EXPECT_EQ(farm::summary_of(totals), "2 jobs running, 1 validating; 12 workers, 10 of them busy");
}

TEST(BacklogMeter, CountsTheSecondsOfOneWorker) {
  BacklogMeter meter;
  const BacklogMeter::Clock::time_point start{};
  EXPECT_EQ(meter.measure(totals_with(0, 0, 0), start), (Backlog{false, 0}));
  EXPECT_EQ(meter.measure(totals_with(50'000, 0, 0), start), (Backlog{true, 1})) << "no speed is known";
  EXPECT_EQ(meter.measure(totals_with(50'000, 2, 1000), start), (Backlog{true, 100}));
  EXPECT_EQ(meter.measure(totals_with(50'000, 0, 0), start + 1h), (Backlog{true, 100})) << "remembered";
  EXPECT_EQ(meter.measure(totals_with(50'000, 20, 10'000), start + 1h), (Backlog{true, 100}))
      << "more workers do not make the work less";
}

TEST(BacklogMeter, AveragesTheSpeed) {
  BacklogMeter meter;
  const BacklogMeter::Clock::time_point start{};
  meter.measure(totals_with(50'000, 1, 500), start);
  EXPECT_EQ(meter.measure(totals_with(50'000, 1, 1000), start + 15s).worker_seconds, 50'000 / 750.0);
}

TEST(BacklogMeter, WantsAWorkerForSamplesToVerifyAndScenesToValidate) {
  farm::Totals totals;
  totals.validating_jobs = 1;
  EXPECT_EQ(BacklogMeter().measure(totals, {}), (Backlog{true, 1}));
  totals.validating_jobs = 0;
  totals.scheduler.samples_to_verify = 10;
  EXPECT_EQ(BacklogMeter().measure(totals, {}), (Backlog{true, 1}));
}

class ClusterManager : public testing::Test {
 protected:
  ClusterManager() {
    server_ = *ClusterServer::start("127.0.0.1:0", [this] {
      while (hangs_) std::this_thread::yield();
      return totals_with(missing_, 2, 1000);
    });
    channel_ = grpc::CreateChannel(server_->address(), grpc::InsecureChannelCredentials());
    keda_ = externalscaler::ExternalScaler::NewStub(channel_);
  }
  ~ClusterManager() override { hangs_ = false; }

  // The bytes of HealthCheckResponse, or the status code.
  std::string health(const std::string& service) {
    std::string request;
    if (!service.empty()) request = std::string("\x0a") + static_cast<char>(service.size()) + service;
    const grpc::Slice slice(request);
    const grpc::ByteBuffer message(&slice, 1);
    grpc::ByteBuffer answer;
    grpc::ClientContext context;
    std::promise<grpc::Status> ended;
    grpc::GenericStub(channel_).UnaryCall(&context, "/grpc.health.v1.Health/Check", {}, &message, &answer,
                                          [&](grpc::Status status) { ended.set_value(std::move(status)); });
    const grpc::Status status = ended.get_future().get();
    if (!status.ok()) return std::to_string(status.error_code());
    grpc::Slice bytes;
    return answer.DumpToSingleSlice(&bytes).ok()
               ? std::string(reinterpret_cast<const char*>(bytes.begin()), bytes.size())
               : "unreadable";
  }
  externalscaler::ScaledObjectRef object(const std::string& target = {}) {
    externalscaler::ScaledObjectRef object;
    object.set_name("tessera-worker");
    if (!target.empty()) (*object.mutable_scalermetadata())[ScalerService::kTargetKey] = target;
    return object;
  }
  grpc::Status spec(const std::string& target, externalscaler::GetMetricSpecResponse& response) {
    grpc::ClientContext context;
    return keda_->GetMetricSpec(&context, object(target), &response);
  }

  std::atomic<std::uint64_t> missing_ = 50'000;
  std::atomic<bool> hangs_ = false;
  std::unique_ptr<ClusterServer> server_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<externalscaler::ExternalScaler::Stub> keda_;
};

TEST_F(ClusterManager, ReadsHealthByServiceName) {
  const std::string serving = "\x08\x01";
  for (const char* const service : {"", kLiveness, kReadiness})
    EXPECT_EQ(health(service), serving) << service;
  EXPECT_EQ(health("other"), std::to_string(grpc::StatusCode::NOT_FOUND));
}

TEST_F(ClusterManager, SeesAFarmThatHangsAsNotReady) {
  hangs_ = true;
  const auto late = std::chrono::steady_clock::now() + 30s;
  while (health(kReadiness) != "\x08\x02" && std::chrono::steady_clock::now() < late)
    std::this_thread::sleep_for(50ms);
  EXPECT_EQ(health(kReadiness), "\x08\x02");
  EXPECT_EQ(health(kLiveness), "\x08\x01") << "it may recover";
}

TEST_F(ClusterManager, ReadsTheBacklogAndItsTarget) {
  externalscaler::GetMetricSpecResponse specs;
  ASSERT_TRUE(spec("90.5", specs).ok());
  ASSERT_EQ(specs.metricspecs_size(), 1);
  EXPECT_EQ(specs.metricspecs(0).targetsize(), 91);
  EXPECT_EQ(specs.metricspecs(0).targetsizefloat(), 90.5);
  externalscaler::GetMetricsRequest request;
  request.set_metricname(specs.metricspecs(0).metricname());
  externalscaler::GetMetricsResponse values;
  grpc::ClientContext context;
  ASSERT_TRUE(keda_->GetMetrics(&context, request, &values).ok());
  ASSERT_EQ(values.metricvalues_size(), 1);
  EXPECT_EQ(values.metricvalues(0).metricname(), specs.metricspecs(0).metricname());
  EXPECT_EQ(values.metricvalues(0).metricvalue(), 100);
  EXPECT_EQ(values.metricvalues(0).metricvaluefloat(), 100);
}

TEST_F(ClusterManager, IsToldOfATargetThatIsNoNumberOfSeconds) {
  externalscaler::GetMetricSpecResponse specs;
  for (const char* const wrong : {"0", "-1", "two", "5s", "nan", "inf"})
    EXPECT_EQ(spec(wrong, specs).error_code(), grpc::StatusCode::INVALID_ARGUMENT) << wrong;
}

TEST_F(ClusterManager, FollowsWhetherThereIsWork) {
  grpc::ClientContext context, other;
  externalscaler::IsActiveResponse active;
  const auto stream = keda_->StreamIsActive(&context, object());
  ASSERT_TRUE(stream->Read(&active));
  EXPECT_TRUE(active.result());
  missing_ = 0;
  ASSERT_TRUE(stream->Read(&active));
  EXPECT_FALSE(active.result());
  ASSERT_TRUE(keda_->IsActive(&other, object(), &active).ok());
  EXPECT_FALSE(active.result());
  server_.reset();
  EXPECT_FALSE(stream->Read(&active)) << "the server ends its streams when it stops";
}

TEST_F(ClusterManager, CannotFollowWithTooManyStreams) {
  std::vector<std::unique_ptr<grpc::ClientContext>> contexts;
  std::vector<std::unique_ptr<grpc::ClientReader<externalscaler::IsActiveResponse>>> streams;
  externalscaler::IsActiveResponse active;
  for (int i = 0; i <= ScalerService::kMaxStreams; ++i) {
    contexts.push_back(std::make_unique<grpc::ClientContext>());
    streams.push_back(keda_->StreamIsActive(contexts.back().get(), object()));
    EXPECT_EQ(streams.back()->Read(&active), i < ScalerService::kMaxStreams);
  }
  EXPECT_EQ(streams.back()->Finish().error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  for (const auto& context : contexts) context->TryCancel();
}

TEST(ClusterServer, SaysWhereItCannotListen) {
  const auto server = ClusterServer::start("192.0.2.1:0", [] { return farm::Totals(); });
  ASSERT_FALSE(server);
  EXPECT_EQ(server.error().code, core::ErrorCode::kUnavailable);
  EXPECT_NE(server.error().message.find("--cluster"), std::string::npos);
}

}  // namespace
}  // namespace tessera::scaling
