// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/farm.hpp"

#include <google/protobuf/stubs/logging.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <utility>

#include "core/scene/settings.hpp"
#include "proto/convert.hpp"
#include "server/farm/job_record.hpp"
#include "server/film/tile_row.hpp"
#include "tests/fuzz/scratch_folder.hpp"

namespace tessera::fuzz {
namespace {

namespace fs = std::filesystem;

// Small enough for a film at every input.
constexpr std::uint64_t kMaxPixels = 1 << 16;

v1::Job spec_of(const std::string& id, int width_px, int height_px, std::uint32_t spp) {
  v1::Job spec;
  spec.set_id(id);
  spec.set_name("scene.json");
  core::RenderSettings settings;
  settings.width_px = width_px;
  settings.height_px = height_px;
  settings.spp = spp;
  *spec.mutable_settings() = proto::to_proto(settings);
  spec.mutable_display()->set_tone_curve(v1::TONE_CURVE_NONE);
  spec.mutable_bundle()->set_scene_path("scene.json");
  spec.mutable_created_at()->set_seconds(1);
  return spec;
}

store::JobRow row_of(const v1::Job& spec, v1::JobState state) {
  store::JobRow row;
  row.id = spec.id();
  row.request_id = "request " + spec.id().substr(0, 1);
  row.spec = spec.SerializeAsString();
  row.revision = 1;
  row.state = state;
  row.spp = spec.settings().spp();
  row.created_ms = 1000;
  return row;
}

store::TileRow tile_row(const v1::Job& spec, int tile, core::SampleRange range) {
  const core::PixelRect rect = farm::grid_of(spec).rect(tile);
  core::FilmTile samples = tile_of(rect, range);
  film::TileContent content{
      {std::move(samples.sums), std::move(samples.odd_sums), range.count(), range.odd_count()},
      samples.counters};
  return film::encode_tile_row(spec.id(), tile, rect, {range}, content);
}

void make_template(const fs::path& folder) {
  auto state = store::StateDirectory::open(folder);
  expect(state.has_value(), "a new state folder can be made");
  const v1::Job a = spec_of(id_of("a"), 130, 4, 6), b = spec_of(id_of("b"), 64, 8, 4),
                c = spec_of(id_of("c"), 10, 5, 1);
  const bool stored =
      state->jobs.insert_job(row_of(a, v1::JOB_STATE_RUNNING)) &&
      state->jobs.insert_job(row_of(b, v1::JOB_STATE_PAUSED)) &&
      state->jobs.insert_job(row_of(c, v1::JOB_STATE_DONE)) &&
      state->jobs.write_tiles({tile_row(a, 0, {0, 6}), tile_row(a, 1, {0, 2}), tile_row(c, 0, {0, 1})});
  expect(stored, "jobs can be stored");
}

const fs::path& template_folder() {
  static const fs::path folder = [] {
    spdlog::set_level(spdlog::level::off);
    google::protobuf::SetLogHandler(nullptr);
    fs::path made = scratch_folder() / "template";
    make_template(made);
    return made;
  }();
  return folder;
}

// Accepts any scene: 40 x 3 pixels, 2 samples per pixel, overrides applied.
core::Result<jobs::CheckedScene> accept(const v1::Bundle&, const v1::RenderOverrides& overrides,
                                        const std::vector<std::int32_t>&, const std::stop_token&) {
  const auto wanted = proto::from_proto(overrides);
  if (!wanted) return core::fail(wanted.error());
  core::RenderSettings settings;
  settings.width_px = 40;
  settings.height_px = 3;
  settings.spp = 2;
  const auto resolved = core::resolve_settings(settings, *wanted);
  if (!resolved) return core::fail(resolved.error());
  jobs::CheckedScene checked;
  checked.settings = proto::to_proto(*resolved);
  checked.display.set_tone_curve(v1::TONE_CURVE_NONE);
  return checked;
}

// Of the workers of these farms, as inputs have it.
constexpr const char* kFingerprint = "f00d";

}  // namespace

std::string id_of(const std::string& text) {
  return text.size() == 1 ? std::string(32, text.front()) : text;
}

core::FilmTile tile_of(const core::PixelRect& rect, core::SampleRange range) {
  core::FilmTile tile(rect, range);
  for (std::uint64_t& sum : tile.sums) sum = range.count();
  for (std::uint64_t& sum : tile.odd_sums) sum = range.odd_count();
  tile.counters.samples = rect.pixel_count() * std::uint64_t{range.count()};
  return tile;
}

Farm::Farm(jobs::SceneCheck check_scene, const Damage& damage)
    : check_scene_(check_scene ? std::move(check_scene) : accept) {
  const fs::path& original = template_folder();
  const fs::path folder = scratch_folder() / "state";
  fs::remove_all(folder);
  fs::copy(original, folder, fs::copy_options::recursive);
  if (damage) damage(folder);
  reopen();
}

Farm::~Farm() = default;

void Farm::reopen() {
  coordinator_.reset();
  auto state = store::StateDirectory::open(scratch_folder() / "state");
  if (!expect_answer(state)) return;
  signer_.emplace(state->jobs.secret());
  server::CoordinatorOptions options;
  options.farm.fingerprints = {kFingerprint};
  options.limits.image_pixels = kMaxPixels;
  options.farm.audit_share = 1;  // of all ranges, so that chance chooses none
  options.farm.now = [this] { return now_; };
  auto opened = server::Coordinator::open(options, std::move(*state), check_scene_);
  if (expect_answer(opened)) coordinator_ = std::move(*opened);
}

void Farm::sign(v1::SubmitResultRequest& request) const {
  if (!request.lease_token().empty()) return;
  request.set_lease_token(signer_->sign({request.lease_id()}, {request.worker_id()}, {request.job_id()}));
}

void Farm::sign(v1::SynchronizeRequest& request) const {
  for (v1::Lease& lease : *request.mutable_held())
    if (lease.token().empty())
      lease.set_token(signer_->sign({lease.id()}, {request.worker_id()}, {lease.job_id()}));
}

void Farm::wait(std::chrono::milliseconds time) {
  now_ += time;
  coordinator_->dispatcher().tick();
}

void Farm::synchronize(const v1::SynchronizeRequest& request) {
  farm::SynchronizeCaller caller;
  caller.answer = [](const core::Result<v1::SynchronizeResponse>& answer) { expect_sendable(answer); };
  coordinator_->dispatcher().synchronize(request, std::move(caller));
}

void Farm::greet(char worker) {
  v1::SynchronizeRequest request;
  request.set_worker_id(std::string(32, worker));
  request.set_name(std::string("host-") + worker);
  request.set_version("1");
  request.set_determinism_fingerprint(kFingerprint);
  request.set_threads(1);
  request.set_wanted_leases(1);
  synchronize(request);
}

}  // namespace tessera::fuzz
