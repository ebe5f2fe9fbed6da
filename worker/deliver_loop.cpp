// SPDX-License-Identifier: Apache-2.0
#include "worker/deliver_loop.hpp"

#include <fmt/format.h>
#include <google/protobuf/util/time_util.h>

#include <chrono>

#include "core/common/log.hpp"
#include "proto/retry.hpp"
#include "proto/status.hpp"
#include "proto/tile_codec.hpp"
#include "worker/waiting.hpp"

namespace tessera::worker {
namespace {

using namespace std::chrono_literals;

// The timeout of a message: a constant, and a part for each kilobyte, so that lines of a few kilobytes a
// second suffice. The channel's keepalive detects a peer that vanished long before.
constexpr proto::Duration kSubmitDeadline = 30s, kSubmitDeadlinePerKilobyte = 250ms;
constexpr proto::BackoffOptions kDeliveryBackoff{.first = 100ms, .longest = 2s};

// Whether the result was rejected, so that a retry cannot succeed. After any other error the result may still
// be needed.
bool is_refusal(core::ErrorCode code) {
  return code == core::ErrorCode::kInvalidArgument || code == core::ErrorCode::kNotFound ||
         code == core::ErrorCode::kFailedPrecondition;
}

proto::RetryPolicy unless_refused(proto::RetryPolicy inner) {
  return [inner = std::move(inner)](const proto::Attempts& attempts) -> std::optional<proto::Duration> {
    if (is_refusal(attempts.last_code)) return std::nullopt;
    return inner(attempts);
  };
}

}  // namespace

void DeliverLoop::run(const std::stop_token& stop) {
  const proto::RetryPolicy policy = unless_refused(proto::exponential_backoff(kDeliveryBackoff));
  while (const auto delivery = lease_tracker_.next_delivery(stop)) {
    const v1::SubmitResultRequest request = encode(*delivery);
    v1::SubmitResultResponse response;
    const core::Status done =
        proto::retry(policy, waiter_until(stop), [&] { return submit(request, stop, response); });
    if (!done && !is_refusal(done.error().code)) return;  // a stop was requested
    ++(done ? metrics_.results_delivered : metrics_.results_rejected);
    if (!done)
      common::log(spdlog::level::err,
                  fmt::format("job {}: the coordinator refused {} items: {}", delivery->job_id,
                              delivery->tiles.size(), done.error().message),
                  {.job = delivery->job_id});
    lease_tracker_.delivered(*delivery, response);
  }
}

v1::SubmitResultRequest DeliverLoop::encode(const Delivery& delivery) const {
  v1::SubmitResultRequest request;
  request.set_worker_id(identity_.worker_id);
  request.set_version(identity_.version);
  request.set_determinism_fingerprint(identity_.determinism_fingerprint);
  request.set_job_id(delivery.job_id);
  request.set_lease_id(delivery.lease_id);
  request.set_lease_token(delivery.lease_token);
  for (const RenderedTile& tile : delivery.tiles) *request.add_items() = proto::encode_tile(tile, tile.image);
  *request.mutable_render_time() = google::protobuf::util::TimeUtil::NanosecondsToDuration(
      std::chrono::duration_cast<std::chrono::nanoseconds>(delivery.render_time).count());
  request.set_lease_finished(delivery.lease_finished);
  request.set_decline_reason(delivery.decline_reason);
  request.mutable_held_lease_ids()->Add(delivery.held_besides.begin(), delivery.held_besides.end());
  return request;
}

core::Status DeliverLoop::submit(const v1::SubmitResultRequest& request, const std::stop_token& stop,
                                 v1::SubmitResultResponse& response) {
  const std::size_t kilobytes = request.ByteSizeLong() / 1000;
  StoppableCall call(stop, kSubmitDeadline + kilobytes * kSubmitDeadlinePerKilobyte);
  call.context()->set_wait_for_ready(true);
  const grpc::Status status = coordinator_.SubmitResult(call.context(), request, &response);
  if (status.ok() && response.dropped_items() > 0)
    common::log(spdlog::level::debug,
                fmt::format("job {}: {} of {} items were there already", request.job_id(),
                            response.dropped_items(), request.items_size()),
                {.job = request.job_id()});
  return proto::from_grpc(status);
}

}  // namespace tessera::worker
