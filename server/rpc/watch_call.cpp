// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/watch_call.hpp"

#include <chrono>
#include <utility>

#include "proto/status.hpp"

namespace tessera::rpc {

namespace {

constexpr auto kShortestInterval = std::chrono::milliseconds(250);

bool is_final(v1::JobState state) {
  return state == v1::JOB_STATE_DONE || state == v1::JOB_STATE_CANCELLED || state == v1::JOB_STATE_FAILED;
}

}  // namespace

void WatchCall::begin() {
  auto place = streams().watches.take(caller().key);
  if (!place) {
    const std::lock_guard lock(mutex_);
    return end(
        auth::try_later(context(),
                        server::over_share(streams().watches.held_by(caller().key), "jobs",
                                           "are being watched", streams().limits.watches, "--max-watches"),
                        auth::kTryAgainAfter));
  }
  place_.emplace(*std::move(place));
  hub_.add(*this);
}

void WatchCall::tell(const core::Result<v1::Job>& job) {
  const std::lock_guard lock(mutex_);
  if (!job) return end(proto::to_grpc(job.error()));
  const bool soon = Clock::now() < last_sent_at_ + kShortestInterval;
  if (writing_ || ending_ || (soon && !is_final(job->state()))) return;
  std::string bytes = job->SerializeAsString();
  if (bytes == last_sent_) return;
  last_sent_ = std::move(bytes);
  write(*job);
  if (is_final(job->state())) end(grpc::Status::OK);
}

void WatchCall::write(const v1::Job& job) {
  last_sent_at_ = Clock::now();
  writing_ = true;
  *response_.mutable_job() = job;
  auto bytes = serialise(response_);
  if (!bytes) {
    writing_ = false;
    return end(proto::to_grpc(core::Status(core::fail(bytes.error()))));
  }
  bytes_ = *std::move(bytes);
  StartWrite(&bytes_);
}

void WatchCall::end(grpc::Status status) {
  if (!ending_) ending_ = std::move(status);
  if (writing_ || finished_) return;
  finished_ = true;
  Finish(*ending_);
}

// A write is in progress; only ending the call cancels it.
void WatchCall::end_own_wait_since(Clock::time_point time) {
  const std::lock_guard lock(mutex_);
  if (writing_ && last_sent_at_ <= time) context().TryCancel();
}

void WatchCall::OnWriteDone(bool ok) {
  const std::lock_guard lock(mutex_);
  writing_ = false;
  if (!ok) return end(grpc::Status::CANCELLED);
  if (ending_) end(*ending_);
}

void WatchCall::on_cancel() {
  const std::lock_guard lock(mutex_);
  end(grpc::Status::CANCELLED);
}

void WatchCall::OnDone() {
  hub_.remove(*this);
  { const std::lock_guard whoever_ended_it_is_done(mutex_); }
  RequestCall::OnDone();
}

}  // namespace tessera::rpc
