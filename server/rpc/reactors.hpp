// SPDX-License-Identifier: Apache-2.0
// How handlers leave gRPC's threads: every call's work is posted to a pool of ours, and the call finished
// from there. gRPC has few threads for callbacks, at least two; one that blocks stops the others. What is
// short is done on one of them at a time, since waking another thread costs a good part of such work.
#pragma once

#include <grpcpp/support/status.h>

#include <exception>
#include <functional>
#include <new>
#include <string>
#include <utility>

#include "proto/status.hpp"
#include "server/coordinator/fair_pool.hpp"
#include "server/coordinator/thread_pool.hpp"

namespace tessera::rpc {

// What a call is answered with when there are too many already.
inline grpc::Status busy() {
  return {grpc::StatusCode::UNAVAILABLE, "the coordinator has too much to do at this moment: try again"};
}

// What work is answered with that still waits when the coordinator stops.
inline grpc::Status stopping() {
  return {grpc::StatusCode::UNAVAILABLE, "the coordinator is stopping: try again"};
}

// The status of `work()`, also when it throws: what libraries throw ends here.
template <typename Work>
core::Status guarded(const Work& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return core::fail(core::ErrorCode::kResourceExhausted, "the coordinator has not enough memory for this");
  } catch (const std::exception& error) {
    return core::fail(core::ErrorCode::kInternal, error.what());
  }
}

// FairPool's callers take turns; ThreadPool's do not.
inline bool post(coordinator::ThreadPool& pool, const std::string&, std::function<void()> task) {
  return pool.post(std::move(task));
}
inline bool post(coordinator::FairPool& pool, const std::string& caller, std::function<void()> task) {
  return pool.post(caller, std::move(task));
}

// Finishes a unary call with the status of `work()`.
template <typename Call, typename Pool, typename Work>
std::function<void()> finishing(Call& call, const Pool& pool, Work work) {
  return [&call, &pool, work = std::move(work)] {
    call.finish(pool.is_closed() ? stopping() : proto::to_grpc(guarded(work)));
  };
}

// Answers a unary call with the status of `work()`, run on `pool`, or with when_full() if too much waits for
// that. What `work` refers to must live until then; the call does.
template <typename Call, typename Pool, typename Work, typename WhenFull = grpc::Status (*)()>
void run_unary(Call& call, Pool& pool, Work work, WhenFull when_full = busy) {
  if (!post(pool, call.caller().key, finishing(call, pool, std::move(work)))) call.finish(when_full());
}

// The same for work that is short, which may be done on the calling thread (run_or_post).
template <typename Call, typename Work>
void run_short_unary(Call& call, coordinator::ThreadPool& pool, Work work) {
  if (!pool.run_or_post(finishing(call, pool, std::move(work)))) call.finish(busy());
}

// A step of a stream for a pool: if it throws, the stream ends with what guarded() makes of that.
template <typename Stream, typename Step>
std::function<void()> guarded_step(Stream& stream, Step step) {
  return [&stream, step = std::move(step)] {
    const core::Status done = guarded([&]() -> core::Status {
      step();
      return {};
    });
    if (!done) stream.Finish(proto::to_grpc(done));
  };
}

}  // namespace tessera::rpc
