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
#include <stop_token>
#include <thread>
#include <utility>

#include "core/base/available_resources.hpp"
#include "core/base/mutex.hpp"
#include "proto/listener.hpp"
#include "server/auth/auth_interceptor.hpp"
#include "server/base/periodic.hpp"
#include "server/base/wall_clock.hpp"
#include "server/rpc/admin_service.hpp"
#include "server/rpc/render_service.hpp"
#include "server/rpc/validation_queue.hpp"
#include "server/rpc/worker_service.hpp"

namespace tessera::rpc {

using server::Coordinator;

namespace {

constexpr auto kTickPeriod = std::chrono::milliseconds(100);
// A result that arrives just after a checkpoint began is stored by the next one. With the time of writing
// both, a crash costs at most two seconds of results, unless a checkpoint takes longer than this period.
constexpr auto kCheckpointPeriod = std::chrono::milliseconds(1000);
constexpr auto kValidatePeriod = std::chrono::milliseconds(500);
constexpr auto kReopenPeriod = std::chrono::milliseconds(500);
constexpr auto kLongestCheckpoint = std::chrono::milliseconds(500);
constexpr auto kRemovePeriod = std::chrono::milliseconds(100);
constexpr auto kRetirePeriod = std::chrono::seconds(1);
constexpr auto kCollectPeriod = std::chrono::minutes(10);
constexpr auto kHealthPeriod = std::chrono::milliseconds(1000);
constexpr auto kLeaveForCalls = std::chrono::seconds(2);

constexpr const char* kRenderService = "tessera.v1.RenderService";

constexpr int kSlowThreads = 2, kClearingThreads = 1;
constexpr std::size_t kMaxWaiting = 1024;
constexpr std::size_t kMaxWaitingSlow = 64;

// Of each pool for tasks that take milliseconds.
int pool_threads() {
  return std::max(2, static_cast<int>(core::available_threads()));
}

// The limits, lowered where the process may not open so many files. A quarter of the files is for the store,
// uploads and validators.
proto::ConnectionSlots connection_slots(const server::Limits& limits) {
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

// A checkpoint, and what has changed of the quarantine.
core::Status write_all(Coordinator& coordinator) {
  const core::Status saved = coordinator.fleet().save();
  const core::Status written = coordinator.checkpointer().checkpoint();
  return written ? saved : written;
}

// Logs failures and recoveries of checkpoints once each. For one thread at a time.
class CheckpointLog {
 public:
  // Returns whether everything was written.
  core::Status write(Coordinator& coordinator) {
    const auto begin = std::chrono::steady_clock::now();
    core::Status written = write_all(coordinator);
    note_time(std::chrono::steady_clock::now() - begin);
    note(written);
    return written;
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
  Parts(Coordinator& c, auth::Access access, const server::Limits& l, const ServerFacts& f,
        const jobs::KeepFinished& keep)
      : coordinator(c),
        limits(l),
        keep_finished(keep),
        gate(std::move(access), limits),
        calls(gate.methods()),
        streams(limits, calls),
        heartbeats(pool_threads(), kMaxWaiting),
        results(pool_threads(), kMaxWaiting),
        receiving(pool_threads(), kMaxWaiting + static_cast<std::size_t>(limits.uploads)),
        sending(pool_threads(), kMaxWaiting + static_cast<std::size_t>(limits.fetches)),
        users(pool_threads(), kMaxWaiting),
        watching(pool_threads(), limits.watches),
        slow(kSlowThreads, kMaxWaitingSlow),
        validations(c, limits),
        clearing(kClearingThreads, limits.uploads),
        watches(c.events()),
        facts(f),
        render_service(c, gate, pools(), validations, watches, streams, facts),
        worker_service(c, gate, pools(), streams),
        admin_service(c, gate, users, streams),
        checkpointer(kCheckpointPeriod, [this] { write_checkpoint(); }),
        ticker(kTickPeriod,
               [this] {
                 gate.flush_log();
                 if (coordinator.dispatcher().tick()) checkpointer.trigger();
                 readiness.note_lock();
               }),
        validator(kValidatePeriod, [this] { validations.post_unvalidated(); }),
        reopener(kReopenPeriod, [this] { coordinator.jobs().reopen(); }),
        remover(kRemovePeriod, [this] { note_maintenance(coordinator.jobs().remove_deleted_tiles()); }),
        retirer(kRetirePeriod, [this] { note_maintenance(coordinator.jobs().retire(keep_finished)); }),
        collector(kCollectPeriod, [this] { coordinator.files().collect(); }),
        store_checker([this](const std::stop_token& stop) { check_store(stop); }) {}

  Pools pools() { return {heartbeats, results, receiving, sending, users, watching, slow, clearing}; }
  void write_checkpoint();
  // Tells gRPC's health service whether the coordinator takes new work.
  void report_health();
  // Logs each failure once.
  void note_maintenance(const core::Status& done);
  // Reads what was too large to be checked at the start.
  void check_store(const std::stop_token& stop);
  // Requires a listener.
  core::Status serve(const std::shared_ptr<grpc::ServerCredentials>& credentials,
                     const proto::Patience& patience, bool with_reflection);

  Coordinator& coordinator;
  const server::Limits limits;
  const jobs::KeepFinished keep_finished;
  auth::AuthInterceptor gate;
  CallStats calls;
  StreamLimits streams;
  base::ThreadPool heartbeats, results, receiving, sending;
  base::FairPool users, watching, slow;
  ValidationQueue validations;
  base::FairPool clearing;
  WatchHub watches;
  const ServerFacts facts;
  Readiness readiness;
  RenderService render_service;
  WorkerService worker_service;
  AdminService admin_service;
  CheckpointLog checkpoint_log;
  core::Mutex maintenance_mutex;
  std::string last_maintenance_failure TESSERA_GUARDED_BY(maintenance_mutex);
  base::Periodic checkpointer, ticker, validator, reopener, remover, retirer, collector;
  std::jthread store_checker;
  std::shared_ptr<proto::Certificates> certificates;  // null without TLS
  std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> acceptor;
  std::unique_ptr<grpc::Server> grpc;
  std::unique_ptr<base::Periodic> health_reporter;
  std::unique_ptr<proto::Listener> listener;  // passes connections to the acceptor
};

// A checkpoint without changes writes nothing, and succeeds on a full disk.
void Server::Parts::write_checkpoint() {
  const core::Status written = checkpoint_log.write(coordinator);
  std::string trouble = base::write_obstacle(coordinator.store().file().parent_path());
  if (trouble.empty() && !written) trouble = "the last checkpoint failed; the coordinator's log says why";
  readiness.note_store(std::move(trouble));
}

void Server::Parts::report_health() {
  grpc->GetHealthCheckService()->SetServingStatus(kRenderService, readiness.status().has_value());
}

void Server::Parts::note_maintenance(const core::Status& done) {
  const std::string failure = done ? "" : done.error().message;
  const core::MutexLock lock(maintenance_mutex);
  if (!failure.empty() && failure != last_maintenance_failure)
    spdlog::warn("cannot delete films and jobs yet, and will try again: {}", failure);
  if (!failure.empty()) last_maintenance_failure = failure;
}

void Server::Parts::check_store(const std::stop_token& stop) {
  store::JobStore& store = coordinator.store();
  if (!store.has_rest_to_check()) return;
  spdlog::info("the database is large: it is checked while the coordinator runs");
  const core::Status checked = store.check_rest(stop);
  if (checked) return spdlog::info("the database is whole");
  if (!stop.stop_requested()) spdlog::critical("nothing is stored any more: {}", checked.error().message);
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
  builder.RegisterService(&admin_service);
  acceptor = builder.experimental().AddExternalConnectionAcceptor(
      grpc::ServerBuilder::experimental_type::ExternalConnectionType::FROM_FD, credentials);
  grpc = builder.BuildAndStart();
  if (!grpc) return core::fail(core::ErrorCode::kInternal, "gRPC does not start");
  for (const char* const service : {kRenderService, "tessera.v1.WorkerService", "tessera.v1.AdminService"})
    grpc->GetHealthCheckService()->SetServingStatus(service, true);
  health_reporter = std::make_unique<base::Periodic>(kHealthPeriod, [this] { report_health(); });
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
  auto listening = options.sockets.empty() ? proto::listen_on(address, options.patience.answer)
                                           : core::Result<proto::ListeningSockets>(proto::adopt(
                                                 std::move(options.sockets), options.patience.answer));
  if (!listening) return core::fail(listening.error());
  auto listener =
      proto::Listener::make(std::move(*listening), connection_slots(options.limits),
                            {"this farm takes no more (--max-connections)",
                             "this farm takes no more of one machine (--max-machine-connections)"});
  if (!listener) return core::fail(listener.error());
  const ServerFacts facts{.fingerprints = coordinator.fingerprints(),
                          .started_ms = base::wall_clock_ms(),
                          .is_open = options.access.is_open()};
  auto parts = std::make_unique<Parts>(coordinator, std::move(options.access), options.limits, facts,
                                       options.keep_finished);
  parts->listener = std::move(*listener);
  parts->certificates = credentials->certificates;
  if (const auto served = parts->serve(credentials->credentials, options.patience, with_reflection); !served)
    return core::fail(served.error());
  const std::string host = address.substr(0, address.rfind(':'));
  const int port = parts->listener->port();
  return std::unique_ptr<Server>(new Server(std::move(parts), fmt::format("{}:{}", host, port)));
}

Services Server::services() {
  Parts& p = *parts_;
  return {p.coordinator, p.gate, p.pools(), p.validations, p.watches, p.streams, p.facts, p.readiness};
}

const CallStats& Server::calls() const {
  return parts_->calls;
}

std::vector<Server::QueueDepth> Server::queue_depths() const {
  return {{"heartbeats", parts_->heartbeats.waiting()},
          {"results", parts_->results.waiting()},
          {"receiving", parts_->receiving.waiting()},
          {"sending", parts_->sending.waiting()},
          {"users", parts_->users.waiting()},
          {"watching", parts_->watching.waiting()},
          {"slow", parts_->slow.waiting()},
          {"validating", parts_->validations.waiting()},
          {"clearing", parts_->clearing.waiting()}};
}

proto::Certificates* Server::certificates() {
  return parts_->certificates.get();
}

void Server::announce_stop() {
  parts_->readiness.note_stop();
  parts_->report_health();
}

core::Status Server::stop() {
  if (!parts_) return {};
  parts_->health_reporter.reset();
  announce_stop();
  Coordinator& coordinator = parts_->coordinator;
  coordinator.close();
  parts_->slow.close();
  parts_->validations.close();
  parts_->clearing.close();
  parts_->watches.close();
  parts_->listener->stop();
  parts_->grpc->Shutdown(std::chrono::system_clock::now() + kLeaveForCalls);
  parts_->grpc->Wait();
  parts_.reset();
  return write_all(coordinator);
}

void Server::replace_access(auth::Access access) {
  parts_->gate.replace_access(std::move(access));
}

}  // namespace tessera::rpc
