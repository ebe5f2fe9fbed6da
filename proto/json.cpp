// SPDX-License-Identifier: Apache-2.0
#include "proto/json.hpp"

#include <fmt/format.h>
#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "proto/blob.hpp"
#include "proto/convert.hpp"
#include "proto/convert_display.hpp"
#include "proto/state_text.hpp"

namespace tessera::proto {
namespace {

using google::protobuf::util::TimeUtil;
using Json = nlohmann::ordered_json;

// A time that RFC 3339 cannot express, which is a fault of the sender, becomes null.
Json time_json(const google::protobuf::Timestamp& time, bool is_present) {
  const bool is_valid = time.seconds() >= TimeUtil::kTimestampMinSeconds &&
                        time.seconds() <= TimeUtil::kTimestampMaxSeconds && time.nanos() >= 0 &&
                        time.nanos() < 1'000'000'000;
  if (!is_present || !is_valid) return nullptr;
  return TimeUtil::ToString(time);
}

// The shortest decimal number that is this float: 0.1 rather than 0.10000000149.
double shortest(float value) {
  return std::strtod(fmt::format("{}", value).c_str(), nullptr);
}

template <typename T>
Json or_null(const T& value, bool is_known) {
  return is_known ? Json(value) : Json(nullptr);
}

template <typename Strings>
Json list_json(const Strings& strings) {
  Json list = Json::array();
  for (const std::string& text : strings) list.push_back(text);
  return list;
}

Json rect_json(const v1::PixelRect& rect) {
  return Json::array({rect.x0(), rect.y0(), rect.x1(), rect.y1()});
}

Json integrator_json(v1::Integrator integrator) {
  const auto known = from_proto(integrator);
  return known ? Json(core::integrator_name(*known)) : Json(nullptr);
}

Json heuristic_json(v1::Heuristic heuristic) {
  return Json(core::heuristic_name(from_proto(heuristic).value_or(core::RenderSettings{}.heuristic)));
}

// A job that was stored without a filter has the default one.
void add_filter(Json& json, const v1::RenderSettings& settings) {
  const auto kind = from_proto(settings.filter());
  json["filter"] = core::filter_name(kind.value_or(core::PixelFilter{}.kind));
  json["filter_radius"] = shortest(kind ? settings.filter_radius_px() : core::PixelFilter{}.radius_px);
}

void add_settings(Json& json, const v1::RenderSettings& settings) {
  json["width"] = settings.width_px();
  json["height"] = settings.height_px();
  json["crop"] = settings.has_crop() ? rect_json(settings.crop()) : Json(nullptr);
  json["spp"] = settings.spp();
  json["integrator"] = integrator_json(settings.integrator());
  json["heuristic"] = heuristic_json(settings.heuristic());
  json["clamp_indirect"] = shortest(settings.clamp_indirect());
  json["seed"] = settings.seed();
  json["max_depth"] = settings.max_depth();
  add_filter(json, settings);
  json["layers"] = list_json(settings.layers());
}

void add_display(Json& json, const v1::DisplaySettings& display) {
  json["exposure"] = shortest(display.exposure_stops());
  json["tone_curve"] =
      core::tone_curve_name(from_proto(display.tone_curve()).value_or(core::ToneCurve::kNone));
}

void add_progress(Json& json, const v1::Job& job) {
  const auto left = seconds_left(job);
  json["samples_total"] = job.samples_total();
  json["samples_done"] = job.samples_done();
  json["samples_to_verify"] = job.samples_to_verify();
  json["samples_per_second"] = job.samples_per_second();
  json["seconds_left"] = or_null(left.value_or(0), left.has_value());
  json["active_workers"] = job.active_workers();
  json["queue_position"] = or_null(job.queue_position(), job.queue_position() > 0);
  json["waiting_reason"] = or_null(job.waiting_reason(), !job.waiting_reason().empty());
}

std::string failure_reason(v1::Failure::Reason reason) {
  switch (reason) {
    case v1::Failure::REASON_INVALID_SCENE:
      return "invalid_scene";
    case v1::Failure::REASON_LIMIT:
      return "limit";
    case v1::Failure::REASON_WORKERS_LOST:
      return "workers_lost";
    case v1::Failure::REASON_DECLINED:
      return "declined";
    case v1::Failure::REASON_FILE_LOST:
      return "file_lost";
    case v1::Failure::REASON_FILM_LOST:
      return "film_lost";
    case v1::Failure::REASON_INTERNAL:
      return "internal";
    default:
      return "unknown";
  }
}

Json failure_json(const v1::Job& job) {
  if (job.failure().empty() && !job.has_failure_details()) return nullptr;
  const v1::Failure& details = job.failure_details();
  Json json = {{"reason", failure_reason(details.reason())},
               {"message", job.failure().empty() ? details.message() : job.failure()},
               {"workers", list_json(details.workers())}};
  if (details.has_item())
    json["item"] = {{"rect", rect_json(details.item().rect())},
                    {"sample_begin", details.item().sample_begin()},
                    {"sample_end", details.item().sample_end()}};
  return json;
}

Json counters_json(const v1::Counters& counters) {
  Json json = {{"samples", counters.samples()},
               {"closest_hit_rays", counters.closest_hit_rays()},
               {"shadow_rays", counters.shadow_rays()},
               {"non_finite_samples", counters.non_finite_samples()},
               {"saturated_samples", counters.saturated_samples()},
               {"first_non_finite", nullptr}};
  if (counters.has_first_non_finite()) {
    const auto& first = counters.first_non_finite();
    json["first_non_finite"] = {{"x", first.x()}, {"y", first.y()}, {"sample", first.sample()}};
  }
  return json;
}

Json files_json(const v1::Bundle& bundle) {
  Json files = Json::array();
  for (const v1::Bundle::Asset& asset : bundle.assets()) {
    const auto digest = from_proto(asset.digest());
    files.push_back({{"path", asset.path()},
                     {"sha256", digest ? Json(digest->hex()) : Json(nullptr)},
                     {"bytes", asset.digest().size_bytes()}});
  }
  return files;
}

Json images_json(const v1::Job& job) {
  Json images = Json::array();
  for (const v1::Image& image : job.images())
    images.push_back({{"frame", image.frame()},
                      {"name", image.name()},
                      {"samples_total", image.samples_total()},
                      {"samples_done", image.samples_done()}});
  return images;
}

Json events_json(const v1::Job& job) {
  Json events = Json::array();
  for (const v1::JobEvent& event : job.events())
    events.push_back({{"at", time_json(event.at(), event.has_at())}, {"kind", event_name(event.kind())}});
  return events;
}

// A map of protobuf has no order.
Json labels_json(const v1::Job& job) {
  Json labels = Json::object();
  for (const auto& [key, value] :
       std::map<std::string, std::string>(job.labels().begin(), job.labels().end()))
    labels[key] = value;
  return labels;
}

Json cache_json(const v1::Worker& worker) {
  if (!worker.has_cache()) return nullptr;
  return {{"used_bytes", worker.cache().used_bytes()}, {"limit_bytes", worker.cache().limit_bytes()}};
}

Json cooldowns_json(const v1::Worker& worker) {
  Json list = Json::array();
  for (const auto& cooldown : worker.cooldowns())
    list.push_back({{"job_id", cooldown.job_id()},
                    {"remaining_seconds", cooldown.remaining().seconds()},
                    {"fetching", cooldown.fetching()}});
  return list;
}

std::string code_name(core::ErrorCode code) {
  switch (code) {
    case core::ErrorCode::kCancelled:
      return "CANCELLED";
    case core::ErrorCode::kInvalidArgument:
      return "INVALID_ARGUMENT";
    case core::ErrorCode::kNotFound:
      return "NOT_FOUND";
    case core::ErrorCode::kAlreadyExists:
      return "ALREADY_EXISTS";
    case core::ErrorCode::kPermissionDenied:
      return "PERMISSION_DENIED";
    case core::ErrorCode::kResourceExhausted:
      return "RESOURCE_EXHAUSTED";
    case core::ErrorCode::kFailedPrecondition:
      return "FAILED_PRECONDITION";
    case core::ErrorCode::kUnavailable:
      return "UNAVAILABLE";
    case core::ErrorCode::kDeadlineExceeded:
      return "DEADLINE_EXCEEDED";
    case core::ErrorCode::kDataLoss:
      return "DATA_LOSS";
    case core::ErrorCode::kOutOfRange:
      return "OUT_OF_RANGE";
    case core::ErrorCode::kInternal:
      return "INTERNAL";
  }
  return "UNKNOWN";
}

}  // namespace

Json to_json(const v1::Job& job) {
  Json json = {{"id", job.id()},
               {"name", job.name()},
               {"state", state_name(job.state())},
               {"owner", job.owner()},
               {"priority", job.priority()},
               {"max_workers", job.max_workers()},
               {"labels", labels_json(job)}};
  add_settings(json, job.settings());
  add_display(json, job.display());
  add_progress(json, job);
  json["image_count"] = std::max(job.image_count(), 1U);
  if (!job.images().empty()) json["images"] = images_json(job);
  json["created_at"] = time_json(job.created_at(), job.has_created_at());
  json["finished_at"] = time_json(job.finished_at(), job.has_finished_at());
  if (!job.events().empty()) json["events"] = events_json(job);
  json["revision"] = job.revision();
  json["failure"] = failure_json(job);
  json["warnings"] = list_json(job.warnings());
  json["troubles"] = list_json(job.troubles());
  json["counters"] = counters_json(job.counters());
  if (job.has_bundle()) {
    json["scene"] = job.bundle().scene_path();
    json["files"] = files_json(job.bundle());
  }
  return json;
}

Json to_json(const v1::Worker& worker) {
  return {{"id", worker.id()},
          {"name", worker.name()},
          {"principal", worker.principal()},
          {"state", worker_state(worker)},
          {"threads", worker.threads()},
          {"version", worker.version()},
          {"held_leases", worker.held_leases()},
          {"samples_per_second", worker.samples_per_second()},
          {"samples_accepted", worker.samples_accepted()},
          {"cache", cache_json(worker)},
          {"last_seen_at", time_json(worker.last_seen_at(), worker.has_last_seen_at())},
          {"renders_layers", worker.renders_layers()},
          {"rejected_results", worker.rejected_results()},
          {"audited_ranges", worker.audited_ranges()},
          {"disproved_ranges", worker.disproved_ranges()},
          {"quarantine_reason", or_null(worker.quarantine_reason(), worker.quarantined())},
          {"troubles", list_json(worker.troubles())},
          {"remarks", list_json(worker_remarks(worker))},
          {"cooldowns", cooldowns_json(worker)}};
}

Json to_json(const v1::QuarantineEntry& entry) {
  return {{"id", entry.id()},
          {"worker_id", entry.worker_id()},
          {"worker_name", entry.worker_name()},
          {"principal", entry.principal()},
          {"reason", entry.reason()},
          {"since", time_json(entry.since(), entry.has_since())}};
}

Json to_json(const v1::GetServerInfoResponse& info) {
  const auto& limits = info.limits();
  return {{"version", info.version()},
          {"started_at", time_json(info.started_at(), info.has_started_at())},
          {"features", list_json(info.features())},
          {"determinism_fingerprints", list_json(info.determinism_fingerprints())},
          {"limits",
           {{"message_bytes", limits.message_bytes()},
            {"blob_bytes", limits.blob_bytes()},
            {"bundle_bytes", limits.bundle_bytes()},
            {"bundle_files", limits.bundle_files()},
            {"image_pixels", limits.image_pixels()},
            {"spp", limits.spp()}}},
          {"principal", info.principal()},
          {"role", info.role()},
          {"open", info.role().empty()}};
}

Json error_to_json(const core::Error& error) {
  Json json = {{"code", code_name(error.code)}, {"message", error.message}};
  const core::ErrorDetails details = core::details_of(error);
  if (!details.reason.empty()) json["reason"] = details.reason;
  if (!details.field.empty()) json["field"] = details.field;
  if (details.missing.empty()) return json;
  json["missing"] = Json::array();
  for (const std::string& name : details.missing) {
    const auto digest = digest_from_name(name);
    json["missing"].push_back(digest ? digest->hex() : name);
  }
  return json;
}

std::string to_line(const Json& json) {
  return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

}  // namespace tessera::proto
