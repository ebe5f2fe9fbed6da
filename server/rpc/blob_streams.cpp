#include "server/rpc/blob_streams.hpp"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "proto/blob.hpp"
#include "server/coordinator/admission.hpp"
#include "server/rpc/reactors.hpp"

namespace tessera::rpc {

using core::ErrorCode;

UploadStream::UploadStream(coordinator::Coordinator& coordinator, coordinator::ThreadPool& pool,
                           StreamLimits& streams, coordinator::FairShare::Held place,
                           v1::UploadBlobResponse* response)
    : coordinator_(coordinator),
      pool_(pool),
      streams_(streams),
      place_(std::move(place)),
      response_(response) {
  streams_.stalls.add(*this);
  read_next();
}

void UploadStream::read_next() {
  const std::lock_guard lock(mutex_);
  waiting_since_ = Clock::now();
  StartRead(&request_);
}

void UploadStream::OnReadDone(bool ok) {
  {
    const std::lock_guard lock(mutex_);
    waiting_since_.reset();
    if (ended_) return;
  }
  const bool posted = pool_.post([this, ok] {
    if (!ok) return Finish(proto::to_grpc(commit()));
    if (auto taken = take_chunk(); !taken) return Finish(proto::to_grpc(taken));
    read_next();
  });
  if (!posted) Finish(busy());
}

void UploadStream::end_if_waiting_since(Clock::time_point time) {
  const std::lock_guard lock(mutex_);
  if (ended_ || !waiting_since_ || *waiting_since_ > time) return;
  ended_ = true;
  Finish({grpc::StatusCode::UNAVAILABLE,
          fmt::format(
              "nothing has come of this upload for {} s (tessera-coordinator --stall-seconds): send it again",
              std::chrono::duration<double>(streams_.stalls.patience()).count())});
}

void UploadStream::OnDone() {
  streams_.stalls.remove(*this);
  delete this;
}

core::Status UploadStream::take_chunk() {
  const v1::BlobChunk& chunk = request_.chunk();
  if (chunk.has_digest() == writer_.has_value()) {
    return core::fail(ErrorCode::kInvalidArgument,
                      "chunk.digest: must be in the first message and in no later one");
  }
  if (chunk.data().size() > proto::kMaxChunkBytes) {
    return core::fail(ErrorCode::kInvalidArgument, fmt::format("chunk.data: must be at most {} bytes, got {}",
                                                               proto::kMaxChunkBytes, chunk.data().size()));
  }
  if (!writer_) {
    if (auto begun = begin(chunk.digest()); !begun) return begun;
  }
  if (auto room = make_room(chunk.data().size()); !room) return room;
  return writer_->append(chunk.data());
}

// By the size that it is said to have: a stream that brings more is ended by the writer.
core::Status UploadStream::begin(const v1::Digest& message) {
  const auto digest = proto::from_proto(message);
  if (!digest) return core::fail(digest.error());
  if (auto fits = coordinator::check_blob_size(digest->size_bytes, streams_.limits); !fits) return fits;
  if (auto room = make_room(digest->size_bytes); !room) return room;
  auto writer = coordinator_.blobs().write(*digest);
  if (!writer) return core::fail(writer.error());
  writer_.emplace(std::move(*writer));
  *response_->mutable_digest() = message;
  return {};
}

core::Status UploadStream::make_room(std::uint64_t bytes) {
  const auto fits = [&] {
    return coordinator::check_store_size(coordinator_.blobs().used_bytes(), bytes, streams_.limits);
  };
  if (fits()) return {};
  coordinator_.make_room();
  return fits();
}

core::Status UploadStream::commit() {
  if (!writer_) return core::fail(ErrorCode::kInvalidArgument, "the stream ended before the first chunk");
  return writer_->commit();
}

FetchStream::FetchStream(coordinator::Coordinator& coordinator, coordinator::ThreadPool& pool,
                         const v1::Digest& digest)
    : coordinator_(coordinator), pool_(pool), message_(digest) {
  *response_.mutable_chunk()->mutable_digest() = digest;
  const bool posted = pool_.post([this, digest] {
    if (auto opened = open(digest); !opened) return fail(opened.error());
    write_next();
  });
  if (!posted) Finish(busy());
}

core::Status FetchStream::open(const v1::Digest& message) {
  const auto digest = proto::from_proto(message);
  if (!digest) return core::fail(digest.error());
  auto reader = coordinator_.blobs().read(*digest);
  if (!reader) return core::fail(reader.error());
  reader_.emplace(std::move(*reader));
  left_bytes_ = digest->size_bytes;
  return {};
}

void FetchStream::OnWriteDone(bool ok) {
  if (!ok) return Finish(grpc::Status::CANCELLED);
  if (left_bytes_ == 0) return Finish(grpc::Status::OK);
  response_.mutable_chunk()->clear_digest();
  if (!pool_.post([this] { write_next(); })) Finish(busy());
}

void FetchStream::write_next() {
  auto bytes = reader_->next(proto::kChunkBytes);
  if (!bytes) return fail(bytes.error());
  left_bytes_ -= bytes->size();
  response_.mutable_chunk()->set_data(std::move(*bytes));
  StartWrite(&response_);
}

void FetchStream::fail(const core::Error& error) {
  if (const auto digest = proto::from_proto(message_)) coordinator_.blob_is_lost(*digest, error);
  Finish(proto::to_grpc(core::Status(core::fail(error))));
}

}  // namespace tessera::rpc
