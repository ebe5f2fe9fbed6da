// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/blob_streams.hpp"

#include <fmt/format.h>
#include <google/protobuf/util/time_util.h>

#include <chrono>
#include <utility>
#include <variant>

#include "proto/blob.hpp"
#include "proto/peer_address.hpp"
#include "proto/segments.hpp"
#include "server/blobs/admission.hpp"
#include "server/rpc/reactors.hpp"
#include "server/rpc/segment_requests.hpp"

namespace tessera::rpc {

using core::ErrorCode;

UploadStream::UploadStream(grpc::CallbackServerContext& context, server::Coordinator& coordinator,
                           const Pools& pools, StreamLimits& streams, auth::Admission admission)
    : Reactor(streams.calls, admission.method),
      context_(context),
      coordinator_(coordinator),
      pools_(pools),
      streams_(streams),
      admission_(std::move(admission)),
      place_(streams.uploads.take(caller())) {
  streams_.stalls.add(*this);
  if (place_) {
    read_next();
    return;
  }
  const core::MutexLock lock(mutex_);
  ended_ = true;
  Finish(auth::try_later(context_,
                         server::over_share(streams_.uploads.held_by(caller()), "uploads", "are in progress",
                                            streams_.limits.uploads, "--max-uploads"),
                         auth::kTryAgainAfter));
}

void UploadStream::read_next() {
  const core::MutexLock lock(mutex_);
  waiting_since_ = Clock::now();
  StartRead(&bytes_);
}

void UploadStream::OnReadDone(bool ok) {
  {
    const core::MutexLock lock(mutex_);
    waiting_since_.reset();
    if (ended_) return;
  }
  const bool posted =
      pools_.receiving.post(guarded_step(*this, [this, ok] { ok ? take_chunk() : commit(); }));
  if (!posted) Finish(busy());
}

void UploadStream::end_if_waiting_since(Clock::time_point time) {
  const core::MutexLock lock(mutex_);
  if (ended_ || !waiting_since_ || *waiting_since_ > time) return;
  ended_ = true;
  Finish(proto::to_grpc(core::Error{
      ErrorCode::kUnavailable,
      fmt::format(
          "no data of this upload has arrived for {} s (tessera-coordinator --stall-seconds): send it again",
          std::chrono::duration<double>(streams_.stalls.patience()).count())}));
}

void UploadStream::OnDone() {
  streams_.stalls.remove(*this);
  const auto end = [this] {
    static_cast<void>(guarded([this]() -> core::Status {
      keep_partial();
      return {};
    }));
    delete this;
  };
  // An incomplete file may be deleted, which uses the disk.
  if (!writer_ || !pools_.receiving.post(end)) end();
}

void UploadStream::take_chunk() {
  if (auto parsed = parse_message(admission_.method, bytes_, request_); !parsed)
    return Finish(proto::to_grpc(parsed));
  if (auto fine = check_chunk(); !fine) return Finish(proto::to_grpc(fine));
  if (writer_) return append();
  begin();
}

core::Status UploadStream::check_chunk() const {
  const v1::BlobChunk& chunk = request_.chunk();
  if (chunk.has_digest() == writer_.has_value()) {
    return core::fail(ErrorCode::kInvalidArgument,
                      "chunk.digest: must be in the first message and in no later one");
  }
  if (chunk.data().size() > proto::kMaxChunkBytes) {
    return core::fail(ErrorCode::kInvalidArgument, fmt::format("chunk.data: must be at most {} bytes, got {}",
                                                               proto::kMaxChunkBytes, chunk.data().size()));
  }
  return {};
}

// Checks the declared size: the writer ends a stream that sends more.
void UploadStream::begin() {
  const auto digest = proto::from_proto(request_.chunk().digest());
  if (!digest) return Finish(proto::to_grpc(digest.error()));
  if (auto fits = blobs::check_blob_size(digest->size_bytes, streams_.limits); !fits)
    return Finish(proto::to_grpc(fits));
  auto use = coordinator_.files().use(caller(), *digest);
  if (!use) return Finish(auth::try_later(context_, use.error(), auth::kTryAgainAfter));
  use_.emplace(*std::move(use));
  *response_.mutable_digest() = request_.chunk().digest();
  take_room(*digest);
}

void UploadStream::take_room(const proto::Digest& digest) {
  const std::uint64_t offset_bytes = request_.offset_bytes();
  auto writer = offset_bytes > 0 ? coordinator_.files().continue_partial(caller(), digest, offset_bytes)
                                 : coordinator_.files().write(caller(), digest);
  if (writer) {
    writer_.emplace(*std::move(writer));
    return append();
  }
  if (writer.error().code != ErrorCode::kResourceExhausted) return Finish(proto::to_grpc(writer.error()));
  if (!pools_.clearing.post(caller(), guarded_step(*this, [this, digest] { make_room(digest); })))
    Finish(busy());
}

void UploadStream::make_room(const proto::Digest& digest) {
  if (pools_.clearing.is_closed()) return Finish(stopping());
  auto writer = coordinator_.files().write_making_room(caller(), digest);
  if (!writer) return Finish(proto::to_grpc(writer.error()));
  writer_.emplace(*std::move(writer));
  append();
}

void UploadStream::append() {
  if (auto appended = writer_->append(request_.chunk().data()); !appended)
    return Finish(proto::to_grpc(appended));
  streams_.calls.traffic.blobs_received += request_.chunk().data().size();
  read_next();
}

void UploadStream::commit() {
  core::Status done = store();
  use_.reset();  // its claims end here, not when gRPC deletes this object
  if (!done) return Finish(proto::to_grpc(done));
  auto bytes = serialise(response_);
  if (!bytes) return Finish(proto::to_grpc(core::Status(core::fail(bytes.error()))));
  bytes_ = *std::move(bytes);
  StartWriteAndFinish(&bytes_, grpc::Status::OK);
}

core::Status UploadStream::store() {
  if (!writer_) return core::fail(ErrorCode::kInvalidArgument, "the stream ended before the first chunk");
  if (writer_->is_whole()) return writer_->commit();
  const std::uint64_t come = writer_->written_bytes();
  const proto::Digest digest = writer_->digest();
  keep_partial();
  return core::fail(
      ErrorCode::kDataLoss,
      fmt::format("blob {}: {} of its {} bytes were received: send the rest (GetUpload says from where)",
                  digest.hex(), come, digest.size_bytes));
}

void UploadStream::keep_partial() {
  if (!writer_) return;
  blobs::BlobWriter writer = *std::move(writer_);
  writer_.reset();
  coordinator_.files().keep_partial(caller(), std::move(writer));
}

void FetchStream::begin() {
  // The share is by machine, since each worker could open many connections.
  const std::string machine = proto::address_key(context().peer());
  auto place = streams().fetches.take(machine);
  if (!place)
    return Finish(
        auth::try_later(context(),
                        server::over_share(streams().fetches.held_by(machine), "files", "are being fetched",
                                           streams().limits.fetches, "--max-fetches"),
                        auth::kTryAgainAfter));
  place_.emplace(*std::move(place));
  *response_.mutable_chunk()->mutable_digest() = request_.digest();
  const bool posted = pool_.post(guarded_step(*this, [this] {
    if (auto opened = open(); !opened) return fail(opened.error());
    request_.has_segment() ? answer_segment_request() : write_next();
  }));
  if (!posted) Finish(busy());
}

core::Status FetchStream::open() {
  const auto digest = proto::from_proto(request_.digest());
  if (!digest) return core::fail(digest.error());
  digest_ = *digest;
  auto reader = coordinator_.blobs().read(digest_);
  if (!reader) return core::fail(reader.error());
  reader_.emplace(std::move(*reader));
  return {};
}

void FetchStream::answer_segment_request() {
  const auto now = coordinator_.farm().options().now();
  const auto ask = read_segment_request(request_.segment(), digest_, context().peer(), now);
  if (!ask) return Finish(proto::to_grpc(core::Status(core::fail(ask.error()))));
  auto source = coordinator_.segments().choose(*ask, now);
  if (auto* const sending = std::get_if<blobs::SegmentTracker::Sending>(&source)) {
    if (auto begun = begin_segment(std::move(*sending)); !begun) return fail(begun.error());
    return write_next();
  }
  response_.clear_chunk();
  if (const auto* const peer = std::get_if<blobs::SegmentTracker::Peer>(&source))
    *response_.mutable_referral() = referral_to(*peer, digest_, now);
  else
    *response_.mutable_retry_after() = google::protobuf::util::TimeUtil::MillisecondsToDuration(
        std::get<blobs::SegmentTracker::Later>(source).time.count());
  answer_at_once();
}

core::Status FetchStream::begin_segment(blobs::SegmentTracker::Sending sending) {
  const proto::Segment segment = proto::segment_at(digest_.size_bytes, sending.index());
  sending_.emplace(std::move(sending));
  *response_.mutable_segment() = proto::to_proto(segment);
  return reader_->limit_to(segment.offset_bytes, segment.size_bytes);
}

void FetchStream::answer_at_once() {
  auto message = serialise(response_);
  if (!message) return Finish(proto::to_grpc(core::Status(core::fail(message.error()))));
  bytes_ = *std::move(message);
  StartWriteAndFinish(&bytes_, grpc::Status::OK);
}

void FetchStream::OnWriteDone(bool ok) {
  {
    const core::MutexLock lock(mutex_);
    waiting_since_.reset();
  }
  if (!ok) return Finish(grpc::Status::CANCELLED);
  if (reader_->left_bytes() == 0) {
    if (sending_) sending_->complete(reader_->read_digest().sha256);
    return Finish(grpc::Status::OK);
  }
  response_.clear_segment();
  response_.mutable_chunk()->clear_digest();
  if (!pool_.post(guarded_step(*this, [this] { write_next(); }))) Finish(busy());
}

void FetchStream::write_next() {
  auto bytes = reader_->next(proto::kChunkBytes);
  if (!bytes) return fail(bytes.error());
  streams().calls.traffic.blobs_sent += bytes->size();
  response_.mutable_chunk()->set_data(std::move(*bytes));
  auto message = serialise(response_);
  if (!message) return Finish(proto::to_grpc(core::Status(core::fail(message.error()))));
  bytes_ = *std::move(message);
  {
    const core::MutexLock lock(mutex_);
    waiting_since_ = Clock::now();
  }
  StartWrite(&bytes_);
}

// A write is in progress; only ending the call cancels it.
void FetchStream::end_own_wait_since(Clock::time_point time) {
  const core::MutexLock lock(mutex_);
  if (waiting_since_ && *waiting_since_ <= time) context().TryCancel();
}

void FetchStream::fail(const core::Error& error) {
  if (const auto digest = proto::from_proto(request_.digest())) {
    coordinator_.segments().forget(*digest);
    coordinator_.jobs().blob_is_lost(*digest, error);
  }
  Finish(proto::to_grpc(core::Status(core::fail(error))));
}

}  // namespace tessera::rpc
