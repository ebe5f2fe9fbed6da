// tessera-coordinator: see options.hpp.
#include <signal.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdlib>
#include <iostream>
#include <stop_token>

#include "server/options.hpp"
#include "server/rpc/server.hpp"

namespace {

using namespace tessera;

// Blocks the signals that end the process, in this thread and those it will start; sigwait() takes them.
sigset_t block_stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

core::Status run(const server::Options& options, const sigset_t& stop_signals) {
  auto state = store::StateDirectory::open(options.state);
  if (!state) return core::fail(state.error());
  const store::BlobStore blobs = state->blobs;
  std::stop_source stopping;
  const validator::ProcessOptions validator{.path = options.validator, .stop = stopping.get_token()};
  const auto check = [&](const v1::Bundle& bundle,
                         const v1::RenderOverrides& overrides) -> core::Result<coordinator::CheckedScene> {
    const auto approval = validator::validate_scene(validator, blobs, bundle, overrides);
    if (!approval) return core::fail(approval.error());
    return coordinator::CheckedScene{approval->settings, approval->display};
  };
  coordinator::Options settings;
  settings.lease_duration =
      std::chrono::duration_cast<scheduler::Duration>(std::chrono::duration<double>(options.lease_seconds));
  settings.keep_unused_blobs = std::chrono::duration_cast<std::chrono::seconds>(
      std::chrono::duration<double, std::ratio<3600>>(options.keep_unused_hours));
  const auto coordinator = coordinator::Coordinator::open(settings, std::move(*state), check);
  if (!coordinator) return core::fail(coordinator.error());
  const auto server = rpc::Server::start(**coordinator, options.listen);
  if (!server) return core::fail(server.error());

  if (!server::is_loopback(options.listen)) {
    spdlog::warn("there is no encryption and no authentication yet: whoever reaches {} may use it",
                 options.listen);
  }
  std::cout << "tessera-coordinator: listening on " << (*server)->address() << std::endl;
  int signal = 0;
  sigwait(&stop_signals, &signal);
  spdlog::info("stopping on signal {}", signal);
  stopping.request_stop();  // nobody waits for a scene that is being validated
  return (*server)->stop();
}

}  // namespace

int main(int argc, char** argv) {
  // Errors are told once, in our words; GRPC_VERBOSITY=DEBUG brings gRPC's own back.
  setenv("GRPC_VERBOSITY", "NONE", 0);
  spdlog::set_default_logger(spdlog::stderr_color_mt("tessera-coordinator"));
  const sigset_t stop_signals = block_stop_signals();
  const auto ended = run(server::parse_options(argc, argv), stop_signals);
  if (ended) return EXIT_SUCCESS;
  std::cerr << "tessera-coordinator: " << ended.error().message << '\n';
  return EXIT_FAILURE;
}
