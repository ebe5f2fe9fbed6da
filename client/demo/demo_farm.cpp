// SPDX-License-Identifier: Apache-2.0
#include "client/demo/demo_farm.hpp"

#include <absl/synchronization/mutex.h>
#include <fmt/format.h>
#include <unistd.h>

#include <optional>
#include <stop_token>
#include <thread>
#include <utility>

#include "client/console.hpp"
#include "core/base/available_resources.hpp"
#include "core/base/version.hpp"
#include "core/common/log.hpp"
#include "core/common/open_files.hpp"
#include "core/common/start_limits.hpp"
#include "core/integrators/fingerprint.hpp"
#include "proto/channel.hpp"
#include "proto/client_credentials.hpp"
#include "proto/worker_key.hpp"
#include "server/coordinator.hpp"
#include "server/http/api.hpp"
#include "server/rpc/server.hpp"
#include "server/scene_check.hpp"
#include "server/validator/validator_process.hpp"
#include "worker/machine_key.hpp"
#include "worker/worker.hpp"

namespace tessera::client {
namespace {

constexpr std::uint64_t kCacheBytes = std::uint64_t{16} << 30;
constexpr const char* kWorkerName = "demo";

worker::Identity new_identity() {
  const std::string key = worker::new_worker_key("");
  return {.worker_id = proto::worker_id_of(key),
          .name = kWorkerName,
          .version = std::string(core::version()),
          .determinism_fingerprint = core::integrators::determinism_fingerprint(),
          .threads = core::available_threads(),
          .worker_key = key};
}

// A worker in a thread of its own, until it is destroyed.
class WorkerThread {
 public:
  WorkerThread(worker::BlobCache cache, std::unique_ptr<v1::WorkerService::StubInterface> coordinator)
      : cache_(std::move(cache)),
        coordinator_(std::move(coordinator)),
        worker_(new_identity(), cache_, *coordinator_),
        thread_([this](const std::stop_token& stop) { worker_.run(stop); }) {}

 private:
  const worker::BlobCache cache_;
  const std::unique_ptr<v1::WorkerService::StubInterface> coordinator_;
  worker::Worker worker_;
  std::jthread thread_;  // last: it uses the others
};

core::Result<std::unique_ptr<WorkerThread>> start_worker(const std::string& coordinator,
                                                         const std::filesystem::path& folder) {
  auto cache = worker::BlobCache::open((folder / "cache").string(), kCacheBytes);
  if (!cache) return core::fail(cache.error());
  const auto credentials = proto::ClientCredentials::open(coordinator, {});
  if (!credentials) return core::fail(credentials.error());
  return std::make_unique<WorkerThread>(
      *std::move(cache), v1::WorkerService::NewStub(proto::open_channel(coordinator, *credentials)));
}

// As the programs tessera-coordinator and tessera-worker do.
void prepare_process() {
  common::log_to_stderr("tessera", {.level = spdlog::level::err});
  common::raise_file_limit();
  // Debian's Abseil searches for deadlocks each time that gRPC takes a lock.
  absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kIgnore);
}

}  // namespace

// In the order in which they start; they end in reverse.
struct DemoFarm::Parts {
  std::unique_ptr<server::Coordinator> coordinator{};
  std::unique_ptr<rpc::Server> server{};
  std::unique_ptr<http_api::Api> page{};
  std::unique_ptr<WorkerThread> worker{};
};

core::Status check_demo_programs() {
  struct Needed {
    std::string path;
    const char* package;
  };
  std::string missing, packages;
  for (const auto& [path, package] : {Needed{validator::default_validator_path(), "tessera-coordinator"},
                                      Needed{worker::LoaderOptions().program, "tessera-worker"}}) {
    if (::access(path.c_str(), X_OK) == 0) continue;
    const std::string name = std::filesystem::path(path).filename();
    missing += (missing.empty() ? "" : " and ") + name;
    packages += fmt::format(" ./{}_*.deb", package);
  }
  if (missing.empty()) return {};
  return core::fail(core::ErrorCode::kNotFound,
                    fmt::format("the demo reads scenes in {}, which must be in the folder of this program: "
                                "install their Debian packages (apt-get install{})",
                                missing, packages));
}

DemoFarm::DemoFarm(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
DemoFarm::~DemoFarm() = default;

core::Result<std::unique_ptr<DemoFarm>> DemoFarm::start(const std::filesystem::path& folder,
                                                        const std::string& http) {
  prepare_process();
  if (auto enough =
          common::check_start_limits("the demo", common::kCoordinatorThreads + common::kWorkerThreads +
                                                     static_cast<int>(core::available_threads()));
      !enough)
    return core::fail(enough.error());
  const server::ValidatorOptions validator{.program = validator::default_validator_path()};
  if (const auto usable = server::check_validator(validator, print_note); !usable)
    return core::fail(usable.error());
  if (const auto usable = worker::check_loader({}, print_note); !usable) return core::fail(usable.error());
  auto state = store::StateDirectory::open(folder / "state");
  if (!state) return core::fail(state.error());
  auto check = server::confined_scene_check(validator, state->blobs);
  auto parts = std::make_unique<Parts>();
  auto coordinator = server::Coordinator::open({}, *std::move(state), std::move(check));
  if (!coordinator) return core::fail(coordinator.error());
  parts->coordinator = *std::move(coordinator);
  auto server = rpc::Server::start(*parts->coordinator, {.address = "127.0.0.1:0"});
  if (!server) return core::fail(server.error());
  parts->server = *std::move(server);
  auto page = http_api::Api::start(parts->server->services(), {.address = http});
  if (!page) return core::fail(page.error());
  parts->page = *std::move(page);
  auto worker = start_worker(parts->server->address(), folder);
  if (!worker) return core::fail(worker.error());
  parts->worker = *std::move(worker);
  return std::unique_ptr<DemoFarm>(new DemoFarm(std::move(parts)));
}

const std::string& DemoFarm::address() const {
  return parts_->server->address();
}

std::string DemoFarm::page() const {
  return parts_->page->url();
}

}  // namespace tessera::client
