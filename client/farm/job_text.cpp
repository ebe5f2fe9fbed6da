// SPDX-License-Identifier: Apache-2.0
#include "client/farm/job_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
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

std::string percent(std::uint64_t done, std::uint64_t total) {
  if (total == 0) return "";
  // 100% is reserved for what is complete, so other percentages are rounded down.
  const double fraction = static_cast<double>(done) / static_cast<double>(total);
  return std::to_string(static_cast<int>(100 * fraction));
}

std::string percent_done(const v1::Job& job) {
  return percent(job.samples_done(), job.samples_total());
}

std::string samples_text(const v1::Job& job) {
  if (job.samples_total() == 0) return "-";
  return fmt::format("{} of {} ({} %)", job.samples_done(), job.samples_total(), percent_done(job));
}

std::string spp_text(const v1::RenderSettings& settings) {
  return settings.spp() == 0 ? "-" : std::to_string(settings.spp());
}

std::string speed(double samples_per_second) {
  return samples_per_second > 0 ? format_count(samples_per_second) : "-";
}

std::string time_left(const v1::Job& job) {
  const auto seconds = proto::seconds_left(job);
  return seconds ? format_duration(*seconds) : "-";
}

std::string or_dash(const std::string& text) {
  return text.empty() ? "-" : text;
}

// "queued (2)": second in the queue.
std::string state_cell(const v1::Job& job) {
  return is_queued(job) ? fmt::format("queued ({})", job.queue_position()) : shown_state(job);
}

// Prefixes of one length at which all ids of a list differ. So long that new jobs rarely share one.
template <typename Messages>
std::size_t prefix_length(const Messages& messages) {
  constexpr std::size_t kShortest = 8, kLongest = 32;
  for (std::size_t length = kShortest; length < kLongest; ++length) {
    std::set<std::string> prefixes;
    for (const auto& message : messages) prefixes.insert(message.id().substr(0, length));
    if (prefixes.size() == static_cast<std::size_t>(messages.size())) return length;
  }
  return kLongest;
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

// Those of a job with several: how many are done, and those that are being rendered.
std::vector<std::pair<std::string, std::string>> image_rows(const v1::Job& job) {
  constexpr std::size_t kMaxShown = 8;
  if (job.images_size() < 2) return {};
  int done = 0;
  std::vector<std::pair<std::string, std::string>> begun;
  for (int i = 0; i < job.images_size(); ++i) {
    const v1::Image& image = job.images(i);
    const bool is_done = image.samples_total() > 0 && image.samples_done() == image.samples_total();
    done += is_done ? 1 : 0;
    if (is_done || image.samples_done() == 0 || begun.size() == kMaxShown) continue;
    begun.emplace_back(
        fmt::format("image {}", i),
        fmt::format("frame {}, {} %", image.frame(), percent(image.samples_done(), image.samples_total())));
  }
  std::vector<std::pair<std::string, std::string>> rows{
      {"images", fmt::format("{}, of which {} are done; frames {} to {}", job.images_size(), done,
                             job.images(0).frame(), job.images(job.images_size() - 1).frame())}};
  rows.insert(rows.end(), begun.begin(), begun.end());
  return rows;
}

// The numbers of a worker's audited and wrong ranges.
std::string audits_of(const v1::Worker& worker) {
  if (worker.disproved_ranges() == 0) return std::to_string(worker.audited_ranges());
  return fmt::format("{} ({} wrong)", worker.audited_ranges(), worker.disproved_ranges());
}

}  // namespace

std::string ago(const Timestamp& time, double now_seconds) {
  return format_duration(std::max(0.0, now_seconds - seconds_of(time))) + " ago";
}

std::string size_text(const v1::RenderSettings& settings) {
  const core::PixelRect window = proto::window_of(settings);
  if (window.empty()) return "-";  // the scene says, and is not validated
  return fmt::format("{}x{}", window.width(), window.height());
}

bool is_over(v1::JobState state) {
  return state == v1::JOB_STATE_DONE || state == v1::JOB_STATE_CANCELLED || state == v1::JOB_STATE_FAILED;
}

std::string written_text(const v1::Job& job, const std::vector<std::string>& paths, double seconds) {
  return fmt::format("wrote {} ({} pixels, {} spp) in {:.2f} s, {} samples/s", fmt::join(paths, ", "),
                     size_text(job.settings()), job.settings().spp(), seconds,
                     format_count(static_cast<double>(job.samples_done()) / std::max(seconds, 1e-3)));
}

std::string shown_state(const v1::Job& job) {
  return is_queued(job) ? "queued" : state_name(job.state());
}

Color state_color(const std::string& state) {
  static const std::map<std::string, Color> kColors{
      {"running", Color::kCyan},    {"working", Color::kCyan},      {"fetching", Color::kCyan},
      {"done", Color::kGreen},      {"failed", Color::kRed},        {"quarantined", Color::kRed},
      {"silent", Color::kRed},      {"stuck", Color::kRed},         {"paused", Color::kYellow},
      {"queued", Color::kYellow},   {"validating", Color::kYellow}, {"in cooldown", Color::kYellow},
      {"draining", Color::kYellow}, {"cancelled", Color::kDim},     {"drained", Color::kDim},
      {"leaving", Color::kDim}};
  const auto found = kColors.find(state.substr(0, state.find(" (")));
  return found == kColors.end() ? Color::kNone : found->second;
}

ProgressState progress_of(const v1::Job& job) {
  const std::uint32_t workers = job.active_workers();
  std::string note = fmt::format("{} worker{}", workers, workers == 1 ? "" : "s");
  if (is_queued(job))
    note = fmt::format("queued, place {}{}{}", job.queue_position(), job.waiting_reason().empty() ? "" : ": ",
                       core::printable(job.waiting_reason()));
  if (job.state() == v1::JOB_STATE_PAUSED) note = "paused";
  if (job.state() == v1::JOB_STATE_VALIDATING) note = "validating";
  return {job.samples_done(), job.samples_total(), std::move(note)};
}

std::string jobs_table(const v1::ListJobsResponse& jobs, double now_seconds, const TextStyle& style) {
  const std::size_t digits = prefix_length(jobs.jobs());
  std::vector<std::vector<std::string>> rows;
  for (const v1::Job& job : jobs.jobs())
    rows.push_back({job.id().substr(0, digits), job.name(), or_dash(job.owner()), state_cell(job),
                    or_dash(percent_done(job)), time_left(job), size_text(job.settings()),
                    spp_text(job.settings()),
                    job.state() == v1::JOB_STATE_RUNNING ? speed(job.samples_per_second()) : "-",
                    workers_text(job), std::to_string(job.priority()), ago(job.created_at(), now_seconds)});
  std::string table = format_table({{.title = "JOB"},
                                    {.title = "NAME", .is_flexible = true},
                                    {.title = "OWNER", .is_flexible = true, .rank = 3},
                                    {.title = "STATE", .color = state_color},
                                    {.title = "DONE %", .align = Align::kRight},
                                    {.title = "TIME LEFT", .align = Align::kRight, .rank = 1},
                                    {.title = "SIZE PX", .align = Align::kRight, .rank = 7},
                                    {.title = "SPP", .align = Align::kRight, .rank = 6},
                                    {.title = "SAMPLES/S", .align = Align::kRight, .rank = 5},
                                    {.title = "WORKERS", .align = Align::kRight, .rank = 2},
                                    {.title = "PRIORITY", .align = Align::kRight, .rank = 8},
                                    {.title = "SUBMITTED", .align = Align::kRight, .rank = 4}},
                                   rows, style);
  for (const v1::Job& job : jobs.jobs()) {
    if (!is_queued(job) || job.waiting_reason().empty()) continue;
    table += core::printable(fmt::format("{} ({}) is queued: {}", job.name(), job.id().substr(0, digits),
                                         job.waiting_reason())) +
             "\n";
  }
  return table;
}

std::string workers_table(const v1::ListWorkersResponse& workers, double now_seconds,
                          const TextStyle& style) {
  const std::size_t digits = prefix_length(workers.workers());
  std::vector<std::vector<std::string>> rows;
  for (const v1::Worker& worker : workers.workers())
    rows.push_back({worker.id().substr(0, digits), worker.name(), or_dash(worker.principal()),
                    proto::worker_state(worker), std::to_string(worker.threads()),
                    std::to_string(worker.held_leases()), speed(worker.samples_per_second()),
                    format_count(static_cast<double>(worker.samples_accepted())), audits_of(worker),
                    ago(worker.last_seen_at(), now_seconds), worker.version()});
  std::string table = format_table({{.title = "WORKER"},
                                    {.title = "NAME", .is_flexible = true},
                                    {.title = "PRINCIPAL", .is_flexible = true, .rank = 5},
                                    {.title = "STATE", .color = state_color},
                                    {.title = "THREADS", .align = Align::kRight, .rank = 2},
                                    {.title = "LEASES", .align = Align::kRight, .rank = 3},
                                    {.title = "SAMPLES/S", .align = Align::kRight},
                                    {.title = "SAMPLES", .align = Align::kRight, .rank = 4},
                                    {.title = "AUDITED RANGES", .align = Align::kRight, .rank = 7},
                                    {.title = "SEEN", .align = Align::kRight, .rank = 1},
                                    {.title = "VERSION", .is_flexible = true, .rank = 6}},
                                   rows, style);
  for (const v1::Worker& worker : workers.workers())
    for (const std::string& remark : proto::worker_remarks(worker))
      table +=
          core::printable(fmt::format("{} ({}) {}", worker.name(), worker.id().substr(0, digits), remark)) +
          "\n";
  return table;
}

std::string job_description(const v1::Job& job, double now_seconds, const TextStyle& style) {
  std::vector<std::pair<std::string, std::string>> rows{
      {"job", job.id()},
      {"name", job.name()},
      {"state", state_cell(job)},
      {"samples", samples_text(job)},
      {"time left", time_left(job)},
      {"size", size_text(job.settings())},
      {"spp", spp_text(job.settings())},
      {"integrator", integrator_text(job.settings().integrator())},
      {"seed", std::to_string(job.settings().seed())},
      {"priority", std::to_string(job.priority())},
      {"workers", workers_text(job)},
      {"submitted",
       fmt::format("{} ({})", TimeUtil::ToString(job.created_at()), ago(job.created_at(), now_seconds))},
      {"scene", fmt::format("{} with {} file{}", job.bundle().scene_path(), job.bundle().assets_size(),
                            job.bundle().assets_size() == 1 ? "" : "s")}};
  for (auto& row : image_rows(job)) rows.push_back(std::move(row));
  if (job.settings().has_crop()) rows.push_back({"crop", crop_text(job.settings())});
  if (!job.settings().layers().empty())
    rows.push_back({"layers", fmt::format("{}", fmt::join(job.settings().layers(), ", "))});
  if (job.samples_to_verify() > 0)
    rows.push_back({"to verify", fmt::format("{} samples", job.samples_to_verify())});
  if (!job.owner().empty()) rows.push_back({"owner", job.owner()});
  if (job.settings().integrator() == v1::INTEGRATOR_MIS)
    rows.push_back({"heuristic", heuristic_text(job.settings().heuristic())});
  if (job.settings().clamp_indirect() > 0)
    rows.push_back({"clamp_indirect", fmt::format("{}", job.settings().clamp_indirect())});
  if (is_queued(job) && !job.waiting_reason().empty()) rows.push_back({"queued", job.waiting_reason()});
  if (!job.failure().empty()) rows.push_back({"failure", job.failure()});
  for (const std::string& worker : job.failure_details().workers()) rows.push_back({"failed on", worker});
  for (const std::string& warning : job.warnings()) rows.push_back({"warning", warning});
  for (const auto& [key, value] : sorted_labels(job)) rows.push_back({"label", key + "=" + value});
  for (const std::string& trouble : job.troubles()) rows.push_back({"trouble", trouble});
  if (job.state() == v1::JOB_STATE_RUNNING)
    rows.push_back(
        {"speed", job.samples_per_second() > 0 ? speed(job.samples_per_second()) + " samples/s" : "-"});
  // A coordinator of an earlier release sends no events.
  if (job.events().empty() && job.has_finished_at())
    rows.push_back({"finished", TimeUtil::ToString(job.finished_at())});
  for (const v1::JobEvent& event : job.events())
    if (event.kind() != v1::JobEvent::KIND_SUBMITTED)
      rows.push_back({proto::event_name(event.kind()), TimeUtil::ToString(event.at())});
  if (job.counters().non_finite_samples() > 0)
    rows.push_back({"non-finite", fmt::format("{} samples", job.counters().non_finite_samples())});
  if (job.counters().saturated_samples() > 0)
    rows.push_back({"saturated", fmt::format("{} samples", job.counters().saturated_samples())});
  return format_description(std::move(rows), style);
}

}  // namespace tessera::client
