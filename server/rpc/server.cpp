// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/server.hpp"

#include <fmt/format.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/impl/server_builder_option.h>
#include <grpcpp/server_builder.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "server/auth/auth_interceptor.hpp"
#include "server/base/periodic.hpp"
#include "server/rpc/listener.hpp"
#include "server/rpc/render_service.hpp"
#include "server/rpc/worker_service.hpp"

namespace tessera::rpc {

using server::Coordinator;

namespace {

constexpr auto kTickPeriod = std::chrono::milliseconds(100);
// A result that arrives just after a checkpoint began is stored by the next one. With the time of writing
// both, a crash costs at most two seconds of results, unless a checkpoint takes longer than this period.
constexpr auto kCheckpointPeriod = std::chrono::milliseconds(1000);
constexpr auto kReopenPeriod = std::chrono::milliseconds(500);
constexpr auto kLongestCheckpoint = std::chrono::milliseconds(500);
constexpr auto kRemovePeriod = std::chrono::milliseconds(100);
constexpr auto kCollectPeriod = std::chrono::minutes(10);
constexpr auto kLeaveForCalls = std::chrono::seconds(2);

constexpr int kSlowThreads = 2, kClearingThreads = 1;
constexpr std::size_t kMaxWaitingQuick = 1024;
constexpr std::size_t kMaxWaitingSlow = 64;

int quick_threads() {
  return std::max(2, static_cast<int>(std::thread::hardware_concurrency()));
}

// The limits, lowered where the process may not open so many files. A quarter of the files is for the store,
// uploads and validators.
ConnectionSlots connection_slots(const server::Limits& limits) {
  std::uint64_t most = limits.connections;
  rlimit files{};
  if (getrlimit(RLIMIT_NOFILE, &files) == 0 && most > files.rlim_cur - files.rlim_cur / 4) {
    most = std::max<std::uint64_t>(1, files.rlim_cur - files.rlim_cur / 4);
    spdlog::warn(
        "this process may open {} files, which is too few for --max-connections {}: it takes {} (ulimit -n, "
        "LimitNOFILE= of systemd)",
        files.rlim_cur, limits.connections, most);
  }
  return {most, limits.machine_connections};
}

// Removes the plugin of the linked reflection service, which would answer everybody and parse any message.
class WithoutReflection final : public grpc::ServerBuilderOption {
 public:
  void UpdateArguments(grpc::ChannelArguments*) override {}
  void UpdatePlugins(std::vector<std::unique_ptr<grpc::ServerBuilderPlugin>>* plugins) override {
    const std::string name = grpc::reflection::ProtoServerReflectionPlugin().name();
    std::erase_if(*plugins, [&](const auto& plugin) { return plugin->name() == name; });
  }
};

// Logs failures and recoveries of checkpoints once each. For one thread at a time.
class CheckpointLog {
 public:
  void write(Coordinator& coordinator) {
    const auto begin = std::chrono::steady_clock::now();
    const core::Status written = coordinator.checkpointer().checkpoint();
    note_time(std::chrono::steady_clock::now() - begin);
    note(written);
  }

 private:
  void note_time(std::chrono::steady_clock::duration took) {
    const bool is_slow = took > kLongestCheckpoint;
    if (is_slow && !was_slow_)
      spdlog::warn(
          "writing a checkpoint took {} ms: while they take more than {} ms, a crash costs more than two "
          "seconds of work; is the disk busy or slow?",
          std::chrono::duration_cast<std::chrono::milliseconds>(took).count(), kLongestCheckpoint.count());
    was_slow_ = is_slow;
  }
  void note(const core::Status& written) {
    const std::string failure = written ? "" : written.error().message;
    if (failure == failure_) return;
    failure_ = failure;
    if (written) return spdlog::info("checkpoints are written again");
    spdlog::error("cannot write checkpoints; a crash would lose the work since the last one: {}", failure);
  }

  std::string failure_;  // empty after a success
  bool was_slow_ = false;
};

}  // namespace

struct Server::Parts {
  Parts(Coordinator& c, auth::Access access, const server::Limits& l)
      : coordinator(c),
        limits(l),
        gate(std::move(access), limits),
        streams(limits),
        quick(quick_threads(), kMaxWaitingQuick),
        users(quick_threads(), kMaxWaitingQuick),
        slow(kSlowThreads, kMaxWaitingSlow),
        validating(limits.validations, limits.waiting_scenes),
        clearing(kClearingThreads, limits.uploads),
        watches(c),
        render_service(c, gate, {quick, users, slow, validating, clearing}, watches, streams),
        worker_service(c, gate, quick, streams),
        checkpointer(kCheckpointPeriod, [this] { checkpoint_log.write(coordinator); }),
        ticker(kTickPeriod,
               [this] {
                 gate.flush_log();
                 if (coordinator.dispatcher().tick()) checkpointer.trigger();
               }),
        reopener(kReopenPeriod, [this] { coordinator.jobs().reopen(); }),
        remover(kRemovePeriod, [this] { remove_deleted_tiles(); }),
        collector(kCollectPeriod, [this] { coordinator.files().collect(); }) {}

  void remove_deleted_tiles();
  // Requires a listener.
  core::Status serve(const std::shared_ptr<grpc::ServerCredentials>& credentials,
                     const proto::Patience& patience, bool with_reflection);

  Coordinator& coordinator;
  const server::Limits limits;
  auth::AuthInterceptor gate;
  StreamLimits streams;
  base::ThreadPool quick;
  base::FairPool users, slow, validating, clearing;
  WatchHub watches;
  RenderService render_service;
  WorkerService worker_service;
  CheckpointLog checkpoint_log;
  std::string last_failure_to_remove;  // used by the remover thread only
  base::Periodic checkpointer, ticker, reopener, remover, collector;
  std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> acceptor;
  std::unique_ptr<grpc::Server> grpc;
  std::unique_ptr<Listener> listener;  // passes connections to the acceptor
};

void Server::Parts::remove_deleted_tiles() {
  const core::Status removed = coordinator.jobs().remove_deleted_tiles();
  const std::string failure = removed ? "" : removed.error().message;
  if (!failure.empty() && failure != last_failure_to_remove)
    spdlog::warn("cannot remove the films of deleted jobs yet, and will try again: {}", failure);
  last_failure_to_remove = failure;
}

core::Status Server::Parts::serve(const std::shared_ptr<grpc::ServerCredentials>& credentials,
                                  const proto::Patience& patience, bool with_reflection) {
  grpc::EnableDefaultHealthCheckService(true);
  grpc::ServerBuilder builder;
  if (!with_reflection) builder.SetOption(std::make_unique<WithoutReflection>());
  proto::apply_server_options(builder, patience,
                              {.message_bytes = static_cast<int>(limits.message_mib * server::kMib),
                               .quota_bytes = limits.receive_mib * server::kMib});
  builder.RegisterService(&render_service);
  builder.RegisterService(&worker_service);
  acceptor = builder.experimental().AddExternalConnectionAcceptor(
      grpc::ServerBuilder::experimental_type::ExternalConnectionType::FROM_FD, credentials);
  grpc = builder.BuildAndStart();
  if (!grpc) return core::fail(core::ErrorCode::kInternal, "gRPC does not start");
  listener->start([this](int descriptor) {
    grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters connection;
    connection.fd = descriptor;
    acceptor->HandleNewConnection(&connection);
  });
  return {};
}

Server::Server(std::unique_ptr<Parts> parts, std::string address)
    : parts_(std::move(parts)), address_(std::move(address)) {}

Server::~Server() {
  if (const auto stopped = stop(); !stopped) {
    spdlog::error("could not write the last checkpoint: {}", stopped.error().message);
  }
}

core::Result<std::unique_ptr<Server>> Server::start(Coordinator& coordinator, ServerOptions options) {
  const std::string& address = options.address;
  const auto credentials = proto::server_credentials(address, options.security);
  if (!credentials) return core::fail(credentials.error());
  // Reflection parses messages before callers are authenticated.
  const bool with_reflection = options.access.is_open() || !options.security.client_ca.empty();
  auto listening = listen_on(address, options.patience.answer);
  if (!listening) return core::fail(listening.error());
  auto listener = Listener::make(std::move(*listening), connection_slots(options.limits));
  if (!listener) return core::fail(listener.error());
  auto parts = std::make_unique<Parts>(coordinator, std::move(options.access), options.limits);
  parts->listener = std::move(*listener);
  if (const auto served = parts->serve(*credentials, options.patience, with_reflection); !served)
    return core::fail(served.error());
  const std::string host = address.substr(0, address.rfind(':'));
  const int port = parts->listener->port();
  return std::unique_ptr<Server>(new Server(std::move(parts), fmt::format("{}:{}", host, port)));
}

core::Status Server::stop() {
  if (!parts_) return {};
  Coordinator& coordinator = parts_->coordinator;
  coordinator.close();
  parts_->slow.close();
  parts_->validating.close();
  parts_->clearing.close();
  parts_->watches.close();
  parts_->listener->stop();
  parts_->grpc->Shutdown(std::chrono::system_clock::now() + kLeaveForCalls);
  parts_->grpc->Wait();
  parts_.reset();
  return coordinator.checkpointer().checkpoint();
}

}  // namespace tessera::rpc
