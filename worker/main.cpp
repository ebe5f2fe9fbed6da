// tessera-worker: renders for a farm. Parse, build, wire, run.
#include <spdlog/spdlog.h>

#include <cstdlib>

#include "core/integrators/fingerprint.hpp"
#include "proto/log.hpp"
#include "proto/unreachable.hpp"
#include "worker/options.hpp"
#include "worker/signals.hpp"
#include "worker/start_anew.hpp"
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

int run(const worker::Options& options, char** arguments) {
  worker::StopSignals signals;
  const auto cache = worker::BlobCache::open(options.cache, options.cache_bytes());
  if (!cache) {
    spdlog::error("{}: choose another folder with --cache", cache.error().message);
    return 1;
  }
  const auto channel = proto::open_channel(options.coordinator, options.security);
  if (!channel) {
    spdlog::error("{}", channel.error().message);
    return 1;
  }
  for (const std::string& sentence : proto::exposed_secrets({options.security.key, options.security.token}))
    spdlog::warn("{}", sentence);
  const auto coordinator = v1::WorkerService::NewStub(*channel);
  worker::Identity identity{.worker_id = worker::random_worker_id(),
                            .name = options.name,
                            .version = TESSERA_VERSION,
                            .arithmetic_fingerprint = core::arithmetic_fingerprint(),
                            .threads = options.threads};
  spdlog::info("worker {} ({}) with {} threads, for the coordinator at {}, cache {}", options.name,
               identity.worker_id, options.threads, options.coordinator, options.cache);
  worker::Worker::Options how = worker::that_starts_anew(arguments, signals);
  how.explain = explaining(options);
  worker::Worker worker(std::move(identity), *cache, *coordinator, std::move(how));
  const core::Status done = worker.run(signals.token());
  if (!done) {
    spdlog::error("refused by the coordinator: {}", done.error().message);
    return 1;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  // Errors are told once, in our words; GRPC_VERBOSITY=DEBUG brings gRPC's own back.
  setenv("GRPC_VERBOSITY", "NONE", 0);
  worker::keep_program_name();
  const worker::Options options = worker::parse_options(argc, argv);
  proto::log_to_stderr("tessera-worker");
  if (options.verbose) spdlog::set_level(spdlog::level::debug);
  return run(options, argv);
}
