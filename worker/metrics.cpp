// SPDX-License-Identifier: Apache-2.0
#include "worker/metrics.hpp"

#include <fmt/format.h>

namespace tessera::worker {

namespace {

double seconds(const Metrics::Count& ns) {
  return static_cast<double>(ns) * 1e-9;
}

void write_work(common::MetricWriter& writer, const Metrics& metrics, const Identity& identity) {
  writer.gauge("tessera_worker_threads", "Threads that render", static_cast<double>(identity.threads));
  writer.counter("tessera_worker_samples_rendered_total", "Pixel samples rendered, wanted or not",
                 static_cast<double>(metrics.samples_rendered));
  writer.counter("tessera_worker_render_seconds_total", "Time spent rendering", seconds(metrics.render_ns));
  writer.gauge("tessera_worker_leases", "Leases held at the last heartbeat",
               static_cast<double>(metrics.leases_held));
  writer.begin_counter("tessera_worker_results_total", "Results sent, by the coordinator's answer");
  writer.add(static_cast<double>(metrics.results_delivered), {{"answer", "taken"}});
  writer.add(static_cast<double>(metrics.results_rejected), {{"answer", "rejected"}});
}

void write_scenes(common::MetricWriter& writer, const Metrics& metrics, const BlobCache& cache) {
  writer.counter("tessera_worker_blobs_fetched_total", "Files of scenes fetched",
                 static_cast<double>(cache.traffic().files));
  writer.counter("tessera_worker_received_bytes_total", "Bytes of files fetched",
                 static_cast<double>(cache.traffic().received_bytes));
  writer.counter("tessera_worker_peer_received_bytes_total", "Bytes of files fetched from other workers",
                 static_cast<double>(cache.traffic().peer_received_bytes));
  writer.counter("tessera_worker_peer_sent_bytes_total",
                 "Bytes of files sent to other workers (--serve-blobs)",
                 static_cast<double>(cache.traffic().peer_sent_bytes));
  writer.gauge("tessera_worker_cache_bytes", "Size of the files in the cache folder",
               static_cast<double>(cache.used_bytes()));
  writer.gauge("tessera_worker_cache_limit_bytes", "Limit on the cache folder (--cache-gib)",
               static_cast<double>(cache.max_bytes()));
  writer.begin_counter("tessera_worker_scene_loads_total", "Scenes made ready to render, by outcome");
  writer.add(static_cast<double>(metrics.scenes_loaded), {{"outcome", "loaded"}});
  writer.add(static_cast<double>(metrics.scenes_failed), {{"outcome", "failed"}});
  writer.counter("tessera_worker_scene_load_seconds_total", "Time spent making scenes ready",
                 seconds(metrics.scene_load_ns));
}

void write_connection(common::MetricWriter& writer, const Metrics& metrics) {
  writer.gauge("tessera_worker_connected", "1 if the coordinator has answered the last heartbeat, else 0",
               metrics.connected ? 1 : 0);
  writer.gauge("tessera_worker_last_answer_age_seconds",
               "Time since the coordinator last answered a heartbeat, or since the start of the worker",
               std::chrono::duration<double>(Metrics::Clock::now() - metrics.last_answer.load()).count());
}

}  // namespace

core::Status check_alive(const Metrics& metrics, Metrics::Clock::duration longest_step) {
  const auto now = Metrics::Clock::now();
  if (now > metrics.next_call_by.load())
    return core::fail(core::ErrorCode::kUnavailable, "the thread that calls the coordinator hangs");
  const auto began = metrics.step_began.load();
  if (began < now && now - began > longest_step)
    return core::fail(core::ErrorCode::kUnavailable,
                      fmt::format("no scene was built and no piece rendered for {} s",
                                  std::chrono::floor<std::chrono::seconds>(now - began).count()));
  return {};
}

core::Status check_ready(const Metrics& metrics, Metrics::Clock::duration longest_step) {
  if (const core::Status alive = check_alive(metrics, longest_step); !alive) return alive;
  if (metrics.connected) return {};
  return core::fail(core::ErrorCode::kUnavailable, "the coordinator has not answered the last call");
}

std::optional<std::string> status_of(const Metrics& metrics, const std::string& address,
                                     Metrics::Clock::duration longest_step) {
  if (!check_alive(metrics, longest_step)) return std::nullopt;
  if (!metrics.connected) return "no connection to " + address;
  return fmt::format("connected to {}, with {} leases", address, metrics.leases_held.load());
}

common::MetricFamilies collect(const Metrics& metrics, const Identity& identity, const BlobCache& cache) {
  common::MetricWriter writer;
  write_work(writer, metrics, identity);
  write_scenes(writer, metrics, cache);
  write_connection(writer, metrics);
  common::write_process_metrics(writer, identity.version, identity.determinism_fingerprint);
  return writer.take();
}

}  // namespace tessera::worker
