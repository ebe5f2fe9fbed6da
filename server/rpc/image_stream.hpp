// One picture on its way to a client.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include <mutex>
#include <optional>
#include <string>

#include "server/coordinator/coordinator.hpp"
#include "server/coordinator/fair_pool.hpp"
#include "server/rpc/stream_limits.hpp"

namespace tessera::rpc {

struct ImageCall {
  v1::GetImageRequest request;
  std::string caller;  // its key
};

// Owned by gRPC until OnDone. There is never more than one operation under way, so that its members need no
// lock, but for the one that says since when the client is waited for.
class ImageStream final : public grpc::ServerWriteReactor<v1::GetImageResponse>, private WatchedStream {
 public:
  // Develops and encodes the picture on `pool`. Until all of it is sent, the memory that took counts for its
  // caller.
  ImageStream(grpc::CallbackServerContext& context, coordinator::Coordinator& coordinator,
              coordinator::FairPool& pool, StreamLimits& streams, const ImageCall& call);

 private:
  void OnWriteDone(bool ok) override;
  void OnDone() override;
  void end_if_waiting_since(Clock::time_point time) override;

  // RESOURCE_EXHAUSTED, with the time after which to try again, if there is not enough memory left for this
  // caller.
  grpc::Status take_memory(const ImageCall& call);
  core::Status take_picture(const v1::GetImageRequest& request);
  void write_next();

  grpc::CallbackServerContext& context_;
  coordinator::Coordinator& coordinator_;
  StreamLimits& streams_;
  std::optional<coordinator::FairShare::Held> memory_;
  std::string file_;
  std::size_t sent_bytes_ = 0;
  v1::GetImageResponse response_;

  std::mutex mutex_;
  std::optional<Clock::time_point> waiting_since_;  // guarded by mutex_; while a write is under way
};

}  // namespace tessera::rpc
