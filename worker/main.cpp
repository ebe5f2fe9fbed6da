// SPDX-License-Identifier: Apache-2.0
// tessera-worker: renders for a farm.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <memory>
#include <stop_token>

#include "core/base/standard_streams.hpp"
#include "core/base/version.hpp"
#include "core/common/log.hpp"
#include "core/common/metrics_server.hpp"
#include "core/common/secret_file.hpp"
#include "core/common/service_manager.hpp"
#include "core/common/start_limits.hpp"
#include "core/integrators/fingerprint.hpp"
#include "proto/channel.hpp"
#include "proto/client_credentials.hpp"
#include "proto/unreachable.hpp"
#include "proto/worker_key.hpp"
#include "worker/machine_key.hpp"
#include "worker/options.hpp"
#include "worker/peer_server.hpp"
#include "worker/self_restart.hpp"
#include "worker/signals.hpp"
#include "worker/worker.hpp"

namespace {

using namespace tessera;

worker::SyncLoop::Explain explaining(const worker::Options& options) {
  return [options](const grpc::Status& status) {
    return proto::is_no_connection(status)
               ? proto::explain_no_connection(status, options.coordinator, options.security)
               : proto::error_from_grpc(status);
  };
}

// Building a scene and rendering a piece take less, or there is something wrong; loading has a limit of its
// own.
constexpr std::chrono::hours kLongestStep{1};

// Null if there is no address. The others must outlive it.
core::Result<std::unique_ptr<common::MetricsServer>> serve_metrics(const worker::Options& options,
                                                                   const worker::Worker& worker,
                                                                   const worker::Identity& identity,
                                                                   const worker::BlobCache& cache) {
  if (options.metrics.empty()) return nullptr;
  const auto longest_step = options.loader.time + kLongestStep;
  auto metrics = common::MetricsServer::start(
      options.metrics, [&] { return worker::collect(worker.metrics(), identity, cache); },
      {.alive = [&worker, longest_step] { return worker::check_alive(worker.metrics(), longest_step); },
       .ready = [&worker, longest_step] { return worker::check_ready(worker.metrics(), longest_step); }});
  if (metrics) spdlog::info("metrics at http://{}/metrics", (*metrics)->address());
  return metrics;
}

// Null if there is no address. The cache must outlive it.
core::Result<std::unique_ptr<worker::PeerServer>> serve_blobs(const std::string& address,
                                                              const worker::BlobCache& cache) {
  if (address.empty()) return nullptr;
  auto server = worker::PeerServer::start(address, cache);
  if (server) spdlog::info("serves files to other workers at port {}", (*server)->endpoint().port());
  return server;
}

void warn_of_exposed_secrets(const proto::ClientSecurity& security) {
  for (const std::string& secret : {security.key, security.token})
    if (const auto warning = common::exposure_of(secret)) spdlog::warn("{}", *warning);
}

// Leases and connections are not affected, and a damaged file changes nothing.
void reload(proto::ClientCredentials& credentials, const proto::ClientSecurity& security) {
  if (const core::Status done = credentials.reload(); !done)
    return spdlog::error("certificates and token stay as they were, since the new ones cannot be used: {}",
                         done.error().message);
  spdlog::info("has read certificates and token again");
  warn_of_exposed_secrets(security);
}

int run(const worker::Options& options, char** arguments) {
  if (const auto enough =
          common::check_start_limits(fmt::format("a worker with --threads {}", options.threads),
                                     common::kWorkerThreads + static_cast<int>(options.threads));
      !enough) {
    spdlog::error("{}", enough.error().message);
    return 1;
  }
  worker::StopSignals signals;
  if (options.cache.empty()) {
    spdlog::error("this user has no home folder to keep the cache in: choose a folder with --cache");
    return 1;
  }
  const auto cache = worker::BlobCache::open(options.cache, options.cache_bytes());
  if (!cache) {
    spdlog::error("{}: choose another folder with --cache", cache.error().message);
    return 1;
  }
  const auto warn = [](const std::string& line) { spdlog::warn("{}", line); };
  if (const auto ready = worker::check_loader(options.loader, warn); !ready) {
    spdlog::error("{}", ready.error().message);
    return 1;
  }
  warn_of_exposed_secrets(options.security);
  const auto credentials = proto::ClientCredentials::open(options.coordinator, options.security);
  if (!credentials) {
    spdlog::error("{}", credentials.error().message);
    return 1;
  }
  signals.on_hangup([&options, held = *credentials] { reload(*held, options.security); });
  const auto machine_key = worker::machine_key(cache->folder());
  if (!machine_key)
    spdlog::warn("{}: this worker has a new identity each time it starts", machine_key.error().message);
  const std::string key = worker::new_worker_key(machine_key.value_or(""));
  const auto coordinator = v1::WorkerService::NewStub(proto::open_channel(options.coordinator, *credentials));
  worker::Identity identity{.worker_id = proto::worker_id_of(key),
                            .name = options.name,
                            .version = std::string(core::version()),
                            .determinism_fingerprint = core::integrators::determinism_fingerprint(),
                            .threads = options.threads,
                            .worker_key = key};
  common::log(spdlog::level::info,
              fmt::format("worker {} ({}) with {} threads, for the coordinator at {}, cache {}", options.name,
                          identity.worker_id, options.threads, options.coordinator, options.cache),
              {.worker = identity.worker_id, .peer = options.coordinator});
  const auto peer_server = serve_blobs(options.serve_blobs, *cache);
  if (!peer_server) {
    spdlog::error("{}", peer_server.error().message);
    return 1;
  }
  worker::Worker::Options how = worker::with_self_restart(arguments, signals);
  how.explain = explaining(options);
  how.peer_server = peer_server->get();
  how.load_scene = [&options](const worker::SceneFiles& files, int threads, const std::stop_token& stop) {
    return worker::load_confined(options.loader, files, threads, stop);
  };
  worker::Worker worker(identity, *cache, *coordinator, std::move(how));
  const auto metrics = serve_metrics(options, worker, identity, *cache);
  if (!metrics) {
    spdlog::error("{}", metrics.error().message);
    return 1;
  }
  common::ServiceReport report([&] {
    return worker::status_of(worker.metrics(), options.coordinator, options.loader.time + kLongestStep);
  });
  const std::stop_callback tell(signals.token(), [&] { report.stopping(); });
  signals.on_hangup([&, held = *credentials] {
    report.reloading();
    reload(*held, options.security);
    report.reloaded();
  });
  worker.run(signals.token());
  signals.leave_pending();  // the report ends before the signals
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  core::prepare_standard_streams();
  proto::configure_grpc();
  worker::keep_program_name();
  const worker::Options options = worker::parse_options(argc, argv);
  common::log_to_stderr("tessera-worker", options.log);
  return run(options, argv);
}
