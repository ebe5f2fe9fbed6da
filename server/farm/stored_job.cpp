// SPDX-License-Identifier: Apache-2.0
#include "server/farm/stored_job.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "core/film/layout.hpp"
#include "proto/convert.hpp"
#include "server/farm/job_record.hpp"
#include "server/farm/wire.hpp"
#include "server/store/stored.pb.h"

namespace tessera::farm {

namespace {

// No message of earlier releases begins with it.
constexpr char kMark = 'J';

stored::v1::Rect to_stored(const v1::PixelRect& rect) {
  stored::v1::Rect stored;
  stored.set_x0(rect.x0());
  stored.set_y0(rect.y0());
  stored.set_x1(rect.x1());
  stored.set_y1(rect.y1());
  return stored;
}

v1::PixelRect from_stored(const stored::v1::Rect& stored) {
  v1::PixelRect rect;
  rect.set_x0(stored.x0());
  rect.set_y0(stored.y0());
  rect.set_x1(stored.x1());
  rect.set_y1(stored.y1());
  return rect;
}

// The values of enumerations are those of the protocol's first release, which later ones keep.
stored::v1::Settings to_stored(const v1::RenderSettings& settings) {
  stored::v1::Settings stored;
  stored.set_width_px(settings.width_px());
  stored.set_height_px(settings.height_px());
  stored.set_spp(settings.spp());
  stored.set_seed(settings.seed());
  stored.set_integrator(static_cast<std::uint32_t>(settings.integrator()));
  stored.set_max_depth(settings.max_depth());
  stored.set_heuristic(static_cast<std::uint32_t>(settings.heuristic()));
  stored.set_filter(static_cast<std::uint32_t>(settings.filter()));
  stored.set_filter_radius_px(settings.filter_radius_px());
  stored.set_clamp_indirect(settings.clamp_indirect());
  *stored.mutable_layers() = settings.layers();
  if (!settings.has_crop()) return stored;
  *stored.mutable_crop() = to_stored(settings.crop());
  return stored;
}

v1::RenderSettings from_stored(const stored::v1::Settings& stored) {
  v1::RenderSettings settings;
  settings.set_width_px(stored.width_px());
  settings.set_height_px(stored.height_px());
  settings.set_spp(stored.spp());
  settings.set_seed(stored.seed());
  settings.set_integrator(static_cast<v1::Integrator>(stored.integrator()));
  settings.set_max_depth(stored.max_depth());
  settings.set_heuristic(static_cast<v1::Heuristic>(stored.heuristic()));
  settings.set_filter(static_cast<v1::PixelFilter>(stored.filter()));
  settings.set_filter_radius_px(stored.filter_radius_px());
  settings.set_clamp_indirect(stored.clamp_indirect());
  *settings.mutable_layers() = stored.layers();
  if (!stored.has_crop()) return settings;
  *settings.mutable_crop() = from_stored(stored.crop());
  return settings;
}

// The numbers of the encodings are those of the protocol.
stored::v1::Layout to_stored(const core::FilmLayout& layout) {
  stored::v1::Layout stored;
  for (const core::FilmChannel& each : layout.channels) {
    stored::v1::Layout::Channel& channel = *stored.add_channels();
    channel.set_name(each.name);
    channel.set_encoding(static_cast<stored::v1::Encoding>(proto::to_proto(each.encoding)));
  }
  return stored;
}

// Whether a layout of the store is what this release makes of the job's layers.
bool is_known(const stored::v1::Layout& layout, const core::FilmLayout& known) {
  return layout.SerializeAsString() == to_stored(known).SerializeAsString();
}

// A job that names no images has one.
void add_images(const v1::Job& job, stored::v1::Job& stored) {
  for (const v1::Image& image : job.images()) {
    stored::v1::Image& added = *stored.add_images();
    added.set_frame(image.frame());
    added.set_name(image.name());
  }
  if (stored.images().empty()) stored.add_images();
  *stored.mutable_images(0)->mutable_layout() = to_stored(core::film_layout(layers_of(job)));
}

// Whether this release can read the images.
bool read_images(const stored::v1::Job& stored, v1::Job& job) {
  const auto layers = proto::layers_from(stored.settings().layers());
  if (!layers) return false;
  const core::FilmLayout known = core::film_layout(*layers);
  const auto has_unknown_layout = [&known](const stored::v1::Image& image) {
    return image.has_layout() && !is_known(image.layout(), known);
  };
  if (stored.images().empty() || !stored.images(0).has_layout()) return false;
  if (std::any_of(stored.images().begin(), stored.images().end(), has_unknown_layout)) return false;
  const stored::v1::Image& first = stored.images(0);
  if (stored.images_size() == 1 && first.frame() == 0 && first.name().empty()) return true;
  for (const stored::v1::Image& image : stored.images()) {
    v1::Image& read = *job.add_images();
    read.set_frame(image.frame());
    read.set_name(image.name());
  }
  job.set_image_count(static_cast<std::uint32_t>(job.images_size()));
  return true;
}

}  // namespace

std::string encode_spec(const v1::Job& job) {
  stored::v1::Job stored;
  stored.set_id(job.id());
  stored.set_name(job.name());
  stored.set_owner(job.owner());
  stored.set_created_ms(ms_from_timestamp(job.created_at()));
  *stored.mutable_settings() = to_stored(job.settings());
  if (job.has_display()) {
    stored.mutable_display()->set_exposure_stops(job.display().exposure_stops());
    stored.mutable_display()->set_tone_curve(static_cast<std::uint32_t>(job.display().tone_curve()));
  }
  stored.set_priority(job.priority());
  stored.set_max_workers(job.max_workers());
  stored.mutable_labels()->insert(job.labels().begin(), job.labels().end());
  stored.mutable_warnings()->Add(job.warnings().begin(), job.warnings().end());
  add_images(job, stored);
  std::string bytes(1, kMark);
  stored.AppendToString(&bytes);
  return bytes;
}

bool decode_spec(const std::string& bytes, v1::Job& job) {
  if (bytes.empty() || bytes.front() != kMark) return job.ParseFromString(bytes);
  stored::v1::Job stored;
  if (!stored.ParseFromString(bytes.substr(1)) || !read_images(stored, job)) return false;
  job.set_id(stored.id());
  job.set_name(stored.name());
  job.set_owner(stored.owner());
  *job.mutable_created_at() = timestamp_from_ms(stored.created_ms());
  *job.mutable_settings() = from_stored(stored.settings());
  if (stored.has_display()) {
    job.mutable_display()->set_exposure_stops(stored.display().exposure_stops());
    job.mutable_display()->set_tone_curve(static_cast<v1::ToneCurve>(stored.display().tone_curve()));
  }
  job.set_priority(stored.priority());
  job.set_max_workers(stored.max_workers());
  job.mutable_labels()->insert(stored.labels().begin(), stored.labels().end());
  job.mutable_warnings()->Add(stored.warnings().begin(), stored.warnings().end());
  return true;
}

std::string encode_submission(const v1::SubmitJobRequest& submission) {
  const v1::RenderOverrides& overrides = submission.overrides();
  stored::v1::Submission message;
  stored::v1::Submission::Overrides& stored = *message.mutable_overrides();
  if (overrides.has_width_px()) stored.set_width_px(overrides.width_px());
  if (overrides.has_height_px()) stored.set_height_px(overrides.height_px());
  if (overrides.has_spp()) stored.set_spp(overrides.spp());
  if (overrides.has_seed()) stored.set_seed(overrides.seed());
  stored.set_integrator(static_cast<std::uint32_t>(overrides.integrator()));
  stored.set_heuristic(static_cast<std::uint32_t>(overrides.heuristic()));
  if (overrides.has_crop()) *stored.mutable_crop() = to_stored(overrides.crop());
  if (overrides.has_clamp_indirect()) stored.set_clamp_indirect(overrides.clamp_indirect());
  if (overrides.has_layers()) *stored.mutable_layers()->mutable_names() = overrides.layers().names();
  if (submission.display().has_exposure_stops())
    message.set_exposure_stops(submission.display().exposure_stops());
  message.set_tone_curve(static_cast<std::uint32_t>(submission.display().tone_curve()));
  return message.SerializeAsString();
}

bool decode_submission(const std::string& bytes, v1::SubmitJobRequest& submission) {
  stored::v1::Submission message;
  if (!message.ParseFromString(bytes)) return false;
  const stored::v1::Submission::Overrides& stored = message.overrides();
  v1::RenderOverrides& overrides = *submission.mutable_overrides();
  if (stored.has_width_px()) overrides.set_width_px(stored.width_px());
  if (stored.has_height_px()) overrides.set_height_px(stored.height_px());
  if (stored.has_spp()) overrides.set_spp(stored.spp());
  if (stored.has_seed()) overrides.set_seed(stored.seed());
  overrides.set_integrator(static_cast<v1::Integrator>(stored.integrator()));
  overrides.set_heuristic(static_cast<v1::Heuristic>(stored.heuristic()));
  if (stored.has_crop()) *overrides.mutable_crop() = from_stored(stored.crop());
  if (stored.has_clamp_indirect()) overrides.set_clamp_indirect(stored.clamp_indirect());
  if (stored.has_layers()) *overrides.mutable_layers()->mutable_names() = stored.layers().names();
  if (message.has_exposure_stops())
    submission.mutable_display()->set_exposure_stops(message.exposure_stops());
  submission.mutable_display()->set_tone_curve(static_cast<v1::ToneCurve>(message.tone_curve()));
  return true;
}

std::string encode_failure(const scheduler::FailureDetails& details) {
  stored::v1::Failure message;
  message.set_reason(static_cast<std::uint32_t>(details.reason));
  if (details.item && details.item->tile >= 0) {
    message.mutable_samples()->set_tile(static_cast<std::uint32_t>(details.item->tile));
    message.mutable_samples()->set_sample_begin(details.item->samples.begin);
    message.mutable_samples()->set_sample_end(details.item->samples.end);
  }
  for (const std::string& worker : details.workers) message.add_workers(worker);
  return message.SerializeAsString();
}

scheduler::FailureDetails decode_failure(const std::string& bytes) {
  stored::v1::Failure message;
  scheduler::FailureDetails details;
  if (!message.ParseFromString(bytes)) return details;
  if (message.reason() <= static_cast<std::uint32_t>(scheduler::FailureReason::kInternal))
    details.reason = static_cast<scheduler::FailureReason>(message.reason());
  if (const stored::v1::Samples& samples = message.samples(); message.has_samples())
    details.item =
        scheduler::WorkItem{static_cast<int>(samples.tile()), {samples.sample_begin(), samples.sample_end()}};
  details.workers.assign(message.workers().begin(), message.workers().end());
  return details;
}

std::string encode_targets(const scheduler::TileTargets& targets) {
  stored::v1::Targets message;
  int last = 0;
  for (const auto& [tile, spp] : targets.all()) {
    message.add_tiles(static_cast<std::uint32_t>(tile - last));
    message.add_spp(spp);
    last = tile;
  }
  return message.SerializeAsString();
}

std::optional<scheduler::TileTargets> decode_targets(const std::string& bytes) {
  stored::v1::Targets message;
  if (!message.ParseFromString(bytes) || message.tiles_size() != message.spp_size()) return std::nullopt;
  scheduler::TileTargets::ByTile targets;
  std::uint64_t tile = 0;
  for (int i = 0; i < message.tiles_size(); ++i) {
    tile += message.tiles(i);
    if (tile >= scheduler::kMaxTilesPerJob || message.spp(i) == 0) return std::nullopt;
    targets.push_back({static_cast<int>(tile), message.spp(i)});
  }
  return scheduler::TileTargets(std::move(targets));
}

std::string encode_bundle(const v1::Job& job) {
  stored::v1::Bundle stored;
  stored.set_scene_path(job.bundle().scene_path());
  for (const v1::Bundle::Asset& asset : job.bundle().assets()) {
    stored::v1::Bundle::Asset& added = *stored.add_assets();
    added.set_path(asset.path());
    added.set_sha256(asset.digest().sha256());
    added.set_size_bytes(asset.digest().size_bytes());
  }
  *stored.mutable_scene_digests() = job.scene_digests();
  for (const v1::TextAttribute& each : job.attributes()) {
    stored::v1::Attribute& attribute = *stored.add_attributes();
    attribute.set_name(each.name());
    attribute.set_value(each.value());
  }
  return stored.SerializeAsString();
}

bool decode_bundle(const std::string& bytes, v1::Job& job) {
  stored::v1::Bundle stored;
  if (!stored.ParseFromString(bytes)) return false;
  v1::Bundle& bundle = *job.mutable_bundle();
  bundle.set_scene_path(stored.scene_path());
  for (const stored::v1::Bundle::Asset& asset : stored.assets()) {
    v1::Bundle::Asset& added = *bundle.add_assets();
    added.set_path(asset.path());
    added.mutable_digest()->set_sha256(asset.sha256());
    added.mutable_digest()->set_size_bytes(asset.size_bytes());
  }
  *job.mutable_scene_digests() = stored.scene_digests();
  for (const stored::v1::Attribute& each : stored.attributes()) {
    v1::TextAttribute& attribute = *job.add_attributes();
    attribute.set_name(each.name());
    attribute.set_value(each.value());
  }
  return true;
}

}  // namespace tessera::farm
