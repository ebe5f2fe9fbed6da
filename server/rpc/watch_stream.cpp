// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/watch_stream.hpp"

#include <utility>

#include "proto/status.hpp"
#include "server/rpc/reactors.hpp"

namespace tessera::rpc {

void WatchStream::begin() {
  auto place = streams().watches.take(caller().key);
  if (!place) {
    const core::MutexLock lock(mutex_);
    return end(
        auth::try_later(context(),
                        server::over_share(streams().watches.held_by(caller().key), "jobs",
                                           "are being watched", streams().limits.watches, "--max-watches"),
                        auth::kTryAgainAfter));
  }
  place_.emplace(*std::move(place));
  hub_.add(*this);
}

bool WatchStream::notify(bool changed) {
  const core::MutexLock lock(mutex_);
  is_due_ = is_due_ || changed;
  step_if_due();
  return is_due_ && !is_busy_ && !ending_;
}

void WatchStream::step_if_due() {
  if (!is_due_ || is_busy_ || ending_ || Clock::now() < paused_until_) return;
  if (!pool_.post(caller().key, [this] { step(); })) return;  // the hub asks again
  is_due_ = false;
  is_busy_ = true;
}

void WatchStream::step() {
  Step step;
  const core::Status made = guarded([&]() -> core::Status {
    auto next_step = next();
    if (!next_step) return core::fail(next_step.error());
    step = *next_step;
    return {};
  });
  const core::MutexLock lock(mutex_);
  is_busy_ = false;
  if (!made) return end(proto::to_grpc(made));
  paused_until_ = Clock::now() + step.pause;
  is_due_ = is_due_ || step.has_more;
  if (step.message != nullptr && !ending_) send(step);
  if (step.is_last) end(grpc::Status::OK);
  finish_if_ended();
  step_if_due();
  if (is_due_ && !is_busy_) hub_.request_round();
}

void WatchStream::send(const Step& step) {
  auto bytes = serialise(*step.message);
  if (!bytes) return end(proto::to_grpc(core::Status(core::fail(bytes.error()))));
  bytes_ = *std::move(bytes);
  streams().calls.traffic.watched_sent += bytes_.Length();
  is_busy_ = true;
  sending_since_ = Clock::now();
  StartWrite(&bytes_);
}

void WatchStream::end(grpc::Status status) {
  if (!ending_) ending_ = std::move(status);
  finish_if_ended();
}

void WatchStream::finish_if_ended() {
  if (!ending_ || is_busy_ || std::exchange(is_finished_, true)) return;
  Finish(*ending_);
}

void WatchStream::close() {
  const core::MutexLock lock(mutex_);
  end(stopping());
}

// A write is in progress; only ending the call cancels it.
void WatchStream::end_own_wait_since(Clock::time_point time) {
  const core::MutexLock lock(mutex_);
  if (sending_since_ && *sending_since_ <= time) context().TryCancel();
}

void WatchStream::OnWriteDone(bool ok) {
  const core::MutexLock lock(mutex_);
  is_busy_ = false;
  sending_since_.reset();
  if (!ok) return end(grpc::Status::CANCELLED);
  finish_if_ended();
  step_if_due();
  if (is_due_ && !is_busy_ && !ending_) hub_.request_round();
}

void WatchStream::on_cancel() {
  const core::MutexLock lock(mutex_);
  end(grpc::Status::CANCELLED);
}

void WatchStream::OnDone() {
  hub_.remove(*this);
  { const core::MutexLock whoever_ended_it_is_done(mutex_); }
  RequestCall::OnDone();
}

}  // namespace tessera::rpc
