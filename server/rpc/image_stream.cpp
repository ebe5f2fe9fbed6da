// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/image_stream.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <utility>

#include "proto/blob.hpp"
#include "server/rpc/reactors.hpp"

namespace tessera::rpc {

void ImageStream::begin() {
  if (!pools_.users.post(caller().key, guarded_step(*this, [this] { wait_for_memory(); }))) Finish(busy());
}

// The stream may end at any moment once it waits, but it is not deleted before OnDone has taken the lock.
void ImageStream::wait_for_memory() {
  const auto need_bytes = coordinator_.images().bytes_to_write(request_);
  if (!need_bytes) return Finish(proto::to_grpc(need_bytes.error()));
  need_mib_ = 1 + *need_bytes / server::kMib;
  const core::MutexLock lock(mutex_);
  if (cancelled_) return Finish(grpc::Status::CANCELLED);
  queued_since_ = Clock::now();
  const auto granted = [this](base::FairShare::Held memory) { make_image(std::move(memory)); };
  if (!streams().image_mib.wait(this, caller().key, need_mib_, granted)) Finish(no_memory());
}

// The caller must hold neither the lock nor that of wait_for_memory().
void ImageStream::make_image(base::FairShare::Held memory) {
  memory_.emplace(std::move(memory));
  const bool posted = pools_.slow.post(caller().key, guarded_step(*this, [this] {
                                         if (pools_.slow.is_closed()) return Finish(stopping());
                                         if (auto taken = take_image(); !taken)
                                           return Finish(proto::to_grpc(taken));
                                         write_next();
                                       }));
  if (!posted) Finish(busy());
}

grpc::Status ImageStream::no_memory() {
  core::Error error = server::over_limit(
      fmt::format("this image takes {} MiB of memory, and others that are being fetched {} MiB", need_mib_,
                  streams().image_mib.held()),
      fmt::format("{} MiB", streams().limits.image_mib), "--max-image-mib");
  error.message += ", some of which it keeps for other callers";
  return auth::try_later(context(), error, auth::kTryAgainAfter);
}

core::Status ImageStream::take_image() {
  auto image = coordinator_.images().write(request_);
  if (!image) return core::fail(image.error());
  response_.mutable_header()->set_size_bytes(image->size_bytes);
  *response_.mutable_header()->mutable_job() = std::move(image->job);
  size_bytes_ = image->size_bytes;
  file_.emplace(std::move(image->file));
  return {};
}

void ImageStream::OnWriteDone(bool ok) {
  {
    const core::MutexLock lock(mutex_);
    waiting_since_.reset();
  }
  if (!ok) return Finish(grpc::Status::CANCELLED);
  if (sent_bytes_ == size_bytes_) return Finish(grpc::Status::OK);
  response_.clear_header();
  if (!pools_.sending.post(guarded_step(*this, [this] { write_next(); }))) Finish(busy());
}

void ImageStream::write_next() {
  auto chunk = file_->read_at(sent_bytes_, proto::kChunkBytes);
  if (!chunk) return Finish(proto::to_grpc(core::Status(core::fail(chunk.error()))));
  sent_bytes_ += chunk->size();
  response_.set_data(*std::move(chunk));
  streams().calls.traffic.images_sent += response_.data().size();
  auto message = serialise(response_);
  if (!message) return Finish(proto::to_grpc(core::Status(core::fail(message.error()))));
  bytes_ = *std::move(message);
  {
    const core::MutexLock lock(mutex_);
    waiting_since_ = Clock::now();
  }
  StartWrite(&bytes_);
}

// Memory becomes free while others read their images, so the wait for it is bounded by the stall time as
// well. A write in progress is cancelled only by ending the call.
void ImageStream::end_own_wait_since(Clock::time_point time) {
  const core::MutexLock lock(mutex_);
  if (waiting_since_ && *waiting_since_ <= time) return context().TryCancel();
  if (queued_since_ && *queued_since_ <= time && streams().image_mib.leave(this)) Finish(no_memory());
}

void ImageStream::on_cancel() {
  {
    const core::MutexLock lock(mutex_);
    cancelled_ = true;
  }
  if (streams().image_mib.leave(this)) Finish(grpc::Status::CANCELLED);
}

void ImageStream::OnDone() {
  streams().stalls.remove(*this);
  { const core::MutexLock whoever_ended_it_is_done(mutex_); }
  // The file may be large, and to free it uses the disk.
  if (!file_ || !pools_.sending.post([this] { RequestCall::OnDone(); })) RequestCall::OnDone();
}

}  // namespace tessera::rpc
