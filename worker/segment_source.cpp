// SPDX-License-Identifier: Apache-2.0
#include "worker/segment_source.hpp"

#include <fmt/format.h>
#include <google/protobuf/util/time_util.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "proto/retry.hpp"
#include "proto/segments.hpp"
#include "worker/waiting.hpp"

namespace tessera::worker {

namespace {

using core::ErrorCode;

constexpr std::int64_t kMinPauseMs = 10, kMaxPauseMs = 10'000;

}  // namespace

core::Status SegmentSource::fetch(PartialBlob& into, const std::stop_token& stop) {
  if (knows_segments_) {
    if (core::Status fetched = fetch_segments(into, stop); !fetched) return fetched;
    if (into.is_intact()) return {};
  }
  // An earlier coordinator, or a file that is damaged at the coordinator, which finds out when it sends all
  // of it.
  into.clear();
  return whole_.fetch(into, stop);
}

core::Status SegmentSource::fetch_segments(PartialBlob& into, const std::stop_token& stop) {
  const auto policy = proto::transient_only(proto::exponential_backoff());
  core::Status done;
  while (done && knows_segments_ && !into.held().is_full()) {
    done = proto::retry(policy, waiter_until(stop), [&] { return fetch_one(into, stop); });
    if (stop.stop_requested()) return core::fail(ErrorCode::kCancelled, "stopped");
  }
  return done;
}

core::Status SegmentSource::fetch_one(PartialBlob& into, const std::stop_token& stop) {
  v1::FetchBlobResponse response;
  {
    StoppableCall call(stop);
    StallGuard guard([&] { call.context()->TryCancel(); }, kMaxSilence);
    call.context()->set_wait_for_ready(true);
    const auto stream = coordinator_.FetchBlob(call.context(), request_for(into));
    core::Status received;
    if (stream->Read(&response)) {
      guard.progressed();
      knows_segments_ = response.has_segment() || response.has_referral() || response.has_retry_after();
      if (response.has_segment()) received = receive(*stream, response, into, guard);
      if (!knows_segments_ || !received) call.context()->TryCancel();
    }
    const core::Status finished = finish_download(*stream, *call.context(), stop);
    if (!knows_segments_) return {};
    if (!received) return received;
    if (!finished) return finished;
  }
  if (response.has_referral()) return follow(response.referral(), into, stop);
  if (response.has_retry_after()) {
    const std::int64_t pause =
        google::protobuf::util::TimeUtil::DurationToMilliseconds(response.retry_after());
    wait_for(stop, std::chrono::milliseconds(std::clamp(pause, kMinPauseMs, kMaxPauseMs)));
  }
  return {};
}

// The first message has been read. Adds the segment if all of it comes. The bytes of the coordinator are
// checked with the whole blob.
core::Status SegmentSource::receive(grpc::ClientReaderInterface<v1::FetchBlobResponse>& stream,
                                    v1::FetchBlobResponse& response, PartialBlob& into, StallGuard& guard) {
  const auto segment = proto::from_proto(response.segment(), into.digest().size_bytes);
  if (!segment) return core::fail(segment.error());
  std::string bytes;
  do {
    guard.progressed();
    if (response.chunk().data().size() > segment->size_bytes - bytes.size())
      return core::fail(ErrorCode::kInvalidArgument, "the coordinator sent more than the segment");
    bytes += response.chunk().data();
  } while (stream.Read(&response));
  response.Clear();
  // Otherwise the status of the call says why.
  if (bytes.size() == segment->size_bytes) return into.add(*segment, bytes);
  return {};
}

// If the worker fails, the coordinator names another one, or sends the segment itself.
core::Status SegmentSource::follow(const v1::PeerReferral& referral, PartialBlob& into,
                                   const std::stop_token& stop) {
  const auto segment = proto::from_proto(referral.segment(), into.digest().size_bytes);
  if (!segment) return core::fail(segment.error());
  const auto bytes = peers_.fetch(into.digest(), referral, stop);
  if (!bytes) return {};
  cache_.traffic().peer_received_bytes += bytes->size();
  return into.add(*segment, *bytes);
}

v1::FetchBlobRequest SegmentSource::request_for(const PartialBlob& blob) {
  v1::FetchBlobRequest request;
  *request.mutable_digest() = proto::to_proto(blob.digest());
  v1::SegmentRequest& segment = *request.mutable_segment();
  segment.set_worker_key(worker_key_);
  segment.set_held(blob.held().to_bytes());
  if (server_ != nullptr) *segment.mutable_endpoint() = server_->endpoint();
  for (const std::string& id : peers_.excluded(PeerClient::Clock::now())) segment.add_excluded_worker_ids(id);
  return request;
}

}  // namespace tessera::worker
