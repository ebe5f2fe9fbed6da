// SPDX-License-Identifier: Apache-2.0
// How handlers leave gRPC's threads: every call's work is posted to a pool of ours, and the call finished
// from there. gRPC has few threads for callbacks, at least two; one that blocks stops the others. What is
// short is done on one of them at a time, since waking another thread costs a good part of such work.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

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
template <typename Pool, typename Work>
std::function<void()> finishing(grpc::ServerUnaryReactor* reactor, const Pool& pool, Work work) {
  return [reactor, &pool, work = std::move(work)] {
    reactor->Finish(pool.is_closed() ? stopping() : proto::to_grpc(guarded(work)));
  };
}

// Answers a unary call of `caller` with the status of `work()`, run on `pool`, or with when_full() if too
// much waits for that. What `work` refers to must live until then; request and response of a call do.
template <typename Pool, typename Work, typename WhenFull = grpc::Status (*)()>
grpc::ServerUnaryReactor* run_unary(grpc::CallbackServerContext* context, Pool& pool,
                                    const std::string& caller, Work work, WhenFull when_full = busy) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  if (!post(pool, caller, finishing(reactor, pool, std::move(work)))) reactor->Finish(when_full());
  return reactor;
}

// The same for work that is short, which may be done on the calling thread (run_or_post).
template <typename Work>
grpc::ServerUnaryReactor* run_short_unary(grpc::CallbackServerContext* context, coordinator::ThreadPool& pool,
                                          Work work) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  if (!pool.run_or_post(finishing(reactor, pool, std::move(work)))) reactor->Finish(busy());
  return reactor;
}

// Answers a unary call without looking at it.
inline grpc::ServerUnaryReactor* refuse(grpc::CallbackServerContext* context, const grpc::Status& status) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  reactor->Finish(status);
  return reactor;
}

// The same for a stream, e.g. RefusedStream<grpc::ServerWriteReactor<Response>>. Owned by gRPC until OnDone.
template <typename Reactor>
class RefusedStream final : public Reactor {
 public:
  explicit RefusedStream(const grpc::Status& status) { this->Finish(status); }

 private:
  void OnDone() override { delete this; }
};

}  // namespace tessera::rpc
