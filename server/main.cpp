// SPDX-License-Identifier: Apache-2.0
// tessera-coordinator: see options.hpp.
#include <absl/synchronization/mutex.h>
#include <fmt/format.h>
#include <signal.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>

#include <cstdlib>
#include <exception>
#include <iostream>
#include <memory>
#include <new>
#include <stop_token>
#include <utility>
#include <vector>

#include "core/base/printable.hpp"
#include "core/base/standard_streams.hpp"
#include "core/cli/parse.hpp"
#include "core/common/journal.hpp"
#include "core/common/log.hpp"
#include "core/common/metrics_server.hpp"
#include "core/common/open_files.hpp"
#include "core/common/passed_sockets.hpp"
#include "core/common/secret_file.hpp"
#include "core/common/service_manager.hpp"
#include "core/common/start_limits.hpp"
#include "proto/certificates.hpp"
#include "proto/channel.hpp"
#include "server/admin/maintenance.hpp"
#include "server/base/file.hpp"
#include "server/farm/totals.hpp"
#include "server/http/api.hpp"
#include "server/metrics/collect.hpp"
#include "server/options.hpp"
#include "server/rpc/server.hpp"
#include "server/scaling/cluster_server.hpp"
#include "server/scene_check.hpp"

namespace {

using namespace tessera;

// Blocks the signals of the operator in this thread and those it starts; sigwait() receives them.
sigset_t block_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

void warn_of_open_doors(const server::Options& options) {
  const bool tls = !options.security.certificate.empty();
  if (proto::is_loopback(options.listen)) return;
  if (!tls)
    spdlog::warn("there is no TLS: others on the network can read and change the traffic of {}",
                 options.listen);
  if (options.tokens.empty() && options.security.client_ca.empty())
    spdlog::warn("neither --tokens nor --tls-client-ca: anybody who reaches {} may submit and render",
                 options.listen);
  if (tls && options.security.client_ca.empty())
    spdlog::warn(
        "no --tls-client-ca: anybody who reaches {} can use up the memory of this process and stop it",
        options.listen);
}

// Takes the sockets of the service manager instead of listening itself. Their addresses replace the options,
// so that they need the same security.
core::Status adopt_passed_sockets(server::Options& options, std::vector<base::Fd>& sockets) {
  auto passed = common::take_passed_sockets();
  if (!passed) return core::fail(passed.error());
  for (const common::PassedSocket& each : *passed) {
    if (each.name == "http" && options.http_socket < 0) {
      options.http = each.address;
      options.http_socket = each.descriptor;
      options.http_is_given = true;
    } else if (each.name == "grpc") {
      const bool is_first = sockets.empty() || !proto::is_loopback(each.address);
      if (is_first) options.listen = each.address;
      sockets.emplace(is_first ? sockets.begin() : sockets.end(), each.descriptor);
    } else {
      return core::fail(core::ErrorCode::kInvalidArgument,
                        fmt::format("the service manager has passed on a socket at {} with the name '{}': "
                                    "FileDescriptorName= must be grpc, or http for one socket",
                                    each.address, core::printable(each.name)));
    }
  }
  return {};
}

// Null if it is off, or if nobody has asked for it and its port is taken. The server must outlive it.
core::Result<std::unique_ptr<http_api::Api>> serve_page(const server::Options& options, rpc::Server& server) {
  if (options.http == "off") return nullptr;
  auto page = http_api::Api::start(server.services(), {options.http, options.http_socket, options.security,
                                                       options.state / store::kSessionsName});
  if (page) return page;
  if (options.http_is_given) return core::fail(page.error().within("--http"));
  if (page.error().code != core::ErrorCode::kUnavailable) return page;
  spdlog::warn("there is no page: {} (--http HOST:PORT chooses another port, --http off silences this)",
               page.error().message);
  return nullptr;
}

// Null unless the options ask for metrics. Coordinator, server and page must outlive it.
core::Result<std::unique_ptr<common::MetricsServer>> serve_metrics(const server::Options& options,
                                                                   server::Coordinator& coordinator,
                                                                   const rpc::Server& server,
                                                                   const http_api::Api* page) {
  if (options.metrics.empty()) return nullptr;
  const rpc::CallStats* const http_calls = page == nullptr ? nullptr : &page->calls();
  auto metrics = common::MetricsServer::start(options.metrics, [&coordinator, &server, http_calls] {
    return metrics::collect(coordinator, server, http_calls);
  });
  if (metrics) spdlog::info("metrics at http://{}/metrics", (*metrics)->address());
  return metrics;
}

// Null unless the options ask for it. The coordinator must outlive it.
core::Result<std::unique_ptr<scaling::ClusterServer>> serve_cluster(const server::Options& options,
                                                                    server::Coordinator& coordinator) {
  if (options.cluster.empty()) return nullptr;
  auto cluster = scaling::ClusterServer::start(
      options.cluster, [&coordinator] { return farm::totals_of(coordinator.farm()); });
  if (cluster) spdlog::info("cluster managers are served at {}", (*cluster)->address());
  return cluster;
}

void warn_of_exposed_secrets(const server::Options& options) {
  for (const std::string& secret : {options.security.key, options.tokens})
    if (const auto warning = common::exposure_of(secret)) spdlog::warn("{}", *warning);
}

// Calls in progress, jobs and connections are not affected, and a damaged file changes nothing.
void reload_tokens(const server::Options& options, rpc::Server& server) {
  if (options.tokens.empty()) return;
  auto access = auth::Access::read(options.tokens);
  if (!access)
    return spdlog::error("the tokens stay as they were, since the new ones cannot be read: {}",
                         access.error().message);
  server.replace_access(*std::move(access));
  spdlog::info("has read the tokens in {} again", options.tokens);
  warn_of_exposed_secrets(options);
}

// As for tokens.
void reload_certificates(const server::Options& options, rpc::Server& server, http_api::Api* page) {
  if (server.certificates() == nullptr) return;
  if (const core::Status done = server.certificates()->reload(); !done)
    return spdlog::error("the certificates stay as they were, since the new ones cannot be used: {}",
                         done.error().message);
  if (page != nullptr)
    if (const core::Status done = page->reload_certificates(); !done)
      return spdlog::error("the page keeps its certificates, since the new ones cannot be used: {}",
                           done.error().message);
  spdlog::info("has read the certificate in {} again", options.security.certificate);
}

void wait_for_stop(const server::Options& options, rpc::Server& server, http_api::Api* page,
                   const sigset_t& signals, common::ServiceReport& report) {
  int signal = 0;
  while (sigwait(&signals, &signal) == 0 && signal == SIGHUP) {
    report.reloading();
    reload_tokens(options, server);
    reload_certificates(options, server, page);
    report.reloaded();
  }
  spdlog::info("stopping on signal {}", signal);
  server.announce_stop();
  report.stopping();
}

core::Status run(const server::Options& options, std::vector<base::Fd> sockets, const sigset_t& signals) {
  if (const auto enough = common::check_start_limits("a coordinator", common::kCoordinatorThreads); !enough)
    return enough;
  const server::ValidatorOptions validator{
      .program = options.validator, .limits = options.limits, .require_sandbox = options.require_sandbox};
  const auto warn = [](const std::string& line) { spdlog::warn("{}", line); };
  if (const auto usable = server::check_validator(validator, warn); !usable) return usable;
  auto state = store::StateDirectory::open(options.state);
  if (!state) return core::fail(state.error());
  auto check = server::confined_scene_check(validator, state->blobs);
  server::CoordinatorOptions settings;
  settings.limits = options.limits;
  settings.farm.lease_duration =
      std::chrono::duration_cast<scheduler::Duration>(std::chrono::duration<double>(options.lease_seconds));
  settings.keep_unused_blobs = std::chrono::duration_cast<std::chrono::seconds>(
      std::chrono::duration<double, std::ratio<3600>>(options.keep_unused_hours));
  settings.farm.audit_share = options.audit;
  if (!options.fingerprints.empty())
    settings.farm.fingerprints = {options.fingerprints.begin(), options.fingerprints.end()};
  const auto coordinator = server::Coordinator::open(settings, std::move(*state), std::move(check));
  if (!coordinator) return core::fail(coordinator.error());
  rpc::ServerOptions serving{.address = options.listen,
                             .sockets = std::move(sockets),
                             .security = options.security,
                             .limits = options.limits};
  if (!options.keep_finished.empty()) {
    const auto keep = jobs::read_keep_finished(options.keep_finished);
    if (!keep) return core::fail(keep.error());
    serving.keep_finished = *keep;
  }
  if (!options.tokens.empty()) {
    auto access = auth::Access::read(options.tokens);
    if (!access) return core::fail(access.error());
    serving.access = *std::move(access);
  }
  const auto server = rpc::Server::start(**coordinator, std::move(serving));
  if (!server) return core::fail(server.error());
  auto page = serve_page(options, **server);
  if (!page) return core::fail(page.error());
  auto metrics = serve_metrics(options, **coordinator, **server, page->get());
  if (!metrics) return core::fail(metrics.error());
  auto cluster = serve_cluster(options, **coordinator);
  if (!cluster) return core::fail(cluster.error());

  warn_of_open_doors(options);
  warn_of_exposed_secrets(options);
  common::flush_log();
  std::cout << "tessera-coordinator: listening on " << (*server)->address() << std::endl;
  if (*page) std::cout << "tessera-coordinator: the page is at " << (*page)->url() << std::endl;
  common::ServiceReport report([&] { return farm::summary_of(farm::totals_of((*coordinator)->farm())); });
  wait_for_stop(options, **server, page->get(), signals, report);
  cluster->reset();
  metrics->reset();
  page->reset();
  return (*server)->stop();
}

core::Status run_guarded(server::Options options, const sigset_t& signals) {
  try {
    std::vector<base::Fd> sockets;
    if (auto adopted = adopt_passed_sockets(options, sockets); !adopted) return adopted;
    return run(options, std::move(sockets), signals);
  } catch (const std::bad_alloc&) {
    return core::fail(core::ErrorCode::kResourceExhausted,
                      "there is not enough memory to start (ulimit -v, LimitAS= or MemoryMax= of systemd)");
  } catch (const std::exception& error) {
    return core::fail(core::ErrorCode::kInternal, fmt::format("cannot start: {}", error.what()));
  }
}

}  // namespace

int main(int argc, char** argv) {
  core::prepare_standard_streams();
  proto::configure_grpc();
  const server::Options options = server::parse_options(argc, argv);
  common::log_to_stderr("tessera-coordinator", options.log);
  ::umask(S_IRWXG | S_IRWXO);  // other users of this machine must not read submitted scenes
  if (!options.check.empty()) return admin::check(options.check);
  if (!options.salvage.empty()) return admin::salvage(options.salvage);
  if (!options.backup.empty()) return admin::back_up(options.state, options.backup);
  if (!options.restore.empty()) return admin::restore(options.restore, options.state);
  // Debian's Abseil searches for deadlocks each time that gRPC takes a lock.
  absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kIgnore);
  common::raise_file_limit();
  const sigset_t signals = block_signals();
  const auto ended = run_guarded(options, signals);
  if (ended) return EXIT_SUCCESS;
  if (common::stderr_is_journal()) std::cerr << common::journal_prefix(spdlog::level::err);
  return cli::print_error("tessera-coordinator", ended.error().message);
}
