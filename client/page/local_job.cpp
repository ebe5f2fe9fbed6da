// SPDX-License-Identifier: Apache-2.0
#include "client/page/local_job.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <utility>

namespace tessera::client {
namespace {

using Json = nlohmann::ordered_json;
using SystemTime = std::chrono::system_clock::time_point;

std::string to_text(SystemTime time) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(time)));
}

// The shortest decimal number that is this float: 0.1 rather than 0.10000000149.
double shortest(float value) {
  return std::strtod(fmt::format("{}", value).c_str(), nullptr);
}

Json crop_json(const core::RenderSettings& settings) {
  if (!settings.crop) return nullptr;
  return Json::array({settings.crop->x0, settings.crop->y0, settings.crop->x1, settings.crop->y1});
}

void add_settings(Json& json, const core::RenderSettings& settings) {
  json["width"] = settings.width_px;
  json["height"] = settings.height_px;
  json["crop"] = crop_json(settings);
  json["spp"] = settings.spp;
  json["integrator"] = core::integrator_name(settings.integrator);
  json["heuristic"] = core::heuristic_name(settings.heuristic);
  json["clamp_indirect"] = shortest(settings.clamp_indirect);
  json["seed"] = settings.seed;
  json["max_depth"] = settings.max_depth;
  json["filter"] = core::filter_name(settings.filter.kind);
  json["filter_radius"] = shortest(settings.filter.radius_px);
  json["layers"] = core::layer_names(settings.layers);
}

std::uint64_t samples_of(const core::Film& film) {
  std::uint64_t samples = 0;
  for (int tile = 0; tile < film.grid().tile_count(); ++tile)
    samples += std::uint64_t{film.grid().rect(tile).pixel_count()} * film.samples(tile);
  return samples;
}

// What a job of a farm has.
void add_farm_parts(Json& json) {
  json["samples_to_verify"] = 0;
  json["active_workers"] = 0;
  json["queue_position"] = nullptr;
  json["waiting_reason"] = nullptr;
  json["failure"] = nullptr;
  json["warnings"] = Json::array();
  json["troubles"] = Json::array();
}

}  // namespace

LocalJob::LocalJob(std::string name, const core::RenderSettings& settings,
                   const core::DisplaySettings& display)
    : name_(std::move(name)), settings_(settings), display_(display) {}

void LocalJob::begin(const core::Film& film) {
  const std::uint64_t samples = samples_of(film);
  const std::lock_guard lock(mutex_);
  first_samples_ = samples_ = samples;
  began_ = changed_ = Clock::now();
  ++revision_;
}

void LocalJob::add(std::uint64_t samples) {
  const std::lock_guard lock(mutex_);
  samples_ += samples;
  changed_ = Clock::now();
  ++revision_;
}

void LocalJob::end() {
  const std::lock_guard lock(mutex_);
  if (std::exchange(is_over_, true)) return;
  finished_ = std::chrono::system_clock::now();
  ++revision_;
}

std::string LocalJob::started_at() const {
  return to_text(created_);
}

std::uint64_t LocalJob::total_samples() const {
  return std::uint64_t{settings_.window().pixel_count()} * settings_.spp;
}

bool LocalJob::has_all_samples() const {
  const std::lock_guard lock(mutex_);
  return samples_ >= total_samples();
}

view::JobHeader LocalJob::header() const {
  const std::lock_guard lock(mutex_);
  const std::uint64_t total = total_samples();
  const double seconds = std::chrono::duration<double>(changed_ - began_).count();
  const double rate = seconds > 0 ? static_cast<double>(samples_ - first_samples_) / seconds : 0;
  const char* const end_state = samples_ >= total ? "done" : "cancelled";
  Json json = {{"id", kLocalJobId},
               {"name", name_},
               {"state", is_over_ ? end_state : "running"},
               {"owner", ""},
               {"priority", 0},
               {"max_workers", 0},
               {"labels", Json::object()}};
  add_settings(json, settings_);
  json["exposure"] = shortest(display_.exposure_stops);
  json["tone_curve"] = core::tone_curve_name(display_.tone_curve);
  json["samples_total"] = total;
  json["samples_done"] = samples_;
  json["samples_per_second"] = is_over_ ? 0 : rate;
  json["seconds_left"] =
      is_over_ || rate <= 0 ? Json(nullptr) : Json(static_cast<double>(total - samples_) / rate);
  json["image_count"] = 1;
  json["created_at"] = to_text(created_);
  json["finished_at"] = is_over_ ? Json(to_text(finished_)) : Json(nullptr);
  json["revision"] = revision_;
  add_farm_parts(json);
  return {json.dump(-1, ' ', true, Json::error_handler_t::replace), revision_};
}

}  // namespace tessera::client
