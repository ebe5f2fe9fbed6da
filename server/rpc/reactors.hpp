// SPDX-License-Identifier: Apache-2.0
// Moves the work of handlers from gRPC's threads to our pools, which also finish the calls. gRPC has few
// threads for callbacks, at least two, and one that blocks stops the others. Short work without disk access
// may run on one of them at a time for each pool, since waking another thread costs a good part of such work.
#pragma once

#include <grpcpp/support/status.h>

#include <exception>
#include <functional>
#include <new>
#include <string>
#include <utility>

#include "proto/status.hpp"
#include "server/base/fair_pool.hpp"
#include "server/base/thread_pool.hpp"

namespace tessera::rpc {

// The answer to a call when too many are waiting already.
inline grpc::Status busy() {
  return proto::to_grpc(core::Error{core::ErrorCode::kUnavailable,
                                    "the coordinator has too much to do at this moment: try again"});
}

// The answer to work that still waits when the coordinator stops.
inline grpc::Status stopping() {
  return proto::to_grpc(core::Error{core::ErrorCode::kUnavailable, "the coordinator is stopping: try again"});
}

// The status of `work()`. Exceptions of libraries become a status, too.
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

// Posts a task; only FairPool uses the caller.
inline bool post(base::ThreadPool& pool, const std::string&, std::function<void()> task) {
  return pool.post(std::move(task));
}
inline bool post(base::FairPool& pool, const std::string& caller, std::function<void()> task) {
  return pool.post(caller, std::move(task));
}

// A task that finishes a unary call with the status of `work()`.
template <typename Call, typename Pool, typename Work>
std::function<void()> finishing(Call& call, const Pool& pool, Work work) {
  return [&call, &pool, work = std::move(work)] {
    call.finish(pool.is_closed() ? stopping() : proto::to_grpc(guarded(work), call.context()));
  };
}

// Answers a unary call with the status of `work()`, run on `pool`, or with when_full() if too many tasks
// wait. What `work` refers to must live until then; the call itself does.
template <typename Call, typename Pool, typename Work, typename WhenFull = grpc::Status (*)()>
void run_unary(Call& call, Pool& pool, Work work, WhenFull when_full = busy) {
  if (!post(pool, call.caller().key, finishing(call, pool, std::move(work)))) call.finish(when_full());
}

// The same for short work, which may run on the calling thread (run_or_post).
template <typename Call, typename Work>
void run_short_unary(Call& call, base::ThreadPool& pool, Work work) {
  if (!pool.run_or_post(finishing(call, pool, std::move(work)))) call.finish(busy());
}

// A step of a stream for a pool. If it throws, the stream ends with the status of guarded().
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
