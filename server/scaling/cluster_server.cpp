// SPDX-License-Identifier: Apache-2.0
#include "server/scaling/cluster_server.hpp"

#include <fmt/format.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/impl/server_builder_option.h>
#include <grpcpp/resource_quota.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include <atomic>
#include <chrono>
#include <utility>
#include <vector>

#include "server/base/periodic.hpp"
#include "server/scaling/backlog_board.hpp"
#include "server/scaling/scaler_service.hpp"

namespace tessera::scaling {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto kPeriod = 1s;
constexpr auto kReadyWithin = 5s, kAliveWithin = 60s;
constexpr auto kEndOfCalls = 1s;

// Messages are of a few names and numbers, and callers few.
constexpr int kMaxMessageBytes = 16 << 10;
constexpr int kMaxStreamsOfConnection = 32;
constexpr std::size_t kMaxMemory = 64 << 20;
constexpr int kMaxThreads = 32;

// Removes what linked libraries add to every server, such as reflection.
class WithoutPlugins final : public grpc::ServerBuilderOption {
 public:
  void UpdateArguments(grpc::ChannelArguments*) override {}
  void UpdatePlugins(std::vector<std::unique_ptr<grpc::ServerBuilderPlugin>>* plugins) override {
    plugins->clear();
  }
};

}  // namespace

struct ClusterServer::Parts {
  explicit Parts(ReadTotals read) : read_totals(std::move(read)), scaler(board) { measure(); }
  ~Parts();

  void measure();
  // On a thread of its own, which does not wait for the state lock.
  void report_health();

  const ReadTotals read_totals;
  BacklogMeter meter;  // of the measuring thread
  BacklogBoard board;
  ScalerService scaler;
  std::atomic<Clock::time_point> measured_at{};
  std::unique_ptr<grpc::Server> server;
  std::unique_ptr<base::Periodic> measuring, reporting;
};

ClusterServer::Parts::~Parts() {
  reporting.reset();
  board.close();
  if (server) {
    server->GetHealthCheckService()->Shutdown();
    server->Shutdown(std::chrono::system_clock::now() + kEndOfCalls);
    server->Wait();
  }
  measuring.reset();
}

void ClusterServer::Parts::measure() {
  board.publish(meter.measure(read_totals(), Clock::now()));
  measured_at = Clock::now();
}

void ClusterServer::Parts::report_health() {
  const auto age = Clock::now() - measured_at.load();
  server->GetHealthCheckService()->SetServingStatus(kReadiness, age < kReadyWithin);
  server->GetHealthCheckService()->SetServingStatus(kLiveness, age < kAliveWithin);
}

ClusterServer::ClusterServer(std::unique_ptr<Parts> parts, std::string address)
    : parts_(std::move(parts)), address_(std::move(address)) {}

ClusterServer::~ClusterServer() = default;

core::Result<std::unique_ptr<ClusterServer>> ClusterServer::start(const std::string& address,
                                                                  ReadTotals read_totals) {
  auto parts = std::make_unique<Parts>(std::move(read_totals));
  grpc::EnableDefaultHealthCheckService(true);
  grpc::ResourceQuota quota("cluster");
  quota.Resize(kMaxMemory).SetMaxThreads(kMaxThreads);
  int port = 0;
  grpc::ServerBuilder builder;
  builder.SetOption(std::make_unique<WithoutPlugins>())
      .SetResourceQuota(quota)
      .SetMaxReceiveMessageSize(kMaxMessageBytes)
      .AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, kMaxStreamsOfConnection)
      .AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0)
      .AddListeningPort(address, grpc::InsecureServerCredentials(), &port)
      .RegisterService(&parts->scaler);
  parts->server = builder.BuildAndStart();
  if (!parts->server || port == 0)
    return core::fail(
        core::ErrorCode::kUnavailable,
        fmt::format("cannot listen on {} for --cluster: it must be HOST:PORT, with an address of "
                    "this machine and a port that is free",
                    address));
  parts->report_health();
  parts->measuring = std::make_unique<base::Periodic>(kPeriod, [p = parts.get()] { p->measure(); });
  parts->reporting = std::make_unique<base::Periodic>(kPeriod, [p = parts.get()] { p->report_health(); });
  const std::string host = address.substr(0, address.rfind(':'));
  return std::unique_ptr<ClusterServer>(
      new ClusterServer(std::move(parts), fmt::format("{}:{}", host, port)));
}

}  // namespace tessera::scaling
