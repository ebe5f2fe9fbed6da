// SPDX-License-Identifier: Apache-2.0
#include "worker/sync_loop.hpp"

#include <google/protobuf/util/time_util.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>

#include "worker/waiting.hpp"

namespace tessera::worker {
namespace {

using namespace std::chrono_literals;
using google::protobuf::util::TimeUtil;

// A coordinator may hold a call for up to its heartbeat timeout; after the slack it is presumed lost.
constexpr proto::Duration kFirstDeadline = 60s;
constexpr proto::Duration kDeadlineSlack = 10s;
constexpr proto::Duration kGoodbyeDeadline = 2s;
// An answer without a change should have waited. The worker waits instead of the coordinator.
constexpr proto::Duration kShortestExchange = 50ms;

// More than the pause after any answer, also that of a coordinator that refuses this worker.
constexpr proto::Duration kMaxPause = 120s;

constexpr proto::BackoffOptions kBackoff{.first = 100ms, .longest = 2s};

// Whether the coordinator rejects this worker: its build, machine, name or credentials.
bool refuses_this_worker(core::ErrorCode code) {
  return code == core::ErrorCode::kFailedPrecondition || code == core::ErrorCode::kInvalidArgument ||
         code == core::ErrorCode::kPermissionDenied;
}

}  // namespace

bool SyncLoop::run(const std::stop_token& stop) {
  const proto::RetryPolicy backoff = proto::exponential_backoff(kBackoff);
  const proto::RetryPolicy refusal_backoff = proto::exponential_backoff(refusal_backoff_);
  proto::Duration deadline = kFirstDeadline;
  int failures = 0;
  while (!stop.stop_requested()) {
    const auto start = std::chrono::steady_clock::now();
    metrics_.next_call_by = start + deadline + kMaxPause;
    const auto response = synchronize(stop, deadline);
    if (stop.stop_requested()) break;
    if (response) {
      failures = 0;
      note_success();
      if (response->stop()) return true;
      deadline = std::chrono::milliseconds(TimeUtil::DurationToMilliseconds(response->heartbeat_timeout())) +
                 kDeadlineSlack;
      const bool changed = lease_tracker_.apply(*response);
      if (!changed && std::chrono::steady_clock::now() - start < kShortestExchange)
        wait_for(stop, kShortestExchange);
    } else {
      if (response.error().code == core::ErrorCode::kDeadlineExceeded) continue;  // a long wait
      note_failure(response.error());
      const proto::RetryPolicy& policy =
          refuses_this_worker(response.error().code) ? refusal_backoff : backoff;
      wait_for(stop, policy({.count = ++failures}).value());
    }
  }
  return false;
}

core::Result<v1::SynchronizeResponse> SyncLoop::synchronize(const std::stop_token& stop,
                                                            proto::Duration deadline) {
  v1::SynchronizeRequest request;
  request.set_worker_id(identity_.worker_id);
  request.set_name(identity_.name);
  request.set_version(identity_.version);
  request.set_determinism_fingerprint(identity_.determinism_fingerprint);
  request.set_threads(identity_.threads);
  request.set_worker_key(identity_.worker_key);
  request.set_names_images(true);
  request.set_renders_layers(true);
  lease_tracker_.report(request);
  complete_(request);
  metrics_.leases_held = static_cast<std::uint64_t>(request.held_size());

  StoppableCall call(stop, deadline);
  v1::SynchronizeResponse response;
  const grpc::Status status = coordinator_.Synchronize(call.context(), request, &response);
  if (!status.ok()) return core::fail(explain_(status));
  return response;
}

void SyncLoop::note_success() {
  metrics_.connected = true;
  metrics_.last_answer = Metrics::Clock::now();
  if (!connected_ || !told_reasons_.empty())
    spdlog::info(connected_ ? "the coordinator accepts this worker's calls again"
                            : "registered with the coordinator");
  connected_ = true;
  told_reasons_.clear();
}

void SyncLoop::note_failure(const core::Error& error) {
  metrics_.connected = false;
  if (!told_reasons_.insert(error.message).second) return;
  if (refuses_this_worker(error.code)) {
    spdlog::error("refused by the coordinator ({}); trying again from time to time", error.message);
  } else {
    spdlog::warn("cannot reach the coordinator ({}); trying again until it answers", error.message);
  }
}

void SyncLoop::deregister() {
  const auto response = synchronize(std::stop_token(), kGoodbyeDeadline);
  if (!response && response.error().code != core::ErrorCode::kDeadlineExceeded)
    spdlog::warn("could not deregister from the coordinator: {}", response.error().message);
}

}  // namespace tessera::worker
