// SPDX-License-Identifier: Apache-2.0
// Calls, what they carry and what waits for threads.
#include <string>

#include "server/metrics/histogram.hpp"
#include "server/metrics/parts.hpp"

namespace tessera::metrics {

namespace {

// "/tessera.v1.RenderService/GetJob" is shown as GetJob: no two services have a method of the same name.
// Routes of the HTTP API are shown as they are: "GET /api/v1/jobs/{id}".
std::string method_name(const std::string& path) {
  return path.starts_with('/') ? path.substr(path.rfind('/') + 1) : path;
}

void write_counts(common::MetricWriter& writer, const rpc::CallStats& calls) {
  for (const auto& [path, method] : calls.methods()) {
    for (std::size_t code = 0; code < rpc::kStatusCodes; ++code) {
      const std::uint64_t count = method.ended[code];
      if (count > 0 || code == 0)
        writer.add(static_cast<double>(count),
                   {{"method", method_name(path)}, {"code", rpc::code_name(code)}});
    }
  }
}

void write_durations(common::MetricWriter& writer, const rpc::CallStats& calls) {
  for (const auto& [path, method] : calls.methods())
    writer.add(to_prometheus(method.durations), {{"method", method_name(path)}});
}

void write_in_progress(common::MetricWriter& writer, const rpc::CallStats& calls) {
  for (const auto& [path, method] : calls.methods())
    writer.add(static_cast<double>(method.in_progress), {{"method", method_name(path)}});
}

}  // namespace

void write_calls(common::MetricWriter& writer, const rpc::CallStats& calls,
                 const rpc::CallStats* http_calls) {
  writer.begin_counter("tessera_calls_total", "Calls that have ended, by method or route, and status code");
  write_counts(writer, calls);
  if (http_calls != nullptr) write_counts(writer, *http_calls);
  writer.begin_histogram("tessera_call_duration_seconds",
                         "Time from the beginning of a call until its status is known. Synchronize waits for "
                         "work, WatchJob for the end of a job, streams for their callers");
  write_durations(writer, calls);
  if (http_calls != nullptr) write_durations(writer, *http_calls);
  writer.begin_gauge("tessera_calls_in_progress", "Calls in progress");
  write_in_progress(writer, calls);
  if (http_calls != nullptr) write_in_progress(writer, *http_calls);
  writer.begin_counter("tessera_rejected_callers_total",
                       "Calls that were rejected before their message was read, by status code");
  for (const auto code : {grpc::StatusCode::UNAUTHENTICATED, grpc::StatusCode::PERMISSION_DENIED,
                          grpc::StatusCode::RESOURCE_EXHAUSTED})
    writer.add(static_cast<double>(calls.rejected(code)), {{"code", rpc::code_name(code)}});
}

void write_traffic(common::MetricWriter& writer, const rpc::Traffic& traffic) {
  writer.begin_counter("tessera_received_bytes_total", "Contents received: files of scenes, and results");
  writer.add(static_cast<double>(traffic.blobs_received), {{"of", "blobs"}});
  writer.add(static_cast<double>(traffic.results_received), {{"of", "results"}});
  writer.begin_counter("tessera_sent_bytes_total",
                       "Contents sent: files of scenes, images, and messages to watchers");
  writer.add(static_cast<double>(traffic.blobs_sent), {{"of", "blobs"}});
  writer.add(static_cast<double>(traffic.images_sent), {{"of", "images"}});
  writer.add(static_cast<double>(traffic.watched_sent), {{"of", "watched"}});
}

void write_queues(common::MetricWriter& writer, const rpc::Server& server) {
  writer.begin_gauge("tessera_queued_tasks", "Tasks that wait for a thread, by pool");
  for (const rpc::Server::QueueDepth& queue : server.queue_depths())
    writer.add(static_cast<double>(queue.tasks), {{"pool", queue.pool}});
}

void write_validations(common::MetricWriter& writer, const jobs::ValidationStats& validations) {
  writer.begin_counter(
      "tessera_validations_total",
      "Scenes that were validated, by outcome; failed: without a result, as for lack of memory");
  writer.add(static_cast<double>(validations.accepted), {{"outcome", "accepted"}});
  writer.add(static_cast<double>(validations.rejected), {{"outcome", "rejected"}});
  writer.add(static_cast<double>(validations.failed), {{"outcome", "failed"}});
  writer.begin_histogram("tessera_validation_duration_seconds", "Time of validating a scene");
  writer.add(to_prometheus(validations.durations));
}

}  // namespace tessera::metrics
