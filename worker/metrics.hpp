// SPDX-License-Identifier: Apache-2.0
// What a worker counts of its work, and shows to Prometheus (docs/metrics.md). Lock-free; thread-safe.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "core/base/error.hpp"
#include "core/common/metric_writer.hpp"
#include "worker/blob_cache.hpp"
#include "worker/identity.hpp"

namespace tessera::worker {

struct Metrics {
  using Clock = std::chrono::steady_clock;
  using Count = std::atomic<std::uint64_t>;

  // Pixel samples rendered, including unwanted ones, and the time that this took.
  Count samples_rendered{0}, render_ns{0};
  // Leases that the last heartbeat has reported.
  Count leases_held{0};
  // Results that the coordinator has taken or rejected.
  Count results_delivered{0}, results_rejected{0};
  // Scenes that were made ready to render, those that could not be, and the time of both.
  Count scenes_loaded{0}, scenes_failed{0}, scene_load_ns{0};
  // Whether the last Synchronize was answered, and when one was last; at first the start of the worker.
  std::atomic<bool> connected{false};
  std::atomic<Clock::time_point> last_answer{Clock::now()};
  // When the next Synchronize begins at the latest, unless the thread that calls it hangs.
  std::atomic<Clock::time_point> next_call_by{Clock::time_point::max()};
  // When the thread that renders has begun what it does: making a scene ready, or rendering a piece of it.
  // The maximum while it waits for work.
  std::atomic<Clock::time_point> step_began{Clock::time_point::max()};

  static void add(Count& total, Clock::duration time) {
    total += static_cast<std::uint64_t>(std::chrono::nanoseconds(time).count());
  }
};

// Fails if the worker must be restarted: the thread that synchronises hangs, or that which renders is at one
// step for longer than `longest_step`. Says nothing of the coordinator, which a restart would not bring back.
core::Status check_alive(const Metrics& metrics, Metrics::Clock::duration longest_step);

// Fails unless the worker is alive and the coordinator has answered its last call.
core::Status check_ready(const Metrics& metrics, Metrics::Clock::duration longest_step);

// One line for the service manager: whether the worker is connected to the coordinator at `address`, and what
// it holds. Empty if the worker must be restarted.
std::optional<std::string> status_of(const Metrics& metrics, const std::string& address,
                                     Metrics::Clock::duration longest_step);

// Also what the cache has fetched. Reads the sizes of the files in the cache's folder.
common::MetricFamilies collect(const Metrics& metrics, const Identity& identity, const BlobCache& cache);

}  // namespace tessera::worker
