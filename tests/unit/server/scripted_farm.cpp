// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/server/scripted_farm.hpp"

#include "proto/blob.hpp"
#include "proto/convert.hpp"
#include "proto/tile_codec.hpp"
#include "proto/worker_key.hpp"

namespace tessera::server {
namespace {

// Any hash function will do.
std::uint64_t ready_made_sample(int x, int y, std::size_t channel, std::uint32_t sample,
                                std::uint32_t image) {
  std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15 +
                    static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4f + channel * 0x165667b19e3779f9 +
                    sample * std::uint64_t{0x27d4eb2f165667c5} + image * std::uint64_t{0x2545f4914f6cdd1d};
  h = (h ^ h >> 31) * 0x9fb21c651e98df25;
  return h >> 38;
}

core::ErrorCode code_of(v1::Failure::Reason reason) {
  switch (reason) {
    case v1::Failure::REASON_INVALID_SCENE:
      return core::ErrorCode::kInvalidArgument;
    case v1::Failure::REASON_LIMIT:
      return core::ErrorCode::kResourceExhausted;
    case v1::Failure::REASON_FILE_LOST:
      return core::ErrorCode::kDataLoss;
    default:
      return core::ErrorCode::kInternal;
  }
}

}  // namespace

core::FilmTile ready_made_tile(const core::PixelRect& rect, core::SampleRange range, std::uint32_t image) {
  core::FilmTile tile(rect, range);
  std::size_t i = 0;
  for (int y = rect.y0; y < rect.y1; ++y) {
    for (int x = rect.x0; x < rect.x1; ++x) {
      for (std::size_t channel = 0; channel < 3; ++channel, ++i) {
        for (std::uint32_t s = range.begin; s < range.end; ++s) {
          const std::uint64_t value = ready_made_sample(x, y, channel, s, image);
          tile.sums[i] += value;
          if (s % 2 == 1) tile.odd_sums[i] += value;
        }
      }
    }
  }
  tile.counters.samples = rect.pixel_count() * range.count();
  tile.counters.closest_hit_rays = 2 * tile.counters.samples;
  return tile;
}

v1::RenderedItem ready_made_item(const v1::WorkItem& message) {
  const auto item = proto::from_proto(message);
  return proto::encode_tile(ready_made_tile(item->rect, item->range, item->image), item->image);
}

core::Image ready_made_image(const core::PixelRect& window, std::uint32_t spp, std::uint32_t image) {
  core::Film film({window, core::kTilePx});
  for (int tile = 0; tile < film.grid().tile_count(); ++tile) {
    film.add(ready_made_tile(film.grid().rect(tile), {0, spp}, image));
  }
  return film.develop();
}

core::Image ready_made_image(int width_px, int height_px, std::uint32_t spp) {
  return ready_made_image({0, 0, width_px, height_px}, spp);
}

core::Result<jobs::CheckedScene> accept_scene(const v1::Bundle&, const v1::RenderOverrides& overrides,
                                              const std::vector<std::int32_t>&, const std::stop_token&) {
  core::RenderSettings settings;
  settings.width_px = kWidthPx;
  settings.height_px = kHeightPx;
  settings.spp = kSpp;
  const auto resolved = core::resolve_settings(settings, *proto::from_proto(overrides));
  if (!resolved) return core::fail(resolved.error());
  return jobs::CheckedScene{proto::to_proto(*resolved), {}};
}

v1::SubmitJobRequest submission() {
  v1::SubmitJobRequest request;
  request.mutable_bundle()->set_scene_path("folder/scene.json");
  v1::Bundle::Asset* asset = request.mutable_bundle()->add_assets();
  asset->set_path("folder/scene.json");
  *asset->mutable_digest() = proto::to_proto(proto::digest_of(kSceneBytes));
  return request;
}

v1::SynchronizeRequest greeting(char worker) {
  v1::SynchronizeRequest request;
  request.set_worker_id(std::string(32, worker));
  request.set_name(std::string("host-") + worker);
  request.set_version("0.1.0");
  request.set_determinism_fingerprint(kFingerprint);
  request.set_threads(1);
  request.set_wanted_leases(1);
  request.set_names_images(true);
  request.set_renders_layers(true);
  return request;
}

v1::SubmitResultRequest delivery(char worker, const v1::Lease& lease) {
  v1::SubmitResultRequest request;
  request.set_worker_id(std::string(32, worker));
  request.set_job_id(lease.job_id());
  request.set_lease_id(lease.id());
  request.set_lease_token(lease.token());
  for (const v1::WorkItem& item : lease.items()) *request.add_items() = ready_made_item(item);
  request.mutable_render_time()->set_seconds(1);
  request.set_lease_finished(true);
  return request;
}

v1::SynchronizeRequest greeting_with_key(char worker) {
  v1::SynchronizeRequest request = greeting(worker);
  request.set_worker_key(std::string(proto::kWorkerKeyBytes, worker));
  request.set_worker_id(proto::worker_id_of(request.worker_key()));
  return request;
}

v1::SubmitResultRequest delivery_with_key(char worker, const v1::Lease& lease) {
  v1::SubmitResultRequest request = delivery(worker, lease);
  request.set_worker_id(proto::worker_id_of(std::string(proto::kWorkerKeyBytes, worker)));
  return request;
}

ScriptedFarm::ScriptedFarm() {
  open();
  store_scene();
}

void ScriptedFarm::store_scene() {
  auto writer = coordinator().blobs().write(proto::digest_of(kSceneBytes));
  EXPECT_TRUE(writer && writer->append(kSceneBytes) && writer->commit());
}

void ScriptedFarm::open(const std::filesystem::path& folder) {
  coordinator_.reset();
  auto state = store::StateDirectory::open(folder);
  ASSERT_TRUE(state) << state.error().message;
  CoordinatorOptions options;
  options.farm.now = [this] { return now_; };
  options.farm.hold_clock = hold_clock_;
  options.limits = limits_;
  options.farm.audit_share = audit_share_;
  options.farm.fingerprints = fingerprints_;
  auto opened = Coordinator::open(options, std::move(*state), check_scene_);
  ASSERT_TRUE(opened) << opened.error().message;
  coordinator_ = std::move(*opened);
}

std::string ScriptedFarm::submit(const v1::SubmitJobRequest& request, const std::string& owner) {
  const auto submitted = coordinator().jobs().submit(request, owner);
  EXPECT_TRUE(submitted) << submitted.error().message;
  if (!submitted) return "";
  coordinator().jobs().validate(submitted->id());
  return submitted->id();
}

core::Error ScriptedFarm::refusal(const v1::SubmitJobRequest& request, const std::string& owner) {
  const auto submitted = coordinator().jobs().submit(request, owner);
  if (!submitted) return submitted.error();
  coordinator().jobs().validate(submitted->id());
  const v1::Job ended = job(submitted->id());
  EXPECT_EQ(ended.state(), v1::JOB_STATE_FAILED);
  EXPECT_EQ(ended.failure(), ended.failure_details().message());
  return {code_of(ended.failure_details().reason()), ended.failure()};
}

v1::Job ScriptedFarm::job(const std::string& id) {
  const auto found = coordinator().jobs().get(id);
  EXPECT_TRUE(found) << found.error().message;
  return found ? *found : v1::Job();
}

v1::Job ScriptedFarm::stored_job(const std::string& id) {
  EXPECT_TRUE(coordinator().checkpointer().checkpoint());
  return job(id);
}

std::vector<v1::Job> ScriptedFarm::listed(const v1::ListJobsRequest& request) {
  const auto page = coordinator().jobs().list(request);
  EXPECT_TRUE(page) << page.error().message;
  return page ? std::vector<v1::Job>(page->jobs().begin(), page->jobs().end()) : std::vector<v1::Job>();
}

v1::SynchronizeResponse ScriptedFarm::synchronize(const v1::SynchronizeRequest& request,
                                                  farm::WorkerPrincipal principal) {
  const WaitingCall call(coordinator(), request, std::move(principal));
  EXPECT_TRUE(call.answered());
  if (!call.answered()) return {};
  EXPECT_TRUE(call.answer()) << call.answer().error().message;
  return call.answer() ? *call.answer() : v1::SynchronizeResponse();
}

v1::SubmitResultResponse ScriptedFarm::deliver(const v1::SubmitResultRequest& request) {
  const auto counted = coordinator().dispatcher().submit_result(request);
  EXPECT_TRUE(counted) << counted.error().message;
  return counted ? *counted : v1::SubmitResultResponse();
}

void ScriptedFarm::work(char worker, int leases) {
  for (int done = 0; done < leases;) {
    const WaitingCall call(coordinator(), greeting(worker));
    if (!call.answered()) return;
    ASSERT_TRUE(call.answer()) << call.answer().error().message;
    for (const v1::Lease& lease : call.answer()->leases()) {
      deliver(delivery(worker, lease));
      ++done;
    }
  }
}

WaitingCall::WaitingCall(Coordinator& coordinator, const v1::SynchronizeRequest& request,
                         farm::WorkerPrincipal principal)
    : answer_(std::make_shared<std::optional<core::Result<v1::SynchronizeResponse>>>()) {
  farm::SynchronizeCaller caller;
  caller.answer = [answer = answer_](core::Result<v1::SynchronizeResponse> result) {
    EXPECT_FALSE(answer->has_value()) << "answered twice";
    answer->emplace(std::move(result));
  };
  caller.is_gone = [gone = gone_] { return *gone; };
  caller.principal = std::move(principal);
  coordinator.dispatcher().synchronize(request, std::move(caller));
}

}  // namespace tessera::server
