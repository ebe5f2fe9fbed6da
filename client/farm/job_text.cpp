// SPDX-License-Identifier: Apache-2.0
#include "client/farm/job_text.hpp"

#include <fmt/format.h>
#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <map>
#include <memory>
#include <vector>

#include "client/farm/table.hpp"
#include "core/base/printable.hpp"
#include "core/scene/settings.hpp"
#include "proto/convert.hpp"

namespace tessera::client {
namespace {

using google::protobuf::Timestamp;
using google::protobuf::util::TimeUtil;

double seconds_of(const Timestamp& time) {
  return static_cast<double>(time.seconds()) + 1e-9 * time.nanos();
}

// Whether it is a time or duration outside the range of its JSON form (timestamp.proto, duration.proto).
bool is_inexpressible(const google::protobuf::Message& message) {
  std::string json;
  const std::string& type = message.GetTypeName();
  const bool is_time = type == "google.protobuf.Timestamp" || type == "google.protobuf.Duration";
  return is_time && !google::protobuf::util::MessageToJsonString(message, &json).ok();
}

std::string percent_done(const v1::Job& job) {
  if (job.samples_total() == 0) return "";
  // 100% is reserved for complete jobs, so other percentages are rounded down.
  const double fraction = static_cast<double>(job.samples_done()) / static_cast<double>(job.samples_total());
  return fmt::format("{}%", static_cast<int>(100 * fraction));
}

std::string samples_text(const v1::Job& job) {
  if (job.samples_total() == 0) return "-";
  return fmt::format("{} of {} ({})", job.samples_done(), job.samples_total(), percent_done(job));
}

std::string spp_text(const v1::RenderSettings& settings) {
  return settings.spp() == 0 ? "-" : std::to_string(settings.spp());
}

std::string speed(double samples_per_second) {
  return samples_per_second > 0 ? format_count(samples_per_second) + "/s" : "-";
}

std::string integrator_text(v1::Integrator integrator) {
  const auto known = proto::from_proto(integrator);
  return known ? std::string(core::integrator_name(*known)) : "unknown";
}

std::string heuristic_text(v1::Heuristic heuristic) {
  const auto known = proto::from_proto(heuristic);
  return std::string(core::heuristic_name(known.value_or(core::RenderSettings{}.heuristic)));
}

// "2", or "2/3" if at most three workers are allowed.
std::string workers_text(const v1::Job& job) {
  const std::string now = std::to_string(job.active_workers());
  return job.max_workers() == 0 ? now : fmt::format("{}/{}", now, job.max_workers());
}

// A map of protobuf has no order.
std::map<std::string, std::string> sorted_labels(const v1::Job& job) {
  return {job.labels().begin(), job.labels().end()};
}

std::string crop_text(const v1::RenderSettings& settings) {
  const v1::PixelRect& crop = settings.crop();
  return fmt::format("{},{},{},{} of {}x{}", crop.x0(), crop.y0(), crop.x1(), crop.y1(), settings.width_px(),
                     settings.height_px());
}

std::string state_of(const v1::Worker& worker) {
  if (worker.quarantined()) return "quarantined";
  if (worker.silent()) return "silent";
  if (worker.drain_requested()) return worker.held_leases() > 0 ? "draining" : "drained";
  if (worker.draining()) return "leaving";
  if (worker.stuck()) return "stuck";
  if (worker.cooldowns().empty()) return "working";
  const bool only_fetches = std::all_of(worker.cooldowns().begin(), worker.cooldowns().end(),
                                        [](const auto& bar) { return bar.fetching(); });
  return only_fetches ? "fetching" : "in cooldown";
}

// Why a worker receives no work, or no work of some jobs.
std::vector<std::string> remarks_on(const v1::Worker& worker) {
  std::vector<std::string> remarks;
  if (!worker.quarantine_reason().empty()) remarks.push_back("is quarantined: " + worker.quarantine_reason());
  if (worker.stuck())
    remarks.push_back("still renders what went to others, and is given nothing until it is through with it");
  for (const auto& bar : worker.cooldowns()) {
    const double seconds = static_cast<double>(TimeUtil::DurationToMilliseconds(bar.remaining())) / 1e3;
    remarks.push_back(fmt::format(
        "is given nothing of job {} {}", short_id(bar.job_id()),
        bar.fetching() ? "until it has fetched its scene"
                       : fmt::format("for {}, or until it delivers some of it", format_duration(seconds))));
  }
  for (const std::string& trouble : worker.troubles()) remarks.push_back("says: " + trouble);
  return remarks;
}

// The numbers of a worker's audited and wrong ranges.
std::string audits_of(const v1::Worker& worker) {
  if (worker.disproved_ranges() == 0) return std::to_string(worker.audited_ranges());
  return fmt::format("{} ({} wrong)", worker.audited_ranges(), worker.disproved_ranges());
}

// Removes times and durations without a JSON form anywhere in the message.
void remove_inexpressible_times(google::protobuf::Message& message) {
  const auto* reflection = message.GetReflection();
  std::vector<const google::protobuf::FieldDescriptor*> fields;
  reflection->ListFields(message, &fields);
  for (const auto* field : fields) {
    if (field->cpp_type() != google::protobuf::FieldDescriptor::CPPTYPE_MESSAGE || field->is_map()) continue;
    if (field->is_repeated()) {
      for (int i = 0; i < reflection->FieldSize(message, field); ++i)
        remove_inexpressible_times(*reflection->MutableRepeatedMessage(&message, field, i));
    } else if (is_inexpressible(reflection->GetMessage(message, field))) {
      reflection->ClearField(&message, field);
    } else {
      remove_inexpressible_times(*reflection->MutableMessage(&message, field));
    }
  }
}

}  // namespace

std::string ago(const Timestamp& time, double now_seconds) {
  return format_duration(std::max(0.0, now_seconds - seconds_of(time))) + " ago";
}

std::string short_id(const std::string& id) {
  return id.substr(0, 12);
}

std::string state_name(v1::JobState state) {
  switch (state) {
    case v1::JOB_STATE_VALIDATING:
      return "validating";
    case v1::JOB_STATE_RUNNING:
      return "running";
    case v1::JOB_STATE_PAUSED:
      return "paused";
    case v1::JOB_STATE_DONE:
      return "done";
    case v1::JOB_STATE_CANCELLED:
      return "cancelled";
    case v1::JOB_STATE_FAILED:
      return "failed";
    default:
      return "unknown";
  }
}

std::string size_text(const v1::RenderSettings& settings) {
  const core::PixelRect window = proto::window_of(settings);
  if (window.empty()) return "-";  // the scene says, and is not validated
  return fmt::format("{}x{}", window.width(), window.height());
}

bool is_over(v1::JobState state) {
  return state == v1::JOB_STATE_DONE || state == v1::JOB_STATE_CANCELLED || state == v1::JOB_STATE_FAILED;
}

double seconds_taken(const v1::Job& job) {
  return job.has_finished_at() ? seconds_of(job.finished_at()) - seconds_of(job.created_at()) : 0;
}

ProgressState progress_of(const v1::Job& job) {
  const std::uint32_t workers = job.active_workers();
  std::string note = fmt::format("{} worker{}", workers, workers == 1 ? "" : "s");
  if (job.state() == v1::JOB_STATE_PAUSED) note = "paused";
  if (job.state() == v1::JOB_STATE_VALIDATING) note = "validating";
  return {job.samples_done(), job.samples_total(), std::move(note)};
}

std::string jobs_table(const v1::ListJobsResponse& jobs, double now_seconds) {
  std::vector<std::vector<std::string>> rows;
  for (const v1::Job& job : jobs.jobs())
    rows.push_back({short_id(job.id()), job.name(), state_name(job.state()), percent_done(job),
                    size_text(job.settings()), spp_text(job.settings()),
                    job.state() == v1::JOB_STATE_RUNNING ? speed(job.samples_per_second()) : "-",
                    workers_text(job), std::to_string(job.priority()), ago(job.created_at(), now_seconds)});
  return format_table({{"JOB"},
                       {"NAME"},
                       {"STATE"},
                       {"DONE", Align::kRight},
                       {"SIZE", Align::kRight},
                       {"SPP", Align::kRight},
                       {"SAMPLES", Align::kRight},
                       {"WORKERS", Align::kRight},
                       {"PRIORITY", Align::kRight},
                       {"SUBMITTED", Align::kRight}},
                      rows);
}

std::string workers_table(const v1::ListWorkersResponse& workers, double now_seconds) {
  std::vector<std::vector<std::string>> rows;
  for (const v1::Worker& worker : workers.workers())
    rows.push_back(
        {short_id(worker.id()), worker.name(), worker.principal().empty() ? "-" : worker.principal(),
         state_of(worker), std::to_string(worker.threads()), std::to_string(worker.held_leases()),
         speed(worker.samples_per_second()), format_count(static_cast<double>(worker.samples_accepted())),
         audits_of(worker), ago(worker.last_seen_at(), now_seconds), worker.version()});
  std::string table = format_table({{"WORKER"},
                                    {"NAME"},
                                    {"PRINCIPAL"},
                                    {"STATE"},
                                    {"THREADS", Align::kRight},
                                    {"LEASES", Align::kRight},
                                    {"SPEED", Align::kRight},
                                    {"SAMPLES", Align::kRight},
                                    {"AUDITS", Align::kRight},
                                    {"SEEN", Align::kRight},
                                    {"VERSION"}},
                                   rows);
  for (const v1::Worker& worker : workers.workers()) {
    for (const std::string& remark : remarks_on(worker)) {
      table +=
          core::printable(fmt::format("{} ({}) {}", worker.name(), short_id(worker.id()), remark)) + "\n";
    }
  }
  return table;
}

std::string job_description(const v1::Job& job) {
  std::vector<std::vector<std::string>> rows{
      {"name", job.name()},
      {"state", state_name(job.state())},
      {"samples", samples_text(job)},
      {"size", size_text(job.settings())},
      {"spp", spp_text(job.settings())},
      {"integrator", integrator_text(job.settings().integrator())},
      {"seed", std::to_string(job.settings().seed())},
      {"priority", std::to_string(job.priority())},
      {"workers", workers_text(job)},
      {"submitted", TimeUtil::ToString(job.created_at())},
      {"scene", fmt::format("{} with {} files", job.bundle().scene_path(), job.bundle().assets_size())}};
  if (job.settings().has_crop()) rows.push_back({"crop", crop_text(job.settings())});
  if (job.samples_to_verify() > 0)
    rows.push_back({"to verify", fmt::format("{} samples", job.samples_to_verify())});
  if (!job.owner().empty()) rows.push_back({"owner", job.owner()});
  if (job.settings().integrator() == v1::INTEGRATOR_MIS)
    rows.push_back({"heuristic", heuristic_text(job.settings().heuristic())});
  if (job.settings().clamp_indirect() > 0)
    rows.push_back({"clamp_indirect", fmt::format("{}", job.settings().clamp_indirect())});
  if (!job.failure().empty()) rows.push_back({"failure", job.failure()});
  for (const std::string& worker : job.failure_details().workers()) rows.push_back({"failed on", worker});
  for (const std::string& warning : job.warnings()) rows.push_back({"warning", warning});
  for (const auto& [key, value] : sorted_labels(job)) rows.push_back({"label", key + "=" + value});
  for (const std::string& trouble : job.troubles()) rows.push_back({"trouble", trouble});
  if (job.state() == v1::JOB_STATE_RUNNING) rows.push_back({"speed", speed(job.samples_per_second())});
  if (job.has_finished_at()) rows.push_back({"finished", TimeUtil::ToString(job.finished_at())});
  if (job.counters().non_finite_samples() > 0)
    rows.push_back({"non-finite", fmt::format("{} samples", job.counters().non_finite_samples())});
  if (job.counters().saturated_samples() > 0)
    rows.push_back({"saturated", fmt::format("{} samples", job.counters().saturated_samples())});
  return format_table({{"job"}, {job.id()}}, rows);
}

std::string to_json_line(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  options.always_print_primitive_fields = true;
  std::string json;
  // Fails if a time has no JSON form, which is a fault of the coordinator.
  if (google::protobuf::util::MessageToJsonString(message, &json, options).ok()) return json + "\n";
  const std::unique_ptr<google::protobuf::Message> without(message.New());
  without->CopyFrom(message);
  remove_inexpressible_times(*without);
  json.clear();
  (void)google::protobuf::util::MessageToJsonString(*without, &json, options);
  return json + "\n";
}

}  // namespace tessera::client
