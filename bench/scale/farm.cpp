// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/farm.hpp"

#include <fmt/format.h>
#include <grpcpp/create_channel.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <thread>

#include "bench/scale/page_viewers.hpp"
#include "bench/scale/tile_watchers.hpp"
#include "proto/blob.hpp"
#include "proto/channel.hpp"
#include "proto/status.hpp"
#include "tessera/v1/render_service.grpc.pb.h"

namespace tessera::bench {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

// The coordinator validates this scene, but nobody renders it.
constexpr const char* kScene = R"({
  "camera": { "position": [0, 1.5, 6], "look_at": [0, 1, 0] },
  "materials": { "lamp": { "type": "lambert", "emission": 12 } },
  "shapes": [ { "type": "sphere", "center": [0, 1, 0], "radius": 1, "material": "lamp" } ]
})";

// Workers arrive one after the other, as on machines that start a program over a network.
constexpr auto kBetweenArrivals = 1ms;
constexpr auto kDonePolls = 200ms;

class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "tessera-scale-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) std::abort();
    path_ = pattern;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

double own_cpu_seconds() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// Each channel has its own connection, as workers on different machines have.
core::Result<std::shared_ptr<grpc::Channel>> own_connection(const std::string& address) {
  const auto credentials = proto::channel_credentials(address, {});
  if (!credentials) return core::fail(credentials.error());
  grpc::ChannelArguments arguments;
  arguments.SetMaxSendMessageSize(proto::kMaxMessageBytes);
  arguments.SetMaxReceiveMessageSize(proto::kMaxMessageBytes);
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);  // as in proto/channel.cpp
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  return grpc::CreateCustomChannel(address, *credentials, arguments);
}

core::Status upload(v1::RenderService::Stub& users, const proto::Digest& digest) {
  grpc::ClientContext context;
  v1::UploadBlobResponse response;
  const auto stream = users.UploadBlob(&context, &response);
  v1::UploadBlobRequest request;
  proto::for_each_chunk(digest, kScene, [&](const v1::BlobChunk& chunk) {
    *request.mutable_chunk() = chunk;
    return stream->Write(request);
  });
  stream->WritesDone();
  return proto::from_grpc(stream->Finish());
}

v1::ListJobsResponse page_of_jobs(v1::RenderService::Stub& users, const v1::ListJobsRequest& request) {
  while (true) {
    grpc::ClientContext context;
    v1::ListJobsResponse response;
    if (users.ListJobs(&context, request, &response).ok()) return response;
    std::this_thread::sleep_for(kDonePolls);  // the coordinator is overloaded
  }
}

std::vector<v1::Job> list_jobs(v1::RenderService::Stub& users) {
  std::vector<v1::Job> jobs;
  v1::ListJobsRequest request;
  do {
    const v1::ListJobsResponse page = page_of_jobs(users, request);
    jobs.insert(jobs.end(), page.jobs().begin(), page.jobs().end());
    request.set_page_token(page.next_page_token());
  } while (!request.page_token().empty());
  return jobs;
}

bool any_is_validated(v1::RenderService::Stub& users) {
  v1::ListJobsRequest request;
  request.add_states(v1::JOB_STATE_VALIDATING);
  request.set_page_size(1);
  return page_of_jobs(users, request).jobs_size() > 0;
}

// Waits while too many scenes wait to be validated.
core::Result<v1::Job> submit_job(v1::RenderService::Stub& users, const v1::SubmitJobRequest& request) {
  while (true) {
    grpc::ClientContext context;
    v1::SubmitJobResponse response;
    const grpc::Status status = users.SubmitJob(&context, request, &response);
    if (status.ok()) return response.job();
    if (!proto::asked_wait(status, context)) return core::fail(proto::error_from_grpc(status));
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

// Returns the id of the first, which is passed on as soon as it is submitted.
core::Result<std::string> submit_jobs(
    v1::RenderService::Stub& users, const Load& load,
    const std::function<core::Status(const std::string&)>& submitted_first) {
  const proto::Digest digest = proto::digest_of(kScene);
  if (auto uploaded = upload(users, digest); !uploaded) return core::fail(uploaded.error());
  v1::SubmitJobRequest request;
  request.mutable_bundle()->set_scene_path("scene.json");
  v1::Bundle::Asset& asset = *request.mutable_bundle()->add_assets();
  asset.set_path("scene.json");
  *asset.mutable_digest() = proto::to_proto(digest);
  request.mutable_overrides()->set_width_px(static_cast<std::uint32_t>(load.width_px));
  request.mutable_overrides()->set_height_px(static_cast<std::uint32_t>(load.height_px));
  request.mutable_overrides()->set_spp(load.spp);
  std::string first;
  for (int job = 0; job < load.jobs; ++job) {
    request.set_name(fmt::format("simulated-{}", job));
    const auto submitted = submit_job(users, request);
    if (!submitted) return core::fail(submitted.error());
    if (job > 0) continue;
    first = submitted->id();
    if (auto followed = submitted_first(first); !followed) return core::fail(followed.error());
  }
  while (any_is_validated(users)) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  return first;
}

bool all_done(const std::vector<v1::Job>& jobs) {
  return !jobs.empty() && std::all_of(jobs.begin(), jobs.end(),
                                      [](const v1::Job& job) { return job.state() == v1::JOB_STATE_DONE; });
}

// The film memory of tiles with samples. Ranges are leased in passes over the whole image, the first two of
// which have one sample each. Small sums take 4 bytes each, and the sums of odd samples take none before
// there are any. (In later passes it is up to 48 bytes for each pixel.)
std::uint64_t touched_film_bytes(const std::vector<v1::Job>& jobs) {
  std::uint64_t bytes = 0;
  for (const v1::Job& job : jobs) {
    const std::uint64_t pixels = std::uint64_t{job.settings().width_px()} * job.settings().height_px();
    const std::uint64_t done = job.samples_done();
    bytes += 12 * std::min(pixels, done) + 12 * std::min(pixels, done - std::min(pixels, done));
  }
  return bytes;
}

// The workers of one farm with their connections.
class Workers {
 public:
  explicit Workers(Tally& tally) : tally_(tally) {}
  ~Workers() {
    for (const auto& worker : workers_) worker->stop();
    // Calls in progress hold their workers until they have ended.
    for (const auto& worker : workers_)
      while (worker.use_count() > 1) std::this_thread::sleep_for(1ms);
  }

  core::Status start(const Load& load, const std::string& address) {
    for (int i = 0; i < load.workers; ++i) {
      auto channel = own_connection(address);
      if (!channel) return core::fail(channel.error());
      workers_.push_back(std::make_shared<SimulatedWorker>(
          i, load.speed, *std::move(channel), SimulatedWorker::World{tiles_, timeline_, tally_}));
      workers_.back()->start();
      std::this_thread::sleep_for(kBetweenArrivals);
    }
    return {};
  }

 private:
  Tally& tally_;
  const ReadyTiles tiles_;
  Timeline timeline_;
  std::vector<std::shared_ptr<SimulatedWorker>> workers_;
};

void wait_until_done(v1::RenderService::Stub& users, double at_most_seconds) {
  const auto end = Clock::now() + std::chrono::duration<double>(at_most_seconds);
  while (Clock::now() < end && !all_done(list_jobs(users))) std::this_thread::sleep_for(kDonePolls);
}

}  // namespace

core::Result<Figures> measure(const Load& load, const std::filesystem::path& coordinator_program) {
  const Folder folder;
  const auto coordinator = MeasuredCoordinator::start(
      {coordinator_program, folder.path(), load.coordinator_core, load.film_gib, load.page_viewers > 0});
  if (!coordinator) return core::fail(coordinator.error());
  const auto channel = own_connection(coordinator->address());
  if (!channel) return core::fail(channel.error());
  v1::RenderService::Stub users(*channel);

  Figures figures;
  figures.before_jobs = coordinator->usage();
  PageViewers viewers;
  Tally tally([&viewers](const core::PixelRect& rect) { viewers.counted(rect); });
  Workers workers(tally);
  const bool is_shown = load.page_viewers > 0;
  if (is_shown)
    if (auto started = workers.start(load, coordinator->address()); !started)
      return core::fail(started.error());
  Clock::time_point submitted_at{};
  const auto submitted = submit_jobs(users, load, [&](const std::string& id) {
    submitted_at = Clock::now();
    return is_shown ? viewers.start(load.page_viewers, coordinator->page_address(), id) : core::Status();
  });
  if (!submitted) return core::fail(submitted.error());
  TileWatchers watchers;
  const core::Status watched =
      watchers.start(load.watchers, *submitted, [&] { return own_connection(coordinator->address()); });
  if (!watched) return core::fail(watched.error());
  if (load.until_done) tally.start();
  figures.before = coordinator->usage();
  figures.own_cpu_seconds = -own_cpu_seconds();
  auto start = Clock::now();
  if (!is_shown)
    if (auto started = workers.start(load, coordinator->address()); !started)
      return core::fail(started.error());
  if (load.until_done) {
    wait_until_done(users, load.measured_seconds);
  } else {
    std::this_thread::sleep_for(std::chrono::duration<double>(load.warm_up_seconds));
    tally.start();
    figures.before = coordinator->usage();
    figures.own_cpu_seconds = -own_cpu_seconds();
    figures.watched_tiles = watchers.tiles() + viewers.tiles();
    figures.watched_bytes = watchers.bytes() + viewers.bytes();
    viewers.take_delays();
    start = Clock::now();
    std::this_thread::sleep_for(std::chrono::duration<double>(load.measured_seconds));
  }
  figures.counts = tally.stop();
  figures.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  figures.after = coordinator->usage();
  figures.watched_tiles = watchers.tiles() + viewers.tiles() - figures.watched_tiles;
  figures.watched_bytes = watchers.bytes() + viewers.bytes() - figures.watched_bytes;
  figures.shown_seconds = viewers.take_delays();
  if (const auto first = viewers.first_tile())
    figures.first_pixel_seconds = std::chrono::duration<double>(*first - submitted_at).count();
  if (!load.until_done && watchers.ended() + viewers.ended() > 0)
    return core::fail(core::ErrorCode::kInternal, "the coordinator has ended a watch of tiles");
  figures.own_cpu_seconds += own_cpu_seconds();
  const std::vector<v1::Job> jobs = list_jobs(users);
  figures.all_done = all_done(jobs);
  figures.film_bytes = touched_film_bytes(jobs);
  return figures;
}

}  // namespace tessera::bench
